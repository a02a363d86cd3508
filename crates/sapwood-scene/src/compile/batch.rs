//! Batches: the `init`s of a batch run side by side, while what came of those of the batch before
//! is published in order.
//!
//! Rules are pure, so they may run ahead of their turn, on any thread. Everything else is done
//! in the order of the wants, as if nothing had run ahead, and so comes out the same whatever the
//! number of threads: what ran ahead counts only where it is what would have run now.

use std::sync::{Arc, Mutex};

use rayon::prelude::*;
use sapwood_geom::{FixedSet, fixed_state};
use sapwood_graph::{EnvId, Interrupted, SiteId, Want};

use super::cache::Target;
use super::ingredients::{PlansOfView, PlansUnseen};
use super::init::{Job, Outcome, Run};
use super::pull::Pull;
use crate::rules::{Limits, Memories, Stock};
use crate::semantic::Graph;
use crate::slots::Environments;

/// Wants whose `init`s run ahead together; what comes of them waits for its turn in memory.
const TOGETHER: usize = 128;

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
    memories: Memories,
    job: Job,
    /// Nothing where it was interrupted, or did not run yet. Boxed, for it is handed on several
    /// times.
    run: Option<Box<Run>>,
}

/// What is about to be made: whoever comes later may find what the first one will have made.
struct AboutToBeMade {
    batch: FixedSet<(Target, u32)>,
    /// In the batch before, which may not be published yet.
    before: FixedSet<(Target, u32)>,
}

impl AboutToBeMade {
    fn new() -> Self {
        let none = FixedSet::with_hasher(fixed_state());
        Self { batch: none.clone(), before: none }
    }

    fn begin_batch(&mut self) {
        std::mem::swap(&mut self.batch, &mut self.before);
        self.batch.clear();
    }

    fn is_first(&mut self, target: Target, rule: u32) -> bool {
        let is_new = self.batch.insert((target, rule));
        is_new && !self.before.contains(&(target, rule))
    }
}

impl Ahead {
    /// What it came to, if it ran for this component in this environment and lacked nothing: what
    /// it lacked may be there by now.
    pub(super) fn outcome_for(
        self,
        target: Target,
        rule: u32,
        env: EnvId,
        previous: Option<SiteId>,
    ) -> Option<Box<Run>> {
        let is_it =
            (self.target, self.rule, self.env, self.previous) == (target, rule, env, previous);
        let is_of_use = is_it && !self.is_lacking();
        self.run.filter(|_| is_of_use)
    }

    fn is_lacking(&self) -> bool {
        self.run.as_ref().is_some_and(|run| matches!(run.outcome, Outcome::Needs(..)))
    }
}

