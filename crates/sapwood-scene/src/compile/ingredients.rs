//! Ingredients: what a rule asks for is compiled first, and then its `init` is begun again.
//!
//! Rules are pure, so an `init` that met something missing is thrown away without harm. What is
//! under way lies on a stack of its own; nothing here recurses. Beyond the limit the first asker
//! fails alone: whether more ingredients than allowed lie above each other is the same whichever
//! of them were compiled before, so what fails does not depend on that.

use std::sync::Arc;

use sapwood_geom::Digest;
use sapwood_graph::{EnvId, Interrupted, Kind};

use super::cache::{Cache, Plan, Target};
use super::init::{Outcome, Run, Unfinished};
use super::pull::Pull;
use crate::log::Action;
use crate::rules::{
    CompiledPlan, CompiledPlans, Draft, DraftTables, Found, Ingredient, MOST_ABOVE_EACH_OTHER,
    MOST_INGREDIENTS, Memories, Need, too_high, too_many,
};
use crate::slots::{SlotKey, SlotReader};
use crate::view::{RootValues, View};

/// How much may be compiled.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Allowance {
    /// What the view's budget allows.
    Budget,
    /// Anything: what is made again to be compared is there already.
    Anything,
}

/// A component whose `init` is under way: it waits for the one after it.
struct Pending {
    target: Target,
    rule: u32,
    kind: Kind,
    content: Digest,
    /// What it was found to be made of so far.
    known: Vec<Ingredient>,
    unfinished: Unfinished,
}

impl Pull<'_> {
    /// Compiles a component, its ingredients first, and publishes the plan. Its `init` may have
    /// run ahead already.
    pub(super) fn make(
        &mut self,
        target: Target,
        rule: u32,
        revision: u64,
        env: EnvId,
        memories: &Memories,
        ahead: Option<Box<Run>>,
    ) -> Result<u32, Interrupted> {
        self.note_compiled(target, rule);
        let mut made = Vec::new();
        let draft = self.draft(target, rule, env, memories, Allowance::Budget, &mut made, ahead);
        let outcome = draft.and_then(|draft| self.publish(target, rule, revision, draft));
        if let Err(Interrupted::Exhausted { .. }) = outcome {
            // They would be thrown away and made again for as long as that seems to make room.
            made.into_iter().rev().for_each(|plan| self.discard(plan));
        }
        outcome
    }

    /// What the rule makes of a component. Ingredients that are not there yet are published on
    /// the way, and added to `made`. What its `init` came to `ahead` counts where the budget, as
    /// it is by now, would have allowed it.
    #[expect(clippy::too_many_arguments, reason = "all of it is needed to begin again")]
    pub(super) fn draft(
        &mut self,
        target: Target,
        rule: u32,
        env: EnvId,
        memories: &Memories,
        allowance: Allowance,
        made: &mut Vec<u32>,
        ahead: Option<Box<Run>>,
    ) -> Result<Draft, Interrupted> {
        let first = match ahead.filter(|run| self.limits().allow(run.triangles, run.n_parts)) {
            Some(run) => run.outcome,
            None => self.begin(target, rule, env, memories, &[], allowance)?,
        };
        let mut outcome = match first {
            Outcome::Made(draft) if draft.tables.ingredients.list.is_empty() => return Ok(draft),
            outcome => outcome,
        };
        let kind = self.cache.rules[rule as usize].identity.kind;
        let mut pending = vec![Pending::new(target, rule, kind, Digest::from_bits(0))];
        while let Some(mut top) = pending.pop() {
            self.note_found(&mut top.known, &outcome, env)?;
            match outcome {
                Outcome::Made(draft) => {
                    let Some(mut asker) = pending.pop() else { return Ok(draft) };
                    let Pending { target, rule, kind, content, .. } = top;
                    let plan = match allowance {
                        Allowance::Budget => self.publish(target, rule, 0, draft)?,
                        Allowance::Anything => self.publish_unlimited(target, rule, 0, draft),
                    };
                    self.enlist(target, rule, plan);
                    made.push(plan);
                    asker.known.push(Ingredient { kind, content, plan });
                    pending.push(asker);
                }
                Outcome::Needs(need, unfinished) => {
                    top.unfinished = unfinished;
                    if top.known.len() == MOST_INGREDIENTS {
                        // A pure rule was refused before it got here: this one asks for others
                        // each time.
                        let Unfinished { reads, slots, .. } = std::mem::take(&mut top.unfinished);
                        let tables = DraftTables { reads, ..DraftTables::default() };
                        let error = Draft::error(top.kind, too_many(), tables, slots);
                        outcome = Outcome::Made(error);
                        pending.push(top);
                        continue;
                    }
                    pending.push(top);
                    let Need { kind, content, component } = need;
                    let target = Target::Emitted(self.cache.emitted.identify(content, component));
                    self.cache.resolve_kinds(self.view, self.graph);
                    let rule = self.rule_for(target).expect("what no rule serves is no need");
                    let is_made_of_itself =
                        pending.iter().any(|asker| (asker.target, asker.rule) == (target, rule));
                    if is_made_of_itself || pending.len() > MOST_ABOVE_EACH_OTHER as usize {
                        return Ok(too_high_draft(pending, kind));
                    }
                    self.note_compiled(target, rule);
                    pending.push(Pending::new(target, rule, kind, content));
                }
            }
            let Some(Pending { target, rule, known, .. }) = pending.last() else { break };
            outcome = self.begin(*target, *rule, env, memories, known, allowance)?;
        }
        unreachable!("the first asker is there until its draft is returned")
    }

    fn begin(
        &self,
        target: Target,
        rule: u32,
        env: EnvId,
        memories: &Memories,
        known: &[Ingredient],
        allowance: Allowance,
    ) -> Result<Outcome, Interrupted> {
        let limits = match allowance {
            Allowance::Budget => self.limits(),
            Allowance::Anything => self.limits().without_budget(),
        };
        Ok(self.init(target, rule, env, memories, known, &limits)?.outcome)
    }

    fn note_compiled(&mut self, target: Target, rule: u32) {
        let identity = self.cache.rules[rule as usize].identity;
        self.cache.log.note(Action::Compiled, &identity, target);
    }

    /// Notes ingredients that were there already, each once.
    fn note_found(
        &mut self,
        known: &mut Vec<Ingredient>,
        outcome: &Outcome,
        env: EnvId,
    ) -> Result<(), Interrupted> {
        let asked = match outcome {
            Outcome::Made(draft) => &draft.tables.ingredients.list,
            Outcome::Needs(_, unfinished) => &unfinished.ingredients.list,
        };
        for ingredient in asked {
            if !known.iter().any(|known| known.plan == ingredient.plan) {
                self.note_reused(ingredient.plan, env)?;
                known.push(*ingredient);
            }
        }
        Ok(())
    }

    /// Throws a plan away that nothing is made of and nothing shows.
    fn discard(&mut self, plan: u32) {
        let Plan { target, rule, .. } = self.cache.plans[plan];
        let identity = self.cache.rules[rule as usize].identity;
        self.cache.log.note(Action::Discarded, &identity, target);
        if let Some(group) = self.cache.groups.get_mut(&(target, rule))
            && !group.retain(&|other| other != plan)
        {
            self.cache.groups.remove(&(target, rule));
        }
        self.cache.remove_plan(plan);
    }
}

