//! Handlers: code that anyone registers for a traversal and a sort of plan.
//!
//! A table belongs to one traversal type. For each plan that a walk enters, the first of these
//! is called, and nothing where there is none; the walk goes on either way:
//!
//! 1. The *exact* handler, for the type of the plan's data: registered by whoever knows both the
//!    traversal and the rule.
//! 2. The handler for an *interface* that the rule offers of its data: the traversal's author
//!    writes it once for all rules that offer the trait, and neither crate knows the other. A
//!    rule that offers several is served by the first one of them, in its own order, that the
//!    table has.
//! 3. The *fallback* of the kind: its owner tells, for traversals that know nothing of it, which
//!    simpler data may stand in for a plan of this kind; the exact handler for those is called.
//!    What stands in is made from what every traversal sees, so it holds whichever rule compiled
//!    the component. (So does OpenUSD let an unknown prim type stand for a known one, and
//!    OpenSceneGraph an unknown node for its base class.)
//!
//! Which one it is depends on the rule alone, is found once and is then one hash access. Parts
//! have handlers of their own, by their type.

use std::any::{Any, TypeId};
use std::sync::{Arc, RwLock};

use sapwood_geom::{FixedMap, fixed_state};

use crate::parts::Rows;
use crate::{At, Kind, Named, Part, PlanRef};

