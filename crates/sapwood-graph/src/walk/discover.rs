//! Discovering: finding unfilled links, having them provided, and going on below them.
//!
//! One pass starts at the root and descends through unsettled sites only. Wants are noted and
//! provided in batches, and the pass resumes below them, so that a chain of any depth costs
//! each link once. A site shared by several places is gone into once in the first pass: when it
//! is settled, what it reads is known, and most other places need not go into it at all. Where
//! they must, later passes allow twice as many visits each, so that the passes together cost no
//! more than twice the last.

use sapwood_geom::glam::Affine3;
use sapwood_geom::{FixedMap, fixed_state};

use crate::walk::{Approach, Interest};
use crate::{EnvId, Interrupted, Kind, Provide, RenderNode, SiteId, Supplied, Supply, Want};

/// Wants that are provided together at most; bounds the memory of a pass.
const BATCH: usize = 4096;

/// Compiles everything below the root that `interest` asks for.
///
/// # Errors
/// When compiling was cancelled or a budget ran out; what was compiled so far stays.
pub fn discover<I: Interest>(provide: &mut dyn Provide, interest: &I) -> Result<(), Interrupted> {
    if provide.is_settled(provide.root().1) {
        return Ok(());
    }
    let mut visits_allowed = 1;
    loop {
        provide.begin_pass();
        let mut pass =
            Pass { frames: Vec::new(), wanted: Vec::new(), visits: Visits::new(), is_final: true };
        let outcome = pass.run(provide, interest, visits_allowed);
        provide.settle();
        outcome?;
        // A pass that met no want and postponed nothing found everything in its place.
        if pass.is_final || provide.is_settled(provide.root().1) {
            return Ok(());
        }
        visits_allowed = u32::saturating_mul(visits_allowed, 2);
    }
}

/// A site to go into, with what was pushed on the way to it.
struct Frame<S> {
    env: EnvId,
    site: SiteId,
    world: Affine3,
    state: S,
}

/// A child to go into once its want is provided.
struct Wanted<S> {
    want: Want,
    world: Affine3,
    state: S,
}

/// One pass from the root.
struct Pass<S> {
    frames: Vec<Frame<S>>,
    wanted: Vec<Wanted<S>>,
    visits: Visits,
    /// Whether no later pass has anything left to do.
    is_final: bool,
}

impl<S: Clone> Pass<S> {
    fn run<I: Interest<State = S>>(
        &mut self,
        provide: &mut dyn Provide,
        interest: &I,
        visits_allowed: u32,
    ) -> Result<(), Interrupted> {
        let (env, site) = provide.root();
        let start = Frame { env, site, world: Affine3::IDENTITY, state: interest.start() };
        self.frames.push(start);
        let mut wants = Vec::new();
        loop {
            while self.wanted.len() < BATCH
                && let Some(frame) = self.frames.pop()
            {
                if self.visits.count(frame.site) > visits_allowed {
                    self.is_final = false;
                } else {
                    self.scan(&*provide, interest, &frame);
                }
            }
            if self.wanted.is_empty() {
                return Ok(());
            }
            self.is_final = false;
            wants.clear();
            wants.extend(self.wanted.iter().map(|wanted| wanted.want));
            provide.provide(&wants)?;
            // Last first, so that the first child is gone into first.
            for Wanted { want, world, state } in self.wanted.drain(..).rev() {
                match provide.enter(want.env, want.site, want.link) {
                    (env, Supplied::Ready(site)) if !provide.is_settled(site) => {
                        self.frames.push(Frame { env, site, world, state });
                    }
                    // Whatever is not ready lost its place to another environment; the next
                    // pass comes by its new place.
                    _ => {}
                }
            }
        }
    }

    /// Looks at every link of one site.
    fn scan<I: Interest<State = S>>(
        &mut self,
        supply: &dyn Supply,
        interest: &I,
        frame: &Frame<S>,
    ) {
        let first_frame = self.frames.len();
        let Frame { env, site, world, state } = frame;
        let mut look = |kind: Kind, world: Affine3, link: u32| {
            let (child_env, supplied) = supply.enter(*env, *site, link);
            let bound = match supplied {
                Supplied::Ready(child) if supply.is_settled(child) => return,
                Supplied::Failed(_) => return,
                Supplied::Ready(child) => supply.bound(child),
                Supplied::Foreseen(bound) => Some(bound),
                Supplied::Previous(_) | Supplied::Unknown => None,
            };
            let approach = Approach { world: &world, bound, kind, link };
            let Some(state) = interest.enter(state, &approach) else { return };
            if let Supplied::Ready(child) = supplied {
                self.frames.push(Frame { env: child_env, site: child, world, state });
            } else {
                let want = Want { env: *env, site: *site, link };
                self.wanted.push(Wanted { want, world, state });
            }
        };
        let plan = supply.plan(*site);
        // Transforms above the node at hand: where each ends, and the product so far.
        let mut above: Vec<(u32, Affine3)> = Vec::new();
        let mut here = *world;
        for index in 0..plan.fragment.len() {
            while let Some((_, outer)) = above.pop_if(|(end, _)| *end <= index) {
                here = outer;
            }
            match plan.fragment.node(index) {
                RenderNode::Transform(transform) => {
                    above.push((plan.fragment.after(index), here));
                    here *= *transform;
                }
                RenderNode::Live(live) => {
                    above.push((plan.fragment.after(index), here));
                    here *= plan.live[live as usize];
                }
                RenderNode::Facing(facing) => {
                    above.push((plan.fragment.after(index), here));
                    here *= facing.turn(&here, supply.eye());
                }
                RenderNode::Deferred(run) => {
                    for link in run.first..run.first + run.count {
                        look(run.kind, here, link);
                    }
                }
                RenderNode::Group
                | RenderNode::Fading(_)
                | RenderNode::Aspects(_)
                | RenderNode::Swaying(_)
                | RenderNode::Mesh { .. }
                | RenderNode::Instances { .. }
                | RenderNode::Lines(_)
                | RenderNode::Light(_)
                | RenderNode::Camera(_)
                | RenderNode::Label(_) => {}
            }
        }
        // The stack gives back the last first.
        self.frames[first_frame..].reverse();
    }
}

/// How often each site was gone into in this pass.
enum Visits {
    /// After an edit few sites are gone into, whatever the size of the graph.
    Few(FixedMap<SiteId, u32>),
    /// By the number of the site.
    Many(Vec<u32>),
}

impl Visits {
    /// Sites up to which a map serves.
    const FEW: usize = 4096;

    fn new() -> Self {
        Self::Few(FixedMap::with_hasher(fixed_state()))
    }

    /// Counts one visit and tells how many there were with it.
    fn count(&mut self, site: SiteId) -> u32 {
        if let Self::Few(visits) = self
            && visits.len() >= Self::FEW
        {
            let mut all = Vec::new();
            for (site, n) in visits.drain() {
                *at(&mut all, site) = n;
            }
            *self = Self::Many(all);
        }
        let n = match self {
            Self::Few(visits) => visits.entry(site).or_default(),
            Self::Many(visits) => at(visits, site),
        };
        *n += 1;
        *n
    }
}

fn at(visits: &mut Vec<u32>, site: SiteId) -> &mut u32 {
    let index = site.0 as usize;
    if index >= visits.len() {
        visits.resize(index + 1, 0);
    }
    &mut visits[index]
}
