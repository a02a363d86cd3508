//! Attributes in general: slot pushes for everything below.

use sapwood_geom::{Content, Digester};
use sapwood_graph::Named;

use crate::slots::{SlotKey, SlotValue};
use crate::{Children, Component, Context, Held, Rule, RuleError, Slot};

/// Sets any number of held slots for its child.
#[derive(Clone, Default)]
pub struct Attribute {
    /// Sorted by slot name.
    pushes: Vec<(SlotKey, SlotValue)>,
}

impl Attribute {
    /// An attribute that sets nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// The attribute with one more slot set, or set anew.
    pub fn with<S: Slot<Rate = Held>>(mut self, value: S::Value) -> Self {
        self.set::<S>(value);
        self
    }

    /// Sets a slot.
    pub fn set<S: Slot<Rate = Held>>(&mut self, value: S::Value) {
        let (slot, value) = (SlotKey::of::<S>(), SlotValue::new::<S>(value));
        match self.pushes.binary_search_by_key(&slot, |(slot, _)| *slot) {
            Ok(place) => self.pushes[place].1 = value,
            Err(place) => self.pushes.insert(place, (slot, value)),
        }
    }

    /// Sets a slot no longer, and tells whether it was set.
    pub fn clear<S: Slot<Rate = Held>>(&mut self) -> bool {
        let n = self.pushes.len();
        self.pushes.retain(|(slot, _)| *slot != SlotKey::of::<S>());
        self.pushes.len() < n
    }
}

impl Content for Attribute {
    fn write(&self, digester: &mut Digester) {
        digester.add(&self.pushes.len());
        for (slot, value) in &self.pushes {
            digester.add(slot.name()).add(&value.digest);
        }
    }
}

impl std::fmt::Debug for Attribute {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_list().entries(self.pushes.iter().map(|(slot, _)| slot)).finish()
    }
}

impl Named for Attribute {
    const NAME: &'static str = "attribute";
}

impl Component for Attribute {
    const CHILDREN: Children = Children::One;
}

pub(super) struct AttributeRule;

impl Rule for AttributeRule {
    type Component = Attribute;
    type Data = ();
    const NAME: &'static str = "attribute";

    fn init(&self, attribute: &Attribute, cx: &mut Context<'_>) -> Result<(), RuleError> {
        push_all(&attribute.pushes, cx);
        Ok(())
    }
}

/// Nests one push in another. Recurses once for each slot that the attribute sets, of which a
/// program has as many as it has slot types.
fn push_all(pushes: &[(SlotKey, SlotValue)], cx: &mut Context<'_>) {
    match pushes {
        [] => cx.children(),
        [(slot, value), rest @ ..] => {
            cx.push_value(*slot, value.clone(), |cx| push_all(rest, cx));
        }
    }
}
