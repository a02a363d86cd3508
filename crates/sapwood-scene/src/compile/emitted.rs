//! Emitted components: what came out of rules, found by its content.
//!
//! A component lies behind a shared pointer, so that its rule can run while others are published.

use std::sync::Arc;

use sapwood_geom::{Digest, FixedMap, FixedSet, fixed_state};
use sapwood_graph::Kind;

use crate::column::Column;
use crate::semantic::AnyComponent;

/// A component that came out of a rule.
pub(crate) struct Emitted {
    pub(crate) component: Arc<dyn AnyComponent>,
    /// The number of its kind, in the order in which kinds were met.
    pub(crate) kind: u32,
    pub(crate) digest: Digest,
}

/// All components that came out of rules.
pub(crate) struct EmittedComponents {
    rows: Column<Emitted>,
    index: FixedMap<(Kind, Digest), u32>,
    kinds: Vec<Kind>,
    numbers: FixedMap<Kind, u32>,
}

impl EmittedComponents {
    pub(crate) fn new() -> Self {
        Self {
            rows: Column::new(),
            index: FixedMap::with_hasher(fixed_state()),
            kinds: Vec::new(),
            numbers: FixedMap::with_hasher(fixed_state()),
        }
    }

    /// The number of the component with this content: of the one that is there, or of this one.
    pub(crate) fn identify(&mut self, digest: Digest, component: Arc<dyn AnyComponent>) -> u32 {
        let kind = component.kind();
        *self.index.entry((kind, digest)).or_insert_with(|| {
            let kinds = &mut self.kinds;
            let number = *self.numbers.entry(kind).or_insert_with(|| {
                kinds.push(kind);
                kinds.len() as u32 - 1
            });
            self.rows.insert(Emitted { component, kind: number, digest })
        })
    }

    /// The number of the component with this content, if it is there.
    pub(crate) fn number(&self, kind: Kind, digest: Digest) -> Option<u32> {
        self.index.get(&(kind, digest)).copied()
    }

    /// The kind of a component that is there.
    pub(crate) fn kind(&self, number: u32) -> Kind {
        self.kinds[self.rows[number].kind as usize]
    }

    /// The kinds that were met, in that order.
    pub(crate) fn kinds(&self) -> &[Kind] {
        &self.kinds
    }

    /// Throws away all but those with these numbers.
    pub(crate) fn retain(&mut self, keep: &FixedSet<u32>) {
        let numbers = self.rows.iter().map(|(number, _)| number);
        let gone: Vec<u32> = numbers.filter(|number| !keep.contains(number)).collect();
        for number in gone {
            if let Some(Emitted { kind, digest, .. }) = self.rows.remove(number) {
                self.index.remove(&(self.kinds[kind as usize], digest));
            }
        }
    }
}

/// For numbers that are known to be in use.
impl std::ops::Index<u32> for EmittedComponents {
    type Output = Emitted;

    fn index(&self, number: u32) -> &Emitted {
        &self.rows[number]
    }
}
