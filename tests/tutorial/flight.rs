//! A staircase divided into steps, and their triangles. `docs/writing-rules.md` links to this file
//! and does not print it, for it is about geometry and not about rules.

use sapwood::geom::glam::{Affine3, Quat, Vec2, Vec3};
use sapwood::geom::{Cap, Mesh, Ring, Section, SharedMesh, Sweep, SweepOptions};
use sapwood::scene::{Context, RuleError};

use super::rules::Flight;
use super::staircase::Staircase;

/// The radius of the pole in the middle, in metres.
pub const POLE: f32 = 0.07;

impl Flight {
    /// Divides a staircase into equal steps, none higher than `greatest_rise`; nothing where that
    /// cannot be built. A tread covers one radian at most.
    pub fn of(staircase: &Staircase, greatest_rise: f32) -> Option<Self> {
        let Staircase { height, radius, turn } = *staircase;
        let n_steps = (height / greatest_rise).ceil();
        // Each comparison is false for a NaN.
        let is_sound = n_steps >= 1.0
            && n_steps.is_finite()
            && radius > 2.0 * POLE
            && radius.is_finite()
            && turn.abs() > 0.0
            && turn.abs() <= n_steps;
        let flight = Self { n_steps: n_steps as u32, rise: height / n_steps, radius, turn };
        is_sound.then_some(flight)
    }

    /// Where step number `i` is, counted from 0: turned to its front edge, lifted to its top.
    pub fn place(&self, i: f32) -> Affine3 {
        let turn = Quat::from_rotation_y(self.turn_of_step() * i);
        Affine3::from_rotation_translation(turn, Vec3::Y * (self.rise * (i + 1.0)))
    }

    /// The angle from one step to the next.
    pub fn turn_of_step(&self) -> f32 {
        self.turn / self.n_steps as f32
    }
}

/// The outline of a tread from above: x and -z, counter-clockwise.
///
/// It begins a little before its front edge, so that treads overlap, and inside the pole. Its
/// outer edge has `n_pieces`.
pub fn outline(flight: &Flight, n_pieces: u32) -> Vec<Vec2> {
    let step = flight.turn_of_step();
    let front = -0.08 * step;
    let (begin, end) = (front.min(step), front.max(step));
    let at = |angle, radius| Vec2::from_angle(angle) * radius;
    let arc = (0..=n_pieces).map(|i| begin + (end - begin) * (i as f32 / n_pieces as f32));
    let arc = arc.map(|angle| at(angle, flight.radius));
    arc.chain([at(end, 0.5 * POLE), at(begin, 0.5 * POLE)]).collect()
}

/// A solid of even thickness below a convex outline, with flat faces. Texture coordinates are
/// metres on each face.
pub fn slab(outline: &[Vec2], thickness: f32) -> Mesh {
    let mut mesh = Mesh::default();
    let mut face = |corners: &[Vec3]| {
        let along = (corners[1] - corners[0]).normalize();
        let normal = along.cross(corners[2] - corners[0]).normalize();
        let up = normal.cross(along);
        let first = mesh.positions.len() as u32;
        for corner in corners {
            mesh.positions.push(*corner);
            mesh.normals.push(normal);
            mesh.uvs.push(Vec2::new(corner.dot(along), -corner.dot(up)));
        }
        for i in 2..corners.len() as u32 {
            mesh.indices.extend([first, first + i - 1, first + i]);
        }
    };
    let down = Vec3::NEG_Y * thickness;
    let top: Vec<Vec3> = outline.iter().map(|p| Vec3::new(p.x, 0.0, -p.y)).collect();
    let bottom: Vec<Vec3> = top.iter().rev().map(|corner| corner + down).collect();
    face(&top);
    face(&bottom);
    for (i, a) in top.iter().enumerate() {
        let b = top[(i + 1) % top.len()];
        face(&[a + down, b + down, b, *a]);
    }
    mesh
}

/// A round bar through `points`, of which the budget must allow `n`.
pub fn bar(
    points: &[Vec3],
    radius: f32,
    sides: u32,
    n: u32,
    cx: &mut Context<'_>,
) -> Result<SharedMesh, RuleError> {
    let rings: Vec<Ring> = points.iter().map(|center| Ring { center: *center, radius }).collect();
    let options = SweepOptions { base: Cap::Flat, ..SweepOptions::default() };
    let (section, mut sweep, mut mesh) = (Section::round(sides), Sweep::default(), Mesh::default());
    // Laying tells how many triangles there will be; writing makes them.
    let n_triangles = sweep.lay(&section, &rings, &options);
    cx.reserve_triangles(n_triangles as u64 * u64::from(n))?;
    sweep.write(&section, &mut mesh);
    Ok(SharedMesh::new(mesh))
}