type PlanHandler<T, S> = Arc<dyn Fn(&mut T, &(dyn Any + Send + Sync), &At<'_, S>) + Send + Sync>;
type PartHandler<T, S> = Box<dyn Fn(&mut T, &dyn Any, &At<'_, S>) + Send + Sync>;
type MakeStandIn = Arc<dyn Fn(&PlanRef<'_>) -> Box<dyn Any + Send + Sync> + Send + Sync>;
/// By rule and kind; nothing where no handler serves them.
type Found<T, S> = FixedMap<(TypeId, TypeId), Option<PlanHandler<T, S>>>;

/// The handlers of traversal `T`, whose interest pushes states of type `S`.
pub struct Handlers<T, S = ()> {
    plans: FixedMap<TypeId, PlanHandler<T, S>>,
    interfaces: FixedMap<TypeId, PlanHandler<T, S>>,
    fallbacks: Fallbacks,
    parts: FixedMap<TypeId, PartHandler<T, S>>,
    /// Which handler serves a rule and a kind, for those met so far.
    found: RwLock<Found<T, S>>,
}

/// What stands in for plans of certain kinds where a traversal knows nothing better.
#[derive(Clone, Default)]
pub struct Fallbacks(Vec<StandIn>);

#[derive(Clone)]
struct StandIn {
    kind: Kind,
    /// The type of what is made.
    data: TypeId,
    make: MakeStandIn,
}

impl Fallbacks {
    /// No fallbacks.
    pub fn new() -> Self {
        Self::default()
    }

    /// Lets what `make` makes of a plan stand in for plans of kind `K`.
    ///
    /// # Panics
    /// When the kind has a fallback already.
    pub fn with<K: Named, E: Any + Send + Sync>(
        mut self,
        make: impl Fn(&PlanRef<'_>) -> E + Send + Sync + 'static,
    ) -> Self {
        let make: MakeStandIn = Arc::new(move |plan| Box::new(make(plan)));
        self.add(StandIn { kind: Kind::of::<K>(), data: TypeId::of::<E>(), make });
        self
    }

    fn add(&mut self, stand_in: StandIn) {
        let kind = stand_in.kind;
        assert!(self.of(kind).is_none(), "there is a fallback for {kind}");
        self.0.push(stand_in);
    }

    fn of(&self, kind: Kind) -> Option<&StandIn> {
        self.0.iter().find(|stand_in| stand_in.kind == kind)
    }
}

impl<T: 'static, S: 'static> Handlers<T, S> {
    /// An empty table.
    pub fn new() -> Self {
        Self {
            plans: FixedMap::with_hasher(fixed_state()),
            interfaces: FixedMap::with_hasher(fixed_state()),
            fallbacks: Fallbacks::new(),
            parts: FixedMap::with_hasher(fixed_state()),
            found: RwLock::new(FixedMap::with_hasher(fixed_state())),
        }
    }

    /// Calls `handler` for each plan whose rule made data of type `D`, whatever the rule; the
    /// plan's parts are in `at.plan().parts`. For `()` that is every rule that makes no data.
    ///
    /// # Panics
    /// When a handler for `D` is registered already.
    pub fn on_plan<D: Any>(
        mut self,
        handler: impl Fn(&mut T, &D, &At<'_, S>) + Send + Sync + 'static,
    ) -> Self {
        self.forget();
        let shim: PlanHandler<T, S> = Arc::new(move |traversal, data, at| {
            if let Some(data) = data.downcast_ref::<D>() {
                handler(traversal, data, at);
            }
        });
        let earlier = self.plans.insert(TypeId::of::<D>(), shim);
        assert!(earlier.is_none(), "a handler for {} is there", std::any::type_name::<D>());
        self
    }

    /// Calls `handler` for each plan whose rule offers its data as an `I`, such as `dyn Weighs`,
    /// and that has no exact handler.
    ///
    /// # Panics
    /// When a handler for `I` is registered already.
    pub fn on_interface<I: ?Sized + 'static>(
        mut self,
        handler: impl Fn(&mut T, &I, &At<'_, S>) + Send + Sync + 'static,
    ) -> Self {
        self.forget();
        let shim: PlanHandler<T, S> = Arc::new(move |traversal, data, at| {
            if let Some(data) = at.plan().interfaces.see::<I>(data) {
                handler(traversal, data, at);
            }
        });
        let earlier = self.interfaces.insert(TypeId::of::<I>(), shim);
        assert!(earlier.is_none(), "a handler for {} is there", std::any::type_name::<I>());
        self
    }

    /// Adds what the owners of kinds let stand in for them.
    ///
    /// # Panics
    /// When a kind has a fallback already.
    pub fn with_fallbacks(mut self, fallbacks: &Fallbacks) -> Self {
        self.forget();
        for stand_in in &fallbacks.0 {
            self.fallbacks.add(stand_in.clone());
        }
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
        if let Some(handler) = self.handler(&plan) {
            handler(traversal, plan.data, at);
        }
        for (kind, rows) in plan.parts.arrays() {
            if let Some(handler) = self.parts.get(&kind.type_id()) {
                handler(traversal, rows, at);
            }
        }
    }

    /// The handler that serves a plan.
    fn handler(&self, plan: &PlanRef<'_>) -> Option<PlanHandler<T, S>> {
        let key = (plan.interfaces.rule(), plan.kind.type_id());
        let found = self.found.read().unwrap_or_else(|broken| broken.into_inner());
        if let Some(handler) = found.get(&key) {
            return handler.clone();
        }
        drop(found);
        let handler = self.find(plan);
        let mut found = self.found.write().unwrap_or_else(|broken| broken.into_inner());
        found.insert(key, handler.clone());
        handler
    }

    fn find(&self, plan: &PlanRef<'_>) -> Option<PlanHandler<T, S>> {
        let exact = self.plans.get(&plan.interfaces.data());
        let offered = || plan.interfaces.offered().find_map(|id| self.interfaces.get(&id));
        exact.or_else(offered).cloned().or_else(|| self.fallback(plan.kind))
    }

    /// What was found no longer holds when the table grows.
    fn forget(&mut self) {
        self.found.get_mut().unwrap_or_else(|broken| broken.into_inner()).clear();
    }

    fn fallback(&self, kind: Kind) -> Option<PlanHandler<T, S>> {
        let StandIn { data, make, .. } = self.fallbacks.of(kind)?;
        let (handler, make) = (Arc::clone(self.plans.get(data)?), Arc::clone(make));
        Some(Arc::new(move |traversal, _, at| {
            // Nothing stands in for what could not be compiled.
            if at.plan().error.is_none() {
                handler(traversal, &*make(&at.plan()), at);
            }
        }))
    }
}

impl<T: 'static, S: 'static> Default for Handlers<T, S> {
    fn default() -> Self {
        Self::new()
    }
}
