//! Gathering what could not be compiled, with the place of each.

use crate::{Diagnostic, Everything, Order, RenderNode, Supplied, Supply, walk};

/// All error plans and failed links below the root in pre-order, each with the links that lead
/// to it. At most `limit` are gathered.
pub fn diagnostics(supply: &dyn Supply, limit: usize) -> Vec<(Vec<u32>, Diagnostic)> {
    let mut found = Vec::new();
    let (env, _) = supply.root();
    walk(supply, Order::Pre, &Everything, &mut |at| {
        if found.len() >= limit {
            return;
        }
        if let Some(error) = at.plan().error.filter(|_| at.enters_plan()) {
            found.push((at.path().links(), error.clone()));
        }
        if let RenderNode::Deferred(run) = at.node() {
            for link in run.first..run.first + run.count {
                if let (_, Supplied::Failed(error)) = supply.enter(env, at.site(), link) {
                    let mut links = at.path().links();
                    links.push(link);
                    found.push((links, error.clone()));
                }
            }
        }
    });
    found.truncate(limit);
    found
}
