//! Poses: where everything that sways is at a time, for what a draw list has.
//!
//! The list stands at rest and is made once. From one picture to the next only numbers move: a
//! transform for each joint of each body, which vertices and instances follow. Occurrences of one
//! body share them in a few phases, so a forest of a few individuals costs what these cost in each
//! phase, and neighbours mostly do not sway in step. A level whose sway
//! would be less than half a pixel high, from where somebody looks, rides rigidly on what carries
//! it; so far away that this holds of all levels, nothing is moved at all.

use std::sync::Arc;

use sapwood_geom::glam::{Affine3, Mat3, Vec3};
use sapwood_geom::{Aabb, Digest, FixedMap, Mesh, Shared, SharedMesh, fixed_state};

use super::{Body, DrawList, DrawRow, Follows};
use crate::{Eye, Levels, Rig, Wind};

/// The poses of what sways in a draw list; kept from one picture to the next.
///
/// They belong to the list that they were made for, in its order; a new list needs new ones.
///
/// Equal trees are apart in time by where they stand: each is in one of a few phases, as likely any,
/// and one at the root's origin is in the first, in which everything is where its rig has it at the
/// time. What is moved elsewhere is in another phase when its new list has new poses.
#[derive(Clone, Debug)]
pub struct Poses {
    n_phases: u8,
    bodies: Vec<Option<Posing>>,
    occurrences: Vec<Placed>,
}

/// What an update moved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Moved {
    /// Occurrences of which something moves.
    pub n_occurrences: usize,
    /// Joints that were turned, those that several occurrences share counted once.
    pub n_joints: usize,
    /// Levels that move somewhere.
    pub levels: Levels,
}

#[derive(Clone, Debug)]
struct Placed {
    body: u32,
    /// From the root's frame to the body's; nothing where that is flat.
    to_body: Option<Affine3>,
    /// What tells its phase, by where it stands: a number that is as likely any.
    drawn: u32,
    /// Which of the body's variants is seen here; nothing where it is at rest.
    variant: Option<u32>,
}

/// How one body sways.
#[derive(Clone, Debug)]
struct Posing {
    rig: Arc<Rig>,
    /// Everything that sways, at rest.
    rest: Aabb,
    /// For each level that sways how far it carries anything, in metres where the wind's shares
    /// add up to 1, and how many joints do so.
    levels: Vec<(u8, f32, usize)>,
    /// A pose for each set of levels and each phase that was seen so far.
    variants: Vec<Variant>,
}

#[derive(Clone, Debug)]
struct Variant {
    levels: Levels,
    phase: u8,
    /// Whether any occurrence shows it at the moment.
    is_shown: bool,
    pose: Vec<Affine3>,
}

/// How many phases there are unless somebody wants others.
const PHASES: u8 = 4;

/// How far phases are apart, in seconds: long enough for most stems to be anywhere by then.
const PHASE_SECONDS: f64 = 17.0;

impl Poses {
    /// Everything at rest, to sway in four phases. Costs all vertices that sway.
    pub fn new(list: &DrawList) -> Self {
        let occurrences = list.occurrences.iter().map(|occurrence| {
            let to_body = occurrence.world.inverse();
            let to_body = to_body.is_finite().then_some(to_body);
            let drawn = drawn_by(occurrence.world.translation);
            Placed { body: occurrence.body, to_body, drawn, variant: None }
        });
        Self {
            n_phases: PHASES,
            bodies: list.bodies.iter().map(Posing::of).collect(),
            occurrences: occurrences.collect(),
        }
    }

    /// The same in so many phases, at least one: an update costs each body as often as it is seen in
    /// different ones.
    pub fn in_phases(self, n_phases: u8) -> Self {
        Self { n_phases: n_phases.max(1), ..self }
    }

