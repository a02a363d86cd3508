//! Batches: the `init`s of a batch run side by side, and what comes of them is published in order.
//!
//! Rules are pure, so they may run ahead of their turn, on any thread. Everything else is done
//! in the order of the wants, as if nothing had run ahead, and so comes out the same whatever the
//! number of threads: what ran ahead counts only where it is what would have run now.

use rayon::prelude::*;
use sapwood_geom::{FixedSet, fixed_state};
use sapwood_graph::{EnvId, Interrupted, SiteId, Want};

use super::cache::Target;
use super::init::{Outcome, Run};
use super::pull::Pull;
use crate::rules::Memories;

/// Wants whose `init`s run ahead together; what comes of them waits for its turn in memory.
const TOGETHER: usize = 256;

/// `init`s that one thread takes at a time.
const AT_A_TIME: usize = 4;

/// How often those that lack an ingredient run ahead again once one is there; then each waits for
/// its turn.
const MOST_AGAIN: u32 = 4;

/// What the `init` of a component came to ahead of its turn.
pub(super) struct Ahead {
    target: Target,
    rule: u32,
    env: EnvId,
    previous: Option<SiteId>,
    /// Nothing where it was interrupted. Boxed, for it is handed on several times.
    run: Option<Box<Run>>,
}

impl Ahead {
    /// What it came to, if it ran for this component in this environment.
    pub(super) fn outcome_for(
        self,
        target: Target,
        rule: u32,
        env: EnvId,
        previous: Option<SiteId>,
    ) -> Option<Box<Run>> {
        let is_it =
            (self.target, self.rule, self.env, self.previous) == (target, rule, env, previous);
        self.run.filter(|_| is_it)
    }

    fn is_lacking(&self) -> bool {
        self.run.as_ref().is_some_and(|run| matches!(run.outcome, Outcome::Needs(..)))
    }
}

impl Pull<'_> {
    /// Fills links, in order.
    pub(super) fn fill_all(&mut self, wants: &[Want]) -> Result<(), Interrupted> {
        for (i, together) in wants.chunks(TOGETHER).enumerate() {
            let outcome = self.fill_together(together);
            if let Err((n_filled, why)) = outcome {
                if let Interrupted::Exhausted { .. } = why {
                    self.let_go(&wants[i * TOGETHER + n_filled..]);
                }
                return Err(why);
            }
        }
        Ok(())
    }

    /// Fills links; where that is interrupted, tells how many were filled as well.
    fn fill_together(&mut self, wants: &[Want]) -> Result<(), (usize, Interrupted)> {
        let mut all_ahead = self.run_ahead(wants);
        let mut n_again = 0;
        for (i, want) in wants.iter().enumerate() {
            let ahead = all_ahead.get_mut(i).and_then(Option::take);
            let is_lacking = ahead.as_ref().is_some_and(Ahead::is_lacking);
            self.fill(*want, ahead).map_err(|why| (i, why))?;
            if is_lacking {
                // What it lacked is there now, and others may have lacked the same.
                n_again += 1;
                self.run_again(&mut all_ahead[i + 1..], n_again <= MOST_AGAIN);
            }
        }
        Ok(())
    }

    /// Runs the `init`s of whatever has to be made, each once.
    fn run_ahead(&mut self, wants: &[Want]) -> Vec<Option<Ahead>> {
        if wants.len() < 2 || rayon::current_num_threads() < 2 {
            return Vec::new();
        }
        let mut seen: FixedSet<(Target, u32)> = FixedSet::with_hasher(fixed_state());
        let mut all: Vec<Option<Ahead>> =
            wants.iter().map(|want| self.foreseen_run(*want, &mut seen)).collect();
        self.run_all(&mut all, |_| true);
        all
    }

    /// Which `init` will run for a want, if one will.
    fn foreseen_run(&mut self, want: Want, seen: &mut FixedSet<(Target, u32)>) -> Option<Ahead> {
        let previous = self.previous(want)?;
        let target = self.cache.plan_of(want.site).links[want.link as usize].target;
        self.cache.resolve_kinds(self.view, self.graph);
        self.target_kind(target)?;
        let rule = self.rule_for(target)?;
        // Whoever comes later may find what the first one will have made.
        if !seen.insert((target, rule)) {
            return None;
        }
        let env = self.behind(want);
        let memories = self.memories(target, rule, previous);
        let revision = self.revision_of(target);
        let is_there =
            self.is_too_deep(env) || self.find(target, rule, revision, env, &memories).is_some();
        (!is_there).then_some(Ahead { target, rule, env, previous, run: None })
    }

    /// Runs those again that lacked an ingredient, or forgets what they came to.
    fn run_again(&self, all: &mut [Option<Ahead>], is_worth_it: bool) {
        if is_worth_it {
            self.run_all(all, Ahead::is_lacking);
            return;
        }
        for ahead in all {
            if ahead.as_ref().is_some_and(Ahead::is_lacking) {
                *ahead = None;
            }
        }
    }

    fn run_all(&self, all: &mut [Option<Ahead>], which: impl Fn(&Ahead) -> bool) {
        let mut chosen: Vec<&mut Ahead> =
            all.iter_mut().flatten().filter(|ahead| which(ahead)).collect();
        if chosen.is_empty() {
            return;
        }
        let limits = self.limits();
        chosen.par_iter_mut().with_min_len(AT_A_TIME).for_each(|ahead| {
            let Ahead { target, rule, env, previous, .. } = **ahead;
            let memories: Memories = self.memories(target, rule, previous);
            // An interruption is met again when its turn comes, and counts then.
            ahead.run = self.init(target, rule, env, &memories, &[], &limits).ok().map(Box::new);
        });
    }
}
