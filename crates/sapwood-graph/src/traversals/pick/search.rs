//! The search: plans from near to far, and in them every node that the ray meets.
//!
//! A site that several places show in the same frame is gone into once; where it is found again,
//! only the way there is noted. Which of the ways comes first in pre-order is asked at the end.

use sapwood_geom::glam::{Affine3, DVec3, Vec2, Vec3};
use sapwood_geom::{
    Bound, FixedMap, Mesh, MeshHit, Ray, SharedMesh, Sides, closest_on_transformed, fixed_state,
};

use super::lines::{Passed, meet_label, pass_lines};
use super::sight::Sight;
use super::{Hit, PickOptions, PickedPart, PickedSides, Struck};
use crate::{
    DrawRange, EnvId, Interrupted, LimitsAbove, Material, PlanRef, RenderNode, Run, SiteId,
    Supplied, Supply, Vantage,
};

pub(super) struct Search<'a> {
    supply: &'a dyn Supply,
    ray: &'a Ray,
    options: &'a PickOptions,
    /// The sites gone into, each once for each frame; the root first.
    steps: Vec<SiteId>,
    /// Their numbers, by the site and the bits of its frame.
    known: FixedMap<(SiteId, [u32; 12]), u32>,
    ways: Vec<Way>,
    stack: Vec<Frame>,
    /// The closest hits: all of them are as near.
    closest: Vec<Found>,
}

/// One of the ways to a step: behind a link of another one.
#[derive(Clone, Copy)]
struct Way {
    parent: u32,
    /// The deferred node in the parent's fragment, and the link.
    node: u32,
    link: u32,
    step: u32,
}

/// A site to go into.
struct Frame {
    env: EnvId,
    site: SiteId,
    world: Affine3,
    /// The distance before which nothing is met there.
    enters: f64,
    /// The step of the parent.
    parent: u32,
    node: u32,
    link: u32,
}

/// A hit, as far as it is needed to compare it with others.
struct Found {
    distance: f64,
    step: u32,
    node: u32,
    /// From the node's frame to the root's.
    world: Affine3,
    thing: Thing,
}

enum Thing {
    /// With an instance the number of it, and how much larger it is drawn.
    Triangle {
        hit: MeshHit,
        instance: Option<(u32, f32)>,
    },
    Line(Passed),
    Label,
}

/// A mesh repeated, as far as it is drawn.
struct Instances<'a> {
    mesh: &'a SharedMesh,
    material: &'a Material,
    transforms: &'a [Affine3],
    part: DrawRange,
    growth: f32,
}

/// An instance that is drawn larger about its own origin.
fn grown(transform: &Affine3, growth: f32) -> Affine3 {
    if growth == 1.0 {
        return *transform;
    }
    *transform * Affine3::from_scale(Vec3::splat(growth))
}

impl<'a> Search<'a> {
    pub(super) fn new(supply: &'a dyn Supply, ray: &'a Ray, options: &'a PickOptions) -> Self {
        Self {
            supply,
            ray,
            options,
            steps: Vec::new(),
            ways: Vec::new(),
            stack: Vec::new(),
            closest: Vec::new(),
            known: FixedMap::with_hasher(fixed_state()),
        }
    }

    pub(super) fn run(mut self) -> Result<Option<Hit>, Interrupted> {
        let (env, site) = self.supply.root();
        let world = Affine3::IDENTITY;
        let enters = self.ray.min();
        self.stack.push(Frame { env, site, world, enters, parent: 0, node: 0, link: 0 });
        while let Some(frame) = self.stack.pop() {
            if frame.enters <= self.reach() {
                self.come_by(&frame)?;
            }
        }
        Ok(self.first_in_pre_order().map(|(found, ways)| self.hit(found, &ways)))
    }

    /// How far there is anything to find.
    fn reach(&self) -> f64 {
        self.closest.first().map_or(self.ray.max(), |found| found.distance)
    }

    /// Notes the way to a site, and goes into it where that was not done in the same frame.
    fn come_by(&mut self, frame: &Frame) -> Result<(), Interrupted> {
        let limit = self.options.most_occurrences;
        let Frame { parent, node, link, site, .. } = *frame;
        if self.ways.len() >= limit as usize {
            let component = self.supply.plan(site).kind.name();
            let limit = u64::from(limit);
            return Err(Interrupted::Exhausted { what: "occurrences", limit, component });
        }
        let bits = frame.world.to_cols_array().map(f32::to_bits);
        let next = self.steps.len() as u32;
        let step = *self.known.entry((site, bits)).or_insert(next);
        self.ways.push(Way { parent, node, link, step });
        if step == next {
            self.steps.push(site);
            self.scan(frame, step);
        }
        Ok(())
    }

