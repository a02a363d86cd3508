//! What is known of a tree's wood from its stems alone, each by itself: where the tips are, and how
//! much there is of it. What welding makes is held against this, in the tests and in the bench
//! `union`, which shares the file.

use sapwood::geom::glam::{Affine3, Vec3};
use sapwood::geom::{
    Aabb, BoxTree, Mesh, MeshBvh, Purpose, Ray, Sides, Solid, Stream, StreamPath, Union,
};
use sapwood::graph::{At, Everything, Handlers, Order, Solids};
use sapwood::rules::weber_penn::{Segment, Stem};
use sapwood::scene::{Scene, ViewId};

/// All stems of a view, in the world.
#[derive(Default)]
pub(crate) struct Wood {
    /// The surface of each stem, closed.
    pub(crate) stems: Vec<Mesh>,
    /// The level of each stem, 0 for trunks.
    levels: Vec<u8>,
    /// The middle of the tip of each stem that is more than 2 mm thick.
    pub(crate) tips: Vec<Vec3>,
    /// The levels of the stems whose surface comes next.
    levels_met: Vec<u8>,
    /// Boxes around segments, which cover all stems.
    boxes: Vec<SegmentBox>,
}

/// A box along a segment.
struct SegmentBox {
    world: Affine3,
    segment: Segment,
    half_width: f32,
}

impl SegmentBox {
    fn length(&self) -> f32 {
        self.segment.length + 2.0 * self.half_width
    }

    fn volume(&self) -> f64 {
        4.0 * f64::from(self.half_width * self.half_width * self.length())
    }

    /// The point at shares from 0 to 1 of its edges.
    fn point(&self, [x, y, z]: [f32; 3]) -> Vec3 {
        let across = |share: f32| (2.0 * share - 1.0) * self.half_width;
        let along = z * self.length() - self.half_width;
        let local = self.segment.frame.point(Vec3::new(across(x), across(y), along));
        self.world.transform_point3(local)
    }

    fn contains(&self, point: Vec3) -> bool {
        let arm = self.world.inverse().transform_point3(point) - self.segment.frame.origin;
        let local = self.segment.frame.axes.transpose() * arm;
        let along = local.z + self.half_width;
        local.x.abs() <= self.half_width
            && local.y.abs() <= self.half_width
            && (0.0..=self.length()).contains(&along)
    }

    fn aabb(&self) -> Aabb {
        let ends = [0.0, 1.0];
        let corners = ends.into_iter().flat_map(|x| {
            ends.into_iter().flat_map(move |y| ends.into_iter().map(move |z| [x, y, z]))
        });
        Aabb::of_points(corners.map(|corner| self.point(corner)))
    }
}

impl Wood {
    /// The wood of a view that can be compiled.
    pub(crate) fn of(scene: &mut Scene, view: ViewId) -> Self {
        let handlers = Handlers::<Self>::new().on_interface::<dyn Solids>(
            |wood: &mut Self, solids: &(dyn Solids + 'static), at: &At<'_, ()>| {
                for (solid, level) in solids.solids().iter().zip(&wood.levels_met) {
                    if !solid.is_empty() {
                        let mut placed = Mesh::default();
                        placed.append(solid, at.world());
                        wood.stems.push(placed);
                        wood.levels.push(*level);
                    }
                }
            },
        );
        let mut wood = Self::default();
        let visit = &mut |at: &At<'_, ()>| {
            handlers.handle(&mut wood, at);
            wood.meet(at);
        };
        scene.traverse(view, Order::Pre, &Everything, visit).expect("nobody interrupts");
        wood
    }

    fn meet(&mut self, at: &At<'_, ()>) {
        if !at.enters_plan() {
            return;
        }
        let (plan, world) = (at.plan(), *at.world());
        let (stems, segments) = (plan.parts.of::<Stem>(), plan.parts.of::<Segment>());
        if !stems.is_empty() {
            self.levels_met = stems.iter().map(|stem| stem.seed.level).collect();
        }
        for stem in stems {
            let own = &segments[stem.segment_range()];
            if let Some(last) = own.last().filter(|_| stem.seed.radius > 1e-3) {
                self.tips.push(world.transform_point3(last.end()));
            }
            // Trunks have flare, lobes and bumps.
            let wider = if stem.seed.level == 0 { 3.0 } else { 1.3 };
            self.boxes.extend(own.iter().map(|segment| {
                let half_width = wider * segment.radius_foot.max(segment.radius_end)
                    + 2.0 * stem.helix_radius.abs()
                    + 1e-5;
                SegmentBox { world, segment: *segment, half_width }
            }));
        }
    }

    /// How many corners of stems no box covers: there should be none.
    pub(crate) fn n_uncovered(&self) -> usize {
        let in_boxes = BoxTree::new(self.boxes.iter().map(SegmentBox::aabb));
        let corners = self.stems.iter().flat_map(|stem| &stem.positions);
        let is_uncovered = |corner: &&Vec3| {
            let mut n = 0;
            in_boxes.within(&Aabb { min: **corner, max: **corner }, |i| {
                n += u32::from(self.boxes[i as usize].contains(**corner));
            });
            n == 0
        };
        corners.filter(is_uncovered).count()
    }

