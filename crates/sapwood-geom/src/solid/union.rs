//! The union of many solids as one. Where their surfaces cross, the crate `manifold-rust` (a port
//! of the library Manifold) cuts and joins them in double precision, so that edges stay manifold
//! whatever the input. What rounding to single precision breaks then, [`mend`] mends; the
//! result is checked exactly and handed out only where nothing is wrong with it.

use std::fmt;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use glam::Vec3;
use manifold_rust::cancel::CancelToken;
use manifold_rust::csg_tree::CsgNode;
use manifold_rust::manifold::Manifold;
use manifold_rust::types::{Error, MeshGL64, OpType, WindingRule};

use super::mend::{Mended, mend};
use super::{Solid, SolidReport};

/// Solids that are joined in one go, before these are joined with each other.
const BATCH: usize = 256;

/// The union of solids.
#[derive(Clone, Debug)]
pub struct Union {
    /// One body, or several where parts do not touch.
    pub solid: Solid,
    /// For each triangle which part it comes from, and which triangle of the part, both counted
    /// from 0; the triangle is unknown where the part crossed itself.
    pub sources: Vec<(u32, Option<u32>)>,
    /// What mending did.
    pub mended: Mended,
    /// Parts that crossed themselves, and were made to fill what they go around.
    pub n_rebuilt: usize,
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
    /// So many parts hang together already, of all that there are.
    Joined {
        /// How many; counted again when what was joined is joined with each other.
        parts: usize,
    },
    /// What was joined is being mended and checked.
    Mending,
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
    /// Faults were left that could not be mended.
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
            Self::Unsound { report } => write!(f, "what was joined is no solid: {report}"),
        }
    }
}

impl std::error::Error for UnionError {}

/// Joins `parts`, each of them a solid, to one. Parts may cross themselves; what is inside any of
/// them is inside the union. Empty parts are left out.
///
/// Corners keep their places but for those where surfaces crossed, which are moved by less than
/// half a millimetre, nearly always by less than a hundredth of that. The order of corners and
/// triangles follows from the parts alone.
///
/// `goes_on` is told the step every now and then, and ends the work where it answers no. Needs
/// about one kilobyte for each of at most `max_triangles` triangles.
///
/// # Errors
/// See [`UnionError`].
pub fn union(
    parts: &[Solid],
    max_triangles: u64,
    goes_on: &dyn Fn(UnionStep) -> bool,
) -> Result<Union, UnionError> {
    let needed: u64 = parts.iter().map(|part| part.triangles.len() as u64).sum();
    if needed > max_triangles {
        return Err(UnionError::TooManyTriangles { limit: max_triangles, needed });
    }
    let ids = Manifold::reserve_ids(parts.len() as u32);
    let mut bodies = Vec::new();
    let mut n_rebuilt = 0;
    for (number, part) in parts.iter().enumerate() {
        if number % 64 == 0 && !goes_on(UnionStep::Checked { parts: number }) {
            return Err(UnionError::Interrupted);
        }
        if part.triangles.is_empty() {
            continue;
        }
        let report = part.check();
        if report.is_sound() {
            bodies.push(body(part, ids + number as u32));
            continue;
        }
        if !(SolidReport { crossings: 0, degenerate_triangles: 0, ..report }.is_sound()) {
            return Err(UnionError::NoSolid { part: number, report });
        }
        n_rebuilt += 1;
        let rebuilt = body(part, ids + number as u32).rebuild_solid(WindingRule::Positive);
        if rebuilt.status() != Error::NoError || rebuilt.is_empty() {
            return Err(UnionError::NoSolid { part: number, report });
        }
        bodies.push(rebuilt);
    }
    let joined = joined(bodies, max_triangles, goes_on)?;
    let (mut solid, mut sources) = rounded(&joined, ids);
    drop(joined);
    let mut still = || goes_on(UnionStep::Mending);
    let mended = mend(&mut solid, &mut sources, &mut still).ok_or(UnionError::Interrupted)?;
    let (solid, sources) = ordered(&solid, &sources);
    if !goes_on(UnionStep::Mending) {
        return Err(UnionError::Interrupted);
    }
    let report = solid.check();
    let is_nothing = solid.triangles.is_empty();
    if !report.is_sound() && !is_nothing {
        return Err(UnionError::Unsound { report });
    }
    Ok(Union { solid, sources, mended, n_rebuilt, report })
}

/// A part as the library takes it; its triangles are told by their numbers afterwards.
fn body(part: &Solid, id: u32) -> Manifold {
    let mesh = MeshGL64 {
        num_prop: 3,
        vert_properties: part
            .positions
            .iter()
            .flat_map(|position| position.to_array().map(f64::from))
            .collect(),
        tri_verts: part.triangles.iter().flatten().map(|corner| u64::from(*corner)).collect(),
        run_original_id: vec![id],
        face_id: (0..part.triangles.len() as u64).collect(),
        ..MeshGL64::default()
    };
    Manifold::from_mesh_gl64(&mesh)
}

