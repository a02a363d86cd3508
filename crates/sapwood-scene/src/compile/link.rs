//! Linking: the plan in its context becomes a site, and the parent's link leads to it.

use sapwood_geom::{Digest, FixedMap, fixed_state};
use sapwood_graph::{Diagnostic, EnvId, Interrupted, Kind, SiteId, Supplied, Supply, Want};
use smallvec::SmallVec;

use super::batch::Ahead;
use super::cache::{Link, NOT_CHECKED, Plan, Site, Target};
use super::pull::Pull;
use super::pushes::Pushes;
use crate::slots::SlotKey;

/// A site whose key holds whatever a child of it reads below a push.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) struct Covered {
    site: SiteId,
    scope: u32,
    child: SiteId,
    /// Of the site and of the child: either key may grow.
    key_numbers: [u32; 2],
}

impl Pull<'_> {
    /// Fills one link, unless it is filled already or its site belongs to another environment
    /// by now.
    pub(super) fn fill(&mut self, want: Want, ahead: Option<Ahead>) -> Result<(), Interrupted> {
        let Want { env, site, link } = want;
        let Some(previous) = self.previous(want) else { return Ok(()) };
        if !self.fits_still(site, env) {
            return Ok(());
        }
        self.cache.sites[site.0].is_closed = false;
        let target = self.cache.plan_of(site).links[link as usize].target;
        let child_env = self.behind(want);
        let child = self.child(target, child_env, previous, ahead)?;
        match child {
            Ok(child) => {
                self.cache.sites[site.0].links[link as usize] = Link::Site(child, NOT_CHECKED);
                self.grow(child_env);
                if self.cache.sites[child.0].is_moving {
                    self.note_above(child_env, |site| std::mem::replace(&mut site.is_moving, true));
                }
                if self.cache.sites[child.0].remembers {
                    self.note_above(child_env, |site| std::mem::replace(&mut site.remembers, true));
                }
            }
            Err(diagnostic) => {
                let failed = Box::new((diagnostic, self.graph.revision));
                self.cache.sites[site.0].links[link as usize] = Link::Failed(failed);
            }
        }
        Ok(())
    }

    /// Whether a site's key gives the values that hold in `env`, where it is asked for one link
    /// of the site after the other.
    fn fits_still(&mut self, site: SiteId, env: EnvId) -> bool {
        let asked = (site, env, self.cache.sites[site.0].key_number);
        if self.fitting != Some(asked) {
            self.fitting = self.fits(site, env).then_some(asked);
        }
        self.fitting.is_some()
    }

    /// The site that a link which must be filled led to before, if any; nothing where it need
    /// not be filled.
    pub(super) fn previous(&self, Want { env, site, link }: Want) -> Option<Option<SiteId>> {
        match self.enter(env, site, link).1 {
            Supplied::Ready(_) | Supplied::Failed(_) => None,
            Supplied::Previous(_) | Supplied::Foreseen(_) | Supplied::Unknown => {
                match &self.cache.sites[site.0].links[link as usize] {
                    Link::Site(previous, _) => Some(Some(*previous)),
                    Link::Unfilled | Link::Failed(_) => Some(None),
                }
            }
        }
    }

    /// The environment behind a link.
    pub(super) fn behind(&mut self, Want { env, site, link }: Want) -> EnvId {
        let facts = self.facts(site, link);
        self.environments().enter(env, site, facts)
    }

    /// Whether as many emitted components as are allowed lie above a place.
    pub(super) fn is_too_deep(&mut self, env: EnvId) -> bool {
        let n_emitted = self.above(env).map_or(0, |above| above.n_emitted);
        n_emitted > self.view.budget.emitted_depth
    }

    /// Empties links that were about to be filled anew: what they led to may make room.
    pub(super) fn let_go(&mut self, wants: &[Want]) {
        for want in wants {
            let link = &mut self.cache.sites[want.site.0].links[want.link as usize];
            if let Link::Site(..) = link {
                *link = Link::Unfilled;
                self.cache.sites[want.site.0].is_closed = false;
            }
        }
    }

    /// The site of a component in an environment, or why there is none.
    fn child(
        &mut self,
        target: Target,
        env: EnvId,
        previous: Option<SiteId>,
        ahead: Option<Ahead>,
    ) -> Result<Result<SiteId, Diagnostic>, Interrupted> {
        self.cache.resolve_kinds(self.view, self.graph);
        let Some(kind) = self.target_kind(target) else {
            let kind = Kind::of::<super::cache::ViewRoot>();
            let message = "the component was removed from the scene".to_owned();
            return Ok(Err(Diagnostic { kind, message }));
        };
        let Some(rule) = self.rule_for(target) else {
            let message = format!("the view has no rule for components of kind {kind}");
            return Ok(Err(Diagnostic { kind, message }));
        };
        if self.is_too_deep(env) {
            let message = format!(
                "more than {} emitted components lie above each other",
                self.view.budget.emitted_depth
            );
            return Ok(Err(Diagnostic { kind, message }));
        }
        let plan = self.plan_for(target, rule, env, previous, ahead)?;
        Ok(Ok(self.site_for(plan, env, previous)))
    }

    /// The site of a plan in an environment: found by the slots that sites of the plan are
    /// known to read below, or made.
    fn site_for(&mut self, plan: u32, env: EnvId, previous: Option<SiteId>) -> SiteId {
        let row = &self.cache.plans[plan];
        let mut all: SmallVec<[SlotKey; 16]> = SmallVec::new();
        let mut expect = |slot: SlotKey| {
            if let Err(place) = all.binary_search(&slot) {
                all.insert(place, slot);
            }
        };
        if !row.has_sites {
            all.extend_from_slice(&row.slots);
            return self.new_site(plan, env, previous, &all);
        }
        for set in &row.slot_sets {
            let key: SmallVec<[_; 16]> = self.digests(env, set.iter().copied());
            if let Some(&site) = self.cache.site_index.get(&index_of(plan, self.number, &key)) {
                let found = &self.cache.sites[site.0];
                let is_ours = found.plan == plan && found.view == self.number;
                // What remembers is taken over from place to place, never found again.
                let is_present = !found.remembers || found.made_at == self.graph.revision;
                if is_ours && is_present && self.fits(site, env) {
                    self.visit_below(site);
                    return site;
                }
                // It has read more since it was indexed, as this one probably will.
                found.key.iter().filter(|_| is_ours).for_each(|(slot, _)| expect(*slot));
            }
            set.iter().copied().for_each(&mut expect);
        }
        self.new_site(plan, env, previous, &all)
    }

    /// A new site of a plan in an environment, whose key holds `slots`: everything that was ever
    /// read below the plan is likely to be read here too.
    fn new_site(
        &mut self,
        plan: u32,
        env: EnvId,
        previous: Option<SiteId>,
        slots: &[SlotKey],
    ) -> SiteId {
        let key: Vec<_> = self.digests(env, slots.iter().copied());
        self.cache.plans[plan].has_sites = true;
        let row = &self.cache.plans[plan];
        let links = match previous {
            Some(previous) => self.links_like(row, previous),
            None => row.links.iter().map(|_| Link::Unfilled).collect(),
        };
        let remembers = row.reads.iter().any(|read| read.memory.is_some())
            || links.iter().any(|link| match link {
                Link::Site(child, _) => self.cache.sites[child.0].remembers,
                Link::Unfilled | Link::Failed(_) => false,
            });
        let n_live = row.fragment.n_live() as usize;
        let site = SiteId(self.cache.sites.insert(Site {
            plan,
            view: self.number,
            key,
            key_number: 0,
            enlisted_key: None,
            indices: SmallVec::new(),
            links,
            verified: 0,
            is_closed: false,
            is_moving: n_live > 0,
            made_at: self.graph.revision,
            remembers,
            bound: None,
            live: vec![sapwood_geom::glam::Affine3::IDENTITY; n_live].into(),
            visit_error: None,
            settled_in: 0,
            visited_tick: self.view.tick,
        }));
        self.enlist_site(site);
        self.visit(site);
        site
    }

    /// Links for a new plan's site, taken over from the site of the plan before it where they
    /// lead to the same component. Whether they fit is found out on entering.
    fn links_like(&self, plan: &Plan, previous: SiteId) -> SmallVec<[Link; 1]> {
        let old = &self.cache.plan_of(previous).links;
        let filled = |place: usize| match &self.cache.sites[previous.0].links[place] {
            Link::Site(site, _) => Link::Site(*site, NOT_CHECKED),
            Link::Unfilled | Link::Failed(_) => Link::Unfilled,
        };
        let mut moved: Option<FixedMap<(Target, u64), usize>> = None;
        let links = plan.links.iter().enumerate().map(|(place, link)| {
            let same = |place: usize| {
                old.get(place).is_some_and(|old| (old.target, old.key) == (link.target, link.key))
            };
            if same(place) {
                return filled(place);
            }
            let moved = moved.get_or_insert_with(|| {
                let mut map = FixedMap::with_hasher(fixed_state());
                map.extend(old.iter().enumerate().map(|(i, old)| ((old.target, old.key), i)));
                map
            });
            moved.get(&(link.target, link.key)).map_or(Link::Unfilled, |place| filled(*place))
        });
        links.collect()
    }

    /// Lets keys grow from the link behind `env` upwards by the slots that are read below.
    fn grow(&mut self, env: EnvId) {
        let mut at = env;
        let mut expected = None;
        while let Some(above) = self.above(at) {
            let Link::Site(child, _) = self.cache.sites[above.site.0].links[above.link as usize]
            else {
                return;
            };
            if expected.is_some_and(|expected| expected != child) {
                // The place above belongs to another environment by now.
                return;
            }
            if self.is_covered(above.site, above.link, child) {
                return;
            }
            let pushes = Pushes { cache: self.cache };
            let missing = pushes.missing(above.site, above.link, child);
            if missing.is_empty() {
                self.covered = Some(self.covering(above.site, above.link, child));
                return;
            }
            let grown: SmallVec<[_; 4]> = self.digests(above.env, missing.iter().copied());
            let row = &mut self.cache.sites[above.site.0];
            for (slot, digest) in grown {
                if let Err(place) = row.key.binary_search_by_key(&slot, |(slot, _)| *slot) {
                    row.key.insert(place, (slot, digest));
                }
            }
            row.key_number += 1;
            expected = Some(above.site);
            at = above.env;
        }
    }

    /// Whether a site's key is known to hold whatever is read of it behind a link, because it does
    /// so for a child before this one that reads the same slots below the same pushes.
    fn is_covered(&self, site: SiteId, link: u32, child: SiteId) -> bool {
        let Some(covered) = self.covered else { return false };
        let sites = &self.cache.sites;
        let Some(before) = sites.get(covered.child.0) else { return false };
        let (before, now) = (&before.key, &sites[child.0].key);
        covered == self.covering(site, link, covered.child)
            && before.len() == now.len()
            && before.iter().zip(now).all(|((a, _), (b, _))| a == b)
    }

    fn covering(&self, site: SiteId, link: u32, child: SiteId) -> Covered {
        let scope = self.cache.plan_of(site).links[link as usize].scope;
        let key_numbers = [site, child].map(|site| self.cache.sites[site.0].key_number);
        Covered { site, scope, child, key_numbers }
    }

    /// Notes something of every site above a place, up to one where `note` says that it was
    /// noted before.
    fn note_above(&mut self, env: EnvId, note: impl Fn(&mut Site) -> bool) {
        let mut at = env;
        while let Some(above) = self.above(at) {
            if note(&mut self.cache.sites[above.site.0]) {
                return;
            }
            at = above.env;
        }
    }

    /// Makes a site findable by its key as it is now, unless another one is found by it.
    ///
    /// A site stays findable by its earlier keys: who finds it compares its key first.
    pub(super) fn enlist_site(&mut self, site: SiteId) {
        let row = &mut self.cache.sites[site.0];
        if row.enlisted_key == Some(row.key_number) {
            return;
        }
        row.enlisted_key = Some(row.key_number);
        let (plan, index) = (row.plan, index_of(row.plan, row.view, &row.key));
        let plan = &mut self.cache.plans[plan];
        if matches!(plan.target, Target::View(_)) || row.indices.contains(&index) {
            return;
        }
        let is_known = plan.slot_sets.iter().any(|set| {
            set.len() == row.key.len() && set.iter().zip(&row.key).all(|(a, (b, _))| a == b)
        });
        if !is_known {
            plan.slot_sets.push(row.key.iter().map(|(slot, _)| *slot).collect());
        }
        let found = *self.cache.site_index.entry(index).or_insert(site);
        if found != site {
            let old = &mut self.cache.sites[found.0];
            if !old.remembers || old.made_at == self.graph.revision {
                return;
            }
            old.indices.retain(|known| *known != index);
            self.cache.site_index.insert(index, site);
        }
        self.cache.sites[site.0].indices.push(index);
    }
}

/// The hash by which the site of a plan in a view is looked for.
fn index_of(plan: u32, view: u32, key: &[(SlotKey, Digest)]) -> u64 {
    fixed_state().hash_one((plan, view, key))
}
