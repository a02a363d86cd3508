//! What remains of what is drawn.

use sapwood_geom::glam::Affine3;
use sapwood_geom::{Bound, Mesh, Shared, SharedMesh, Side};

use super::cut::{Remains, Surface, Through};
use super::fate::Fate;
use super::meter::{Meter, Meters};
use super::{Pruning, Standing, lines};
use crate::At;

/// What a pruning leaves, for whoever makes something of his own of it.
pub struct Remaining<'a> {
    pub(super) pruning: &'a Pruning,
    pub(super) meters: &'a Meters<'a>,
}

impl Remaining<'_> {
    /// What remains of a mesh that the node draws, as draw lists have it: itself where that is all.
    pub fn mesh(&self, at: &At<'_, Standing>, mesh: &SharedMesh) -> Option<SharedMesh> {
        of_mesh(self.pruning, &self.meters.drawn, at, mesh, None)
    }

    /// What remains of a mesh that stands in for the one that the node draws, as that does: its
    /// triangle `i` shows what number `of[i]` of the drawn mesh shows, or number `i` where there is
    /// no `of`. Nothing where nothing remains.
    pub fn stand_in(
        &self,
        at: &At<'_, Standing>,
        mesh: &SharedMesh,
        of: Option<&[u32]>,
    ) -> Option<SharedMesh> {
        of_mesh(self.pruning, &self.meters.stand_ins, at, mesh, of)
    }

    /// What remains of a closed mesh for each part that the node's mesh shows, in their order:
    /// closed meshes, shut by caps where they were cut. Nothing where nobody has decided about the
    /// parts: what is clipped by the envelope stays open.
    pub fn solids(&self, at: &At<'_, Standing>, solids: &[SharedMesh]) -> Option<Vec<SharedMesh>> {
        let fates = self.pruning.fates_of(at)?;
        let to_plan = fates.world.inverse() * *at.world();
        let left = (0..).zip(solids).filter_map(|(row, solid)| match fates.of(Some(row)) {
            Fate::Whole => Some(solid.clone()),
            Fate::Gone => None,
            Fate::Cut(part) => {
                let mut remains = Remains::closed(&self.meters.stand_ins);
                for triangle in 0..solid.n_triangles() {
                    remains.add_cut(solid, triangle, &Through { part: &**part, to_plan });
                }
                remains.cap();
                Some(SharedMesh::new(remains.finish()))
            }
        });
        Some(left.filter(|solid| !solid.is_empty()).collect())
    }
}

/// How something drawn with a bound stands.
fn side(pruning: &Pruning, at: &At<'_, Standing>, bound: &Bound, world: &Affine3) -> Side {
    match at.state().side() {
        Side::Inside => Side::Inside,
        _ => pruning.prune.envelope.side_of_bound(&bound.transformed(world)),
    }
}

fn surface<'a>(pruning: &'a Pruning, world: Affine3) -> Surface<'a> {
    Surface { envelope: &pruning.prune.envelope, world, tolerance: pruning.prune.tolerance }
}

/// What remains of a mesh; itself where that is all. `of` tells which of the node's triangles those
/// of the mesh stand for, where it is not the node's own.
pub(super) fn of_mesh(
    pruning: &Pruning,
    meter: &Meter<'_>,
    at: &At<'_, Standing>,
    mesh: &SharedMesh,
    of: Option<&[u32]>,
) -> Option<SharedMesh> {
    if let (Some(fates), Some(shown)) = (pruning.fates_of(at), at.plan().fragment.shown(at.index()))
    {
        if fates.rows.iter().all(|fate| matches!(fate, Fate::Whole)) {
            return Some(mesh.clone());
        }
        let to_plan = fates.world.inverse() * *at.world();
        let mut remains = Remains::new(meter);
        let mut last = None;
        // Those of one part together, so that each is capped once: a mesh that fades has them lie
        // between others.
        let row_of = |triangle: usize| match of {
            None => shown.row(triangle as u32),
            Some(of) => of.get(triangle).and_then(|number| shown.row(*number)),
        };
        let mut triangles: Vec<usize> = (0..mesh.n_triangles()).collect();
        triangles.sort_by_cached_key(|triangle| row_of(*triangle));
        for triangle in triangles {
            let row = row_of(triangle);
            if row != last {
                remains.cap();
                last = row;
            }
            match fates.of(row) {
                Fate::Whole => remains.add(mesh, triangle),
                Fate::Gone => {}
                Fate::Cut(part) => {
                    remains.add_cut(mesh, triangle, &Through { part: &**part, to_plan });
                }
            }
        }
        remains.cap();
        return Some(remains.finish()).filter(|mesh| !mesh.is_empty()).map(SharedMesh::new);
    }
    match side(pruning, at, mesh.bound(), at.world()) {
        Side::Inside => Some(mesh.clone()),
        Side::Outside => None,
        Side::Crossing => {
            let surface = surface(pruning, *at.world());
            let mut remains = Remains::new(meter);
            let mut is_all = true;
            for triangle in 0..mesh.n_triangles() {
                is_all &= remains.add_cut(mesh, triangle, &surface);
            }
            remains.leave_open();
            if is_all {
                return Some(mesh.clone());
            }
            Some(remains.finish()).filter(|mesh| !mesh.is_empty()).map(SharedMesh::new)
        }
    }
}

