//! The union of many solids as one, by groups: what was joined in each group is kept, so that only
//! groups in which something has changed are joined again, with those above them.

use std::fmt;
use std::sync::Arc;
use std::time::Duration;

use manifold_rust::cancel::CancelToken;

use super::plan::{Plan, Stage};
use super::{Mended, Solid, SolidReport};
use crate::{Content, Digest, Digester, FixedMap, fixed_state};

/// The union of solids.
#[derive(Clone, Debug)]
pub struct Union {
    /// One body, or several where parts do not touch.
    pub solid: Solid,
    /// For each triangle which part it comes from, and which triangle of the part, both counted
    /// from 0; the triangle is unknown where the part crossed itself.
    pub sources: Vec<(u32, Option<u32>)>,
    /// For each corner, how far mending has moved the surface there at most, in metres, here and in
    /// the groups that it was joined from: never by more than a millimetre.
    pub strayed: Vec<f32>,
    /// What mending did, here and in the groups that it was joined from.
    pub mended: Mended,
    /// What is known of the result.
    pub report: SolidReport,
}

/// How far joining has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnionStep {
    /// So many of all parts were looked at.
    Checked {
        /// How many.
        parts: usize,
    },
    /// So many of all parts were joined with others at least once.
    Joined {
        /// How many.
        parts: usize,
    },
}

/// Why there is no union.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum UnionError {
    /// Whoever asked wants it no more.
    Interrupted,
    /// More triangles than allowed would be needed, in the parts or in the result.
    TooManyTriangles {
        /// How many were allowed.
        limit: u64,
        /// How many there are, as far as it came.
        needed: u64,
    },
    /// A part is no solid: it is open, inside out, or its triangles do not fit together.
    NoSolid {
        /// Which of the parts.
        part: usize,
        /// What is wrong with it.
        report: SolidReport,
    },
    /// Faults were left that could not be mended by moving the surface by a millimetre at most.
    Unsound {
        /// What is wrong with the result.
        report: SolidReport,
    },
}

impl fmt::Display for UnionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Interrupted => write!(f, "joining was interrupted"),
            Self::TooManyTriangles { limit, needed } => {
                write!(f, "joining needs {needed} triangles, more than {limit}")
            }
            Self::NoSolid { part, report } => write!(f, "part {part} is no solid: {report}"),
            Self::Unsound { report } => write!(
                f,
                "what was joined cannot be mended by moving its surface by at most a millimetre: \
                 {report}"
            ),
        }
    }
}

impl std::error::Error for UnionError {}

/// What a group of solids consists of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Member {
    /// The solid with this number.
    Solid(u32),
    /// The group with this number.
    Group(u32),
}

/// What was joined anew, and what was there already.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UnionWork {
    /// Groups that were joined.
    pub n_joined: usize,
    /// Members of those groups: solids, and groups that count as one each.
    pub n_members: usize,
    /// Groups that were kept from an earlier call and are used again.
    pub n_kept: usize,
}

/// Joins solids; keeps what it made for the next call.
#[derive(Clone)]
pub struct Unions {
    kept: FixedMap<Digest, Arc<Union>>,
}

impl Default for Unions {
    fn default() -> Self {
        Self::new()
    }
}

impl fmt::Debug for Unions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} unions kept", self.kept.len())
    }
}

/// Joins `parts` in one go, as [`Unions::join`] joins a group.
///
/// # Errors
/// See [`UnionError`].
pub fn union(
    parts: &[Solid],
    max_triangles: u64,
    goes_on: &dyn Fn(UnionStep) -> bool,
) -> Result<Union, UnionError> {
    let members = (0..parts.len() as u32).map(Member::Solid).collect();
    let (union, _) = Unions::new().join(parts, &[members], max_triangles, goes_on)?;
    Ok(Arc::unwrap_or_clone(union))
}

impl Unions {
    /// Nothing kept yet.
    pub fn new() -> Self {
        Self { kept: FixedMap::with_hasher(fixed_state()) }
    }