    /// Moves everything to where it is in this wind at a time in seconds, as far as that can be
    /// seen by an eye in the root's frame; without one, from nearby. Allocates nothing, unless
    /// other levels of a body move, or others in a phase, than ever before.
    pub fn update(&mut self, wind: Wind, time: f64, eye: Option<&Eye>) -> Moved {
        let mut moved = Moved::default();
        for posing in self.bodies.iter_mut().flatten() {
            posing.variants.iter_mut().for_each(|variant| variant.is_shown = false);
        }
        for placed in &mut self.occurrences {
            placed.variant = None;
            let body = self.bodies.get_mut(placed.body as usize);
            let (Some(Some(posing)), Some(to_body)) = (body, &placed.to_body) else { continue };
            let levels = posing.moving(wind, eye, to_body);
            if !levels.is_empty() {
                // The upper half of a product of 32 bits each is below the other factor.
                let phase = (u64::from(placed.drawn) * u64::from(self.n_phases)) >> 32;
                placed.variant = Some(posing.variant(levels, phase as u8));
                moved.n_occurrences += 1;
                moved.levels = moved.levels.union(levels);
            }
        }
        for Posing { rig, levels, variants, .. } in self.bodies.iter_mut().flatten() {
            for variant in variants.iter_mut().filter(|variant| variant.is_shown) {
                let time = time + PHASE_SECONDS * f64::from(variant.phase);
                rig.pose(wind, time, variant.levels, &mut variant.pose);
                let turned = levels.iter().filter(|(level, ..)| variant.levels.contains(*level));
                moved.n_joints += turned.map(|(_, _, n)| n).sum::<usize>();
            }
        }
        moved
    }

    /// Where what follows each joint of its body's rig is, as transforms from places at rest, in the
    /// body's frame; nothing for an occurrence that is at rest.
    pub fn of(&self, occurrence: usize) -> Option<&[Affine3]> {
        Some(&self.shown(occurrence)?.pose)
    }

    /// Which levels of an occurrence move.
    pub fn levels(&self, occurrence: usize) -> Levels {
        self.shown(occurrence).map_or(Levels::NONE, |variant| variant.levels)
    }

    fn shown(&self, occurrence: usize) -> Option<&Variant> {
        let placed = self.occurrences.get(occurrence)?;
        let posing = self.bodies.get(placed.body as usize)?.as_ref()?;
        posing.variants.get(placed.variant? as usize)
    }

    /// A list that draws everything where it is now, for whoever cannot move vertices: writers of
    /// files, other traversals of lists. Copies the meshes that sway.
    pub fn posed(&self, list: &DrawList) -> DrawList {
        let mut bodies = Vec::new();
        let mut numbers: FixedMap<(u32, Option<u32>), u32> = FixedMap::with_hasher(fixed_state());
        let mut occurrences = list.occurrences.clone();
        for (number, occurrence) in occurrences.iter_mut().enumerate() {
            let variant = self.occurrences.get(number).and_then(|placed| placed.variant);
            occurrence.body = *numbers.entry((occurrence.body, variant)).or_insert_with(|| {
                let body = list.body(occurrence);
                bodies.push(match self.of(number) {
                    Some(pose) => posed_body(body, pose),
                    None => body.clone(),
                });
                bodies.len() as u32 - 1
            });
        }
        DrawList { bodies, occurrences }
    }
}

impl Posing {
    fn of(body: &Body) -> Option<Self> {
        let rig = body.rig.as_ref()?;
        let mut reaches: Vec<Option<f32>> = vec![None; rig.joints.len()];
        let mut rest = Aabb::EMPTY;
        body.each_follower(rig, |joint, distance, middle, radius| {
            reaches[joint] = Some(reaches[joint].unwrap_or(0.0).max(distance));
            let around = Vec3::splat(radius);
            rest = rest.with_point(middle - around).with_point(middle + around);
        });
        let levels = excursions(rig, &reaches);
        Some(Self { rig: Arc::clone(rig), rest, levels, variants: Vec::new() })
    }

    /// The levels whose sway an eye can see.
    fn moving(&self, wind: Wind, eye: Option<&Eye>, to_body: &Affine3) -> Levels {
        let shares: f32 = wind.shares(self.rig.strongest).iter().sum();
        let excursion = |metres: f32| metres * shares;
        let half_pixel = eye.map_or(0.0, |eye| {
            let position = to_body.transform_point3(eye.position);
            let nearest = position.clamp(self.rest.min, self.rest.max);
            // What sways may come nearer.
            let all: f32 = self.levels.iter().map(|(_, metres, _)| excursion(*metres)).sum();
            let distance = (position.distance(nearest) - all).max(0.0);
            0.5 * distance * (1.0 / eye.rows_per_degree).to_radians()
        });
        let seen = self.levels.iter().filter(|(_, metres, _)| excursion(*metres) > half_pixel);
        seen.fold(Levels::NONE, |levels, (level, ..)| levels.with(*level))
    }