    /// Looks at every node of one site.
    fn scan(&mut self, frame: &Frame, step: u32) {
        let site = frame.site;
        let plan = self.supply.plan(site);
        let first = self.stack.len();
        // Transforms above the node at hand: where each ends, and the product so far.
        let mut above: Vec<(u32, Affine3)> = Vec::new();
        let mut here = frame.world;
        let mut sight: Option<Sight> = None;
        let mut limits = LimitsAbove::default();
        for index in 0..plan.fragment.len() {
            while let Some((_, outer)) = above.pop_if(|(end, _)| *end <= index) {
                (here, sight) = (outer, None);
            }
            limits.go_on_to(index);
            let place = match plan.fragment.node(index) {
                RenderNode::Group
                | RenderNode::Swaying(_)
                | RenderNode::Light(_)
                | RenderNode::Camera(_) => continue,
                RenderNode::Transform(transform) => *transform,
                RenderNode::Live(live) => plan.live[live as usize],
                RenderNode::Facing(facing) => facing.turn(&here, self.supply.eye()),
                limiting @ (RenderNode::Fading(_) | RenderNode::Aspects(_)) => {
                    if let Some(limiter) = limiting.limiter() {
                        let vantage = Vantage::of(&here, self.supply.eye());
                        limits.enter(plan.fragment.after(index), limiter, vantage);
                    }
                    continue;
                }
                drawn @ (RenderNode::Mesh { .. }
                | RenderNode::Instances { .. }
                | RenderNode::Lines(_)
                | RenderNode::Label(_)) => {
                    let sight = sight.get_or_insert_with(|| Sight::new(self.ray, &here));
                    let part = limits.drawn(plan.fragment.n_drawn(index).unwrap_or(1));
                    self.meet(&plan, index, drawn, part, sight, step);
                    continue;
                }
                RenderNode::Deferred(run) => {
                    let sight = sight.get_or_insert_with(|| Sight::new(self.ray, &here));
                    self.approach(frame.env, site, index, run, sight, step);
                    continue;
                }
            };
            above.push((plan.fragment.after(index), here));
            (here, sight) = (here * place, None);
        }
        // The stack gives back the last first: the nearest, and of those as near the first.
        let found = &mut self.stack[first..];
        found.reverse();
        found.sort_by(|a, b| b.enters.total_cmp(&a.enters));
    }

    /// Puts those children of a run on the stack that the ray may meet.
    fn approach(
        &mut self,
        env: EnvId,
        site: SiteId,
        node: u32,
        run: Run<'_>,
        sight: &Sight,
        parent: u32,
    ) {
        let (world, by, reach) = (sight.world, self.options.by(), self.reach());
        for link in run.first..run.first + run.count {
            let (env, Supplied::Ready(site)) = self.supply.enter(env, site, link) else { continue };
            let bound = self.supply.bound(site).or(run.foreseen);
            let enters = match bound {
                Some(bound) => sight.enters(bound, by),
                None => Some(self.ray.min()),
            };
            if let Some(enters) = enters.filter(|enters| *enters <= reach) {
                self.stack.push(Frame { env, site, world, enters, parent, node, link });
            }
        }
    }

    /// Takes note of where the ray meets what one node draws.
    fn meet(
        &mut self,
        plan: &PlanRef<'_>,
        node: u32,
        drawn: RenderNode<'_>,
        (part, growth): (DrawRange, f32),
        sight: &Sight,
        step: u32,
    ) {
        let reach = self.reach();
        let bound = plan.fragment.drawn_bound(node).unwrap_or(Bound::EMPTY);
        let by = if let RenderNode::Lines(_) = drawn { self.options.by() } else { 0.0 };
        if sight.enters(&bound, by).is_none_or(|enters| enters > reach) {
            return;
        }
        let world = sight.world;
        let found = match drawn {
            RenderNode::Mesh { mesh, material } => {
                let hit = self.meet_mesh(mesh, part, material, sight, reach);
                hit.map(|hit| (hit.distance, Thing::Triangle { hit, instance: None }))
            }
            RenderNode::Instances { mesh, material, transforms } => {
                let instances = Instances { mesh, material, transforms, part, growth };
                let hit = self.meet_instances(plan, node, &instances, sight);
                let instance = |i| Some((i, growth));
                hit.map(|(i, hit)| (hit.distance, Thing::Triangle { hit, instance: instance(i) }))
            }
            RenderNode::Lines(lines) => self.options.line_radius.and_then(|_| {
                let passed = pass_lines(self.ray, lines, part, &world, f64::from(by), reach)?;
                Some((passed.distance, Thing::Line(passed)))
            }),
            RenderNode::Label(label) => {
                sight.inside.filter(|_| self.options.labels).and_then(|ray| {
                    let distance = meet_label(&ray, label)?;
                    Some((distance, Thing::Label))
                })
            }
            RenderNode::Group
            | RenderNode::Transform(_)
            | RenderNode::Live(_)
            | RenderNode::Facing(_)
            | RenderNode::Fading(_)
            | RenderNode::Aspects(_)
            | RenderNode::Swaying(_)
            | RenderNode::Light(_)
            | RenderNode::Camera(_)
            | RenderNode::Deferred(_) => None,
        };
        let Some((distance, thing)) = found else { return };
        if distance < reach {
            self.closest.clear();
        }
        self.closest.push(Found { distance, step, node, world, thing });
    }

