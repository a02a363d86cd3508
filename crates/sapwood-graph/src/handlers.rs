//! Handlers: code that anyone registers for a traversal and a kind.
//!
//! A table belongs to one traversal type. Plans are found by the type of their data, parts by
//! their own type; the table downcasts once and hands over typed values. Where no handler is
//! registered the walk simply goes on.

use std::any::{Any, TypeId};

use sapwood_geom::{FixedMap, fixed_state};

use crate::parts::Rows;
use crate::{At, Part};

type PlanHandler<T, S> = Box<dyn Fn(&mut T, &(dyn Any + Send + Sync), &At<'_, S>) + Send + Sync>;
type PartHandler<T, S> = Box<dyn Fn(&mut T, &dyn Any, &At<'_, S>) + Send + Sync>;

/// The handlers of traversal `T`, whose interest pushes states of type `S`.
pub struct Handlers<T, S = ()> {
    plans: FixedMap<TypeId, PlanHandler<T, S>>,
    parts: FixedMap<TypeId, PartHandler<T, S>>,
}

impl<T: 'static, S: 'static> Handlers<T, S> {
    /// An empty table.
    pub fn new() -> Self {
        Self {
            plans: FixedMap::with_hasher(fixed_state()),
            parts: FixedMap::with_hasher(fixed_state()),
        }
    }

    /// Calls `handler` for each plan whose rule made data of type `D`.
    ///
    /// # Panics
    /// When a handler for `D` is registered already.
    pub fn on_plan<D: Any>(
        mut self,
        handler: impl Fn(&mut T, &D, &At<'_, S>) + Send + Sync + 'static,
    ) -> Self {
        let shim: PlanHandler<T, S> = Box::new(move |traversal, data, at| {
            if let Some(data) = data.downcast_ref::<D>() {
                handler(traversal, data, at);
            }
        });
        let earlier = self.plans.insert(TypeId::of::<D>(), shim);
        assert!(earlier.is_none(), "a handler for {} is there", std::any::type_name::<D>());
        self
    }

    /// Calls `handler` with all parts of type `P` of each plan that has some.
    ///
    /// # Panics
    /// When a handler for `P` is registered already.
    pub fn on_parts<P: Part>(
        mut self,
        handler: impl Fn(&mut T, &[P], &At<'_, S>) + Send + Sync + 'static,
    ) -> Self {
        let shim: PartHandler<T, S> = Box::new(move |traversal, rows, at| {
            if let Some(rows) = rows.downcast_ref::<Rows<P>>() {
                handler(traversal, rows.as_slice(), at);
            }
        });
        let earlier = self.parts.insert(TypeId::of::<P>(), shim);
        assert!(earlier.is_none(), "a handler for {} is there", P::NAME);
        self
    }

    /// Runs the handlers for the plan that the walk has just entered; does nothing at nodes
    /// further inside a plan. Call it for every node of a walk.
    pub fn handle(&self, traversal: &mut T, at: &At<'_, S>) {
        if !at.enters_plan() {
            return;
        }
        let plan = at.plan();
        if let Some(handler) = self.plans.get(&(*plan.data).type_id()) {
            handler(traversal, plan.data, at);
        }
        for (kind, rows) in plan.parts.arrays() {
            if let Some(handler) = self.parts.get(&kind.type_id()) {
                handler(traversal, rows, at);
            }
        }
    }
}

impl<T: 'static, S: 'static> Default for Handlers<T, S> {
    fn default() -> Self {
        Self::new()
    }
}
