//! Rule sets: which rule serves which kind.

use std::fmt;
use std::panic::Location;
use std::sync::Arc;

use sapwood_graph::Kind;

use super::{AnyRule, Rule};

/// Which rule serves which kind, in layers: what a layer lacks is looked for below it.
#[derive(Clone, Default)]
pub struct RuleSet {
    /// The highest first.
    layers: Vec<Arc<Vec<Registered>>>,
}

#[derive(Clone)]
struct Registered {
    kind: Kind,
    rule: Arc<dyn AnyRule>,
    by: &'static Location<'static>,
}

impl RuleSet {
    /// A set without rules; compiles nothing, not even groups.
    pub fn new() -> Self {
        Self::default()
    }

    /// The set with one more rule.
    ///
    /// # Panics
    /// When this layer has a rule for the kind already, or for another kind of the same name.
    /// To replace a rule of a set made elsewhere, put a layer [`over`](Self::over) it.
    #[track_caller]
    pub fn with<R: Rule>(mut self, rule: R) -> Self {
        let kind = Kind::of::<R::Component>();
        if self.layers.is_empty() {
            self.layers.push(Arc::default());
        }
        let layer = Arc::make_mut(&mut self.layers[0]);
        if let Some(earlier) = layer.iter().find(|earlier| earlier.kind == kind) {
            panic!("the rule for {kind} is registered twice, first at {}", earlier.by);
        }
        let named_alike = layer.iter().find(|other| other.kind.name() == kind.name());
        if let Some(other) = named_alike {
            panic!(
                "two kinds call themselves {kind}; the other's rule is registered at {}",
                other.by
            );
        }
        let by = Location::caller();
        layer.push(Registered { kind, rule: Arc::new(rule), by });
        self
    }

    /// The set as layers over another: its rules come first.
    pub fn over(mut self, below: &RuleSet) -> Self {
        self.layers.extend_from_slice(&below.layers);
        self
    }

    /// The rule for a kind, from the highest layer that has one.
    pub(crate) fn rule(&self, kind: Kind) -> Option<&Arc<dyn AnyRule>> {
        let mut rules = self.layers.iter().flat_map(|layer| layer.iter());
        rules.find(|rule| rule.kind == kind).map(|rule| &rule.rule)
    }
}

impl fmt::Debug for RuleSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let layer = |layer: &Arc<Vec<Registered>>| {
            layer.iter().map(|rule| (rule.kind, rule.rule.identity().name)).collect::<Vec<_>>()
        };
        f.debug_list().entries(self.layers.iter().map(layer)).finish()
    }
}