    fn sides(&self, material: &Material) -> Sides {
        match self.options.sides {
            PickedSides::AsDrawn if !material.double_sided => Sides::Front,
            PickedSides::Both | PickedSides::AsDrawn => Sides::Both,
        }
    }

    fn meet_mesh(
        &self,
        mesh: &SharedMesh,
        part: DrawRange,
        material: &Material,
        sight: &Sight,
        reach: f64,
    ) -> Option<MeshHit> {
        let sides = self.sides(material);
        match &sight.inside {
            Some(ray) => {
                let is_drawn = |triangle| part.contains(triangle);
                mesh.bvh().closest_where(mesh, ray, reach, sides, is_drawn)
            }
            None => {
                let world = sight.world.as_daffine3();
                let triangles = part.numbers();
                closest_on_transformed(mesh, triangles, &world, self.ray, reach, sides)
            }
        }
    }

    fn meet_instances(
        &self,
        plan: &PlanRef<'_>,
        node: u32,
        instances: &Instances<'_>,
        sight: &Sight,
    ) -> Option<(u32, MeshHit)> {
        let Instances { mesh, material, transforms, part, growth } = *instances;
        let triangles = DrawRange { first: 0, end: mesh.n_triangles() as u32 };
        let mut closest: Option<(u32, MeshHit)> = None;
        let mut reach = self.reach();
        let mut look = |instance: u32| {
            if !part.contains(instance) {
                return reach;
            }
            let world = sight.world * grown(&transforms[instance as usize], growth);
            let sight = Sight::new(self.ray, &world);
            if let Some(hit) = self.meet_mesh(mesh, triangles, material, &sight, reach) {
                let precedes =
                    |known: (u32, MeshHit)| (hit.distance, instance) < (known.1.distance, known.0);
                if closest.is_none_or(precedes) {
                    closest = Some((instance, hit));
                    reach = hit.distance;
                }
            }
            reach
        };
        match (&sight.inside, plan.fragment.instance_tree(node)) {
            (Some(ray), Some(tree)) => tree.along(ray, self.reach(), look),
            _ => {
                for instance in part.numbers() {
                    look(instance);
                }
            }
        }
        closest
    }

    /// Of the closest hits the first in pre-order, and the way there from the root.
    fn first_in_pre_order(&self) -> Option<(&Found, Vec<Way>)> {
        // The root's own way leads from nowhere.
        let mut ways = self.ways.get(1..).unwrap_or_default().to_vec();
        ways.sort_unstable_by_key(|way| way.step);
        // Which steps lead to a hit.
        let mut leads = vec![false; self.steps.len()];
        let mut stack: Vec<u32> = self.closest.iter().map(|found| found.step).collect();
        while let Some(step) = stack.pop() {
            if !std::mem::replace(&mut leads[step as usize], true) {
                let first = ways.partition_point(|way| way.step < step);
                let to_here = ways[first..].iter().take_while(|way| way.step == step);
                stack.extend(to_here.map(|way| way.parent));
            }
        }
        ways.retain(|way| leads[way.step as usize]);
        ways.sort_unstable_by_key(|way| (way.parent, way.node, way.link));
        let mut hits: Vec<&Found> = self.closest.iter().collect();
        hits.sort_unstable_by_key(|found| (found.step, found.node));
        let (mut step, mut path) = (0, Vec::new());
        loop {
            let hit = hits.get(hits.partition_point(|found| found.step < step));
            let hit = hit.filter(|found| found.step == step);
            let way = ways.get(ways.partition_point(|way| way.parent < step));
            match (hit, way.filter(|way| way.parent == step)) {
                (Some(hit), Some(way)) if hit.node > way.node => path.push(*way),
                (Some(hit), _) => return Some((hit, path)),
                (None, Some(way)) => path.push(*way),
                (None, None) => return None,
            }
            step = path.last()?.step;
        }
    }
}

