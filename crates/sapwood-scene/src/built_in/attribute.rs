//! Attributes in general: slot pushes for everything below.

use sapwood_geom::{Content, Digester};
use sapwood_graph::Named;

use crate::slots::{SlotKey, SlotValue};
use crate::{Children, Component, Context, Held, PushMode, Rule, RuleError, Slot};

/// Sets any number of held slots for its child.
#[derive(Clone, Default)]
pub struct Attribute {
    /// Sorted by slot.
    pushes: Vec<Push>,
}

#[derive(Clone)]
struct Push {
    slot: SlotKey,
    mode: PushMode,
    value: SlotValue,
}

impl Attribute {
    /// An attribute that sets nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// The attribute with one more slot set, or set anew.
    pub fn with<S: Slot<Rate = Held>>(self, value: S::Value) -> Self {
        self.with_as::<S>(PushMode::Normal, value)
    }

    /// The attribute with one more slot set, or set anew, as strongly as `mode` says.
    pub fn with_as<S: Slot<Rate = Held>>(mut self, mode: PushMode, value: S::Value) -> Self {
        self.set_as::<S>(mode, value);
        self
    }

    /// Sets a slot.
    pub fn set<S: Slot<Rate = Held>>(&mut self, value: S::Value) {
        self.set_as::<S>(PushMode::Normal, value);
    }

    /// Sets a slot, as strongly as `mode` says.
    pub fn set_as<S: Slot<Rate = Held>>(&mut self, mode: PushMode, value: S::Value) {
        let (slot, value) = (SlotKey::of::<S>(), SlotValue::new::<S>(value));
        let push = Push { slot, mode, value };
        match self.place::<S>() {
            Ok(place) => self.pushes[place] = push,
            Err(place) => self.pushes.insert(place, push),
        }
    }

    /// Changes how strongly a slot is set, and tells whether it is set at all.
    pub fn set_mode<S: Slot<Rate = Held>>(&mut self, mode: PushMode) -> bool {
        let place = self.place::<S>();
        place.is_ok_and(|place| {
            self.pushes[place].mode = mode;
            true
        })
    }

    /// Sets a slot no longer, and tells whether it was set.
    pub fn clear<S: Slot<Rate = Held>>(&mut self) -> bool {
        let place = self.place::<S>();
        place.is_ok_and(|place| {
            self.pushes.remove(place);
            true
        })
    }

    /// Where a slot's push is, or where it would be.
    fn place<S: Slot>(&self) -> Result<usize, usize> {
        self.pushes.binary_search_by_key(&SlotKey::of::<S>(), |push| push.slot)
    }
}

impl Content for Attribute {
    fn write(&self, digester: &mut Digester) {
        digester.add(&self.pushes.len());
        for Push { slot, mode, value } in &self.pushes {
            digester.add(slot.name()).add(mode).add(&value.digest);
        }
    }
}

impl std::fmt::Debug for Attribute {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_list().entries(self.pushes.iter().map(|push| push.slot)).finish()
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
fn push_all(pushes: &[Push], cx: &mut Context<'_>) {
    match pushes {
        [] => cx.children(),
        [Push { slot, mode, value }, rest @ ..] => {
            cx.push_value(*slot, *mode, value.clone(), |cx| push_all(rest, cx));
        }
    }
}
