//! Counting components by kind, and parts by kind.
//!
//! What is shared counts once for each place where it occurs, but is looked at once: the memo
//! keeps the counts of each site until something below it changes.

use std::sync::Arc;

use crate::{EnvId, Kind, RenderNode, SiteId, Supplied, Supply};

/// How many components and parts of each kind there are. Sums saturate.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Compiled components by kind, sorted by name.
    pub components: Vec<(Kind, u64)>,
    /// Parts by kind, sorted by name.
    pub parts: Vec<(Kind, u64)>,
}

impl Counts {
    /// How many components of the kind with this name there are.
    pub fn components_of(&self, name: &str) -> u64 {
        find(&self.components, name)
    }

    /// How many parts of the kind with this name there are.
    pub fn parts_of(&self, name: &str) -> u64 {
        find(&self.parts, name)
    }

    fn add(&mut self, other: &Self) {
        for &(kind, n) in &other.components {
            add(&mut self.components, kind, n);
        }
        for &(kind, n) in &other.parts {
            add(&mut self.parts, kind, n);
        }
    }
}

fn find(rows: &[(Kind, u64)], name: &str) -> u64 {
    rows.iter().find(|(kind, _)| kind.name() == name).map_or(0, |(_, n)| *n)
}

fn add(rows: &mut Vec<(Kind, u64)>, kind: Kind, n: u64) {
    match rows.binary_search_by_key(&kind, |(kind, _)| *kind) {
        Ok(i) => rows[i].1 = rows[i].1.saturating_add(n),
        Err(i) => rows.insert(i, (kind, n)),
    }
}

/// The counts of sites, kept between countings. Whoever changes a site or frees it forgets it
/// here.
#[derive(Debug, Default)]
pub struct CountMemo(Vec<Option<Arc<Counts>>>);

impl CountMemo {
    /// Forgets what is known of `site`.
    pub fn forget(&mut self, site: SiteId) {
        if let Some(slot) = self.0.get_mut(site.0 as usize) {
            *slot = None;
        }
    }

    fn get(&self, site: SiteId) -> Option<&Arc<Counts>> {
        self.0.get(site.0 as usize)?.as_ref()
    }

    fn set(&mut self, site: SiteId, counts: Counts) {
        let index = site.0 as usize;
        if index >= self.0.len() {
            self.0.resize(index + 1, None);
        }
        self.0[index] = Some(Arc::new(counts));
    }
}

/// Counts everything below the root; costs the sites whose counts the memo lacks.
pub fn count(supply: &dyn Supply, memo: &mut CountMemo) -> Counts {
    let (env, root) = supply.root();
    let mut stack = vec![root];
    while let Some(&site) = stack.last() {
        if memo.get(site).is_some() {
            stack.pop();
            continue;
        }
        let before = stack.len();
        for_children(supply, env, site, |child| {
            if memo.get(child).is_none() {
                stack.push(child);
            }
        });
        if stack.len() == before {
            let counts = count_site(supply, env, site, memo);
            memo.set(site, counts);
            stack.pop();
        }
    }
    let mut counts = memo.get(root).map(|counts| Counts::clone(counts)).unwrap_or_default();
    counts.components.retain(|(kind, _)| *kind != supply.plan(root).kind);
    counts
}

fn count_site(supply: &dyn Supply, env: EnvId, site: SiteId, memo: &CountMemo) -> Counts {
    let plan = supply.plan(site);
    let mut counts = Counts::default();
    add(&mut counts.components, plan.kind, 1);
    for (kind, n) in plan.parts.lengths() {
        add(&mut counts.parts, kind, n as u64);
    }
    for_children(supply, env, site, |child| {
        if let Some(below) = memo.get(child) {
            counts.add(below);
        }
    });
    counts
}

/// Calls `each` for every site that is linked from `site`.
fn for_children(supply: &dyn Supply, env: EnvId, site: SiteId, mut each: impl FnMut(SiteId)) {
    let fragment = supply.plan(site).fragment;
    for index in 0..fragment.len() {
        if let RenderNode::Deferred(run) = fragment.node(index) {
            for link in run.first..run.first + run.count {
                if let (_, Supplied::Ready(child)) = supply.enter(env, site, link) {
                    each(child);
                }
            }
        }
    }
}
