//! The spot where a ray met something: where it is, how it is turned, and what it is like.

use sapwood_geom::Ray32;
use sapwood_geom::glam::{Vec2, Vec3};

use crate::trace::{Hit, Thing, uv_at};
use crate::world::{Matter, World};
use crate::{Ground, PictureOptions};

/// A spot on a surface, in the root's frame.
pub(crate) struct Spot {
    pub(crate) point: Vec3,
    /// Unit normal of the surface, toward where the ray came from.
    pub(crate) normal: Vec3,
    /// Unit normal to light it by, toward the side that was met where the mesh has it so.
    pub(crate) shading_normal: Vec3,
    /// Where light from the side that was met arrives, on the smooth surface that the mesh stands
    /// for.
    pub(crate) smooth_point: Vec3,
    pub(crate) matter: Matter,
    /// How far from the point rays start, so that they do not meet where they come from.
    pub(crate) clearance: f32,
}

/// How far rays start from a surface, relative to how large the numbers around it are: some ten
/// times what rounding moves it by. Not relative to how far away it is seen from, for then light
/// would come through what is fine the farther away one stands; but for lines, as `flat` does.
const CLEARANCE: f32 = 2e-6;

impl Spot {
    /// The spot of a hit; `width` is how wide a pixel is there.
    pub(crate) fn new(
        world: &World,
        options: &PictureOptions,
        ray: &Ray32,
        hit: &Hit,
        width: f32,
    ) -> Self {
        match &hit.thing {
            Thing::Line { normal, look } => {
                let matter = match look {
                    Some(look) => world.looks[*look as usize].mean(),
                    None => matte(options.line_color),
                };
                Self::flat(ray.at(hit.distance), *normal, hit.distance, matter)
            }
            Thing::Triangle { surface, hit, to_local } => {
                let surface = &world.surfaces[*surface as usize];
                let mesh = &surface.mesh;
                let to_world = to_local.inverse();
                let first = 3 * hit.triangle as usize;
                let corners = [0, 1, 2].map(|i| mesh.indices[first + i] as usize);
                let points = corners.map(|i| to_world.transform_point3(mesh.positions[i]));
                let to_normal = to_local.matrix3.transpose();
                let normals = corners.map(|i| (to_normal * mesh.normals[i]).normalize_or_zero());
                let w = hit.weights;
                let point = points[0] * w.x + points[1] * w.y + points[2] * w.z;
                let across = (points[1] - points[0]).cross(points[2] - points[0]);
                let back = -ray.direction.normalize_or(Vec3::Y);
                let normal = across.normalize_or(back);
                let normal = if normal.dot(back) < 0.0 { -normal } else { normal };

                let uv = uv_at(mesh, hit);
                let uvs = corners.map(|i| mesh.uvs[i]);
                let image_area = (uvs[1] - uvs[0]).perp_dot(uvs[2] - uvs[0]).abs();
                // The share of the image's width that a metre of surface shows.
                let per_metre = libm::sqrtf(image_area / across.length().max(f32::MIN_POSITIVE));
                let look = &world.looks[surface.look as usize];
                let matter = look.at(uv, width * per_metre);

                // By which side was met, not by where normals point: those may be wrong.
                let side = if hit.is_front { 1.0 } else { -1.0 };
                let smooth = normals[0] * w.x + normals[1] * w.y + normals[2] * w.z;
                let smooth = (smooth * side).normalize_or(normal);
                let shading_normal = matter
                    .normal
                    .and_then(|told| bumped(told, smooth, &points, &uvs))
                    .unwrap_or(smooth);
                let smooth_point = smooth_point(point, &points, &normals, w, side);
                let numbers = points.map(Vec3::abs).into_iter().fold(Vec3::ZERO, Vec3::max);
                let numbers = numbers.max(to_world.translation.abs());
                let clearance = CLEARANCE * numbers.max_element();
                Self { point, normal, shading_normal, smooth_point, matter, clearance }
            }
        }
    }

    /// The spot where a ray meets the ground.
    pub(crate) fn of_ground(ground: &Ground, ray: &Ray32, distance: f32) -> Self {
        // As high as it is, however far away.
        let point = Vec3 { y: ground.height, ..ray.at(distance) };
        Self::flat(point, Vec3::Y, 0.0, matte(ground.color))
    }

    /// A spot with no mesh around it, met after so many lengths of its ray's direction, by which
    /// its point may be rounded.
    fn flat(point: Vec3, normal: Vec3, distance: f32, matter: Matter) -> Self {
        let clearance = CLEARANCE * (point.abs().max_element() + distance);
        Self { point, normal, shading_normal: normal, smooth_point: point, matter, clearance }
    }

    /// A ray from the spot to where `toward` points.
    pub(crate) fn ray(&self, toward: Vec3) -> Ray32 {
        let is_front = self.normal.dot(toward) >= 0.0;
        let (start, normal) =
            if is_front { (self.smooth_point, self.normal) } else { (self.point, -self.normal) };
        Ray32::new(start + normal * self.clearance, toward)
    }
}

fn matte(color: [f32; 3]) -> Matter {
    Matter {
        color: Vec3::from(color),
        metallic: 0.0,
        roughness: 1.0,
        emissive: Vec3::ZERO,
        translucency: 0.0,
        normal: None,
    }
}

/// The normal that an image tells of, in the root's frame; nothing where texture coordinates do
/// not tell how the image lies.
fn bumped(told: Vec3, normal: Vec3, points: &[Vec3; 3], uvs: &[Vec2; 3]) -> Option<Vec3> {
    let (edge_1, edge_2) = (points[1] - points[0], points[2] - points[0]);
    let (uv_1, uv_2) = (uvs[1] - uvs[0], uvs[2] - uvs[0]);
    let area = uv_1.perp_dot(uv_2);
    if area == 0.0 {
        return None;
    }
    let along_u = (edge_1 * uv_2.y - edge_2 * uv_1.y) / area;
    // glTF's images grow downwards, and so do the coordinates; the bitangent goes up.
    let along_v = (edge_1 * uv_2.x - edge_2 * uv_1.x) / area;
    let tangent = (along_u - normal * normal.dot(along_u)).try_normalize()?;
    let upward = normal.cross(tangent);
    let upward = if upward.dot(along_v) < 0.0 { -upward } else { upward };
    let bumped = tangent * told.x + upward * told.y + normal * told.z;
    bumped.try_normalize()
}

/// The point of the smooth surface that a mesh stands for, where it bulges out of the mesh, so
/// that flat triangles throw no shadows on themselves (J. Hanika: "Hacking the Shadow
/// Terminator", Ray Tracing Gems II, 2021).
fn smooth_point(
    point: Vec3,
    points: &[Vec3; 3],
    normals: &[Vec3; 3],
    weights: Vec3,
    side: f32,
) -> Vec3 {
    let mut moved = point;
    for i in 0..3 {
        let normal = normals[i] * side;
        let below = (point - points[i]).dot(normal).min(0.0);
        moved -= normal * (below * weights[i]);
    }
    moved
}
