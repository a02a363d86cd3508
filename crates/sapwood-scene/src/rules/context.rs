//! The context of `init`: what a rule reads from and builds with. How it comes by ingredients
//! stands in `ingredient.rs`, what it draws with in `drawing.rs`.

mod drawing;
mod ingredient;

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;

use sapwood_geom::{Bound, Digest};
use sapwood_graph::{Diagnostic, Fragment, FragmentBuilder, Interrupted, Kind, Part, Parts};
use smallvec::SmallVec;

use super::{
    CompiledPlans, Ingredient, Ingredients, Limits, Memories, Need, Read, ReadKey, RuleError,
    forced_digest,
};
use crate::semantic::{AnyComponent, Graph};
use crate::slots::{
    Memory, NO_SCOPE, PANICKED, ProjectionKey, Scope, SlotKey, SlotReader, SlotValue,
};
use crate::{Component, Held, NodeId, Projection, PushMode, Slot};

/// What a rule reads from and builds with.
///
/// Render nodes are added in pre-order; what goes into a transform or below a push is added
/// inside its closure.
pub struct Context<'a> {
    slots: SlotReader<'a>,
    graph: &'a Graph,
    node: Option<NodeId>,
    memories: &'a Memories,
    stock: Stock<'a>,
    limits: &'a Limits,
    component: Kind,
    triangles: u64,
    n_parts: u64,
    n_emitted: u64,
    /// The first interruption that the rule was told of, or that ended emitting.
    interrupted: Option<Interrupted>,
    /// Why the first mesh that nobody could draw or pick is none.
    unsound: Option<String>,
    /// The first ingredient that has to be compiled before the rule can go on.
    need: Option<Need>,
    /// Why no more ingredients are had, whatever the rule makes of it.
    refused: Option<String>,
    scope: u32,
    fragment: FragmentBuilder,
    draft: DraftTables,
}

/// Where ingredients are looked for.
#[derive(Clone, Copy)]
pub(crate) struct Stock<'a> {
    pub(crate) plans: &'a dyn CompiledPlans,
    /// Those that the component was found to be made of so far.
    pub(crate) known: &'a [Ingredient],
}

/// What `init` made beside the fragment.
#[derive(Default)]
pub(crate) struct DraftTables {
    pub(crate) reads: Vec<Read>,
    pub(crate) links: SmallVec<[DraftLink; 1]>,
    pub(crate) scopes: SmallVec<[Scope; 1]>,
    pub(crate) parts: Parts,
    pub(crate) ingredients: Ingredients,
}

/// A child to be.
pub(crate) struct DraftLink {
    pub(crate) target: DraftTarget,
    pub(crate) key: u64,
    /// The innermost push above the child, or [`NO_SCOPE`].
    pub(crate) scope: u32,
}

pub(crate) enum DraftTarget {
    Authored(NodeId),
    Emitted(Digest, Arc<dyn AnyComponent>),
}

/// What `init` made, before it becomes a plan.
pub(crate) struct Draft {
    pub(crate) fragment: Fragment,
    pub(crate) tables: DraftTables,
    pub(crate) data: Option<Box<dyn Any + Send + Sync>>,
    pub(crate) slots: Arc<[SlotKey]>,
    pub(crate) error: Option<Box<Diagnostic>>,
}

impl Draft {
    /// The draft of a plan that draws and holds nothing and tells why.
    pub(crate) fn error(
        kind: Kind,
        message: String,
        tables: DraftTables,
        slots: Arc<[SlotKey]>,
    ) -> Self {
        let error = Some(Box::new(Diagnostic { kind, message }));
        Self { fragment: Fragment::empty(), tables, data: None, slots, error }
    }
}

impl<'a> Context<'a> {
    pub(crate) fn new(
        slots: SlotReader<'a>,
        graph: &'a Graph,
        node: Option<NodeId>,
        memories: &'a Memories,
        stock: Stock<'a>,
        limits: &'a Limits,
        component: Kind,
    ) -> Self {
        Self {
            slots,
            graph,
            node,
            memories,
            stock,
            limits,
            component,
            triangles: 0,
            n_parts: 0,
            n_emitted: 0,
            interrupted: None,
            unsound: None,
            need: None,
            refused: None,
            scope: NO_SCOPE,
            fragment: FragmentBuilder::new(),
            draft: DraftTables { reads: Vec::with_capacity(8), ..DraftTables::default() },
        }
    }

    /// The draft of a plan that draws and holds nothing and tells why.
    pub(crate) fn into_error(self, message: String) -> Draft {
        let DraftTables { reads, ingredients, .. } = self.draft;
        let tables = DraftTables { reads, ingredients, ..DraftTables::default() };
        Draft::error(self.component, message, tables, self.slots.into_slots())
    }

    /// How many triangles and parts the rule has reserved.
    pub(crate) fn reserved(&self) -> (u64, u64) {
        (self.triangles, self.n_parts)
    }

    /// The interruption that the rule met, whatever it made of it: its outcome is worth nothing.
    pub(crate) fn interrupted(&mut self) -> Option<Interrupted> {
        self.interrupted.take()
    }

