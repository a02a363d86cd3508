//! Compiling a view with somebody watching: wants are passed on a few at a time and counted.

use sapwood::geom::Bound;
use sapwood::graph::{
    EnvId, Everything, Eye, Interrupted, PlanRef, Provide, SiteId, Supplied, Supply, Want, discover,
};

use crate::watch::Watch;

/// Wants that are passed on together.
const AT_ONCE: usize = 128;

/// Compiles everything that `provide` can, telling `watch`.
///
/// # Errors
/// When compiling was cancelled or a budget ran out.
pub(super) fn compile_watched(provide: impl Provide, watch: &Watch) -> Result<(), Interrupted> {
    discover(&mut Counting { provide, n_provided: 0, watch }, &Everything)
}

struct Counting<'a, P> {
    provide: P,
    n_provided: u64,
    watch: &'a Watch,
}

impl<P: Provide> Supply for Counting<'_, P> {
    fn root(&self) -> (EnvId, SiteId) {
        self.provide.root()
    }

    fn plan(&self, site: SiteId) -> PlanRef<'_> {
        self.provide.plan(site)
    }

    fn enter(&self, env: EnvId, site: SiteId, link: u32) -> (EnvId, Supplied<'_>) {
        self.provide.enter(env, site, link)
    }

    fn is_settled(&self, site: SiteId) -> bool {
        self.provide.is_settled(site)
    }

    fn bound(&self, site: SiteId) -> Option<&Bound> {
        self.provide.bound(site)
    }

    fn eye(&self) -> Option<&Eye> {
        self.provide.eye()
    }
}

impl<P: Provide> Provide for Counting<'_, P> {
    fn provide(&mut self, wants: &[Want]) -> Result<(), Interrupted> {
        for wants in wants.chunks(AT_ONCE) {
            self.provide.provide(wants)?;
            self.n_provided += wants.len() as u64;
            self.watch.compiled(self.n_provided);
        }
        Ok(())
    }

    fn begin_pass(&mut self) {
        self.provide.begin_pass();
    }

    fn settle(&mut self) {
        self.provide.settle();
    }
}
