//! Mending a closed surface whose corners were rounded: triangles that cross or degenerate since
//! are few, small and local, and go by joining two corners, by turning an edge, or by moving a
//! corner a few micrometres. Each step is taken only where fewer faults are left than before,
//! counted exactly; edges stay manifold throughout.

use std::ops::AddAssign;

use glam::Vec3;
use smallvec::SmallVec;

use super::Solid;
use super::table::{Fault, Few, Table, is_dead};
use crate::{Purpose, Stream, StreamPath};

/// Metres that a corner may be moved by, from the smallest step to the largest.
const STEPS: [f32; 6] = [2e-6, 8e-6, 3e-5, 1e-4, 2e-4, 4e-4];

/// Metres up to which an edge counts as short: its ends may be joined.
const SHORT: f32 = 1e-3;

/// From this round on what is left is stubborn: edges beside the triangles that are at fault are
/// tried too, and steps that leave as many faults as there were are taken.
const STUBBORN: usize = 6;

/// Times that the whole is looked through.
const MOST_ROUNDS: usize = 400;

/// What mending did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mended {
    /// Pairs of crossing triangles and degenerate triangles that were there.
    pub faults: usize,
    /// Edges whose ends were joined.
    pub joined: usize,
    /// Edges that were turned.
    pub turned: usize,
    /// Corners that were moved.
    pub moved: usize,
    /// Faults that could not be mended.
    pub left: usize,
}

impl AddAssign for Mended {
    fn add_assign(&mut self, other: Self) {
        let Self { faults, joined, turned, moved, left } = other;
        self.faults += faults;
        self.joined += joined;
        self.turned += turned;
        self.moved += moved;
        self.left += left;
    }
}

/// Mends `solid`, whose edges must be manifold; `sources` has a row for each triangle and keeps it,
/// `strayed` tells of each corner how far earlier mendings may have moved the surface there, in
/// metres, and then, how far all of them have: never by more than `MOST_STRAYED`. Only faults of
/// `suspects` are looked for, where these are given. `goes_on` is asked now and then, and ends the work
/// where it denies.
pub(super) fn mend<S: Copy>(
    solid: &mut Solid,
    sources: &mut Vec<S>,
    strayed: &mut Vec<f32>,
    suspects: Option<&[u32]>,
    goes_on: &mut dyn FnMut() -> bool,
) -> Option<Mended> {
    let mut table = Table::new(solid, std::mem::take(strayed));
    let mut faults = table.faults(suspects, goes_on)?;
    let mut mended = Mended { faults: faults.len(), ..Mended::default() };
    for round in 0..MOST_ROUNDS {
        if faults.is_empty() {
            break;
        }
        for fault in &faults {
            if !goes_on() {
                return None;
            }
            if table.still(fault) {
                table.mend(fault, round, &mut mended);
            }
        }
        // What was sound and is as it was needs no second look, except beside what changed.
        let mut suspects = std::mem::take(&mut table.touched);
        suspects.extend(faults.iter().flatten());
        suspects.sort_unstable();
        suspects.dedup();
        faults = table.faults(Some(&suspects), goes_on)?;
    }
    mended.left = faults.len();
    *strayed = (0..table.solid.positions.len() as u32).map(|i| table.strayed(i)).collect();
    if mended.joined + mended.turned + mended.moved > 0 {
        keep_living(solid, sources, strayed);
    }
    Some(mended)
}

/// Drops the triangles that died, and corners that nobody has.
fn keep_living<S: Copy>(solid: &mut Solid, sources: &mut Vec<S>, strayed: &mut Vec<f32>) {
    let mut corners = vec![u32::MAX; solid.positions.len()];
    let mut kept = Solid::default();
    let mut kept_sources = Vec::with_capacity(sources.len());
    let mut kept_strayed = Vec::with_capacity(strayed.len());
    for (old, triangle) in solid.triangles.iter().enumerate() {
        if is_dead(*triangle) {
            continue;
        }
        kept_sources.push(sources[old]);
        kept.triangles.push(triangle.map(|corner| {
            let number = &mut corners[corner as usize];
            if *number == u32::MAX {
                *number = kept.positions.len() as u32;
                kept.positions.push(solid.positions[corner as usize]);
                kept_strayed.push(strayed[corner as usize]);
            }
            *number
        }));
    }
    *solid = kept;
    *sources = kept_sources;
    *strayed = kept_strayed;
}