    /// The ingredient that has to be compiled first: the outcome is worth nothing until then.
    pub(crate) fn need(&mut self) -> Option<Need> {
        self.need.take()
    }

    /// Why no more ingredients are had: the outcome is an error, whatever the rule made of it.
    pub(crate) fn refused(&mut self) -> Option<String> {
        self.refused.take()
    }

    /// What was read and found so far, of an outcome that is worth nothing.
    pub(crate) fn into_unfinished(self) -> (Vec<Read>, Ingredients, Arc<[SlotKey]>) {
        (self.draft.reads, self.draft.ingredients, self.slots.into_slots())
    }

    /// The draft of what the rule made; an error where one of its meshes is not sound.
    pub(crate) fn into_draft(mut self, data: Box<dyn Any + Send + Sync>) -> Draft {
        if let Some(why) = self.unsound.take() {
            return self.into_error(why);
        }
        let slots = self.slots.into_slots();
        let fragment = self.fragment.finish();
        Draft { fragment, tables: self.draft, data: Some(data), slots, error: None }
    }

    /// The value of a held slot at this place. The plan is used again wherever the value is the
    /// same; read a projection where less than the whole value matters.
    pub fn read<S: Slot<Rate = Held>>(&mut self) -> Arc<S::Value> {
        let slot = SlotKey::of::<S>();
        let value = self.slots.value(slot);
        self.record(Read { key: ReadKey::Slot(slot), value: value.digest, memory: None });
        value.typed::<S>()
    }

    /// A value of the component's own, unless the slot is forced here: as if the component
    /// pushed the value for itself.
    pub fn own_or_forced<S: Slot<Rate = Held>>(&mut self, own: Arc<S::Value>) -> Arc<S::Value> {
        let slot = SlotKey::of::<S>();
        let forced = self.slots.forced_value(slot);
        let (key, value) = (ReadKey::Forced(slot), forced_digest(forced.as_ref()));
        self.record(Read { key, value, memory: None });
        forced.map_or(own, |forced| forced.typed::<S>())
    }

    /// The value of a projection at this place. The plan is used again wherever the projection
    /// gives the same, whatever the slots behind it.
    pub fn project<P: Projection>(&mut self, projection: P) -> P::Output {
        let projection = Arc::new(projection);
        let key = ProjectionKey::new(Arc::clone(&projection));
        let mut reader = self.slots.fork();
        let standing = self.memories.standing(&key, &mut reader);
        let standing = standing.and_then(|read| read.memory.as_ref()?.downcast_ref::<P::Output>());
        let output = match standing {
            Some(output) => Ok(output.clone()),
            None => catch_unwind(AssertUnwindSafe(|| projection.compute(&mut reader))),
        };
        let slots: Arc<[SlotKey]> = reader.slots.as_slice().into();
        self.slots.note(&slots);
        let digest = output.as_ref().map_or(PANICKED, Digest::of);
        let memory = output.as_ref().ok().filter(|_| P::REMEMBERS);
        let memory = memory.map(|output| Arc::new(output.clone()) as Memory);
        let key = ReadKey::Projection(Arc::new(key.reading(slots)));
        self.record(Read { key, value: digest, memory });
        // What was read is recorded, so the component is tried again when that changes.
        output.unwrap_or_else(|panic| resume_unwind(panic))
    }

    fn record(&mut self, read: Read) {
        #[cfg(feature = "planted-faults")]
        if self.limits.drops_reads && read.key.name() == crate::Placement::NAME {
            return;
        }
        if !self.draft.reads.iter().any(|known| known.key.asks_same(&read.key)) {
            self.draft.reads.push(read);
        }
    }

    /// What the component's value sub-graph answers when it is asked for a slot; nothing where it
    /// has none, or where nobody in it offers anything.
    ///
    /// # Errors
    /// When something in the sub-graph cannot be asked; pass it on.
    pub fn ask<S: Slot<Rate = Held>>(&self) -> Result<Option<Arc<S::Value>>, RuleError> {
        let Some(node) = self.node else { return Ok(None) };
        self.graph.ask::<S>(node).map_err(RuleError::Failed)
    }

    /// As [`ask`](Self::ask), the type forgotten.
    pub(crate) fn ask_value(&self, slot: SlotKey) -> Result<Option<SlotValue>, RuleError> {
        let top = self.node.and_then(|node| self.graph.values.asked_by(node));
        let Some(top) = top else { return Ok(None) };
        self.graph.answer(top, slot).map_err(RuleError::Failed)
    }

    /// How many children the component has in the semantic graph; none if it was emitted.
    pub fn n_children(&self) -> usize {
        self.node.map_or(0, |node| self.graph.children(node).count())
    }

    /// Adds the component's own children, in order.
    pub fn children(&mut self) {
        let Some(node) = self.node else { return };
        for (child, key) in self.graph.children(node) {
            self.authored(child, key);
        }
    }

    /// Adds one of the component's own children, if it has so many.
    pub fn child(&mut self, index: usize) {
        let child = self.node.and_then(|node| self.graph.children(node).nth(index));
        if let Some((child, key)) = child {
            self.authored(child, key);
        }
    }

