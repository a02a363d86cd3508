//! Rules: how components of one kind are compiled, and which rule serves which kind.

mod context;
mod ingredients;
mod limits;
mod reads;
mod rule;
mod rule_set;

pub use context::Context;
pub(crate) use context::{Draft, DraftTables, DraftTarget, Stock, no_data};
pub(crate) use ingredients::{
    CompiledPlan, CompiledPlans, Found, Ingredient, Ingredients, MOST_ABOVE_EACH_OTHER,
    MOST_INGREDIENTS, Need, too_high, too_many,
};
pub(crate) use limits::Limits;
pub use limits::{Budget, CancelToken};
pub(crate) use reads::{Memories, Read, ReadKey, forced_digest};
pub(crate) use rule::{AnyRule, RuleIdentity};
pub use rule::{Rule, RuleError, VisitContext};
pub use rule_set::RuleSet;
