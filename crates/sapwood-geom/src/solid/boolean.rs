//! One boolean operation: solids and unions in, a union out.
//!
//! Where surfaces cross, the crate `manifold-rust` (a port of the library Manifold) cuts and joins
//! them in double precision, so that edges stay manifold whatever the input. What rounding to single
//! precision breaks then, [`mend`] mends; the result is checked exactly and handed out only where
//! nothing is wrong with it.

use glam::Vec3;
use manifold_rust::cancel::CancelToken;
use manifold_rust::csg_tree::CsgNode;
use manifold_rust::manifold::Manifold;
use manifold_rust::types::{Error, MeshGL64, OpType, WindingRule};
use rayon::prelude::*;

use super::mend::mend;
use super::plan::Stage;
use super::{Mended, Solid, SolidReport, Union, UnionError};

/// Small bodies that are joined in one go: first those that lie apart, without cutting anything.
const BATCH: usize = 256;

/// Where a body has more triangles than these, bodies are joined by twos: each step writes all of
/// its triangles again, and of many the library begins with the largest.
const LARGE: usize = 2048;

/// What is joined.
#[derive(Clone, Copy)]
pub(super) enum Part<'a> {
    /// A solid, and its number among all.
    Solid(u32, &'a Solid),
    /// What was joined before; the number of its first solid among all.
    Union(u32, &'a Union),
}

impl Part<'_> {
    fn solid(&self) -> &Solid {
        match self {
            Part::Solid(_, solid) => solid,
            Part::Union(_, union) => &union.solid,
        }
    }
}

/// Where a triangle comes from: which solid, and which triangle of it.
pub(super) type Source = (u32, Option<u32>);

