//! What ends compiling early: a caller's wish, or a budget.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use sapwood_graph::Interrupted;

/// A wish to stop that any thread can utter.
#[derive(Clone, Debug, Default)]
pub struct CancelToken(Arc<AtomicBool>);

impl CancelToken {
    /// Asks whoever compiles to stop at the next checkpoint.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Takes the wish back, so that compiling can go on where it stopped.
    pub fn reset(&self) {
        self.0.store(false, Ordering::Relaxed);
    }

    /// Whether somebody asked to stop.
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// How much may be compiled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// Triangles in all plans together, every instance counted.
    pub triangles: u64,
    /// Parts in all plans together.
    pub parts: u64,
    /// Plans altogether: components that are compiled, each counted once however often it
    /// occurs, and again for each way in which what it reads differs. No single component may
    /// emit more than this either.
    pub plans: u64,
    /// Plans, and as many sites, that are kept although nothing shows them at the moment; past
    /// this they are discarded.
    pub spare_plans: usize,
    /// Emitted components above each other.
    pub emitted_depth: u32,
}

impl Default for Budget {
    /// 50 million triangles, 20 million parts, 3 million plans, of which 65,536 spare, and 1,024
    /// emitted components above each other.
    fn default() -> Self {
        Self {
            triangles: 50_000_000,
            parts: 20_000_000,
            plans: 3_000_000,
            spare_plans: 65_536,
            emitted_depth: 1024,
        }
    }
}

/// What one `init` has to keep to.
#[derive(Clone, Debug)]
pub(crate) struct Limits {
    pub(crate) cancel: CancelToken,
    pub(crate) budget: Budget,
    /// Triangles in plans that are there already.
    pub(crate) triangles: u64,
    /// Parts in plans that are there already.
    pub(crate) n_parts: u64,
    /// Plans that are there already.
    pub(crate) n_plans: u64,
    #[cfg(feature = "planted-faults")]
    pub(crate) drops_reads: bool,
    #[cfg(feature = "planted-faults")]
    pub(crate) drops_ingredients: bool,
}

impl Limits {
    pub(crate) fn check_cancelled(&self) -> Result<(), Interrupted> {
        if self.cancel.is_cancelled() { Err(Interrupted::Cancelled) } else { Ok(()) }
    }

    /// Fails when `more` triangles would exceed the budget.
    pub(crate) fn check_triangles(
        &self,
        more: u64,
        component: &'static str,
    ) -> Result<(), Interrupted> {
        let limit = self.budget.triangles;
        if self.triangles.saturating_add(more) > limit {
            return Err(Interrupted::Exhausted { what: "triangles", limit, component });
        }
        Ok(())
    }

    /// Fails when `more` parts would exceed the budget.
    pub(crate) fn check_parts(
        &self,
        more: u64,
        component: &'static str,
    ) -> Result<(), Interrupted> {
        let limit = self.budget.parts;
        if self.n_parts.saturating_add(more) > limit {
            return Err(Interrupted::Exhausted { what: "parts", limit, component });
        }
        Ok(())
    }

    /// Whether the budget allows so many triangles and parts more.
    pub(crate) fn allow(&self, triangles: u64, n_parts: u64) -> bool {
        self.check_triangles(triangles, "").is_ok() && self.check_parts(n_parts, "").is_ok()
    }

    /// Fails when `more` plans would exceed the budget.
    pub(crate) fn check_plans(
        &self,
        more: u64,
        component: &'static str,
    ) -> Result<(), Interrupted> {
        let limit = self.budget.plans;
        if self.n_plans.saturating_add(more) > limit {
            return Err(Interrupted::Exhausted { what: "plans", limit, component });
        }
        Ok(())
    }

    /// Fails when one rule emits more than could ever be compiled.
    pub(crate) fn check_emitted(&self, n: u64, component: &'static str) -> Result<(), Interrupted> {
        let limit = self.budget.plans;
        if n > limit {
            return Err(Interrupted::Exhausted { what: "plans", limit, component });
        }
        Ok(())
    }

    /// The same without any budget: for making again what is there already.
    pub(crate) fn without_budget(mut self) -> Self {
        let budget = &mut self.budget;
        (budget.triangles, budget.parts, budget.plans) = (u64::MAX, u64::MAX, u64::MAX);
        self
    }
}
