//! A pull: the scene's side of the opening that walks see.

use std::any::TypeId;
use std::sync::{Arc, Mutex, MutexGuard};

use sapwood_geom::{Bound, Digest};
use sapwood_graph::{
    CountMemo, EnvId, Eye, Interrupted, PlanRef, Provide, SiteId, Supplied, Supply, Want,
};

use super::cache::{Cache, Link, Target};
use super::link::Covered;
use super::pushes::Pushes;
use super::resolve::Standing;
use crate::semantic::Graph;
use crate::slots::{Above, Environments, LinkFacts, LinkPushes, NO_SCOPE, SlotKey};
use crate::view::View;
use crate::{NodeId, Viewer};

/// One view's hold on the compiler while a traversal runs.
pub(crate) struct Pull<'a> {
    pub(super) graph: &'a Graph,
    pub(super) cache: &'a mut Cache,
    pub(super) view: &'a mut View,
    pub(super) number: u32,
    /// Behind a lock, for walks may enter links from several threads, and rules read from it while
    /// what others made is published.
    pub(super) environments: Arc<Mutex<Environments>>,
    eye: Option<Eye>,
    /// A site, an environment and a number of the site's key that were found to fit last.
    pub(super) fitting: Option<(SiteId, EnvId, u32)>,
    /// A site and a child that were found covered last.
    pub(super) covered: Option<Covered>,
    #[cfg(feature = "planted-faults")]
    pub(super) drops_reads: bool,
}

impl<'a> Pull<'a> {
    pub(crate) fn new(
        graph: &'a Graph,
        cache: &'a mut Cache,
        view: &'a mut View,
        number: u32,
        #[cfg(feature = "planted-faults")] drops_reads: bool,
    ) -> Self {
        cache.resolve_kinds(view, graph);
        let viewer = view.moving.get(&TypeId::of::<Viewer>());
        let eye = viewer.and_then(|viewer| *viewer.typed::<Viewer>());
        let environments = Arc::new(Mutex::new(Environments::new(&view.root_values)));
        let mut pull = Self {
            graph,
            cache,
            view,
            number,
            environments,
            eye,
            fitting: None,
            covered: None,
            #[cfg(feature = "planted-faults")]
            drops_reads,
        };
        pull.visit_moving();
        pull
    }

    /// The semantic graph that is compiled.
    pub(crate) fn graph(&self) -> &Graph {
        self.graph
    }

    /// What was compiled so far.
    pub(crate) fn cache(&self) -> &Cache {
        self.cache
    }

    /// The component at the view's root.
    pub(crate) fn root_node(&self) -> NodeId {
        self.view.root
    }

    /// The counts that are kept between countings.
    pub(crate) fn take_counts(&mut self) -> CountMemo {
        std::mem::take(&mut self.cache.counts)
    }

    /// Gives back what [`take_counts`](Self::take_counts) took.
    pub(crate) fn give_counts(&mut self, counts: CountMemo) {
        self.cache.counts = counts;
    }

    pub(super) fn environments(&self) -> MutexGuard<'_, Environments> {
        self.environments.lock().unwrap_or_else(|broken| broken.into_inner())
    }

    /// How an environment was reached; nothing for the root.
    pub(super) fn above(&self, env: EnvId) -> Option<Above> {
        self.environments().above(env)
    }

    /// The digests of slots in an environment.
    pub(super) fn digests<C: FromIterator<(SlotKey, Digest)>>(
        &self,
        env: EnvId,
        slots: impl Iterator<Item = SlotKey>,
    ) -> C {
        let mut environments = self.environments();
        slots.map(|slot| (slot, environments.digest(env, slot))).collect()
    }

    /// Whether a site's key gives the values that hold in `env`.
    pub(super) fn fits(&self, site: SiteId, env: EnvId) -> bool {
        let key = &self.cache.sites[site.0].key;
        let mut environments = self.environments();
        key.iter().all(|(slot, digest)| environments.digest(env, *slot) == *digest)
    }

    /// Whether the site's own key holds whatever slot of the child's key comes from above.
    pub(super) fn covers(&self, site: SiteId, link: u32, child: SiteId) -> bool {
        let pushes = Pushes { cache: self.cache };
        pushes.missing(site, link, child).is_empty()
    }

    /// Whether a link pushes nothing and the child's key holds nothing but what the site's own
    /// key holds: then the child fits wherever the site does.
    fn inherits(&self, site: SiteId, link: &LinkFacts, child: SiteId) -> bool {
        let mut key = self.cache.sites[site.0].key.iter();
        let mut child_key = self.cache.sites[child.0].key.iter();
        link.pushes.is_none()
            && child_key.all(|(slot, value)| {
                !slot.descends() && key.any(|above| above.0 == *slot && above.1 == *value)
            })
    }

    /// What environments need to know of a link.
    pub(super) fn facts(&self, site: SiteId, number: u32) -> LinkFacts {
        let plan = self.cache.plan_of(site);
        let link = plan.links[number as usize];
        let is_emitted = matches!(link.target, Target::Emitted(_));
        let pushes = (link.scope != NO_SCOPE).then(|| LinkPushes::new(&plan.scopes, link.scope));
        let forces = pushes.is_some() && plan.forces;
        LinkFacts { number, child_key: link.key, is_emitted, pushes, forces }
    }

    /// The authored component that a link leads to, if it leads to one.
    pub(crate) fn authored_behind(&self, site: SiteId, link: u32) -> Option<NodeId> {
        match self.cache.plan_of(site).links[link as usize].target {
            Target::Authored(node) => Some(node),
            Target::View(_) | Target::Emitted(_) => None,
        }
    }

    /// What the rule foresaw of the children of a link.
    fn foreseen(&self, site: SiteId, link: u32) -> Option<&Bound> {
        self.cache.plan_of(site).fragment.run_of(link)?.foreseen
    }
}