impl Pending {
    fn new(target: Target, rule: u32, kind: Kind, content: Digest) -> Self {
        let (known, unfinished) = (Vec::new(), Unfinished::default());
        Self { target, rule, kind, content, known, unfinished }
    }
}

/// The error of the first asker, which answers to everything that led to the limit.
fn too_high_draft(pending: Vec<Pending>, last: Kind) -> Draft {
    let (kind, first) = (pending[0].kind, pending.get(1).map_or(last, |asked| asked.kind));
    let mut tables = DraftTables::default();
    let mut slots: Vec<SlotKey> = Vec::new();
    for Pending { known, unfinished, .. } in pending {
        for read in unfinished.reads {
            if !tables.reads.iter().any(|known| known.key.asks_same(&read.key)) {
                tables.reads.push(read);
            }
        }
        slots.extend_from_slice(&unfinished.slots);
        tables.ingredients.list.extend(known);
    }
    slots.sort_unstable();
    slots.dedup();
    tables.ingredients.height = MOST_ABOVE_EACH_OTHER + 1;
    Draft::error(kind, too_high(first), tables, slots.into())
}

/// The plans that are there, for rules that run while plans are published: they see none.
pub(super) struct PlansUnseen {
    pub(super) root_values: Arc<RootValues>,
}

impl CompiledPlans for PlansUnseen {
    fn find(&self, kind: Kind, _: Digest, _: &mut SlotReader<'_>, _: &Memories) -> Found<'_> {
        let rule = self.root_values.rules.rule(kind);
        rule.map_or(Found::NoRule, |_| Found::Missing)
    }

    fn plan(&self, _: u32) -> CompiledPlan<'_> {
        unreachable!("a plan that was found before was seen")
    }
}

/// The plans that are there, for the rules of one view.
pub(super) struct PlansOfView<'a> {
    pub(super) cache: &'a Cache,
    pub(super) view: &'a View,
}

impl CompiledPlans for PlansOfView<'_> {
    fn find(
        &self,
        kind: Kind,
        content: Digest,
        slots: &mut SlotReader<'_>,
        memories: &Memories,
    ) -> Found<'_> {
        if self.view.root_values.rules.rule(kind).is_none() {
            return Found::NoRule;
        }
        let mut known = || {
            let number = self.cache.emitted.number(kind, content)?;
            let kind = self.cache.emitted[number].kind;
            let rule = self.view.emitted_rules.get(kind as usize).copied().flatten()?;
            let group = self.cache.groups.get(&(Target::Emitted(number), rule))?;
            group.find(|key| key.read_again(slots, memories))
        };
        known().map_or(Found::Missing, |plan| Found::Plan(self.plan(plan)))
    }

    fn plan(&self, number: u32) -> CompiledPlan<'_> {
        let plan = &self.cache.plans[number];
        CompiledPlan {
            number,
            reads: &plan.reads,
            slots: &plan.slots,
            height: plan.ingredients.as_ref().map_or(0, |made_of| made_of.height),
            data: match plan.error.as_deref() {
                Some(error) => Err(error),
                None => Ok(self.cache.data_of(plan)),
            },
            rule: &*self.cache.rules[plan.rule as usize].rule,
        }
    }
}
