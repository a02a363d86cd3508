//! Where authored components lie: one typed column for each kind.

use std::any::{Any, TypeId};

use sapwood_geom::{FixedMap, fixed_state};
use sapwood_graph::Kind;

use super::Question;
use crate::column::{AnyColumn, Column};
use crate::{Children, Component};

/// Where a component lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct ComponentRow {
    pub(crate) kind: u32,
    pub(crate) row: u32,
}

/// All components of a scene.
pub(crate) struct Storage {
    kinds: Vec<KindColumn>,
    by_type: FixedMap<TypeId, u32>,
}

struct KindColumn {
    kind: Kind,
    children: Children,
    answer: Answer,
    rows: Box<dyn AnyColumn>,
}

/// How components of one kind answer questions for values.
pub(crate) type Answer = fn(&(dyn Any + Send + Sync), &mut Question);

fn answer<C: Component>(component: &(dyn Any + Send + Sync), question: &mut Question) {
    if let Some(component) = component.downcast_ref::<C>() {
        component.answer(question);
    }
}

/// A component whose type is forgotten.
pub(crate) trait AnyComponent: Any + Send + Sync {
    fn kind(&self) -> Kind;
    /// The component itself, for whoever knows its type.
    fn as_any(&self) -> &(dyn Any + Send + Sync);
}

impl<C: Component> AnyComponent for C {
    fn kind(&self) -> Kind {
        Kind::of::<C>()
    }

    fn as_any(&self) -> &(dyn Any + Send + Sync) {
        self
    }
}

impl Storage {
    pub(crate) fn new() -> Self {
        Self { kinds: Vec::new(), by_type: FixedMap::with_hasher(fixed_state()) }
    }

    fn kind_number<C: Component>(&mut self) -> u32 {
        let kinds = &mut self.kinds;
        *self.by_type.entry(TypeId::of::<C>()).or_insert_with(|| {
            let rows = Box::new(Column::<C>::new());
            let (kind, children) = (Kind::of::<C>(), C::CHILDREN);
            kinds.push(KindColumn { kind, children, answer: answer::<C>, rows });
            kinds.len() as u32 - 1
        })
    }

    pub(crate) fn insert<C: Component>(&mut self, component: C) -> ComponentRow {
        let kind = self.kind_number::<C>();
        let row = self.column_mut::<C>(kind).insert(component);
        ComponentRow { kind, row }
    }

    fn column_mut<C: Component>(&mut self, kind: u32) -> &mut Column<C> {
        let rows = self.kinds[kind as usize].rows.as_any_mut();
        rows.downcast_mut().expect("a kind's number leads to its own column")
    }

    pub(crate) fn remove(&mut self, at: ComponentRow) {
        self.kinds[at.kind as usize].rows.discard(at.row);
    }

    /// How many kinds were met.
    pub(crate) fn n_kinds(&self) -> usize {
        self.kinds.len()
    }

    /// The kind with this number, in the order in which kinds were met.
    pub(crate) fn kind_numbered(&self, number: u32) -> Kind {
        self.kinds[number as usize].kind
    }

    pub(crate) fn kind(&self, at: ComponentRow) -> Kind {
        self.kinds[at.kind as usize].kind
    }

    pub(crate) fn children(&self, at: ComponentRow) -> Children {
        self.kinds[at.kind as usize].children
    }

    /// Puts a question to a component of the kind that lies at `at`.
    pub(crate) fn offer(
        &self,
        at: ComponentRow,
        component: &(dyn Any + Send + Sync),
        question: &mut Question,
    ) {
        (self.kinds[at.kind as usize].answer)(component, question);
    }

    pub(crate) fn get(&self, at: ComponentRow) -> &(dyn Any + Send + Sync) {
        self.kinds[at.kind as usize].rows.row(at.row)
    }

    /// The component for changing; nothing if it is of another kind.
    pub(crate) fn get_mut<C: Component>(&mut self, at: ComponentRow) -> Option<&mut C> {
        let rows = self.kinds[at.kind as usize].rows.as_any_mut();
        rows.downcast_mut::<Column<C>>()?.get_mut(at.row)
    }
}
