//! Ingredients: what another component compiles to where a rule's own component stands, for a
//! rule that makes something of it.
//!
//! How they come to be is left to the compiler; here stands what a context needs of it.

use std::any::Any;
use std::sync::Arc;

use sapwood_geom::Digest;
use sapwood_graph::{Diagnostic, Kind};

use super::{AnyRule, Memories, Read};
use crate::semantic::AnyComponent;
use crate::slots::{SlotKey, SlotReader};

/// How many ingredients may be made of each other, one above the other.
pub(crate) const MOST_ABOVE_EACH_OTHER: u32 = 16;

/// How many ingredients one component may be made of.
pub(crate) const MOST_INGREDIENTS: usize = 256;

/// A component that a rule asked for, and the plan of it.
#[derive(Clone, Copy)]
pub(crate) struct Ingredient {
    pub(crate) kind: Kind,
    pub(crate) content: Digest,
    pub(crate) plan: u32,
}

/// What a plan was made of.
#[derive(Default)]
pub(crate) struct Ingredients {
    /// Each once, in the order in which they were asked for.
    pub(crate) list: Vec<Ingredient>,
    /// How many lie above each other, at most; one more than allowed where there are too many.
    pub(crate) height: u32,
}

impl Ingredients {
    /// Whether too many lie above each other.
    pub(crate) fn is_too_high(&self) -> bool {
        self.height > MOST_ABOVE_EACH_OTHER
    }
}

/// A component that must be compiled before the rule that asked for it can go on.
pub(crate) struct Need {
    pub(crate) kind: Kind,
    pub(crate) content: Digest,
    pub(crate) component: Arc<dyn AnyComponent>,
}

/// The plans that are there, as a context sees them.
pub(crate) trait CompiledPlans {
    /// The plan of a component with this content, by the rule that serves its kind, that answers
    /// to what is read through `slots`.
    fn find(
        &self,
        kind: Kind,
        content: Digest,
        slots: &mut SlotReader<'_>,
        memories: &Memories,
    ) -> Found<'_>;

    /// A plan that was found or made before.
    fn plan(&self, number: u32) -> CompiledPlan<'_>;
}

/// What was found for a component that is asked for.
pub(crate) enum Found<'a> {
    /// No rule serves its kind.
    NoRule,
    /// It has to be compiled first.
    Missing,
    Plan(CompiledPlan<'a>),
}

/// A plan, as far as a rule that asks for it needs it.
pub(crate) struct CompiledPlan<'a> {
    pub(crate) number: u32,
    pub(crate) reads: &'a [Read],
    pub(crate) slots: &'a [SlotKey],
    pub(crate) height: u32,
    /// The rule's data, or why there is none.
    pub(crate) data: Result<&'a (dyn Any + Send + Sync), &'a Diagnostic>,
    pub(crate) rule: &'a dyn AnyRule,
}

impl CompiledPlan<'_> {
    /// The kind that it was compiled from.
    pub(crate) fn kind(&self) -> Kind {
        self.rule.identity().kind
    }
}

/// Why a component fails that has too many ingredients above each other, by the kind of the first
/// of them.
pub(crate) fn too_high(first: Kind) -> String {
    format!(
        "ingredient {first}: more than {MOST_ABOVE_EACH_OTHER} ingredients are made of each other, \
         or they are made of themselves"
    )
}

/// Why a component fails that asks for too many ingredients.
pub(crate) fn too_many() -> String {
    format!("more than {MOST_INGREDIENTS} ingredients are asked for")
}
