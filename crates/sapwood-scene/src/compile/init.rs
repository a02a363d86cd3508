//! Running a rule's `init`, and distrusting it.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex};

use sapwood_geom::{FixedSet, fixed_state};
use sapwood_graph::{EnvId, Interrupted};

use super::cache::{Plan, Target};
use super::ingredients::{Allowance, PlansOfView};
use super::pull::Pull;
use crate::NodeId;
use crate::panic::words_of;
use crate::rules::{
    AnyRule, Context, Draft, Ingredient, Ingredients, Limits, Memories, Need, Read, RuleError,
    RuleIdentity, Stock,
};
use crate::semantic::{AnyComponent, Graph};
use crate::slots::{Environments, SlotKey, SlotReader};

impl Pull<'_> {
    /// What the view may still compile.
    pub(super) fn limits(&self) -> Limits {
        Limits {
            cancel: self.view.cancel.clone(),
            budget: self.view.budget,
            triangles: self.cache.triangles,
            n_parts: self.cache.n_parts,
            n_plans: self.cache.plans.len() as u64,
            #[cfg(feature = "planted-faults")]
            drops_reads: self.drops_reads,
            #[cfg(feature = "planted-faults")]
            drops_ingredients: self.cache.drops_ingredients,
        }
    }

    /// What running a rule on a component in an environment needs of the cache.
    pub(super) fn job(&self, target: Target, rule: u32, env: EnvId) -> Job {
        let known = &self.cache.rules[rule as usize];
        let source = match target {
            Target::View(_) => Source::View,
            Target::Authored(node) => Source::Authored(node),
            Target::Emitted(number) => {
                Source::Emitted(Arc::clone(&self.cache.emitted[number].component))
            }
        };
        Job { source, rule: Arc::clone(&known.rule), identity: known.identity, env }
    }

    /// Runs the rule on a component in an environment, made of the `known` ingredients and of
    /// others that are there.
    pub(super) fn init(
        &self,
        target: Target,
        rule: u32,
        env: EnvId,
        memories: &Memories,
        known: &[Ingredient],
        limits: &Limits,
    ) -> Result<Run, Interrupted> {
        let plans = PlansOfView { cache: self.cache, view: self.view };
        let stock = Stock { plans: &plans, known };
        self.job(target, rule, env).run(self.graph, &self.environments, memories, stock, limits)
    }

    /// Runs the rules again for a plan that was found and for all that it was made of, and
    /// compares.
    ///
    /// # Panics
    /// When a rule makes something else of the same reads: it is no pure function, or a read
    /// went unrecorded.
    pub(super) fn check(&mut self, plan: u32, env: EnvId) -> Result<(), Interrupted> {
        let was_on = std::mem::replace(&mut self.cache.log.is_on, false);
        self.cache.is_checking = false;
        let mut checked: FixedSet<u32> = FixedSet::with_hasher(fixed_state());
        let mut stack = vec![plan];
        let mut outcome = Ok(());
        while let (Some(plan), Ok(())) = (stack.pop(), &outcome) {
            if checked.insert(plan) {
                stack.extend(self.cache.ingredients_of(plan));
                outcome = self.check_one(plan, env);
            }
        }
        self.cache.log.is_on = was_on;
        self.cache.is_checking = true;
        outcome
    }

    fn check_one(&mut self, plan: u32, env: EnvId) -> Result<(), Interrupted> {
        let (target, rule, revision, memories) = {
            let plan = &self.cache.plans[plan];
            (plan.target, plan.rule, plan.revision, Memories::of(&plan.reads))
        };
        let allowance = Allowance::Anything;
        let again = self.draft(target, rule, env, &memories, allowance, &mut Vec::new(), None);
        let again = self.publish_unlimited(target, rule, revision, again?);
        let is_same = {
            let (old, new) = (&self.cache.plans[plan], &self.cache.plans[again]);
            // What has too many ingredients above each other reads what led to the limit, which
            // depends on which of them are there already.
            let is_too_high = |plan: &Plan| {
                plan.ingredients.as_ref().is_some_and(|made_of| made_of.is_too_high())
            };
            (old.reads == new.reads || is_too_high(old) && is_too_high(new))
                && self.cache.digest_of(old) == self.cache.digest_of(new)
        };
        self.cache.remove_plan(again);
        let identity = self.cache.rules[rule as usize].identity;
        assert!(
            is_same,
            "rule {} compiles {} differently when run again on the same input",
            identity.name, identity.kind,
        );
        Ok(())
    }
}