/// What is told of the closest hit.
impl Search<'_> {
    fn hit(&self, found: &Found, ways: &[Way]) -> Hit {
        let plan = self.supply.plan(self.steps[found.step as usize]);
        let toward = |normal: DVec3| {
            let normal = normal.normalize_or(-self.ray.direction());
            if normal.dot(self.ray.direction()) > 0.0 { -normal } else { normal }
        };
        let (point, normal, struck) = match &found.thing {
            Thing::Triangle { hit, instance } => self.triangle(&plan, found, hit, *instance),
            Thing::Line(passed) => {
                let Passed { line, stretch, along, point, .. } = *passed;
                // As if it were a thin tube: square to the line.
                let axis = passed.stretch_along.normalize_or_zero();
                let back = -self.ray.direction();
                let normal = (back - axis * back.dot(axis)).normalize_or(back);
                (point, normal, Struck::Line { line, stretch, along: along as f32 })
            }
            Thing::Label => {
                let axes = found.world.as_daffine3().matrix3;
                let normal = toward(axes.x_axis.cross(axes.y_axis));
                (self.ray.at(found.distance), normal, Struck::Label)
            }
        };
        Hit {
            distance: found.distance as f32,
            point: point.as_vec3(),
            normal: normal.as_vec3(),
            struck,
            kind: plan.kind,
            node: found.node,
            part: self.part(found, &plan, ways),
            path: ways.iter().map(|way| way.link).collect(),
        }
    }

    fn triangle(
        &self,
        plan: &PlanRef<'_>,
        found: &Found,
        hit: &MeshHit,
        instance: Option<(u32, f32)>,
    ) -> (DVec3, DVec3, Struck) {
        let (mesh, world): (&Mesh, Affine3) = match (plan.fragment.node(found.node), instance) {
            (RenderNode::Instances { mesh, transforms, .. }, Some((i, growth))) => {
                (mesh, found.world * grown(&transforms[i as usize], growth))
            }
            (RenderNode::Mesh { mesh, .. }, _) => (mesh, found.world),
            (
                RenderNode::Instances { .. }
                | RenderNode::Group
                | RenderNode::Transform(_)
                | RenderNode::Live(_)
                | RenderNode::Facing(_)
                | RenderNode::Fading(_)
                | RenderNode::Aspects(_)
                | RenderNode::Swaying(_)
                | RenderNode::Lines(_)
                | RenderNode::Light(_)
                | RenderNode::Camera(_)
                | RenderNode::Label(_)
                | RenderNode::Deferred(_),
                _,
            ) => unreachable!("triangles are hit in meshes"),
        };
        let world = world.as_daffine3();
        let first = 3 * hit.triangle as usize;
        let corners = [0, 1, 2].map(|i| mesh.indices[first + i] as usize);
        let [a, b, c] =
            corners.map(|corner| world.transform_point3(mesh.positions[corner].as_dvec3()));
        let weights = hit.weights;
        let point = a * weights[0] + b * weights[1] + c * weights[2];
        let normal = (b - a).cross(c - a).normalize_or(-self.ray.direction());
        let normal = if normal.dot(self.ray.direction()) > 0.0 { -normal } else { normal };
        let mut shading = Vec3::ZERO;
        let mut uv = Vec2::ZERO;
        for (corner, weight) in corners.into_iter().zip(weights) {
            shading += mesh.normals[corner] * weight as f32;
            uv += mesh.uvs[corner] * weight as f32;
        }
        let shading = world.matrix3.inverse().transpose() * shading.as_dvec3();
        let shading = if shading.is_finite() { shading.normalize_or(normal) } else { normal };
        let shading = if shading.dot(normal) < 0.0 { -shading } else { shading };
        let struck = Struck::Triangle {
            triangle: hit.triangle,
            instance: instance.map(|(i, _)| i),
            weights: weights.map(|weight| weight as f32),
            shading_normal: shading.as_vec3(),
            uv,
            is_front: hit.is_front,
        };
        (point, normal, struck)
    }

    /// The part that was hit: in the plan that draws, or in the nearest one above that has parts
    /// of the kind.
    fn part(&self, found: &Found, plan: &PlanRef<'_>, ways: &[Way]) -> Option<PickedPart> {
        let shown = plan.fragment.shown(found.node)?;
        let number = match &found.thing {
            Thing::Triangle { instance: Some((instance, _)), .. } => *instance,
            Thing::Triangle { hit, instance: None } => hit.triangle,
            Thing::Line(Passed { line, .. }) => *line,
            Thing::Label => return None,
        };
        let row = shown.row(number)?;
        let above = ways.iter().rev().map(|way| way.parent);
        for (i, step) in std::iter::once(found.step).chain(above).enumerate() {
            let parts = self.supply.plan(self.steps[step as usize]).parts;
            let array = parts.lengths().find(|(kind, _)| *kind == shown.kind());
            if let Some((kind, n)) = array {
                let n_links = (ways.len() - i) as u32;
                return ((row as usize) < n).then_some(PickedPart { kind, row, n_links });
            }
        }
        None
    }
}
