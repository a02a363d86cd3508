//! Running a rule's `init`, and distrusting it.

use std::panic::{AssertUnwindSafe, catch_unwind};

use sapwood_graph::{EnvId, Interrupted};

use super::cache::Target;
use super::pull::Pull;
use super::pushes::Pushes;
use crate::log::Action;
use crate::panic::words_of;
use crate::rules::{Context, Draft, Limits, Memories, RuleError};
use crate::slots::SlotReader;

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
        }
    }

    /// Runs the rule on a component in an environment. A failure or a panic becomes the draft
    /// of an error plan; an interruption becomes nothing.
    pub(super) fn init(
        &mut self,
        target: Target,
        rule: u32,
        env: EnvId,
        memories: Memories,
        limits: &Limits,
    ) -> Result<Draft, Interrupted> {
        limits.check_cancelled()?;
        let identity = self.cache.rules[rule as usize].identity;
        self.cache.log.note(Action::Compiled, &identity, target);
        let Self { graph, cache, view, environments, .. } = self;
        let environments = environments.get_mut().unwrap_or_else(|broken| broken.into_inner());
        let pushes = Pushes { cache, view };
        let node = match target {
            Target::Authored(node) => Some(node),
            Target::View(_) | Target::Emitted(_) => None,
        };
        let slots = SlotReader::new(&pushes, environments, env);
        let mut cx = Context::new(slots, graph, node, memories, limits, identity.kind);
        let component = match target {
            Target::Authored(node) => graph.effective(node),
            Target::View(_) => Err("a view's root is no component".to_owned()),
            Target::Emitted(number) => {
                Ok(cache.emitted_storage.get(cache.emitted[number].component))
            }
        };
        let component = match component {
            Ok(component) => component,
            Err(message) => return Ok(cx.into_error(message)),
        };
        let known = &cache.rules[rule as usize].rule;
        let outcome = catch_unwind(AssertUnwindSafe(|| known.init(component, &mut cx)));
        if let Some(why) = cx.interrupted() {
            return Err(why);
        }
        match outcome {
            Ok(Ok(data)) => Ok(cx.into_draft(data)),
            Ok(Err(RuleError::Interrupted(why))) => Err(why),
            Ok(Err(RuleError::Failed(message))) => Ok(cx.into_error(message)),
            Err(panic) => {
                let rule = identity.name;
                Ok(cx.into_error(format!("rule {rule} panicked: {}", words_of(&*panic))))
            }
        }
    }

    /// Runs the rule again for a plan that was found, and compares.
    ///
    /// # Panics
    /// When the rule makes something else of the same reads: it is no pure function, or a read
    /// went unrecorded.
    pub(super) fn check(&mut self, plan: u32, env: EnvId) -> Result<(), Interrupted> {
        let (target, rule, revision, memories) = {
            let plan = &self.cache.plans[plan];
            (plan.target, plan.rule, plan.revision, Memories::of(&plan.reads))
        };
        let was_on = std::mem::replace(&mut self.cache.log.is_on, false);
        let limits = self.limits().without_budget();
        let again = self.init(target, rule, env, memories, &limits);
        let again = again.map(|draft| self.publish_unlimited(target, rule, revision, draft));
        self.cache.log.is_on = was_on;
        let again = again?;
        let is_same = {
            let (old, new) = (&self.cache.plans[plan], &self.cache.plans[again]);
            old.reads == new.reads && self.cache.digest_of(old) == self.cache.digest_of(new)
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
