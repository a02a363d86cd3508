//! Attributes in general: slot pushes for everything below.

use std::sync::Arc;

use sapwood_geom::{Content, Digester};
use sapwood_graph::Named;

use crate::slots::{SlotKey, SlotValue};
use crate::{Children, Component, Context, Held, PushMode, Question, Rule, RuleError, Slot};

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
    source: Source,
}

/// Where a pushed value comes from.
#[derive(Clone)]
enum Source {
    Held(SlotValue),
    /// The attribute's value sub-graph; where that answers nothing, nothing is pushed.
    Asked,
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
        self.set_source::<S>(mode, Source::Held(SlotValue::new::<S>(value)));
    }

    /// Sets a slot to what the attribute's value sub-graph answers, as strongly as `mode` says.
    /// Where it answers nothing, nothing is set.
    pub fn ask_as<S: Slot<Rate = Held>>(&mut self, mode: PushMode) {
        self.set_source::<S>(mode, Source::Asked);
    }

    /// The attribute with one more slot set to what its value sub-graph answers.
    pub fn asking<S: Slot<Rate = Held>>(mut self) -> Self {
        self.ask_as::<S>(PushMode::Normal);
        self
    }

    fn set_source<S: Slot<Rate = Held>>(&mut self, mode: PushMode, source: Source) {
        let push = Push { slot: SlotKey::of::<S>(), mode, source };
        match self.place::<S>() {
            Ok(place) => self.pushes[place] = push,
            Err(place) => self.pushes.insert(place, push),
        }
    }

    /// The value that the attribute holds for a slot; nothing where it sets none, or asks.
    pub fn get<S: Slot<Rate = Held>>(&self) -> Option<Arc<S::Value>> {
        match &self.pushes[self.place::<S>().ok()?].source {
            Source::Held(value) => Some(value.typed::<S>()),
            Source::Asked => None,
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
        for Push { slot, mode, source } in &self.pushes {
            digester.add(slot.name()).add(mode);
            match source {
                Source::Held(value) => digester.add(&0u8).add(&value.digest),
                Source::Asked => digester.add(&1u8),
            };
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

    fn answer(&self, question: &mut Question) {
        for Push { slot, mode, source } in &self.pushes {
            if let (Source::Held(value), true) = (source, *mode != PushMode::Inherit) {
                question.offer_value(*slot, value);
            }
        }
        question.children();
    }
}

pub(super) struct AttributeRule;

impl Rule for AttributeRule {
    type Component = Attribute;
    type Data = ();
    const NAME: &'static str = "attribute";

    fn init(&self, attribute: &Attribute, cx: &mut Context<'_>) -> Result<(), RuleError> {
        let mut pushes = Vec::new();
        for Push { slot, mode, source } in &attribute.pushes {
            let value = match source {
                Source::Held(value) => Some(value.clone()),
                Source::Asked => cx.ask_value(*slot)?,
            };
            pushes.extend(value.map(|value| (*slot, *mode, value)));
        }
        push_all(&pushes, cx);
        Ok(())
    }
}

/// Nests one push in another. Recurses once for each slot that the attribute sets, of which a
/// program has as many as it has slot types.
fn push_all(pushes: &[(SlotKey, PushMode, SlotValue)], cx: &mut Context<'_>) {
    match pushes {
        [] => cx.children(),
        [(slot, mode, value), rest @ ..] => {
            cx.push_value(*slot, *mode, value.clone(), |cx| push_all(rest, cx));
        }
    }
}
