//! Which finished parts of a graph are shared, how much is in them, and whether they look the same
//! wherever they stand.

use sapwood_geom::{FixedMap, fixed_state};
use sapwood_graph::{RenderNode, SiteId, Supplied, Supply};

/// What is known of finished sites.
pub(super) struct Survey(FixedMap<SiteId, Facts>);

#[derive(Clone, Copy, Default)]
struct Facts {
    /// Links to it that were found.
    n_links: u32,
    is_entered: bool,
    /// Whether the rest is known.
    is_known: bool,
    /// Things in it and below.
    n_items: u64,
    /// Whether something in it depends on where it stands: it turns to the eye, fades with the
    /// distance, it is a line, which is as wide as it is seen, or a light.
    depends_on_place: bool,
}

impl Default for Survey {
    fn default() -> Self {
        Self(FixedMap::with_hasher(fixed_state()))
    }
}

impl Survey {
    /// Things up to which what is shared is repeated rather than kept apart.
    const FEW: u64 = 8;

    /// Whether a site that is finished had better be kept apart from where it stands.
    pub(super) fn is_shared(&self, site: SiteId) -> bool {
        let facts = self.0.get(&site).copied().unwrap_or_default();
        facts.is_known && facts.n_links > 1 && facts.n_items > Self::FEW && !facts.depends_on_place
    }

    /// Whether a site is known to hold nothing that could be seen or could shine.
    pub(super) fn is_empty(&self, site: SiteId) -> bool {
        let facts = self.0.get(&site);
        facts.is_some_and(|facts| facts.is_known && facts.n_items == 0 && !facts.depends_on_place)
    }

    /// Whether a site is known to look the same wherever it stands.
    pub(super) fn is_same_everywhere(&self, site: SiteId) -> bool {
        self.0.get(&site).is_some_and(|facts| facts.is_known && !facts.depends_on_place)
    }

    /// Looks at a site and everything below it, if it is finished; each site once.
    pub(super) fn look_at(&mut self, supply: &dyn Supply, site: SiteId) {
        if !supply.is_settled(site) {
            return;
        }
        self.0.entry(site).or_default().n_links += 1;
        // Each site is left after everything below it: it is entered when it is met on the way
        // down, not when it is found, so that nobody above is left before.
        let mut stack = vec![(site, false)];
        while let Some((site, is_left)) = stack.pop() {
            if !is_left {
                let facts = self.0.entry(site).or_default();
                if std::mem::replace(&mut facts.is_entered, true) {
                    continue;
                }
                stack.push((site, true));
                for child in children(supply, site) {
                    self.0.entry(child).or_default().n_links += 1;
                    stack.push((child, false));
                }
                continue;
            }
            let (mut n_items, mut depends_on_place) = (0u64, false);
            let plan = supply.plan(site);
            for index in 0..plan.fragment.len() {
                match plan.fragment.node(index) {
                    RenderNode::Mesh { .. } => n_items += 1,
                    RenderNode::Instances { transforms, .. } => n_items += transforms.len() as u64,
                    RenderNode::Lines(_)
                    | RenderNode::Facing(_)
                    | RenderNode::Fading(_)
                    | RenderNode::Aspects(_)
                    | RenderNode::Light(_) => {
                        depends_on_place = true;
                    }
                    RenderNode::Group
                    | RenderNode::Swaying(_)
                    | RenderNode::Transform(_)
                    | RenderNode::Live(_)
                    | RenderNode::Camera(_)
                    | RenderNode::Label(_)
                    | RenderNode::Deferred(_) => {}
                }
            }
            for child in children(supply, site) {
                let below = self.0[&child];
                n_items = n_items.saturating_add(below.n_items);
                depends_on_place |= below.depends_on_place;
            }
            let facts = self.0.entry(site).or_default();
            facts.is_known = true;
            (facts.n_items, facts.depends_on_place) = (n_items, depends_on_place);
        }
    }
}

/// The sites behind the links of a finished one.
fn children(supply: &dyn Supply, site: SiteId) -> Vec<SiteId> {
    let (env, _) = supply.root();
    let n_links = supply.plan(site).fragment.n_links();
    let behind = |link| match supply.enter(env, site, link) {
        (_, Supplied::Ready(child)) => Some(child),
        _ => None,
    };
    (0..n_links).filter_map(behind).collect()
}
