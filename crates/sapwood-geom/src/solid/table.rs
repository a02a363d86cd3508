//! A solid under the knife: what is wrong with it, and steps that are taken back where they leave as
//! much. Which of them are tried is left to `mend.rs`.

use glam::Vec3;
use smallvec::SmallVec;

use super::Solid;
use crate::{Aabb, BoxTree};

/// Metres that the surface may move by where an edge is turned.
const LARGEST_TURN: f64 = 3e-4;

/// Metres that steps may move the surface by at any corner, all together, those of earlier mendings
/// included.
pub(super) const MOST_STRAYED: f32 = 1e-3;

/// How many changed triangles are looked through one by one before the tree is made again.
const MOST_CHANGED: usize = 1024;

pub(super) type Few = SmallVec<[u32; 12]>;

pub(super) fn is_dead(triangle: [u32; 3]) -> bool {
    triangle[0] == u32::MAX
}

/// A pair of triangles that cross, or twice a triangle that is degenerate.
pub(super) type Fault = [u32; 2];

/// The solid under the knife.
pub(super) struct Table<'a> {
    pub(super) solid: &'a mut Solid,
    /// The triangles of each corner.
    pub(super) around: Vec<Few>,
    /// Where each corner was in the beginning.
    homes: Vec<Vec3>,
    /// How far from its corner's home anything was at most that has become this corner, and by how
    /// much edges that were turned have moved the surface about it.
    reaches: Vec<f32>,
    /// Over the triangles as they were when it was made.
    tree: BoxTree,
    boxes: Vec<Aabb>,
    /// Triangles whose corners changed since the tree was made, in no order.
    changed: Vec<u32>,
    /// Triangles that steps were taken on, some of them several times.
    pub(super) touched: Vec<u32>,
    is_changed: Vec<bool>,
}

/// What a step changed, to take it back.
#[derive(Default)]
struct Undo {
    triangles: SmallVec<[(u32, [u32; 3]); 16]>,
    corner: Option<(u32, Vec3)>,
    reaches: SmallVec<[(u32, f32); 4]>,
    /// How many triangles had changed before.
    n_changed: usize,
}

impl<'a> Table<'a> {
    /// `strayed` tells how far the surface has strayed at each corner before.
    pub(super) fn new(solid: &'a mut Solid, strayed: Vec<f32>) -> Self {
        let mut around = vec![Few::new(); solid.positions.len()];
        for (number, triangle) in solid.triangles.iter().enumerate() {
            for corner in triangle {
                around[*corner as usize].push(number as u32);
            }
        }
        let boxes: Vec<Aabb> = solid.boxes().collect();
        let tree = BoxTree::new(boxes.iter().copied());
        let is_changed = vec![false; boxes.len()];
        let (homes, reaches) = (solid.positions.clone(), strayed);
        let (changed, touched) = (Vec::new(), Vec::new());
        Self { solid, around, homes, reaches, tree, boxes, changed, touched, is_changed }
    }

    /// How far the surface has strayed at most, at a corner.
    pub(super) fn strayed(&self, corner: u32) -> f32 {
        let i = corner as usize;
        self.solid.positions[i].distance(self.homes[i]) + self.reaches[i]
    }

