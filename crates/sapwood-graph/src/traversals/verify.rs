//! Verifying: looking for faults in everything that a render graph holds, told as a report.
//!
//! Each distinct plan and each distinct mesh is looked at once, where it is met first in
//! pre-order. Nothing is changed.

mod drawn;
mod report;

use sapwood_geom::glam::Affine3;
use sapwood_geom::{Aabb, Bound, Digest, FixedSet, SharedMesh, fixed_state};

pub use report::{Finding, Report, Severity};

use crate::{EnvId, Fragment, Kind, PlanRef, RenderNode, SiteId, Supplied, Supply, fragment_bound};

/// Looks for faults in everything compiled below the root, and tells `limit` of them at most.
///
/// Costs each distinct site, plan and mesh once, every triangle looked at.
pub fn verify(supply: &dyn Supply, limit: usize) -> Report {
    let mut verifier = Verifier {
        supply,
        report: Report::new(limit),
        sites: FixedSet::with_hasher(fixed_state()),
        plans: FixedSet::with_hasher(fixed_state()),
        meshes: FixedSet::with_hasher(fixed_state()),
        path: Vec::new(),
        above: Vec::new(),
    };
    verifier.run();
    verifier.report
}

struct Verifier<'a> {
    supply: &'a dyn Supply,
    report: Report,
    sites: FixedSet<SiteId>,
    /// By the address of the fragment, which lies where it is while the supply is borrowed.
    plans: FixedSet<*const Fragment>,
    meshes: FixedSet<Digest>,
    /// The links to the site at hand.
    path: Vec<u32>,
    /// The sites on the way, the one at hand included.
    above: Vec<SiteId>,
}

/// A site to look at, and the way to it.
struct Todo {
    env: EnvId,
    site: SiteId,
    depth: usize,
    link: u32,
}

impl<'a> Verifier<'a> {
    fn run(&mut self) {
        let (env, site) = self.supply.root();
        let mut stack = vec![Todo { env, site, depth: 0, link: 0 }];
        while let Some(Todo { env, site, depth, link }) = stack.pop() {
            self.above.truncate(depth);
            self.path.truncate(depth.saturating_sub(1));
            self.above.push(site);
            if depth > 0 {
                self.path.push(link);
            }
            if !self.sites.insert(site) {
                continue;
            }
            self.report.n_sites += 1;
            let plan = self.supply.plan(site);
            if let Some(error) = plan.error {
                self.tell(Severity::Error, error.kind, error.message.clone());
            }
            if self.plans.insert(std::ptr::from_ref(plan.fragment)) {
                self.report.n_plans += 1;
                self.look_at_plan(&plan);
            }
            self.look_at_live(&plan);
            self.look_at_bound(env, site, &plan);
            let first = stack.len();
            self.for_links(env, site, &plan, &mut |_, link, env, child| {
                stack.push(Todo { env, site: child, depth: depth + 1, link });
            });
            stack[first..].reverse();
        }
    }

    fn tell(&mut self, severity: Severity, kind: Kind, message: String) {
        let path = self.path.clone();
        self.report.add(Finding { severity, path, kind, message });
    }

    /// Calls `each` for every link behind which there is a site, and tells of those that failed
    /// or lead to nothing.
    fn for_links(
        &mut self,
        env: EnvId,
        site: SiteId,
        plan: &PlanRef<'_>,
        each: &mut dyn FnMut(&mut Self, u32, EnvId, SiteId),
    ) {
        for index in 0..plan.fragment.len() {
            let RenderNode::Deferred(run) = plan.fragment.node(index) else { continue };
            for link in run.first..run.first + run.count {
                match self.supply.enter(env, site, link) {
                    (env, Supplied::Ready(child)) => each(self, link, env, child),
                    (_, Supplied::Failed(error)) => {
                        self.path.push(link);
                        self.tell(Severity::Error, error.kind, error.message.clone());
                        self.path.pop();
                    }
                    (_, Supplied::Previous(_) | Supplied::Foreseen(_) | Supplied::Unknown) => {
                        let message = format!("link {link} to a {} is not compiled", run.kind);
                        self.tell(Severity::Warning, plan.kind, message);
                    }
                }
            }
        }
    }

    /// Live values belong to the site, not to the plan.
    fn look_at_live(&mut self, plan: &PlanRef<'_>) {
        let n = plan.fragment.n_live() as usize;
        if plan.live.len() != n {
            let message = format!("{} live values for {n} nodes", plan.live.len());
            self.tell(Severity::Error, plan.kind, message);
        }
        for (i, live) in plan.live.iter().enumerate() {
            self.look_at_transform(plan.kind, &format!("live value {i}"), live);
        }
    }

    fn look_at_transform(&mut self, kind: Kind, what: &str, transform: &Affine3) {
        if !transform.is_finite() {
            self.tell(Severity::Error, kind, format!("{what} is not finite: {transform:?}"));
        } else if transform.matrix3.determinant() == 0.0 {
            self.tell(Severity::Warning, kind, format!("{what} flattens what it places"));
        }
    }

    /// The bound of a site holds what its plan draws and what its children hold.
    fn look_at_bound(&mut self, env: EnvId, site: SiteId, plan: &PlanRef<'_>) {
        let Some(bound) = self.supply.bound(site) else { return };
        let inside = fragment_bound(plan.fragment, plan.live, |link| {
            match self.supply.enter(env, site, link) {
                (_, Supplied::Ready(child)) => self.supply.bound(child).copied(),
                _ => Some(Bound::EMPTY),
            }
        });
        if let Some(inside) = inside.filter(|inside| !holds(bound, inside)) {
            let message = format!("the bound {:?} does not hold {:?}", bound.aabb, inside.aabb);
            self.tell(Severity::Error, plan.kind, message);
        }
        for index in 0..plan.fragment.len() {
            let RenderNode::Deferred(run) = plan.fragment.node(index) else { continue };
            let Some(foreseen) = run.foreseen else { continue };
            for link in run.first..run.first + run.count {
                if let (_, Supplied::Ready(child)) = self.supply.enter(env, site, link)
                    && let Some(inside) = self.supply.bound(child)
                    && !holds(foreseen, inside)
                {
                    let message = format!(
                        "the bound foreseen for link {link} to a {} does not hold it: {:?}, {:?}",
                        run.kind, foreseen.aabb, inside.aabb
                    );
                    self.tell(Severity::Error, plan.kind, message);
                }
            }
        }
    }

    /// Whether a mesh is met for the first time.
    fn is_new(&mut self, mesh: &SharedMesh) -> bool {
        self.meshes.insert(Digest::of(mesh))
    }
}

/// Whether a bound's box holds another one's, but for rounding.
fn holds(outer: &Bound, inner: &Bound) -> bool {
    if inner.is_empty() {
        return true;
    }
    let Aabb { min, max } = outer.aabb;
    let slack = 1e-4 * min.abs().max(max.abs()).max_element().max(1e-3);
    (min - slack).cmple(inner.aabb.min).all() && (max + slack).cmpge(inner.aabb.max).all()
}
