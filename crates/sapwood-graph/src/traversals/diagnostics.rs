//! Gathering what could not be compiled, with the place of each.

use std::collections::hash_map::Entry;

use sapwood_geom::{FixedMap, fixed_state};

use crate::{Diagnostic, EnvId, RenderNode, SiteId, Supplied, Supply};

/// All error plans and failed links below the root in pre-order, each with the links that lead
/// to it. At most `limit` are gathered. Costs each site once, and the paths to what is gathered.
pub fn diagnostics(supply: &dyn Supply, limit: usize) -> Vec<(Vec<u32>, Diagnostic)> {
    let (env, root) = supply.root();
    let faulty = faulty_sites(supply, env, root);
    let mut found = Vec::new();
    // What is left to look at, with the number of links above it.
    let mut stack = vec![(Behind::Site(root), 0, 0)];
    let mut path: Vec<u32> = Vec::new();
    while let Some((behind, depth, link)) = stack.pop() {
        if found.len() >= limit {
            break;
        }
        path.truncate(usize::saturating_sub(depth, 1));
        if depth > 0 {
            path.push(link);
        }
        let site = match behind {
            Behind::Error(error) => {
                found.push((path.clone(), error.clone()));
                continue;
            }
            Behind::Site(site) => site,
        };
        if let Some(error) = supply.plan(site).error {
            found.push((path.clone(), error.clone()));
        }
        let first = stack.len();
        for_links(supply, env, site, &mut |link, behind| {
            let is_worth_it = match behind {
                Behind::Error(_) => true,
                Behind::Site(site) => faulty.get(&site) == Some(&true),
            };
            if is_worth_it {
                stack.push((behind, depth + 1, link));
            }
        });
        stack[first..].reverse();
    }
    found
}

/// What stands behind a link.
#[derive(Clone, Copy)]
enum Behind<'a> {
    Site(SiteId),
    Error(&'a Diagnostic),
}

/// For each site below the root, whether anything is wrong there or further below.
fn faulty_sites(supply: &dyn Supply, env: EnvId, root: SiteId) -> FixedMap<SiteId, bool> {
    let mut faulty: FixedMap<SiteId, bool> = FixedMap::with_hasher(fixed_state());
    let mut stack = vec![(root, false)];
    while let Some((site, is_done)) = stack.pop() {
        if is_done {
            let mut is_faulty = supply.plan(site).error.is_some();
            for_links(supply, env, site, &mut |_, behind| {
                is_faulty |= match behind {
                    Behind::Error(_) => true,
                    Behind::Site(child) => faulty.get(&child) == Some(&true),
                };
            });
            faulty.insert(site, is_faulty);
        } else if let Entry::Vacant(place) = faulty.entry(site) {
            place.insert(false);
            stack.push((site, true));
            for_links(supply, env, site, &mut |_, behind| {
                if let Behind::Site(child) = behind {
                    stack.push((child, false));
                }
            });
        }
    }
    faulty
}

fn for_links<'a>(
    supply: &'a dyn Supply,
    env: EnvId,
    site: SiteId,
    each: &mut dyn FnMut(u32, Behind<'a>),
) {
    let fragment = supply.plan(site).fragment;
    for index in 0..fragment.len() {
        if let RenderNode::Deferred(run) = fragment.node(index) {
            for link in run.first..run.first + run.count {
                match supply.enter(env, site, link).1 {
                    Supplied::Ready(child) => each(link, Behind::Site(child)),
                    Supplied::Failed(error) => each(link, Behind::Error(error)),
                    Supplied::Previous(_) | Supplied::Foreseen(_) | Supplied::Unknown => {}
                }
            }
        }
    }
}
