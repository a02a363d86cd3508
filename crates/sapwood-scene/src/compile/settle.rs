//! Settling: what sites know of everything below them, brought up to date from the bottom up.
//!
//! Only sites that are not settled are gone into, each once. A site whose every link is filled
//! and settled is closed: its key becomes exact, its bound is known, and no walk meets a want
//! below it.

use sapwood_geom::Bound;
use sapwood_graph::{EnvId, SiteId, Supplied, Supply, fragment_bound};
use smallvec::SmallVec;

use super::cache::Link;
use super::cycles::Rings;
use super::pull::Pull;
use super::pushes::Pushes;
use crate::slots::SlotKey;

/// A site that is being settled.
struct Open {
    site: SiteId,
    env: EnvId,
    next_link: u32,
    /// Whether every link so far is filled and settled.
    is_complete: bool,
    /// The lowest number of an emitted site on the way here that something below leads back to.
    lowest: u32,
}

impl Pull<'_> {
    /// Settles everything below the root that can be settled.
    pub(super) fn settle_all(&mut self) {
        self.cache.settling += 1;
        let settling = self.cache.settling;
        let (env, root) = self.root();
        if self.is_settled(root) {
            return;
        }
        let mut rings = Rings::new();
        let lowest = u32::MAX;
        let mut stack = vec![Open { site: root, env, next_link: 0, is_complete: true, lowest }];
        while let Some(open) = stack.last_mut() {
            let (site, link) = (open.site, open.next_link);
            if link as usize == self.cache.sites[site.0].links.len() {
                let (is_complete, lowest) = (open.is_complete, open.lowest);
                stack.pop();
                if is_complete {
                    self.close(site);
                } else {
                    self.leave_open(site);
                }
                if let Some(part) = rings.leave(site, lowest) {
                    self.fail_ring(&part);
                }
                if let Some(parent) = stack.last_mut() {
                    parent.is_complete &= is_complete;
                    parent.lowest = parent.lowest.min(lowest);
                }
                continue;
            }
            open.next_link += 1;
            match self.enter(open.env, site, link) {
                (_, Supplied::Failed(_)) => {}
                (_, Supplied::Ready(child)) if self.is_settled(child) => {}
                (env, Supplied::Ready(child)) => {
                    if self.cache.sites[child.0].settled_in == settling {
                        // Another way led there before and found it incomplete, or this one.
                        open.is_complete = false;
                        let above = rings.above(child);
                        open.lowest = open.lowest.min(above.unwrap_or(u32::MAX));
                    } else {
                        self.cache.sites[child.0].settled_in = settling;
                        let is_emitted = self.facts(site, link).is_emitted;
                        let lowest = if is_emitted { rings.enter(child) } else { u32::MAX };
                        let (next_link, is_complete) = (0, true);
                        stack.push(Open { site: child, env, next_link, is_complete, lowest });
                    }
                }
                _ => open.is_complete = false,
            }
        }
    }

    /// The sites behind a site's links.
    pub(super) fn linked(&self, site: SiteId) -> impl Iterator<Item = SiteId> + '_ {
        self.cache.sites[site.0].links.iter().filter_map(|link| match link {
            Link::Site(child, _) => Some(*child),
            Link::Unfilled | Link::Failed(_) => None,
        })
    }

    fn close(&mut self, site: SiteId) {
        self.make_key_exact(site);
        self.note_checked(site);
        let bound = self.bound_of(site);
        let is_moving = self.is_moving(site);
        let remembers = self.remembers(site);
        let row = &mut self.cache.sites[site.0];
        row.remembers = remembers;
        row.is_closed = true;
        row.verified = self.graph.revision;
        row.bound = bound;
        row.is_moving = is_moving;
        self.cache.counts.forget(site);
    }

    fn leave_open(&mut self, site: SiteId) {
        let is_moving = self.is_moving(site);
        let remembers = self.remembers(site);
        let row = &mut self.cache.sites[site.0];
        row.remembers = remembers;
        row.is_closed = false;
        row.bound = None;
        row.is_moving = is_moving;
        self.cache.counts.forget(site);
    }

    /// Notes at each link which key of the site behind it was found to fit.
    fn note_checked(&mut self, site: SiteId) {
        let mut links = std::mem::take(&mut self.cache.sites[site.0].links);
        for link in &mut links {
            if let Link::Site(child, checked) = link {
                *checked = self.cache.sites[child.0].key_number;
            }
        }
        self.cache.sites[site.0].links = links;
    }

    /// The bound of a site from those of its children.
    pub(super) fn bound_of(&self, site: SiteId) -> Option<Bound> {
        let row = &self.cache.sites[site.0];
        let fragment = &self.cache.plans[row.plan].fragment;
        fragment_bound(fragment, &row.live, |link| match &row.links[link as usize] {
            Link::Site(child, _) => self.cache.sites[child.0].bound,
            Link::Failed(_) => Some(Bound::EMPTY),
            Link::Unfilled => None,
        })
    }

    fn is_moving(&self, site: SiteId) -> bool {
        !self.cache.sites[site.0].live.is_empty()
            || self.linked(site).any(|child| self.cache.sites[child.0].is_moving)
    }

    fn remembers(&self, site: SiteId) -> bool {
        self.cache.plan_of(site).reads.iter().any(|read| read.memory.is_some())
            || self.linked(site).any(|child| self.cache.sites[child.0].remembers)
    }

    /// Drops slots from the key that nothing reads any more.
    fn make_key_exact(&mut self, site: SiteId) {
        let row = &self.cache.sites[site.0];
        if row.key.is_empty() {
            return;
        }
        let pushes = Pushes { cache: self.cache };
        let mut own = self.cache.plans[row.plan].slots.iter().peekable();
        let mut unread: SmallVec<[SlotKey; 16]> = SmallVec::new();
        // Both are sorted.
        for (slot, _) in &row.key {
            while own.next_if(|own| *own < slot).is_some() {}
            if own.peek() != Some(&slot) {
                unread.push(*slot);
            }
        }
        for (link, child) in row.links.iter().enumerate() {
            // Most often the first child reads all that its siblings read.
            if unread.is_empty() {
                break;
            }
            if let Link::Site(child, _) = child {
                pushes.remove_lifted(site, link as u32, *child, &mut unread);
            }
        }
        if !unread.is_empty() {
            let row = &mut self.cache.sites[site.0];
            row.key.retain(|(slot, _)| unread.binary_search(slot).is_err());
            row.key_number += 1;
        }
        self.enlist_site(site);
    }
}
