//! Walking over what is compiled, in pre-, in-, post- or level-order.
//!
//! The walk goes over render nodes. The children of a deferred node are the fragments behind
//! its links; links that are not filled, or whose component failed, have no children.

use std::collections::VecDeque;

use sapwood_geom::glam::Affine3;

use crate::walk::{Approach, Interest};
use crate::{EnvId, PlanRef, RenderNode, SiteId, Supplied, Supply};

/// When a node is visited relative to its children.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// Before its children.
    Pre,
    /// After its first child, before the rest.
    In,
    /// After its children.
    Post,
    /// Level by level, from the top.
    Level,
}

/// A node under a walk's eyes.
pub struct At<'a, S> {
    supply: &'a dyn Supply,
    task: &'a Task<S>,
    steps: &'a [Step],
}

impl<'a, S> At<'a, S> {
    /// The node.
    pub fn node(&self) -> RenderNode<'a> {
        self.plan().fragment.node(self.task.node)
    }

    /// The node's number in its fragment.
    pub fn index(&self) -> u32 {
        self.task.node
    }

    /// The plan that the node belongs to.
    pub fn plan(&self) -> PlanRef<'a> {
        self.supply.plan(self.task.site)
    }

    /// The site that the node belongs to.
    pub fn site(&self) -> SiteId {
        self.task.site
    }

    /// Whether this is the group at the top of its plan: true once for each plan met.
    pub fn enters_plan(&self) -> bool {
        self.task.node == 0
    }

    /// From the node's frame to the root's. The frame of a transform is the one outside it.
    pub fn world(&self) -> &'a Affine3 {
        &self.task.world
    }

    /// The state that the interest pushed on the way into the plan.
    pub fn state(&self) -> &'a S {
        &self.task.state
    }

    /// Number of render nodes above this one.
    pub fn depth(&self) -> u32 {
        self.task.depth
    }

    /// The bound of everything below the plan in the plan's frame, where it is known.
    pub fn bound(&self) -> Option<&'a sapwood_geom::Bound> {
        self.supply.bound(self.task.site)
    }

    /// The way from the root to the plan.
    pub fn path(&self) -> Path<'a> {
        Path { steps: self.steps, last: self.task.step }
    }
}

/// The way from a root to a plan, as the links taken.
#[derive(Clone, Copy)]
pub struct Path<'a> {
    steps: &'a [Step],
    last: u32,
}

impl Path<'_> {
    /// The links from the root on; empty at the root. Costs the path's length.
    pub fn links(&self) -> Vec<u32> {
        let mut links: Vec<u32> = self.sites_upward().map(|(_, link)| link).collect();
        links.pop();
        links.reverse();
        links
    }

    /// The sites from this place up to the root, each with the link that led to it.
    pub fn sites_upward(&self) -> impl Iterator<Item = (SiteId, u32)> + '_ {
        let mut next = Some(self.last);
        std::iter::from_fn(move || {
            let index = next?;
            let step = &self.steps[index as usize];
            next = (index > 0).then_some(step.parent);
            Some((step.site, step.link))
        })
    }

    /// A number for this place that no other place of the same walk has.
    pub fn number(&self) -> u32 {
        self.last
    }

    /// The number of the place one link above; 0 at the root.
    pub fn number_above(&self) -> u32 {
        self.steps[self.last as usize].parent
    }
}

struct Step {
    parent: u32,
    link: u32,
    site: SiteId,
}

#[derive(Clone)]
struct Task<S> {
    env: EnvId,
    site: SiteId,
    node: u32,
    world: Affine3,
    state: S,
    depth: u32,
    /// The step that led to the site; for a child just found, the step of its parent.
    step: u32,
    /// The link to the site where the site is just found.
    link: u32,
}

enum Todo<S> {
    Open(Task<S>),
    Visit(Task<S>),
}

/// Walks over everything compiled that `interest` asks for and calls `visitor` for every node.
pub fn walk<I: Interest>(
    supply: &dyn Supply,
    order: Order,
    interest: &I,
    visitor: &mut dyn FnMut(&At<'_, I::State>),
) {
    let mut walker = Walker { supply, interest, steps: Vec::new(), children: Vec::new() };
    let (env, site) = supply.root();
    let state = interest.start();
    let root =
        Task { env, site, node: 0, world: Affine3::IDENTITY, state, depth: 0, step: 0, link: 0 };
    match order {
        Order::Pre => walker.pre(root, visitor),
        Order::In => walker.deep(root, 1, visitor),
        Order::Post => walker.deep(root, usize::MAX, visitor),
        Order::Level => walker.level(root, visitor),
    }
}

struct Walker<'a, I: Interest> {
    supply: &'a dyn Supply,
    interest: &'a I,
    steps: Vec<Step>,
    children: Vec<Task<I::State>>,
}