    /// Joins `solids` to one, those of each group first. The last group holds everything; each
    /// group before it is a member of exactly one that comes after it, and the solids are numbered
    /// in the order in which groups hold them. Solids may cross themselves and each other; what is
    /// inside any of them is inside the union. Empty solids are left out.
    ///
    /// Corners keep their places but for those where surfaces crossed, which are moved by less than
    /// a millimetre altogether, nearly always by less than a hundredth of that. The result follows
    /// from solids and groups alone, not from what was kept, nor from the number of threads.
    ///
    /// `goes_on` is told the step every now and then, and ends the work where it answers no. Needs
    /// about one kilobyte for each triangle; neither the solids nor what comes of them may have
    /// more than `max_triangles`. What was kept and is no group here is forgotten; where the work
    /// ends early nothing is.
    ///
    /// # Errors
    /// See [`UnionError`].
    ///
    /// # Panics
    /// Where groups or solids do not come in the order told above.
    pub fn join(
        &mut self,
        solids: &[Solid],
        groups: &[Vec<Member>],
        max_triangles: u64,
        goes_on: &dyn Fn(UnionStep) -> bool,
    ) -> Result<(Arc<Union>, UnionWork), UnionError> {
        let needed: u64 = solids.iter().map(|part| part.triangles.len() as u64).sum();
        if needed > max_triangles {
            return Err(UnionError::TooManyTriangles { limit: max_triangles, needed });
        }
        let plan = Plan::new(solids, groups);
        let mut work = UnionWork::default();
        let mut done: Vec<Option<Arc<Union>>> = vec![None; groups.len()];
        let mut steps: Vec<Vec<usize>> = Vec::new();
        let mut wanted = vec![false; groups.len()];
        wanted[groups.len() - 1] = true;
        for number in (0..groups.len()).rev() {
            done[number] = self.kept.get(&plan.digests[number]).cloned();
            if !wanted[number] {
                continue;
            }
            if done[number].is_some() {
                work.n_kept += 1;
                continue;
            }
            work.n_joined += 1;
            work.n_members += groups[number].len();
            let height = plan.heights[number];
            steps.resize(steps.len().max(height + 1), Vec::new());
            steps[height].push(number);
            for member in &groups[number] {
                if let Member::Group(below) = member {
                    wanted[*below as usize] = true;
                }
            }
        }
        let (token, stage) = (CancelToken::new(), Stage::default());
        if !goes_on(stage.step()) {
            return Err(UnionError::Interrupted);
        }
        // The work is done by other threads, so that this one can ask whether it shall go on.
        std::thread::scope(|scope| {
            let (token, stage, done) = (&token, &stage, &mut done);
            let (plan, steps) = (&plan, &steps);
            let worker = scope.spawn(move || plan.run(steps, done, token, stage));
            let mut pause = Duration::from_micros(50);
            while !worker.is_finished() {
                // A thread that others wait for to work lends its hands.
                if rayon::yield_now() != Some(rayon::Yield::Executed) {
                    std::thread::sleep(pause);
                    pause = (pause * 2).min(Duration::from_millis(20));
                }
                if !goes_on(stage.step()) {
                    token.cancel();
                }
            }
            worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        })?;
        if token.is_cancelled() || !goes_on(stage.step()) {
            return Err(UnionError::Interrupted);
        }
        let kept = plan.digests.iter().copied().zip(&done);
        let kept: Vec<_> =
            kept.filter_map(|(digest, union)| Some((digest, union.clone()?))).collect();
        self.kept.clear();
        self.kept.extend(kept);
        let root = done.pop().flatten().expect("the last group was joined or kept");
        let needed = root.solid.triangles.len() as u64;
        if needed > max_triangles {
            return Err(UnionError::TooManyTriangles { limit: max_triangles, needed });
        }
        Ok((root, work))
    }
}

