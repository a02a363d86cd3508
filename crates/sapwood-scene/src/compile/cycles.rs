//! Emitted components that contain themselves.
//!
//! Rules may emit what stands above itself with nothing changed: then sites lead back to
//! themselves. Settling meets such a ring as a strongly connected part of the graph (Tarjan
//! 1972), and every link inside it fails: whichever way the ring was entered, the same links
//! do. Authored components cannot contain themselves.

use sapwood_geom::{FixedMap, FixedSet, fixed_state};
use sapwood_graph::{Diagnostic, SiteId};

use super::cache::Link;
use super::pull::Pull;

/// The emitted sites on the way down, as Tarjan's algorithm keeps them.
pub(super) struct Rings {
    /// When each site of the stack was met first.
    met: FixedMap<SiteId, u32>,
    stack: Vec<SiteId>,
    n_met: u32,
}

impl Rings {
    pub(super) fn new() -> Self {
        Self { met: FixedMap::with_hasher(fixed_state()), stack: Vec::new(), n_met: 0 }
    }

    /// Notes that a site is gone into, and tells its number.
    pub(super) fn enter(&mut self, site: SiteId) -> u32 {
        self.n_met += 1;
        self.met.insert(site, self.n_met);
        self.stack.push(site);
        self.n_met
    }

    /// The number of a site from which the way here came, or that leads back to one.
    pub(super) fn above(&self, site: SiteId) -> Option<u32> {
        self.met.get(&site).copied()
    }

    /// Notes that everything below a site was looked at, where `lowest` is the lowest number
    /// met there. Returns the sites of the ring that it closes, if it does.
    pub(super) fn leave(&mut self, site: SiteId, lowest: u32) -> Option<Vec<SiteId>> {
        if self.above(site)? != lowest {
            return None;
        }
        let place = self.stack.iter().rposition(|other| *other == site)?;
        let part = self.stack.split_off(place);
        for site in &part {
            self.met.remove(site);
        }
        Some(part)
    }
}

impl Pull<'_> {
    /// Fails every link inside a strongly connected part; a single site has none unless it
    /// leads to itself.
    pub(super) fn fail_ring(&mut self, part: &[SiteId]) {
        let mut ring: FixedSet<SiteId> = FixedSet::with_hasher(fixed_state());
        ring.extend(part);
        for site in part {
            for link in 0..self.cache.sites[site.0].links.len() {
                let Link::Site(child, _) = self.cache.sites[site.0].links[link] else { continue };
                if ring.contains(&child) {
                    let kind = self.cache.kind_of(self.cache.plan_of(child));
                    let message = "the component contains itself with nothing changed".to_owned();
                    let failed = (Diagnostic { kind, message }, self.graph.revision);
                    self.cache.sites[site.0].links[link] = Link::Failed(Box::new(failed));
                }
            }
        }
    }
}
