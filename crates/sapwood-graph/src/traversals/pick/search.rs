//! The search: plans from near to far, and in them every node that the ray meets.

use sapwood_geom::glam::{Affine3, DVec3, Vec2, Vec3};
use sapwood_geom::{Bound, Mesh, MeshHit, Ray, SharedMesh, Sides, closest_on_transformed};

use super::lines::{Passed, meet_label, pass_lines};
use super::sight::Sight;
use super::{Hit, PickOptions, PickedPart, PickedSides, Struck};
use crate::{EnvId, Material, PlanRef, RenderNode, Run, SiteId, Supplied, Supply};

pub(super) struct Search<'a> {
    supply: &'a dyn Supply,
    ray: &'a Ray,
    options: &'a PickOptions,
    /// The way to every site gone into.
    steps: Vec<Step>,
    stack: Vec<Frame>,
    closest: Option<Found>,
}

struct Step {
    parent: u32,
    /// The deferred node in the parent's fragment, and the link.
    node: u32,
    link: u32,
    site: SiteId,
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
    Triangle { hit: MeshHit, instance: Option<u32> },
    Line(Passed),
    Label,
}

impl<'a> Search<'a> {
    pub(super) fn new(supply: &'a dyn Supply, ray: &'a Ray, options: &'a PickOptions) -> Self {
        Self { supply, ray, options, steps: Vec::new(), stack: Vec::new(), closest: None }
    }

    pub(super) fn run(mut self) -> Option<Hit> {
        let (env, site) = self.supply.root();
        let world = Affine3::IDENTITY;
        let enters = self.ray.min();
        self.stack.push(Frame { env, site, world, enters, parent: 0, node: 0, link: 0 });
        while let Some(frame) = self.stack.pop() {
            if frame.enters <= self.reach() {
                self.scan(&frame);
            }
        }
        let found = self.closest.take()?;
        Some(self.hit(&found))
    }

    /// How far there is anything to find.
    fn reach(&self) -> f64 {
        self.closest.as_ref().map_or(self.ray.max(), |found| found.distance)
    }

