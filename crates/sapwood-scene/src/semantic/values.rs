//! The value traversal: asking a sub-graph for the value of a slot.
//!
//! An attribute may hold its values, or ask a sub-graph for them. The components of the
//! sub-graph are met in pre-order, each offers what it has, and the slot says how offers are
//! combined: the product for transforms, the last one for styles. Value sub-graphs hang below
//! their attributes like children do: an edit in one marks the attribute and all above it.

use std::sync::Arc;

use sapwood_geom::{FixedMap, fixed_state};
use smallvec::SmallVec;

use super::{Graph, NodeId};
use crate::slots::{SlotKey, SlotValue};
use crate::{EditError, Held, Slot};

/// Components that one question visits at most: a sub-graph that shares its parts may hold many
/// more occurrences than components.
const MOST_VISITS: usize = 1 << 20;

/// A question for the value of one slot, on its way through a value sub-graph.
pub struct Question {
    slot: SlotKey,
    answer: Option<SlotValue>,
    goes_on: GoesOn,
}

enum GoesOn {
    Nowhere,
    Everywhere,
    To(usize),
}

impl Question {
    fn new(slot: SlotKey) -> Self {
        Self { slot, answer: None, goes_on: GoesOn::Nowhere }
    }

    /// Offers a value of slot `S`; does nothing where another slot is asked for.
    pub fn offer<S: Slot<Rate = Held>>(&mut self, value: S::Value) {
        if self.slot == SlotKey::of::<S>() {
            self.combine(SlotValue::new::<S>(value));
        }
    }

    /// Offers a value whose type is forgotten.
    pub(crate) fn offer_value(&mut self, slot: SlotKey, value: &SlotValue) {
        if self.slot == slot {
            self.combine(value.clone());
        }
    }

    fn combine(&mut self, value: SlotValue) {
        self.answer = Some(match self.answer.take() {
            None => value,
            Some(earlier) => self.slot.combine(&earlier, &value),
        });
    }

    /// Goes on to all children of the component, after it.
    pub fn children(&mut self) {
        self.goes_on = GoesOn::Everywhere;
    }

    /// Goes on to one child of the component, if it has so many.
    pub fn child(&mut self, index: usize) {
        self.goes_on = GoesOn::To(index);
    }
}

/// Which nodes ask which value sub-graphs.
pub(crate) struct ValueGraphs {
    /// The top that each node asks, and its place among those that do.
    asks: FixedMap<NodeId, (NodeId, usize)>,
    askers: FixedMap<NodeId, SmallVec<[NodeId; 2]>>,
}

impl ValueGraphs {
    pub(crate) fn new() -> Self {
        Self {
            asks: FixedMap::with_hasher(fixed_state()),
            askers: FixedMap::with_hasher(fixed_state()),
        }
    }

    /// The top of the value sub-graph that a node asks.
    pub(crate) fn asked_by(&self, node: NodeId) -> Option<NodeId> {
        self.asks.get(&node).map(|(top, _)| *top)
    }

    /// The nodes that ask the value sub-graph below a node.
    pub(crate) fn askers(&self, top: NodeId) -> &[NodeId] {
        if self.askers.is_empty() {
            return &[];
        }
        self.askers.get(&top).map_or(&[], |askers| askers)
    }

    fn set(&mut self, node: NodeId, top: Option<NodeId>) {
        if let Some((old, place)) = self.asks.remove(&node)
            && let Some(askers) = self.askers.get_mut(&old)
        {
            askers.swap_remove(place);
            let moved = askers.get(place).and_then(|moved| self.asks.get_mut(moved));
            if let Some((_, old_place)) = moved {
                *old_place = place;
            }
            if askers.is_empty() {
                self.askers.remove(&old);
            }
        }
        if let Some(top) = top {
            let askers = self.askers.entry(top).or_default();
            self.asks.insert(node, (top, askers.len()));
            askers.push(node);
        }
    }
}

impl Graph {
    /// Makes a node ask the value sub-graph below `top`, or none.
    pub(crate) fn set_value_graph(
        &mut self,
        node: NodeId,
        top: Option<NodeId>,
    ) -> Result<(), EditError> {
        self.node(node)?;
        if let Some(top) = top {
            self.node(top)?;
            self.check_acyclic(node, top)?;
        }
        self.values.set(node, top);
        self.touch(node);
        Ok(())
    }

    /// Forgets that a node asks, and tells whom it asked.
    pub(super) fn stop_asking(&mut self, node: NodeId) -> Option<NodeId> {
        let top = self.values.asked_by(node)?;
        self.values.set(node, None);
        Some(top)
    }

    /// What the sub-graph below `top` answers; nothing where nobody in it offers anything.
    pub(crate) fn answer(&self, top: NodeId, slot: SlotKey) -> Result<Option<SlotValue>, String> {
        let mut question = Question::new(slot);
        let mut stack = vec![top];
        let mut n_visits = 0;
        while let Some(node) = stack.pop() {
            n_visits += 1;
            if n_visits > MOST_VISITS {
                return Err(format!(
                    "the value sub-graph asked for {} has more than {MOST_VISITS} occurrences",
                    slot.name()
                ));
            }
            question.goes_on = GoesOn::Nowhere;
            if let Ok(row) = self.node(node) {
                let component = self.effective(node)?;
                self.storage.offer(row.component, component, &mut question);
            }
            let first = stack.len();
            match question.goes_on {
                GoesOn::Nowhere => {}
                GoesOn::Everywhere => stack.extend(self.children(node).map(|(child, _)| child)),
                GoesOn::To(index) => {
                    stack.extend(self.children(node).nth(index).map(|(child, _)| child));
                }
            }
            stack[first..].reverse();
        }
        Ok(question.answer)
    }

    /// What the sub-graph that a node asks answers, with its type.
    pub(crate) fn ask<S: Slot<Rate = Held>>(
        &self,
        node: NodeId,
    ) -> Result<Option<Arc<S::Value>>, String> {
        let Some(top) = self.values.asked_by(node) else { return Ok(None) };
        Ok(self.answer(top, SlotKey::of::<S>())?.map(|value| value.typed::<S>()))
    }
}