impl<'a> Pull<'a> {
    /// Fills links, in order.
    pub(super) fn fill_all(&mut self, wants: &[Want]) -> Result<(), Interrupted> {
        let runs_ahead = wants.len() > 1 && rayon::current_num_threads() > 1;
        let mut about = AboutToBeMade::new();
        let mut batches = wants.chunks(TOGETHER).enumerate().peekable();
        let mut next = Vec::new();
        if let Some((_, first)) = batches.peek().filter(|_| runs_ahead) {
            next = self.foresee(first, &mut about);
            self.run_all(&mut next, |_| true);
        }
        while let Some((i, batch)) = batches.next() {
            let ahead = std::mem::take(&mut next);
            let outcome = match batches.peek().filter(|_| runs_ahead) {
                None => self.fill_together(batch, ahead),
                Some((_, coming)) => {
                    next = self.foresee(coming, &mut about);
                    let beside = self.beside();
                    let outcome = rayon::in_place_scope(|scope| {
                        scope.spawn(|_| beside.run_all(&mut next));
                        self.fill_together(batch, ahead)
                    });
                    if outcome.is_ok() {
                        // What was published meanwhile is seen now.
                        self.run_all(&mut next, Ahead::is_lacking);
                    }
                    outcome
                }
            };
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
    fn fill_together(
        &mut self,
        wants: &[Want],
        mut all_ahead: Vec<Option<Ahead>>,
    ) -> Result<(), (usize, Interrupted)> {
        let mut n_again = 0;
        for (i, want) in wants.iter().enumerate() {
            let ahead = all_ahead.get_mut(i).and_then(Option::take);
            let n_plans = self.cache.plans.len();
            self.fill(*want, ahead).map_err(|why| (i, why))?;
            let has_made_ingredients = self.cache.plans.len() > n_plans + 1;
            if has_made_ingredients && n_again < MOST_AGAIN && i + 1 < all_ahead.len() {
                // Others may have lacked the same.
                n_again += 1;
                self.run_all(&mut all_ahead[i + 1..], Ahead::is_lacking);
            }
        }
        Ok(())
    }

    /// The `init`s of whatever has to be made, each once.
    fn foresee(&mut self, wants: &[Want], about: &mut AboutToBeMade) -> Vec<Option<Ahead>> {
        about.begin_batch();
        wants.iter().map(|want| self.foreseen_run(*want, about)).collect()
    }

    /// Which `init` will run for a want, if one will.
    fn foreseen_run(&mut self, want: Want, about: &mut AboutToBeMade) -> Option<Ahead> {
        let previous = self.previous(want)?;
        let target = self.cache.plan_of(want.site).links[want.link as usize].target;
        self.cache.resolve_kinds(self.view, self.graph);
        self.target_kind(target)?;
        let rule = self.rule_for(target)?;
        if !about.is_first(target, rule) {
            return None;
        }
        let env = self.behind(want);
        let memories = self.memories(target, rule, previous);
        let revision = self.revision_of(target);
        let is_there =
            self.is_too_deep(env) || self.find(target, rule, revision, env, &memories).is_some();
        let job = (!is_there).then(|| self.job(target, rule, env))?;
        Some(Ahead { target, rule, env, previous, memories, job, run: None })
    }

    /// Runs those that `which` chooses, side by side.
    fn run_all(&self, all: &mut [Option<Ahead>], which: impl Fn(&Ahead) -> bool) {
        let (limits, plans) = (self.limits(), PlansOfView { cache: self.cache, view: self.view });
        run_each(all, which, |Ahead { memories, job, .. }| {
            let stock = Stock { plans: &plans, known: &[] };
            job.run(self.graph, &self.environments, memories, stock, &limits)
        });
    }

    /// What `init`s see while what others made is published.
    fn beside(&self) -> Beside<'a> {
        let environments = Arc::clone(&self.environments);
        let plans = PlansUnseen { root_values: Arc::clone(&self.view.root_values) };
        Beside { graph: self.graph, environments, plans, limits: self.limits() }
    }
}

/// What `init`s see while what others made is published: nothing that publishing changes.
struct Beside<'a> {
    graph: &'a Graph,
    environments: Arc<Mutex<Environments>>,
    plans: PlansUnseen,
    limits: Limits,
}

impl Beside<'_> {
    fn run_all(&self, all: &mut [Option<Ahead>]) {
        run_each(
            all,
            |_| true,
            |Ahead { memories, job, .. }| {
                let stock = Stock { plans: &self.plans, known: &[] };
                job.run(self.graph, &self.environments, memories, stock, &self.limits)
            },
        );
    }
}

/// Runs `init`s side by side, a few by each thread at a time.
fn run_each(
    all: &mut [Option<Ahead>],
    which: impl Fn(&Ahead) -> bool,
    run: impl Fn(&Ahead) -> Result<Run, Interrupted> + Sync,
) {
    let mut chosen: Vec<&mut Ahead> =
        all.iter_mut().flatten().filter(|ahead| which(ahead)).collect();
    if !chosen.is_empty() {
        chosen.par_iter_mut().with_min_len(AT_A_TIME).for_each(|ahead| {
            // An interruption is met again when its turn comes, and counts then.
            ahead.run = run(ahead).ok().map(Box::new);
        });
    }
}