/// Joins bodies in batches of neighbours, and those in batches again, until one is left.
///
/// The work is done by another thread, so that this one can ask whether it shall go on.
fn joined(
    mut bodies: Vec<Manifold>,
    max_triangles: u64,
    goes_on: &dyn Fn(UnionStep) -> bool,
) -> Result<Manifold, UnionError> {
    let token = CancelToken::new();
    while bodies.len() > 1 {
        let n_before = bodies.len();
        let batches: Vec<Vec<Manifold>> = {
            let mut rest = bodies.into_iter();
            std::iter::from_fn(|| {
                let batch: Vec<Manifold> = rest.by_ref().take(BATCH).collect();
                (!batch.is_empty()).then_some(batch)
            })
            .collect()
        };
        let (tell, told) = channel();
        bodies = std::thread::scope(|scope| {
            let token = &token;
            let worker = scope.spawn(move || {
                let mut done = 0;
                let mut joined = Vec::with_capacity(batches.len());
                for batch in batches {
                    done += batch.len();
                    let leaves =
                        batch.into_iter().map(|body| CsgNode::leaf(body.into_impl())).collect();
                    let node = CsgNode::op_n(OpType::Add, leaves);
                    joined.push(Manifold::from_impl(node.evaluate_with_token(Some(token))));
                    if tell.send(done).is_err() || token.is_cancelled() {
                        break;
                    }
                }
                joined
            });
            let mut parts = 0;
            loop {
                match told.recv_timeout(Duration::from_millis(20)) {
                    Ok(done) => parts = done,
                    Err(RecvTimeoutError::Timeout) => {}
                    Err(RecvTimeoutError::Disconnected) => break,
                }
                if !goes_on(UnionStep::Joined { parts: parts.min(n_before) }) {
                    token.cancel();
                }
            }
            match worker.join() {
                Ok(joined) => joined,
                Err(panic) => std::panic::resume_unwind(panic),
            }
        });
        if token.is_cancelled() {
            return Err(UnionError::Interrupted);
        }
        let needed = bodies.iter().map(|body| body.num_tri() as u64).sum();
        if needed > max_triangles {
            return Err(UnionError::TooManyTriangles { limit: max_triangles, needed });
        }
    }
    Ok(bodies.pop().unwrap_or_default())
}

type Source = (u32, Option<u32>);

/// A body in single precision, with the part and the part's triangle that each triangle is of.
fn rounded(body: &Manifold, ids: u32) -> (Solid, Vec<Source>) {
    let mesh = body.get_mesh_gl64(-1);
    let stride = mesh.num_prop as usize;
    let position = |row: &[f64]| Vec3::new(row[0] as f32, row[1] as f32, row[2] as f32) + 0.0;
    let mut sources = vec![(0, None); mesh.tri_verts.len() / 3];
    for (run, id) in mesh.run_original_id.iter().enumerate() {
        let [from, to] = [run, run + 1].map(|run| mesh.run_index[run] as usize / 3);
        for (triangle, source) in sources.iter_mut().enumerate().take(to).skip(from) {
            *source = (id.wrapping_sub(ids), mesh.face_id.get(triangle).map(|face| *face as u32));
        }
    }
    let solid = Solid {
        positions: mesh.vert_properties.chunks_exact(stride.max(3)).map(position).collect(),
        triangles: mesh
            .tri_verts
            .chunks_exact(3)
            .map(|t| [t[0] as u32, t[1] as u32, t[2] as u32])
            .collect(),
    };
    (solid, sources)
}

/// The same with corners in the order of their places and triangles in the order of where they
/// come from, so that nothing is left of the order in which they were made.
fn ordered(solid: &Solid, sources: &[Source]) -> (Solid, Vec<Source>) {
    let mut places: Vec<u32> = (0..solid.positions.len() as u32).collect();
    let key = |corner: &u32| solid.positions[*corner as usize].to_array();
    places.sort_by(|a, b| {
        let (a, b) = (key(a), key(b));
        a[2].total_cmp(&b[2]).then(a[1].total_cmp(&b[1])).then(a[0].total_cmp(&b[0]))
    });
    let mut numbers = vec![0; places.len()];
    for (new, old) in places.iter().enumerate() {
        numbers[*old as usize] = new as u32;
    }
    let first_least = |[a, b, c]: [u32; 3]| {
        if a < b && a < c {
            [a, b, c]
        } else if b < c {
            [b, c, a]
        } else {
            [c, a, b]
        }
    };
    let triangles = solid.triangles.iter();
    let mut rows: Vec<(Source, [u32; 3])> = sources
        .iter()
        .zip(triangles)
        .map(|(source, t)| (*source, first_least(t.map(|corner| numbers[corner as usize]))))
        .collect();
    rows.sort_unstable();
    let ordered = Solid {
        positions: places.iter().map(|old| solid.positions[*old as usize]).collect(),
        triangles: rows.iter().map(|row| row.1).collect(),
    };
    (ordered, rows.into_iter().map(|row| row.0).collect())
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use glam::Affine3;

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
        assert_eq!((joined.n_rebuilt, joined.report.components), (1, 1));
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
        for step in [UnionStep::Checked { parts: 0 }, UnionStep::Mending] {
            let stopped = union(&parts[..1], MANY, &|at| at != step);
            assert_eq!(stopped.unwrap_err(), UnionError::Interrupted, "{step:?}");
        }
        let (heap, _) = heap(300);
        let stopped = union(&heap, MANY, &|at| !matches!(at, UnionStep::Joined { .. }));
        assert_eq!(stopped.unwrap_err(), UnionError::Interrupted);
    }
}
