//! What picking is compared with: testing every triangle that a walk comes by.

use sapwood::geom::glam::{Affine3, DVec3, Vec3};
use sapwood::geom::{Bound, Mesh, Purpose, Ray, Stream, StreamPath};
use sapwood::graph::{
    Everything, Hit, Material, Order, PickOptions, PickedSides, PlanRef, RenderNode, Struck,
};
use sapwood::scene::{Scene, ViewId};

/// A triangle in the root's frame, and where it comes from.
struct Triangle {
    corners: [DVec3; 3],
    is_mirrored: bool,
    is_double_sided: bool,
    path: Vec<u32>,
    instance: Option<u32>,
    number: u32,
}

fn triangles(scene: &mut Scene, view: ViewId) -> Vec<Triangle> {
    let mut all = Vec::new();
    let mut add = |path: &[u32], instance, mesh: &Mesh, material: &Material, world: Affine3| {
        let world = world.as_daffine3();
        for (number, corners) in mesh.indices.chunks_exact(3).enumerate() {
            let point = |i: usize| mesh.positions[corners[i] as usize].as_dvec3();
            let corners = [0, 1, 2].map(|i| world.transform_point3(point(i)));
            let is_mirrored = world.matrix3.determinant() < 0.0;
            let (number, path) = (number as u32, path.to_vec());
            let is_double_sided = material.double_sided;
            all.push(Triangle { corners, is_mirrored, is_double_sided, path, instance, number });
        }
    };
    scene
        .traverse(view, Order::Pre, &Everything, &mut |at| match at.node() {
            RenderNode::Mesh { mesh, material } => {
                add(&at.path().links(), None, mesh, material, *at.world());
            }
            RenderNode::Instances { mesh, material, transforms } => {
                for (i, transform) in transforms.iter().enumerate() {
                    let links = at.path().links();
                    add(&links, Some(i as u32), mesh, material, *at.world() * *transform);
                }
            }
            _ => {}
        })
        .unwrap();
    all
}

impl Triangle {
    /// The distance at which the ray meets the triangle (Möller and Trumbore 1997).
    fn meet(&self, ray: &Ray, sides: PickedSides) -> Option<f64> {
        let [a, b, c] = self.corners;
        let (ab, ac) = (b - a, c - a);
        let p = ray.direction().cross(ac);
        let det = ab.dot(p);
        let is_front = (det > 0.0) != self.is_mirrored;
        if sides == PickedSides::AsDrawn && !is_front && !self.is_double_sided {
            return None;
        }
        let from = ray.origin() - a;
        let u = from.dot(p) / det;
        let q = from.cross(ab);
        let v = ray.direction().dot(q) / det;
        let distance = ac.dot(q) / det;
        let is_met = u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance >= ray.min();
        (is_met && distance <= ray.max()).then_some(distance)
    }
}

/// Random rays through a bound.
pub(crate) struct Rays {
    bound: Bound,
    stream: Stream,
}

impl Rays {
    pub(crate) fn new(bound: Bound, seed: u64) -> Self {
        Self { bound, stream: Stream::new(StreamPath::new(seed), Purpose("rays")) }
    }

    pub(crate) fn take(&mut self, n: usize) -> Vec<Ray> {
        (0..n).map(|_| self.next()).collect()
    }

    /// From somewhere in or about the bound toward somewhere in it; every seventh ends there.
    pub(crate) fn next(&mut self) -> Ray {
        let (min, size) = (self.bound.aabb.min, self.bound.aabb.size());
        let mut inside = || Vec3::from_array([(); 3].map(|()| self.stream.unit())) * size + min;
        let (to, from) = (inside(), inside());
        let middle = min + size * 0.5;
        let origin = if self.stream.unit() < 0.7 { middle + (from - middle) * 5.0 } else { from };
        let ray = Ray::new(origin, (to - origin) * 0.3);
        if self.stream.unit() < 1.0 / 7.0 {
            return ray.between(0.01, to.distance(origin));
        }
        ray
    }
}

/// Picks with each of `rays` and compares each hit with what testing every triangle finds; tells
/// how many rays met something. Nothing but the picks compiles before they are done.
pub(crate) fn check(scene: &mut Scene, view: ViewId, rays: &[Ray], options: &PickOptions) -> u32 {
    let hits: Vec<Option<Hit>> =
        rays.iter().map(|ray| scene.pick(view, ray, options).unwrap()).collect();
    let all = triangles(scene, view);
    let mut n_hits = 0;
    for (ray, hit) in rays.iter().zip(hits) {
        let mut closest: Option<(f64, &Triangle)> = None;
        for triangle in &all {
            if let Some(distance) = triangle.meet(ray, options.sides)
                && closest.is_none_or(|(nearest, _)| distance < nearest)
            {
                closest = Some((distance, triangle));
            }
        }
        match (&hit, closest) {
            (None, None) => {}
            (Some(hit), Some((distance, triangle))) => {
                n_hits += 1;
                compare(ray, hit, distance, triangle);
            }
            (hit, closest) => {
                let closest = closest.map(|(distance, triangle)| (distance, &triangle.path));
                panic!("{ray:?}: picked {hit:?}, but {closest:?}");
            }
        }
    }
    n_hits
}

fn compare(ray: &Ray, hit: &Hit, distance: f64, triangle: &Triangle) {
    let slack = 1e-5 * (1.0 + distance);
    assert!((f64::from(hit.distance) - distance).abs() <= slack, "{hit:?}: {distance}");
    assert!(hit.point.as_dvec3().distance(ray.at(distance)) <= 10.0 * slack, "{hit:?}");
    assert!((hit.normal.length() - 1.0).abs() < 1e-5, "{hit:?}");
    assert!(hit.normal.as_dvec3().dot(ray.direction()) <= 0.0, "{hit:?}");
    let Struck::Triangle { triangle: number, instance, shading_normal, .. } = hit.struck else {
        panic!("{hit:?} is no triangle");
    };
    assert!((shading_normal.length() - 1.0).abs() < 1e-5, "{hit:?}");
    // On an edge, or where things touch, either may be told.
    let [a, b, c] = triangle.corners;
    let normal = (b - a).cross(c - a).normalize();
    let is_told =
        (&hit.path, instance, number) == (&triangle.path, triangle.instance, triangle.number);
    if is_told {
        assert!(normal.dot(hit.normal.as_dvec3()).abs() > 0.999, "{hit:?}: {normal}");
    }
}

/// Reads the plan at the end of a path, with its frame.
pub(crate) fn plan_at<R>(
    scene: &mut Scene,
    view: ViewId,
    path: &[u32],
    read: impl Fn(&PlanRef<'_>, &Affine3) -> R,
) -> R {
    let mut found = None;
    let under = sapwood::graph::Under(path.to_vec());
    scene
        .traverse(view, Order::Pre, &under, &mut |at| {
            if at.enters_plan() && *at.state() == path.len() && found.is_none() {
                found = Some(read(&at.plan(), at.world()));
            }
        })
        .unwrap();
    found.unwrap()
}