    /// The volume of what is inside any stem, by `n` random points. They are spread evenly over the
    /// boxes, one box after the other; a point weighs as much less as there are boxes around it.
    pub(crate) fn volume(&self, n: u32) -> f64 {
        let in_boxes = BoxTree::new(self.boxes.iter().map(SegmentBox::aabb));
        let inside = Inside::of(&self.stems);
        let mut sums = vec![0.0];
        for segment in &self.boxes {
            sums.push(sums[sums.len() - 1] + segment.volume());
        }
        let all = sums[sums.len() - 1];
        let mut stream = Stream::new(StreamPath::new(1), Purpose("volume"));
        let mut weight = 0.0;
        for number in 0..n {
            let place = all * (f64::from(number) + f64::from(stream.unit())) / f64::from(n);
            let index = sums.partition_point(|sum| *sum <= place).clamp(1, self.boxes.len()) - 1;
            let point = self.boxes[index].point([(); 3].map(|()| stream.unit()));
            if inside.any(point) {
                let mut n_boxes = 0;
                in_boxes.within(&Aabb { min: point, max: point }, |i| {
                    n_boxes += u32::from(self.boxes[i as usize].contains(point));
                });
                weight += 1.0 / f64::from(n_boxes.max(1));
            }
        }
        all * weight / f64::from(n)
    }

    /// The first solids of those components of a union that hold nothing of any trunk and are no
    /// cavities: stems which hang in the air. The union must be of the stems, in their order.
    pub(crate) fn afloat(&self, union: &Union) -> Vec<u32> {
        let solid = &union.solid;
        let mut volumes = vec![0.0; solid.positions.len()];
        for (number, component) in solid.components().iter().enumerate() {
            let from = solid.positions[*component as usize].as_dvec3();
            let [a, b, c] = solid.corners(number).map(|corner| corner.as_dvec3() - from);
            volumes[*component as usize] += a.dot(b.cross(c));
        }
        let components = solid.components().into_iter().zip(&union.sources);
        let components = components.filter(|(component, _)| volumes[*component as usize] > 0.0);
        let mut roots: Vec<(u32, u8, u32)> = components
            .map(|(component, (part, _))| (component, self.levels[*part as usize], *part))
            .collect();
        roots.sort_unstable();
        roots.dedup_by_key(|(component, _, _)| *component);
        roots.retain(|(_, level, _)| *level > 0);
        roots.into_iter().map(|(_, _, part)| part).collect()
    }

    /// Tips farther than `reach` metres from the surface of `union`, unless they lie inside of
    /// another stem, where no surface is; and how many lie there.
    pub(crate) fn lost_tips(&self, union: &Solid, reach: f32) -> (Vec<Vec3>, usize) {
        let tree = BoxTree::new(
            (0..union.triangles.len()).map(|number| Aabb::of_points(union.corners(number))),
        );
        let far = self.tips.iter().filter(|tip| !is_near(union, &tree, **tip, reach));
        let inside = Inside::of(&self.stems);
        let (covered, lost): (Vec<Vec3>, Vec<Vec3>) =
            far.partition(|tip| inside.any_deeper(**tip, reach));
        (lost, covered.len())
    }
}

/// Tells what is inside of any of some closed meshes.
struct Inside<'a> {
    meshes: &'a [Mesh],
    trees: Vec<MeshBvh>,
    boxes: BoxTree,
}

impl<'a> Inside<'a> {
    fn of(meshes: &'a [Mesh]) -> Self {
        let boxes = BoxTree::new(meshes.iter().map(|mesh| mesh.bound().aabb));
        Self { meshes, trees: meshes.iter().map(MeshBvh::new).collect(), boxes }
    }

    fn any(&self, point: Vec3) -> bool {
        let here = Aabb { min: point, max: point };
        let ray = Ray::new(point, Vec3::new(0.36, 0.48, 0.8));
        let mut is_inside = false;
        self.boxes.within(&here, |number| {
            is_inside = is_inside || self.leaves(number as usize, &ray);
        });
        is_inside
    }

    /// Whether all points about `reach` metres around are inside.
    fn any_deeper(&self, point: Vec3, reach: f32) -> bool {
        let ways = [Vec3::X, Vec3::Y, Vec3::Z].into_iter().flat_map(|way| [way, -way]);
        ways.into_iter().all(|way| self.any(point + reach * way))
    }

    /// Whether the first thing that the ray meets of a mesh is seen from behind.
    fn leaves(&self, number: usize, ray: &Ray) -> bool {
        let (mesh, tree) = (&self.meshes[number], &self.trees[number]);
        let hit = tree.closest(mesh, ray, f64::INFINITY, Sides::Both);
        hit.is_some_and(|hit| !hit.is_front)
    }
}

/// Whether the surface comes as near to a point as `reach` metres.
fn is_near(solid: &Solid, tree: &BoxTree, point: Vec3, reach: f32) -> bool {
    let around = Aabb { min: point - Vec3::splat(reach), max: point + Vec3::splat(reach) };
    let mut is_near = false;
    tree.within(&around, |triangle| {
        is_near |= distance(solid.corners(triangle as usize), point) <= reach;
    });
    is_near
}

/// The distance of a point from a triangle.
fn distance([a, b, c]: [Vec3; 3], point: Vec3) -> f32 {
    let normal = (b - a).cross(c - a);
    let sides = [(a, b), (b, c), (c, a)];
    if sides.iter().all(|(from, to)| (to - from).cross(point - from).dot(normal) >= 0.0) {
        return (point - a).dot(normal.normalize_or_zero()).abs();
    }
    let beside = sides.map(|(from, to)| {
        let along = to - from;
        let share = (point - from).dot(along) / along.length_squared();
        point.distance(from + along * share.clamp(0.0, 1.0))
    });
    beside.into_iter().fold(f32::INFINITY, f32::min)
}