impl Supply for Pull<'_> {
    fn root(&self) -> (EnvId, SiteId) {
        (Environments::root(), self.view.root_site)
    }

    fn plan(&self, site: SiteId) -> PlanRef<'_> {
        let plan = self.cache.plan_of(site);
        PlanRef {
            kind: self.cache.kind_of(plan),
            authored: matches!(plan.target, Target::Authored(_)),
            fragment: &plan.fragment,
            data: self.cache.data_of(plan),
            interfaces: self.cache.interfaces_of(plan),
            parts: &plan.parts,
            live: &self.cache.sites[site.0].live,
            error: plan.error.as_deref().or(self.cache.sites[site.0].visit_error.as_deref()),
        }
    }

    fn enter(&self, env: EnvId, site: SiteId, link: u32) -> (EnvId, Supplied<'_>) {
        match &self.cache.sites[site.0].links[link as usize] {
            Link::Failed(failed) if failed.1 >= self.required(site) => {
                (env, Supplied::Failed(&failed.0))
            }
            Link::Failed(_) | Link::Unfilled => match self.foreseen(site, link) {
                Some(bound) => (env, Supplied::Foreseen(bound)),
                None => (env, Supplied::Unknown),
            },
            Link::Site(child, checked) => {
                let Standing { is_current, is_settled } = self.standing(*child);
                let row = &self.cache.sites[child.0];
                let fits = row.key.is_empty() || row.key_number == *checked;
                if is_current && is_settled && fits {
                    return (env, Supplied::Ready(*child));
                }
                // Below a settled site everything was found right when it was settled.
                if self.is_settled(site) {
                    return (env, Supplied::Ready(*child));
                }
                if !is_current {
                    return (env, Supplied::Previous(*child));
                }
                let facts = self.facts(site, link);
                let inherits = self.inherits(site, &facts, *child);
                if inherits && is_settled {
                    return (env, Supplied::Ready(*child));
                }
                let child_env = self.environments().enter(env, site, facts);
                if inherits || self.fits(*child, child_env) && self.covers(site, link, *child) {
                    (child_env, Supplied::Ready(*child))
                } else {
                    (env, Supplied::Unknown)
                }
            }
        }
    }

    fn is_settled(&self, site: SiteId) -> bool {
        let row = &self.cache.sites[site.0];
        row.is_closed && row.verified >= self.required(site)
    }

    fn bound(&self, site: SiteId) -> Option<&Bound> {
        self.cache.sites[site.0].bound.as_ref().filter(|_| self.is_settled(site))
    }

    fn eye(&self) -> Option<&Eye> {
        self.eye.as_ref()
    }
}

impl Provide for Pull<'_> {
    fn provide(&mut self, wants: &[Want]) -> Result<(), Interrupted> {
        self.fill_all(wants)
    }

    fn begin_pass(&mut self) {
        self.fitting = None;
        self.covered = None;
        self.environments().clear();
    }

    fn settle(&mut self) {
        self.settle_all();
    }
}