impl<I: Interest> Walker<'_, I> {
    fn pre(&mut self, root: Task<I::State>, visitor: &mut dyn FnMut(&At<'_, I::State>)) {
        let mut stack = vec![root];
        while let Some(mut task) = stack.pop() {
            self.step(&mut task);
            self.visit(&task, visitor);
            self.find_children(&task);
            stack.extend(self.children.drain(..).rev());
        }
    }

    fn level(&mut self, root: Task<I::State>, visitor: &mut dyn FnMut(&At<'_, I::State>)) {
        let mut queue = VecDeque::from([root]);
        while let Some(mut task) = queue.pop_front() {
            self.step(&mut task);
            self.visit(&task, visitor);
            self.find_children(&task);
            queue.extend(self.children.drain(..));
        }
    }

    /// Visits each node after `before` of its children, or after all where there are fewer.
    fn deep(
        &mut self,
        root: Task<I::State>,
        before: usize,
        visitor: &mut dyn FnMut(&At<'_, I::State>),
    ) {
        let mut stack = vec![Todo::Open(root)];
        while let Some(todo) = stack.pop() {
            match todo {
                Todo::Visit(task) => self.visit(&task, visitor),
                Todo::Open(mut task) => {
                    self.step(&mut task);
                    self.find_children(&task);
                    let n_before = self.children.len().min(before);
                    stack.extend(self.children.drain(n_before..).rev().map(Todo::Open));
                    stack.push(Todo::Visit(task));
                    stack.extend(self.children.drain(..).rev().map(Todo::Open));
                }
            }
        }
    }

    /// Notes the way to a site that is just found.
    fn step(&mut self, task: &mut Task<I::State>) {
        if task.node == 0 {
            self.steps.push(Step { parent: task.step, link: task.link, site: task.site });
            task.step = self.steps.len() as u32 - 1;
        }
    }

    fn visit(&self, task: &Task<I::State>, visitor: &mut dyn FnMut(&At<'_, I::State>)) {
        visitor(&At { supply: self.supply, task, steps: &self.steps });
    }

    /// Gathers the children of a node in order.
    fn find_children(&mut self, task: &Task<I::State>) {
        let plan = self.supply.plan(task.site);
        let inside = match plan.fragment.node(task.node) {
            RenderNode::Deferred(run) => {
                for link in run.first..run.first + run.count {
                    self.find_linked(task, link, run.kind, run.foreseen);
                }
                return;
            }
            RenderNode::Transform(transform) => task.world * *transform,
            RenderNode::Live(live) => task.world * plan.live[live as usize],
            RenderNode::Facing(facing) => task.world * facing.turn(&task.world, self.supply.eye()),
            RenderNode::Group
            | RenderNode::Fading(_)
            | RenderNode::Aspects(_)
            | RenderNode::Swaying(_)
            | RenderNode::Mesh { .. }
            | RenderNode::Instances { .. }
            | RenderNode::Lines(_)
            | RenderNode::Light(_)
            | RenderNode::Camera(_)
            | RenderNode::Label(_) => task.world,
        };
        for node in plan.fragment.children(task.node) {
            let depth = task.depth + 1;
            let child = Task { node, world: inside, depth, ..task.clone() };
            self.children.push(child);
        }
    }

    fn find_linked(
        &mut self,
        task: &Task<I::State>,
        link: u32,
        kind: crate::Kind,
        foreseen: Option<&sapwood_geom::Bound>,
    ) {
        let (env, supplied) = self.supply.enter(task.env, task.site, link);
        let site = match supplied {
            Supplied::Ready(site) | Supplied::Previous(site) => site,
            Supplied::Foreseen(_) | Supplied::Unknown | Supplied::Failed(_) => return,
        };
        let bound = self.supply.bound(site).or(foreseen);
        let approach = Approach { world: &task.world, bound, kind, link };
        if let Some(state) = self.interest.enter(&task.state, &approach) {
            let (world, depth, step) = (task.world, task.depth + 1, task.step);
            self.children.push(Task { env, site, node: 0, world, state, depth, step, link });
        }
    }
}