    fn authored(&mut self, child: NodeId, key: u64) {
        if let Ok(kind) = self.graph.kind(child) {
            self.fragment.deferred(kind, None);
            let target = DraftTarget::Authored(child);
            self.draft.links.push(DraftLink { target, key, scope: self.scope });
        }
    }

    /// Adds a component that comes out of this rule; its key is its number among the children.
    pub fn emit<C: Component>(&mut self, component: C) {
        let key = self.draft.links.len() as u64;
        self.emit_keyed(key, component, None);
    }

    /// Adds a component under a key of the rule's choosing, with a bound in its own frame if
    /// the rule can tell one without compiling it.
    pub fn emit_keyed<C: Component>(&mut self, key: u64, component: C, foreseen: Option<Bound>) {
        self.n_emitted += 1;
        if let Err(why) = self.limits.check_emitted(self.n_emitted, self.component.name()) {
            self.interrupted.get_or_insert(why);
            return;
        }
        self.fragment.deferred(Kind::of::<C>(), foreseen);
        let target = DraftTarget::Emitted(Digest::of(&component), Arc::new(component));
        self.draft.links.push(DraftLink { target, key, scope: self.scope });
    }

    /// Sets a slot for whatever `inside` adds.
    pub fn push<S: Slot<Rate = Held>>(&mut self, value: S::Value, inside: impl FnOnce(&mut Self)) {
        self.push_as::<S>(PushMode::Normal, value, inside);
    }

    /// Sets a slot for whatever `inside` adds, as strongly as `mode` says.
    pub fn push_as<S: Slot<Rate = Held>>(
        &mut self,
        mode: PushMode,
        value: S::Value,
        inside: impl FnOnce(&mut Self),
    ) {
        self.push_value(SlotKey::of::<S>(), mode, SlotValue::new::<S>(value), inside);
    }

    pub(crate) fn push_value(
        &mut self,
        slot: SlotKey,
        mode: PushMode,
        value: SlotValue,
        inside: impl FnOnce(&mut Self),
    ) {
        let outer = self.scope;
        self.scope = self.draft.scopes.len() as u32;
        self.draft.scopes.push(Scope { outer, slot, mode, value });
        inside(self);
        self.scope = outer;
    }

    /// Adds the component's parts of type `P`: rows that traversals count and hand to whoever
    /// knows their type, as a vector or as something shared that holds a slice.
    ///
    /// # Panics
    /// When parts of this type were added before; the component becomes an error then.
    pub fn parts<P: Part>(&mut self, rows: impl AsRef<[P]> + Send + Sync + 'static) {
        self.draft.parts.add::<P>(rows);
    }

    /// Adds the component's parts of type `P`, `len` of them, which `make` makes when somebody asks
    /// for them: for rows that are many and follow from what the plan holds anyway.
    ///
    /// # Panics
    /// When parts of this type were added before; the component becomes an error then. Whoever
    /// asks panics when `make` makes other than `len`.
    pub fn parts_later<P: Part>(
        &mut self,
        len: usize,
        make: impl FnOnce() -> Vec<P> + Send + Sync + 'static,
    ) {
        self.draft.parts.add_later::<P>(len, make);
    }

    /// To be called now and then by rules that take long.
    ///
    /// # Errors
    /// When the caller asked to stop; pass it on.
    pub fn checkpoint(&mut self) -> Result<(), Interrupted> {
        let outcome = self.limits.check_cancelled();
        self.noting(outcome)
    }

    fn noting(&mut self, outcome: Result<(), Interrupted>) -> Result<(), Interrupted> {
        if let Err(why) = &outcome {
            self.interrupted.get_or_insert_with(|| why.clone());
        }
        outcome
    }

    /// How many parts the budget allows in all plans together: as many rows may be made only to be
    /// looked at and thrown away. A rule that needs more reserves them, and passes the error on.
    pub fn most_parts(&self) -> u64 {
        self.limits.budget.parts
    }

    /// To be called before memory for parts is taken; includes a checkpoint.
    ///
    /// # Errors
    /// When the budget does not allow so many, or the caller asked to stop; pass it on.
    pub fn reserve_parts(&mut self, n: u64) -> Result<(), Interrupted> {
        self.checkpoint()?;
        self.n_parts = self.n_parts.saturating_add(n);
        let outcome = self.limits.check_parts(self.n_parts, self.component.name());
        self.noting(outcome)
    }

    /// To be called before memory for triangles is taken; includes a checkpoint.
    ///
    /// # Errors
    /// When the budget does not allow so many, or the caller asked to stop; pass it on.
    pub fn reserve_triangles(&mut self, n: u64) -> Result<(), Interrupted> {
        self.checkpoint()?;
        self.triangles = self.triangles.saturating_add(n);
        let outcome = self.limits.check_triangles(self.triangles, self.component.name());
        self.noting(outcome)
    }
}

/// The data of an error plan.
pub(crate) fn no_data() -> &'static (dyn Any + Send + Sync) {
    &()
}