    /// The faults of all triangles, or of some, in ascending order.
    pub(super) fn faults(
        &self,
        of: Option<&[u32]>,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Option<Vec<Fault>> {
        let is_all = of.is_none();
        let all: Vec<u32>;
        let of = match of {
            Some(of) => of,
            None => {
                all = (0..self.solid.triangles.len() as u32).collect();
                &all
            }
        };
        let mut faults = Vec::new();
        for (i, triangle) in of.iter().enumerate() {
            if i % 4096 == 0 && !goes_on() {
                return None;
            }
            // Of all triangles each pair is looked at once.
            let least = if is_all { *triangle } else { 0 };
            self.faults_of(*triangle, least, |other| {
                faults.push([*triangle.min(&other), *triangle.max(&other)]);
            });
        }
        faults.sort_unstable();
        faults.dedup();
        Some(faults)
    }

    /// Calls `each` with every triangle from number `least` on that this one crosses, and with itself
    /// if it is degenerate.
    fn faults_of(&self, triangle: u32, least: u32, mut each: impl FnMut(u32)) {
        if is_dead(self.solid.triangles[triangle as usize]) {
            return;
        }
        if self.solid.is_degenerate(triangle as usize) {
            each(triangle);
        }
        let aabb = self.boxes[triangle as usize];
        let mut look = |other: u32| {
            if other != triangle
                && other >= least
                && aabb.intersects(&self.boxes[other as usize])
                && !is_dead(self.solid.triangles[other as usize])
                && self.solid.do_cross(triangle as usize, other as usize)
            {
                each(other);
            }
        };
        self.tree.within(&aabb, |other| {
            if !self.is_changed[other as usize] {
                look(other);
            }
        });
        self.changed.iter().copied().for_each(look);
    }

    /// Whether a fault found earlier is there still.
    pub(super) fn still(&self, [one, other]: &Fault) -> bool {
        let [a, b] = [*one as usize, *other as usize];
        if is_dead(self.solid.triangles[a]) || is_dead(self.solid.triangles[b]) {
            return false;
        }
        if a == b { self.solid.is_degenerate(a) } else { self.solid.do_cross(a, b) }
    }

    /// The number of faults that the triangles have, pairs among them counted once.
    fn cost(&self, triangles: &[u32]) -> usize {
        let mut n = 0;
        for triangle in triangles {
            self.faults_of(*triangle, 0, |other| {
                n += usize::from(other >= *triangle || !triangles.contains(&other));
            });
        }
        n
    }

    /// Joins corner `from` to corner `to` of one edge, if that leaves fewer faults.
    pub(super) fn join(&mut self, from: u32, to: u32) -> bool {
        let (mut dying, mut staying) = (Few::new(), Few::new());
        for triangle in &self.around[from as usize] {
            let has_to = self.solid.triangles[*triangle as usize].contains(&to);
            if has_to { dying.push(*triangle) } else { staying.push(*triangle) }
        }
        if dying.len() != 2 || staying.is_empty() {
            return false;
        }
        // The two corners may have no neighbours in common but those beside their edge.
        let neighbours = |corner: u32| {
            let mut found: SmallVec<[u32; 24]> = self.around[corner as usize]
                .iter()
                .flat_map(|triangle| self.solid.triangles[*triangle as usize])
                .filter(|other| *other != corner)
                .collect();
            found.sort_unstable();
            found.dedup();
            found
        };
        let (ours, theirs) = (neighbours(from), neighbours(to));
        if ours.iter().filter(|corner| theirs.binary_search(corner).is_ok()).count() != 2 {
            return false;
        }
        let [i, j] = [from as usize, to as usize];
        let reach = self.homes[i].distance(self.homes[j]) + self.reaches[i];
        let reach = reach.max(self.reaches[j]);
        if self.solid.positions[j].distance(self.homes[j]) + reach > MOST_STRAYED {
            return false;
        }
        let mut touched = dying.clone();
        touched.extend_from_slice(&staying);
        let before = self.cost(&touched);
        let mut undo = Undo { n_changed: self.changed.len(), ..Undo::default() };
        self.reach(to, reach, &mut undo);
        for triangle in &dying {
            self.set(*triangle, [u32::MAX; 3], &mut undo);
        }
        for triangle in &staying {
            let corners = self.solid.triangles[*triangle as usize];
            let joined = corners.map(|corner| if corner == from { to } else { corner });
            self.set(*triangle, joined, &mut undo);
        }
        self.settle(&touched, before, undo)
    }

    /// Turns the edge between two triangles into the other diagonal, if that leaves fewer faults.
    pub(super) fn turn(&mut self, a: u32, b: u32) -> bool {
        let beside: Few = self.around[a as usize]
            .iter()
            .copied()
            .filter(|triangle| self.solid.triangles[*triangle as usize].contains(&b))
            .collect();
        let &[one, other] = &beside[..] else { return false };
        let apex = |triangle: u32| {
            let corners = self.solid.triangles[triangle as usize];
            corners.into_iter().find(|corner| *corner != a && *corner != b)
        };
        let (Some(over), Some(under)) = (apex(one), apex(other)) else { return false };
        let is_edge = self.around[over as usize]
            .iter()
            .any(|triangle| self.solid.triangles[*triangle as usize].contains(&under));
        if over == under || is_edge {
            return false;
        }
        // The triangle that goes from a to b, and the one that goes back.
        let goes = |triangle: u32| {
            let [p, q, r] = self.solid.triangles[triangle as usize];
            [[p, q], [q, r], [r, p]].contains(&[a, b])
        };
        let (left, right) = if goes(one) { (over, under) } else { (under, over) };
        if goes(one) == goes(other) {
            return false;
        }
        // The surface moves by no more than the height of the body between the two diagonals.
        let [p, q, r, s] =
            [a, b, over, under].map(|corner| self.solid.positions[corner as usize].as_dvec3());
        let six_volumes = (q - p).dot((r - p).cross(s - p)).abs();
        let faces = [(p, q, r), (p, q, s), (r, s, p), (r, s, q)];
        let largest = faces.map(|(a, b, c)| (b - a).cross(c - a).length());
        let largest = largest.into_iter().fold(0.0, f64::max);
        if six_volumes > LARGEST_TURN * largest {
            return false;
        }
        let height = (six_volumes / largest) as f32;
        let corners = [a, b, over, under];
        if corners.iter().any(|corner| self.strayed(*corner) + height > MOST_STRAYED) {
            return false;
        }
        let before = self.cost(&beside);
        let mut undo = Undo { n_changed: self.changed.len(), ..Undo::default() };
        for corner in corners {
            self.reach(corner, self.reaches[corner as usize] + height, &mut undo);
        }
        self.set(one, [a, right, left], &mut undo);
        self.set(other, [right, b, left], &mut undo);
        self.settle(&beside, before, undo)
    }

    /// Moves a corner, if that leaves fewer faults, or so many more than that less one.
    pub(super) fn shift(&mut self, corner: u32, by: Vec3, allowed: usize) -> bool {
        let i = corner as usize;
        let position = self.solid.positions[i];
        if (position + by).distance(self.homes[i]) + self.reaches[i] > MOST_STRAYED {
            return false;
        }
        let touched = self.around[i].clone();
        let before = self.cost(&touched) + allowed;
        let corner_before = Some((corner, position));
        let n_changed = self.changed.len();
        let undo = Undo { corner: corner_before, n_changed, ..Undo::default() };
        self.solid.positions[i] = position + by;
        self.rebox(&touched);
        self.settle(&touched, before, undo)
    }

    /// Keeps what was done to `touched` if fewer faults are left, or takes it back.
    fn settle(&mut self, touched: &[u32], before: usize, undo: Undo) -> bool {
        if self.cost(touched) < before {
            self.touched.extend_from_slice(touched);
            if self.changed.len() > MOST_CHANGED {
                self.plant();
            }
            return true;
        }
        let mut none = Undo::default();
        for (triangle, corners) in undo.triangles.into_iter().rev() {
            self.set(triangle, corners, &mut none);
        }
        if let Some((corner, position)) = undo.corner {
            self.solid.positions[corner as usize] = position;
        }
        for (corner, reach) in undo.reaches {
            self.reaches[corner as usize] = reach;
        }
        self.rebox(touched);
        // Those that changed for this step only are as they were.
        for triangle in self.changed.drain(undo.n_changed..) {
            self.is_changed[triangle as usize] = false;
        }
        false
    }

    /// Makes the tree again.
    fn plant(&mut self) {
        let dead = |number: usize| is_dead(self.solid.triangles[number]);
        let boxes = self.boxes.iter().enumerate();
        self.tree = BoxTree::new(boxes.map(|(i, aabb)| if dead(i) { Aabb::EMPTY } else { *aabb }));
        for triangle in self.changed.drain(..) {
            self.is_changed[triangle as usize] = false;
        }
    }

    /// Gives a corner another reach.
    fn reach(&mut self, corner: u32, reach: f32, undo: &mut Undo) {
        undo.reaches.push((corner, std::mem::replace(&mut self.reaches[corner as usize], reach)));
    }

    /// Gives a triangle other corners.
    fn set(&mut self, triangle: u32, corners: [u32; 3], undo: &mut Undo) {
        let old = std::mem::replace(&mut self.solid.triangles[triangle as usize], corners);
        undo.triangles.push((triangle, old));
        if !is_dead(old) {
            for corner in old {
                self.around[corner as usize].retain(|number| *number != triangle);
            }
        }
        if !is_dead(corners) {
            for corner in corners {
                self.around[corner as usize].push(triangle);
            }
            self.rebox(&[triangle]);
        }
    }

    /// Measures triangles again that changed.
    fn rebox(&mut self, triangles: &[u32]) {
        for triangle in triangles {
            let number = *triangle as usize;
            if !is_dead(self.solid.triangles[number]) {
                self.boxes[number] = Aabb::of_points(self.solid.corners(number));
            }
            if !std::mem::replace(&mut self.is_changed[number], true) {
                self.changed.push(*triangle);
            }
        }
    }
}