    /// Looks at every node of one site.
    fn scan(&mut self, frame: &Frame) {
        let step = self.steps.len() as u32;
        let Frame { parent, node, link, site, .. } = *frame;
        self.steps.push(Step { parent, node, link, site });
        let plan = self.supply.plan(site);
        let first = self.stack.len();
        // Transforms above the node at hand: where each ends, and the product so far.
        let mut above: Vec<(u32, Affine3)> = Vec::new();
        let mut here = frame.world;
        let mut sight: Option<Sight> = None;
        for index in 0..plan.fragment.len() {
            while let Some((_, outer)) = above.pop_if(|(end, _)| *end <= index) {
                (here, sight) = (outer, None);
            }
            let place = match plan.fragment.node(index) {
                RenderNode::Group | RenderNode::Light(_) | RenderNode::Camera(_) => continue,
                RenderNode::Transform(transform) => *transform,
                RenderNode::Live(live) => plan.live[live as usize],
                RenderNode::Facing(facing) => facing.turn(&here, self.supply.eye()),
                drawn @ (RenderNode::Mesh { .. }
                | RenderNode::Instances { .. }
                | RenderNode::Lines(_)
                | RenderNode::Label(_)) => {
                    let sight = sight.get_or_insert_with(|| Sight::new(self.ray, &here));
                    self.meet(&plan, index, drawn, sight, step);
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
                let hit = self.meet_mesh(mesh, material, sight, reach);
                hit.map(|hit| (hit.distance, Thing::Triangle { hit, instance: None }))
            }
            RenderNode::Instances { mesh, material, transforms } => {
                let hit = self.meet_instances(plan, node, mesh, material, transforms, sight);
                hit.map(|(i, hit)| (hit.distance, Thing::Triangle { hit, instance: Some(i) }))
            }
            RenderNode::Lines(lines) => self.options.line_radius.and_then(|_| {
                let passed = pass_lines(self.ray, lines, &world, f64::from(by), reach)?;
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
            | RenderNode::Light(_)
            | RenderNode::Camera(_)
            | RenderNode::Deferred(_) => None,
        };
        let Some((distance, thing)) = found else { return };
        let found = Found { distance, step, node, world, thing };
        if self.closest.as_ref().is_none_or(|closest| self.precedes(&found, closest)) {
            self.closest = Some(found);
        }
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
        material: &Material,
        sight: &Sight,
        reach: f64,
    ) -> Option<MeshHit> {
        let sides = self.sides(material);
        match &sight.inside {
            Some(ray) => mesh.bvh().closest(mesh, ray, reach, sides),
            None => {
                let world = sight.world.as_daffine3();
                closest_on_transformed(mesh, &world, self.ray, reach, sides)
            }
        }
    }

    fn meet_instances(
        &self,
        plan: &PlanRef<'_>,
        node: u32,
        mesh: &SharedMesh,
        material: &Material,
        transforms: &[Affine3],
        sight: &Sight,
    ) -> Option<(u32, MeshHit)> {
        let mut closest: Option<(u32, MeshHit)> = None;
        let mut reach = self.reach();
        let mut look = |instance: u32| {
            let world = sight.world * transforms[instance as usize];
            let sight = Sight::new(self.ray, &world);
            if let Some(hit) = self.meet_mesh(mesh, material, &sight, reach) {
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
                for instance in 0..transforms.len() as u32 {
                    look(instance);
                }
            }
        }
        closest
    }

    /// Whether one hit goes before another: nearer, or as near and earlier in pre-order.
    fn precedes(&self, found: &Found, other: &Found) -> bool {
        if found.distance != other.distance {
            return found.distance < other.distance;
        }
        let place = |found: &Found| {
            let mut place = vec![(found.node, 0)];
            let mut step = found.step;
            while step > 0 {
                let Step { parent, node, link, .. } = self.steps[step as usize];
                place.push((node, link));
                step = parent;
            }
            place.reverse();
            place
        };
        place(found) < place(other)
    }
}

/// What is told of the closest hit.
impl Search<'_> {
    fn hit(&self, found: &Found) -> Hit {
        let mut path = Vec::new();
        let mut step = found.step;
        while step > 0 {
            path.push(self.steps[step as usize].link);
            step = self.steps[step as usize].parent;
        }
        path.reverse();
        let plan = self.supply.plan(self.steps[found.step as usize].site);
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
            part: self.part(found, &plan, path.len() as u32),
            path,
        }
    }

    fn triangle(
        &self,
        plan: &PlanRef<'_>,
        found: &Found,
        hit: &MeshHit,
        instance: Option<u32>,
    ) -> (DVec3, DVec3, Struck) {
        let (mesh, world): (&Mesh, Affine3) = match (plan.fragment.node(found.node), instance) {
            (RenderNode::Instances { mesh, transforms, .. }, Some(i)) => {
                (mesh, found.world * transforms[i as usize])
            }
            (RenderNode::Mesh { mesh, .. }, _) => (mesh, found.world),
            _ => unreachable!("triangles are hit in meshes"),
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
            instance,
            weights: weights.map(|weight| weight as f32),
            shading_normal: shading.as_vec3(),
            uv,
            is_front: hit.is_front,
        };
        (point, normal, struck)
    }

    /// The part that was hit: in the plan that draws, or in the nearest one above that has parts
    /// of the kind.
    fn part(&self, found: &Found, plan: &PlanRef<'_>, n_links: u32) -> Option<PickedPart> {
        let shown = plan.fragment.shown(found.node)?;
        let number = match &found.thing {
            Thing::Triangle { instance: Some(instance), .. } => *instance,
            Thing::Triangle { hit, instance: None } => hit.triangle,
            Thing::Line(Passed { line, .. }) => *line,
            Thing::Label => return None,
        };
        let row = shown.row(number)?;
        let mut n_links = n_links;
        let mut step = found.step;
        loop {
            let parts = self.supply.plan(self.steps[step as usize].site).parts;
            let array = parts.lengths().find(|(kind, _)| *kind == shown.kind());
            if let Some((kind, n)) = array {
                return ((row as usize) < n).then_some(PickedPart { kind, row, n_links });
            }
            if step == 0 {
                return None;
            }
            (step, n_links) = (self.steps[step as usize].parent, n_links - 1);
        }
    }
}