/// What is tried.
impl Table<'_> {
    /// Takes the first step that leaves fewer faults.
    fn mend(&mut self, fault: &Fault, round: usize, mended: &mut Mended) {
        let is_stubborn = round >= STUBBORN;
        let triangles = fault.map(|triangle| self.solid.triangles[triangle as usize]);
        let mut near: Few = Few::from_slice(fault);
        if is_stubborn {
            near.extend(
                triangles
                    .iter()
                    .flatten()
                    .flat_map(|corner| &self.around[*corner as usize])
                    .copied(),
            );
            near.sort_unstable();
            near.dedup();
        }
        let mut edges: SmallVec<[[u32; 2]; 6]> = SmallVec::new();
        for triangle in &near {
            let [a, b, c] = self.solid.triangles[*triangle as usize];
            for [from, to] in [[a, b], [b, c], [c, a]] {
                let edge = [from.min(to), from.max(to)];
                if !edges.contains(&edge) {
                    edges.push(edge);
                }
            }
        }
        let length = |[a, b]: &[u32; 2]| {
            self.solid.positions[*a as usize].distance(self.solid.positions[*b as usize])
        };
        let mut lengths: SmallVec<[(f32, [u32; 2]); 6]> =
            edges.iter().map(|edge| (length(edge), *edge)).collect();
        lengths.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (length, [a, b]) in &lengths {
            if *length <= SHORT && (self.join(*a, *b) || self.join(*b, *a)) {
                mended.joined += 1;
                return;
            }
        }
        for (_, [a, b]) in lengths.iter().rev() {
            if self.turn(*a, *b) {
                mended.turned += 1;
                return;
            }
        }
        let path = StreamPath::new(u64::from(fault[0])).child(u64::from(fault[1]));
        let mut stream = Stream::new(path.child(round as u64), Purpose("mend"));
        let mut corners: SmallVec<[u32; 6]> = triangles.iter().flatten().copied().collect();
        corners.sort_unstable();
        corners.dedup();
        let largest = STEPS.len().min(2 + round / 2);
        let n_tries = if is_stubborn { 12 } else { 4 };
        for step in &STEPS[..largest] {
            for corner in &corners {
                for _ in 0..n_tries {
                    let way = Vec3::from_array([(); 3].map(|()| stream.between(-1.0, 1.0)));
                    if self.shift(*corner, way * *step, 0) {
                        mended.moved += 1;
                        return;
                    }
                }
            }
        }
        // A way out of where no single step helps.
        if is_stubborn && !corners.is_empty() {
            let corner = corners[(stream.unit() * corners.len() as f32) as usize % corners.len()];
            let way = Vec3::from_array([(); 3].map(|()| stream.between(-1.0, 1.0)));
            let step = STEPS[round % STEPS.len()];
            mended.moved += usize::from(self.shift(corner, way * step, 1));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::table::MOST_STRAYED;
    use super::*;
    use crate::shapes::sphere;

    #[test]
    fn what_was_pushed_a_little_is_mended() {
        let mut solid = Solid::of_mesh(&sphere(4));
        let before = solid.volume();
        let mut stream = Stream::new(StreamPath::new(3), Purpose("pushes"));
        // Short edges whose corners change places: the triangles around them fold.
        for _ in 0..30 {
            let triangle = (stream.unit() * solid.triangles.len() as f32) as usize;
            let [a, b, c] = solid.triangles[triangle].map(|corner| corner as usize);
            let (p, q) = (solid.positions[a], solid.positions[b]);
            solid.positions[a] = q.lerp(p, 4e-3);
            solid.positions[b] = q.lerp(solid.positions[c], 2e-3);
        }
        assert!(solid.check().crossings > 0, "{}", solid.check());
        let mut sources: Vec<usize> = (0..solid.triangles.len()).collect();
        let mut strayed = vec![0.0; solid.positions.len()];
        let pushed = solid.clone();
        let mended = mend(&mut solid, &mut sources, &mut strayed, None, &mut || true).unwrap();
        assert!(mended.faults > 0 && mended.left == 0, "{mended:?}");
        let report = solid.check();
        assert!(report.is_sound() && report.components == 1, "{report}");
        assert!((report.volume / before - 1.0).abs() < 0.01);
        assert_eq!(sources.len(), solid.triangles.len());
        // No corner is farther from one that was there than it is told to have strayed.
        assert_eq!(strayed.len(), solid.positions.len());
        for (position, strayed) in solid.positions.iter().zip(&strayed) {
            let away = pushed.positions.iter().map(|before| before.distance(*position));
            let away = away.fold(f32::INFINITY, f32::min);
            assert!(away <= strayed + 1e-6 && *strayed <= MOST_STRAYED, "{away} {strayed}");
        }
        assert!(strayed.iter().any(|strayed| *strayed > 0.0));
        assert!(mend(&mut solid, &mut sources, &mut strayed, None, &mut || false).is_none());
    }

    #[test]
    fn what_has_strayed_as_far_as_it_may_moves_no_more() {
        let mut solid = Solid::of_mesh(&sphere(4));
        // Two corners of a short edge change places.
        let [a, b, _] = solid.triangles[0].map(|corner| corner as usize);
        let (p, q) = (solid.positions[a], solid.positions[b]);
        solid.positions[a] = q.lerp(p, 4e-3);
        solid.positions[b] = p.lerp(q, 4e-3);
        let before = solid.clone();
        assert!(before.check().crossings > 0);
        let mut sources = vec![(); solid.triangles.len()];
        let mut strayed = vec![MOST_STRAYED; solid.positions.len()];
        let mended = mend(&mut solid, &mut sources, &mut strayed, None, &mut || true).unwrap();
        assert_eq!((mended.left, mended.moved), (mended.faults, 0));
        assert!(mended.left > 0 && solid == before);
    }

    #[test]
    fn a_sound_solid_stays_as_it_is() {
        let solid = Solid::of_mesh(&sphere(3));
        let mut mended = solid.clone();
        let mut sources = vec![(); solid.triangles.len()];
        let mut strayed = vec![0.0; solid.positions.len()];
        let outcome = mend(&mut mended, &mut sources, &mut strayed, None, &mut || true);
        assert_eq!(outcome, Some(Mended::default()));
        assert!(strayed.iter().all(|strayed| *strayed == 0.0));
        assert_eq!(mended, solid);
    }
}