/// Joins parts to one. Sources are told by the numbers of solids among all, less that of the first
/// one here, which is `first`. What is joined further is looked through again then, so that only what
/// `is_whole` is searched for crossings once more after mending.
pub(super) fn join(
    parts: &[Part<'_>],
    first: u32,
    is_whole: bool,
    token: &CancelToken,
    stage: &Stage,
) -> Result<Union, UnionError> {
    let ids = Manifold::reserve_ids(parts.len() as u32);
    let bodies: Vec<Result<Body, UnionError>> = parts
        .par_iter()
        .enumerate()
        .filter(|(_, part)| !part.solid().is_empty())
        .map(|(index, part)| {
            if token.is_cancelled() {
                return Err(UnionError::Interrupted);
            }
            let id = ids + index as u32;
            match part {
                Part::Union(_, union) => Ok(Body { shape: body(&union.solid, id), n_solids: 0 }),
                Part::Solid(number, solid) => {
                    let shape = solid_body(solid, id, *number as usize)?;
                    stage.checked();
                    Ok(Body { shape, n_solids: 1 })
                }
            }
        })
        .collect();
    let joined = joined(bodies.into_iter().collect::<Result<_, _>>()?, token, stage);
    if token.is_cancelled() {
        return Err(UnionError::Interrupted);
    }
    let (mut solid, mut sources) = rounded(&joined, ids);
    drop(joined);
    let mut strayed = strayed(&solid, &sources, parts);
    let mut goes_on = || !token.is_cancelled();
    let mut mended = Mended::default();
    let mut suspects = Some(changed(&solid, &sources, parts));
    let report = loop {
        let once = mend(&mut solid, &mut sources, &mut strayed, suspects.as_deref(), &mut goes_on);
        mended += once.ok_or(UnionError::Interrupted)?;
        fill_bubbles(&mut solid, &mut sources, &mut strayed);
        if token.is_cancelled() {
            return Err(UnionError::Interrupted);
        }
        let report = if is_whole {
            solid.check()
        } else {
            SolidReport { crossings: mended.left, ..solid.check_edges() }
        };
        // What was there before may touch, which cutting takes for lying apart.
        if report.is_sound() || suspects.take().is_none() {
            break report;
        }
        mended.left = 0;
    };
    for part in parts {
        if let Part::Union(_, union) = part {
            mended += union.mended;
        }
    }
    for source in &mut sources {
        *source = match &parts[source.0 as usize] {
            Part::Solid(number, _) => (number - first, source.1),
            Part::Union(number, union) => {
                let (below, triangle) = source
                    .1
                    .and_then(|triangle| union.sources.get(triangle as usize).copied())
                    .unwrap_or((0, None));
                (number - first + below, triangle)
            }
        };
    }
    let (solid, sources, strayed) = ordered(&solid, &sources, &strayed);
    // Summed up in this order.
    let report = SolidReport { volume: solid.volume(), ..report };
    if !report.is_sound() && !solid.triangles.is_empty() {
        return Err(UnionError::Unsound { report });
    }
    Ok(Union { solid, sources, strayed, mended, report })
}

/// The triangles that are not, corner for corner, those of a part: of these nobody knows whether
/// they are sound.
fn changed(solid: &Solid, sources: &[Source], parts: &[Part<'_>]) -> Vec<u32> {
    let is_changed = |number: &u32| {
        let number = *number as usize;
        let (part, Some(triangle)) = sources[number] else { return true };
        let of = parts[part as usize].solid();
        if triangle as usize >= of.triangles.len() {
            return true;
        }
        let (mut corners, now) = (of.corners(triangle as usize), solid.corners(number));
        !(0..3).any(|_| {
            corners.rotate_left(1);
            corners == now
        })
    };
    (0..solid.triangles.len() as u32).filter(is_changed).collect()
}

/// How far the surface has strayed at each corner, in the unions that it was joined from.
fn strayed(solid: &Solid, sources: &[Source], parts: &[Part<'_>]) -> Vec<f32> {
    let mut strayed = vec![0.0f32; solid.positions.len()];
    for (corners, (part, triangle)) in solid.triangles.iter().zip(sources) {
        let Part::Union(_, union) = parts[*part as usize] else { continue };
        let of = triangle.and_then(|triangle| union.solid.triangles.get(triangle as usize));
        let Some(of) = of.map(|of| of.map(|corner| corner as usize)) else { continue };
        let most = of.iter().map(|corner| union.strayed[*corner]).fold(0.0, f32::max);
        if most == 0.0 {
            continue;
        }
        for corner in corners.map(|corner| corner as usize) {
            let is_it = |old: &&usize| union.solid.positions[**old] == solid.positions[corner];
            // What was cut anew lies between the corners.
            let own = of.iter().find(is_it).map_or(most, |old| union.strayed[*old]);
            strayed[corner] = strayed[corner].max(own);
        }
    }
    strayed
}

/// A solid as the library takes it, rebuilt where it crosses itself.
fn solid_body(solid: &Solid, id: u32, number: usize) -> Result<Manifold, UnionError> {
    let report = solid.check();
    if report.is_sound() {
        return Ok(body(solid, id));
    }
    if !(SolidReport { crossings: 0, degenerate_triangles: 0, ..report }.is_sound()) {
        return Err(UnionError::NoSolid { part: number, report });
    }
    let rebuilt = body(solid, id).rebuild_solid(WindingRule::Positive);
    if rebuilt.status() != Error::NoError || rebuilt.is_empty() {
        return Err(UnionError::NoSolid { part: number, report });
    }
    Ok(rebuilt)
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

/// Something to be joined, in double precision.
#[derive(Clone)]
struct Body {
    shape: Manifold,
    /// Solids that nobody has told of yet.
    n_solids: usize,
}

/// Joins bodies in batches of neighbours, and those in batches again, until one is left; what is
/// left is of no use where the token was cancelled meanwhile.
fn joined(mut bodies: Vec<Body>, token: &CancelToken, stage: &Stage) -> Manifold {
    loop {
        let is_small = bodies.iter().all(|body| body.shape.num_tri() <= LARGE);
        let n = if is_small { BATCH } else { 2 };
        if bodies.len() < 2 || token.is_cancelled() {
            let last = bodies.pop();
            stage.joined(last.as_ref().map_or(0, |body| body.n_solids));
            return last.map(|body| body.shape).unwrap_or_default();
        }
        bodies = bodies.par_chunks(n).map(|batch| joined_batch(batch, token, stage)).collect();
    }
}

fn joined_batch(batch: &[Body], token: &CancelToken, stage: &Stage) -> Body {
    let shape = match batch {
        [one] => return one.clone(),
        [one, other] => one.shape.boolean_with_token(&other.shape, OpType::Add, Some(token)),
        _ => {
            let leaves = batch.iter().map(|body| CsgNode::leaf(body.shape.as_impl().clone()));
            let node = CsgNode::op_n(OpType::Add, leaves.collect());
            Manifold::from_impl(node.evaluate_with_token(Some(token)))
        }
    };
    stage.joined(batch.iter().map(|body| body.n_solids).sum());
    Body { shape, n_solids: 0 }
}

/// Cavities smaller than this, in cubic metres, are filled: where stems lie side by side they
/// enclose some, of which nobody can tell whether they are there.
const BUBBLE: f64 = 1e-9;

/// Takes away components that bound small cavities.
fn fill_bubbles(solid: &mut Solid, sources: &mut Vec<Source>, strayed: &mut Vec<f32>) {
    let components = solid.components();
    let mut volumes = vec![0.0; solid.positions.len()];
    for (number, component) in components.iter().enumerate() {
        let from = solid.positions[*component as usize].as_dvec3();
        let [a, b, c] = solid.corners(number).map(|corner| corner.as_dvec3() - from);
        volumes[*component as usize] += a.dot(b.cross(c)) / 6.0;
    }
    let is_bubble = |component: &u32| (-BUBBLE..=0.0).contains(&volumes[*component as usize]);
    if !components.iter().any(is_bubble) {
        return;
    }
    let mut kept = components.iter().map(|component| !is_bubble(component));
    solid.triangles.retain(|_| kept.next().unwrap_or(true));
    let mut kept = components.iter().map(|component| !is_bubble(component));
    sources.retain(|_| kept.next().unwrap_or(true));
    // Nothing is left of their corners.
    let mut numbers = vec![u32::MAX; solid.positions.len()];
    let mut positions = Vec::with_capacity(solid.positions.len());
    let mut kept_strayed = Vec::with_capacity(strayed.len());
    for corner in solid.triangles.iter_mut().flatten() {
        let number = &mut numbers[*corner as usize];
        if *number == u32::MAX {
            *number = positions.len() as u32;
            positions.push(solid.positions[*corner as usize]);
            kept_strayed.push(strayed[*corner as usize]);
        }
        *corner = *number;
    }
    solid.positions = positions;
    *strayed = kept_strayed;
}

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
fn ordered(solid: &Solid, sources: &[Source], strayed: &[f32]) -> (Solid, Vec<Source>, Vec<f32>) {
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
    let strayed = places.iter().map(|old| strayed[*old as usize]).collect();
    (ordered, rows.into_iter().map(|row| row.0).collect(), strayed)
}

#[cfg(test)]
mod tests {
    use glam::Affine3;

    use super::*;
    use crate::Mesh;
    use crate::shapes::sphere;

    /// A ball of a metre with a hollow of some radius in it.
    fn hollow(radius: f32) -> Solid {
        let mut mesh = sphere(2);
        let mut inner = Mesh::default();
        inner.append(&sphere(2), &Affine3::from_scale(Vec3::splat(radius)));
        inner.indices.chunks_exact_mut(3).for_each(|triangle| triangle.swap(0, 1));
        mesh.append(&inner, &Affine3::IDENTITY);
        Solid::of_mesh(&mesh)
    }

    #[test]
    fn small_cavities_are_filled_and_large_ones_stay() {
        for (radius, n_left) in [(5e-4, 1), (0.5, 2)] {
            let mut solid = hollow(radius);
            assert_eq!(solid.check().components, 2);
            let mut sources: Vec<Source> =
                (0..solid.triangles.len() as u32).map(|triangle| (0, Some(triangle))).collect();
            let mut strayed: Vec<f32> = (0..solid.positions.len()).map(|i| i as f32).collect();
            let before = solid.clone();
            fill_bubbles(&mut solid, &mut sources, &mut strayed);
            for (position, strayed) in solid.positions.iter().zip(&strayed) {
                assert_eq!(*position, before.positions[*strayed as usize]);
            }
            let report = solid.check();
            assert_eq!((report.components, report.non_manifold_vertices), (n_left, 0));
            assert_eq!(sources.len(), solid.triangles.len());
            assert!(sources.iter().enumerate().all(|(i, source)| source.1 == Some(i as u32)));
        }
    }
}