    /// The number of the pose in which these levels move in a phase, which is shown from now on.
    fn variant(&mut self, levels: Levels, phase: u8) -> u32 {
        let is_it = |variant: &Variant| (variant.levels, variant.phase) == (levels, phase);
        let known = self.variants.iter().position(is_it);
        let number = known.unwrap_or_else(|| {
            let pose = Vec::with_capacity(self.rig.joints.len());
            self.variants.push(Variant { levels, phase, is_shown: true, pose });
            self.variants.len() - 1
        });
        self.variants[number].is_shown = true;
        number as u32
    }
}

/// A number that is as likely any, by a place in the root's frame; 0 at its origin. Places within a
/// centimetre may have the same.
fn drawn_by(place: Vec3) -> u32 {
    let centimetres = (place * 100.0).round().as_i64vec3().to_array();
    if centimetres == [0; 3] { 0 } else { Digest::of(&centimetres).bits() as u32 }
}

/// For each level that sways how far it carries anything, where the wind's shares add up to 1, and
/// how many joints do so. `reaches` tells for each joint how far from it that is which follows it.
fn excursions(rig: &Rig, reaches: &[Option<f32>]) -> Vec<(u8, f32, usize)> {
    let mut levels: Vec<(u8, f32, usize)> = Vec::new();
    for joint in rig.joints.iter().filter(|joint| joint.amplitude != 0.0) {
        match levels.iter_mut().find(|(level, ..)| *level == joint.level) {
            Some((_, _, n)) => *n += 1,
            None => levels.push((joint.level, 0.0, 1)),
        }
    }
    levels.sort_unstable_by_key(|(level, ..)| *level);
    let mut of_each = vec![0.0f32; levels.len()];
    for (number, reach) in reaches.iter().enumerate() {
        let Some(mut reach) = *reach else { continue };
        of_each.fill(0.0);
        let mut next = Some(number as u32);
        while let Some(joint) = next.and_then(|number| rig.joints.get(number as usize)) {
            if let Ok(level) = levels.binary_search_by_key(&joint.level, |(level, ..)| *level) {
                of_each[level] += joint.largest_turn(1.0) * reach;
            }
            let above = joint.parent.and_then(|parent| rig.joints.get(parent as usize));
            reach += above.map_or(0.0, |above| above.origin.distance(joint.origin));
            next = joint.parent;
        }
        for ((_, most, _), here) in levels.iter_mut().zip(&of_each) {
            *most = most.max(*here);
        }
    }
    levels
}

fn posed_body(body: &Body, pose: &[Affine3]) -> Body {
    let rows = body.rows.iter().map(|row| match &row.follows {
        Some(follows) => posed_row(row, follows, pose),
        None => row.clone(),
    });
    Body { rows: rows.collect(), rig: None, ..body.clone() }
}

fn posed_row(row: &DrawRow, follows: &Follows, pose: &[Affine3]) -> DrawRow {
    let to_row = row.local.inverse();
    if !to_row.is_finite() {
        return DrawRow { follows: None, ..row.clone() };
    }
    // In the row's frame.
    let moves = follows.joints.iter().map(|joint| {
        let moved = pose.get(*joint as usize).copied().unwrap_or(Affine3::IDENTITY);
        to_row * moved * row.local
    });
    let moves: Vec<Affine3> = moves.collect();
    let move_of = |number: usize| moves[follows.numbers[number] as usize];
    let mut moved = DrawRow { follows: None, ..row.clone() };
    match &row.instances {
        Some(instances) => {
            let places = instances.iter().enumerate().map(|(i, place)| move_of(i) * *place);
            moved.instances = Some(Shared::new(places.collect()));
        }
        None => {
            let turns = moves.iter().map(|moved| moved.matrix3.inverse().transpose());
            let turns: Vec<Mat3> = turns.collect();
            let mut mesh = Mesh::clone(&row.mesh);
            for (i, position) in mesh.positions.iter_mut().enumerate() {
                *position = move_of(i).transform_point3(*position);
            }
            for (normal, number) in mesh.normals.iter_mut().zip(follows.numbers.iter()) {
                *normal = (turns[*number as usize] * *normal).normalize_or(*normal);
            }
            moved.mesh = SharedMesh::new(mesh);
        }
    }
    moved
}