/// A rule, and the component that it shall compile where that stands.
pub(super) struct Job {
    source: Source,
    rule: Arc<dyn AnyRule>,
    identity: RuleIdentity,
    env: EnvId,
}

/// Where a component comes from.
enum Source {
    View,
    Authored(NodeId),
    Emitted(Arc<dyn AnyComponent>),
}

impl Job {
    /// Runs the rule. A failure or a panic becomes the draft of an error plan; an interruption
    /// becomes nothing.
    pub(super) fn run(
        &self,
        graph: &Graph,
        environments: &Mutex<Environments>,
        memories: &Memories,
        stock: Stock<'_>,
        limits: &Limits,
    ) -> Result<Run, Interrupted> {
        limits.check_cancelled()?;
        let identity = self.identity;
        let slots = SlotReader::new(environments, self.env);
        let (component, node) = match &self.source {
            Source::View => (Err("a view's root is no component".to_owned()), None),
            Source::Authored(node) => (graph.effective(*node), Some(*node)),
            Source::Emitted(component) => (Ok(component.as_any()), None),
        };
        let mut cx = Context::new(slots, graph, node, memories, stock, limits, identity.kind);
        let component = match component {
            Ok(component) => component,
            Err(message) => return Ok(Run::from(Outcome::Made(cx.into_error(message)))),
        };
        let outcome = catch_unwind(AssertUnwindSafe(|| self.rule.init(component, &mut cx)));
        if let Some(why) = cx.interrupted() {
            return Err(why);
        }
        let (triangles, n_parts) = cx.reserved();
        let outcome = if let Some(need) = cx.need() {
            let (reads, ingredients, slots) = cx.into_unfinished();
            Outcome::Needs(need, Unfinished { reads, ingredients, slots })
        } else if let Some(why) = cx.refused() {
            Outcome::Made(cx.into_error(why))
        } else {
            Outcome::Made(match outcome {
                Ok(Ok(data)) => cx.into_draft(data),
                Ok(Err(RuleError::Interrupted(why))) => return Err(why),
                Ok(Err(RuleError::Failed(message))) => cx.into_error(message),
                Err(panic) => {
                    let why = format!("rule {} panicked: {}", identity.name, words_of(&*panic));
                    cx.into_error(why)
                }
            })
        };
        Ok(Run { outcome, triangles, n_parts })
    }
}

/// What comes of running `init`, and what it reserved on the way.
pub(super) struct Run {
    pub(super) outcome: Outcome,
    pub(super) triangles: u64,
    pub(super) n_parts: u64,
}

impl From<Outcome> for Run {
    fn from(outcome: Outcome) -> Self {
        Self { outcome, triangles: 0, n_parts: 0 }
    }
}

/// What `init` came to.
#[expect(clippy::large_enum_variant, reason = "the large one is what comes nearly always")]
pub(super) enum Outcome {
    Made(Draft),
    /// Nothing yet: an ingredient has to be compiled first.
    Needs(Need, Unfinished),
}

/// What was read and found when `init` ended early.
#[derive(Default)]
pub(super) struct Unfinished {
    pub(super) reads: Vec<Read>,
    pub(super) ingredients: Ingredients,
    pub(super) slots: Arc<[SlotKey]>,
}