impl Content for Solid {
    fn write(&self, digester: &mut Digester) {
        digester.add(&self.positions).add(&self.triangles);
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use glam::{Affine3, Vec3};

    use super::*;
    use crate::shapes::sphere;
    use crate::{Mesh, Purpose, Stream, StreamPath};

    const MANY: u64 = 1_000_000;

    fn going(_: UnionStep) -> bool {
        true
    }

    fn ball(center: Vec3, radius: f32) -> Mesh {
        let mut mesh = Mesh::default();
        let scale = Affine3::from_scale(Vec3::splat(radius));
        mesh.append(&sphere(3), &(Affine3::from_translation(center) * scale));
        mesh
    }

    fn solid(center: Vec3, radius: f32) -> Solid {
        Solid::of_mesh(&ball(center, radius))
    }

    /// A heap of balls, with the share of random points that are inside any of them.
    fn heap(n: usize) -> (Vec<Solid>, f64) {
        let mut stream = Stream::new(StreamPath::new(7), Purpose("heap"));
        let mut point = || Vec3::from_array([(); 3].map(|()| stream.between(-1.0, 1.0)));
        let centers: Vec<Vec3> = (0..n).map(|_| 0.5 * point()).collect();
        let inside = |p: Vec3| centers.iter().any(|center| p.distance(*center) < 0.3);
        let n_inside = (0..200_000).filter(|_| inside(point())).count();
        let solids = centers.iter().map(|center| solid(*center, 0.3)).collect();
        (solids, n_inside as f64 / 200_000.0 * 8.0)
    }

    #[test]
    fn a_heap_of_balls_becomes_one_body_whatever_is_asked_meanwhile() {
        let (parts, volume) = heap(40);
        let told = Cell::new(0);
        let joined = union(&parts, MANY, &|_| {
            told.set(told.get() + 1);
            true
        })
        .unwrap();
        assert!(told.get() > 3);
        let report = joined.report;
        assert_eq!(report, joined.solid.check());
        assert!(report.is_sound(), "{report}");
        assert!((report.volume / volume - 1.0).abs() < 0.03, "{} {volume}", report.volume);
        for (triangle, (part, source)) in joined.sources.iter().enumerate() {
            let source = source.unwrap() as usize;
            let [a, b, c] = parts[*part as usize].corners(source);
            let normal = (b - a).cross(c - a).normalize();
            for corner in joined.solid.corners(triangle) {
                assert!((corner - a).dot(normal).abs() < 1e-4);
            }
        }
        let again = union(&parts, MANY, &going).unwrap();
        assert_eq!(again.solid, joined.solid);
        assert_eq!(again.sources, joined.sources);
    }

    #[test]
    fn nothing_and_what_does_not_touch_stays_as_it_is() {
        let nothing = union(&[], MANY, &going).unwrap();
        assert!(nothing.solid.triangles.is_empty());
        let apart = [solid(Vec3::ZERO, 1.0), Solid::default(), solid(3.0 * Vec3::X, 1.0)];
        let joined = union(&apart, MANY, &going).unwrap();
        assert_eq!(joined.report.components, 2);
        assert_eq!(joined.solid.triangles.len(), 2 * apart[0].triangles.len());
        assert_eq!(joined.mended, Mended::default());
    }

    #[test]
    fn a_part_that_crosses_itself_is_filled() {
        let mut twin = ball(Vec3::ZERO, 1.0);
        twin.append(&ball(Vec3::X, 1.0), &Affine3::IDENTITY);
        let parts = [Solid::of_mesh(&twin), solid(2.0 * Vec3::X, 1.0)];
        let joined = union(&parts, MANY, &going).unwrap();
        let three: Vec<_> = (0..3).map(|i| solid(i as f32 * Vec3::X, 1.0)).collect();
        let expected = union(&three, MANY, &going).unwrap().report.volume;
        assert_eq!(joined.report.components, 1);
        assert!(joined.sources.iter().all(|(part, _)| *part < 2));
        assert!((joined.report.volume / expected - 1.0).abs() < 1e-4);
    }

    #[test]
    fn what_cannot_be_joined_is_told() {
        let mut open = solid(Vec3::ZERO, 1.0);
        open.triangles.pop();
        let parts = [solid(Vec3::X, 1.0), open];
        match union(&parts, MANY, &going).unwrap_err() {
            UnionError::NoSolid { part: 1, report } => assert_eq!(report.boundary_edges, 3),
            other => panic!("{other}"),
        }
        let needed = 2 * parts[0].triangles.len() as u64;
        let refused = union(&[parts[0].clone(), parts[0].clone()], needed - 1, &going);
        assert_eq!(
            refused.unwrap_err(),
            UnionError::TooManyTriangles { limit: needed - 1, needed }
        );
        for step in [UnionStep::Checked { parts: 0 }, UnionStep::Joined { parts: 1 }] {
            let stopped = union(&parts[..1], MANY, &|at| at != step);
            assert_eq!(stopped.unwrap_err(), UnionError::Interrupted, "{step:?}");
        }
        let (heap, _) = heap(300);
        let stopped = union(&heap, MANY, &|at| !matches!(at, UnionStep::Joined { .. }));
        assert_eq!(stopped.unwrap_err(), UnionError::Interrupted);
    }

    /// Groups of four, and groups of three of those, up to one.
    fn grouped(n: u32) -> Vec<Vec<Member>> {
        let solids: Vec<u32> = (0..n).collect();
        let mut groups: Vec<Vec<Member>> = solids
            .chunks(4)
            .map(|four| four.iter().copied().map(Member::Solid).collect())
            .collect();
        let mut top: Vec<u32> = (0..groups.len() as u32).collect();
        while top.len() > 1 {
            let first = groups.len() as u32;
            groups.extend(
                top.chunks(3)
                    .map(|three| three.iter().copied().map(Member::Group).collect::<Vec<_>>()),
            );
            top = (first..groups.len() as u32).collect();
        }
        groups
    }

    #[test]
    fn what_changed_is_joined_again_with_what_holds_it_and_nothing_else() {
        let (mut parts, _) = heap(40);
        let groups = grouped(40);
        // 10 groups of solids, 4 of those, 2, and 1.
        assert_eq!(groups.len(), 17);
        let mut unions = Unions::new();
        let (first, work) = unions.join(&parts, &groups, MANY, &going).unwrap();
        assert_eq!(work, UnionWork { n_joined: 17, n_members: 40 + 10 + 4 + 2, n_kept: 0 });
        assert!(first.report.is_sound(), "{}", first.report);
        let flat = union(&parts, MANY, &going).unwrap().report;
        assert!((first.report.volume / flat.volume - 1.0).abs() < 1e-5);
        for (triangle, (part, source)) in first.sources.iter().enumerate() {
            let [a, b, c] = parts[*part as usize].corners(source.unwrap() as usize);
            let normal = (b - a).cross(c - a).normalize();
            for corner in first.solid.corners(triangle) {
                // Mending may move a corner by a millimetre in all; the rest is single precision.
                assert!((corner - a).dot(normal).abs() < 1.1e-3);
            }
        }
        assert_eq!(first.strayed.len(), first.solid.positions.len());
        assert!(first.strayed.iter().all(|strayed| (0.0..=1e-3).contains(strayed)));

        let (same, work) = unions.join(&parts, &groups, MANY, &going).unwrap();
        assert_eq!(work, UnionWork { n_joined: 0, n_members: 0, n_kept: 1 });
        assert_eq!(same.solid, first.solid);

        parts[5] = solid(0.3 * Vec3::ONE, 0.25);
        let (kept, work) = unions.join(&parts, &groups, MANY, &going).unwrap();
        assert_eq!(work, UnionWork { n_joined: 4, n_members: 4 + 3 + 3 + 2, n_kept: 2 + 2 + 1 });
        let (anew, _) = Unions::new().join(&parts, &groups, MANY, &going).unwrap();
        assert_eq!((&kept.solid, &kept.sources), (&anew.solid, &anew.sources));
        assert_eq!((kept.mended, kept.report), (anew.mended, anew.report));
    }
}