/// Rows of what remains of a repeated mesh: those that are whole, and one mesh of all that were
/// clipped.
pub(super) fn of_instances(
    pruning: &Pruning,
    meter: &Meter<'_>,
    at: &At<'_, Standing>,
    mesh: &SharedMesh,
    transforms: &Shared<Vec<Affine3>>,
) -> Vec<(SharedMesh, Option<Shared<Vec<Affine3>>>)> {
    let fates = pruning.fates_of(at);
    let shown = at.plan().fragment.shown(at.index());
    let (mut whole, mut clipped) = (Vec::new(), Mesh::default());
    for (number, transform) in (0..).zip(transforms.iter()) {
        let world = *at.world() * *transform;
        let mut remains = Remains::new(meter);
        let triangles = 0..mesh.n_triangles();
        if let (Some(fates), Some(shown)) = (fates, shown) {
            match fates.of(shown.row(number)) {
                Fate::Whole => whole.push(*transform),
                Fate::Gone => {}
                Fate::Cut(part) => {
                    let to_plan = fates.world.inverse() * world;
                    let through = Through { part: &**part, to_plan };
                    triangles.for_each(|t| {
                        remains.add_cut(mesh, t, &through);
                    });
                    remains.cap();
                }
            }
        } else {
            match side(pruning, at, mesh.bound(), &world) {
                Side::Inside => whole.push(*transform),
                Side::Outside => {}
                Side::Crossing => {
                    let surface = surface(pruning, world);
                    let is_all =
                        triangles.fold(true, |all, t| remains.add_cut(mesh, t, &surface) & all);
                    remains.leave_open();
                    if is_all {
                        whole.push(*transform);
                        continue;
                    }
                }
            }
        }
        let remains = remains.finish();
        if !remains.is_empty() {
            clipped.append(&remains, transform);
        }
    }
    let mut rows = Vec::new();
    if whole.len() == transforms.len() {
        rows.push((mesh.clone(), Some(transforms.clone())));
    } else if !whole.is_empty() {
        rows.push((mesh.clone(), Some(Shared::new(whole))));
    }
    if !clipped.is_empty() {
        rows.push((SharedMesh::new(clipped), None));
    }
    rows
}

/// What remains of lines; themselves where that is all.
pub(super) fn of_lines(
    pruning: &Pruning,
    at: &At<'_, Standing>,
    lines: &Shared<Vec<sapwood_geom::Polyline>>,
) -> Option<Shared<Vec<sapwood_geom::Polyline>>> {
    let world = *at.world();
    let mut remains = Vec::new();
    if let (Some(fates), Some(shown)) = (pruning.fates_of(at), at.plan().fragment.shown(at.index()))
    {
        let to_plan = fates.world.inverse() * world;
        for (number, line) in (0..).zip(lines.iter()) {
            match fates.of(shown.row(number)) {
                Fate::Whole => remains.push(line.clone()),
                Fate::Gone => {}
                Fate::Cut(part) => {
                    let through = Through { part: &**part, to_plan };
                    remains.extend(lines::cut_line(line, &through, |_, _| false));
                }
            }
        }
    } else {
        for line in lines.iter() {
            match side(pruning, at, &line.bound(), &world) {
                Side::Inside => remains.push(line.clone()),
                Side::Outside => {}
                Side::Crossing => {
                    remains.extend(lines::cut_line(line, &surface(pruning, world), |from, to| {
                        let [from, to] = [from, to].map(|end| world.transform_point3(end));
                        lines::is_near(&pruning.prune.envelope, from, to)
                    }));
                }
            }
        }
    }
    if remains == **lines {
        return Some(lines.clone());
    }
    (!remains.is_empty()).then(|| Shared::new(remains))
}
