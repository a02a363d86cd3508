//! Welding by identity: whatever is made of pieces in a view becomes one mesh for each plan.
//!
//! Rules that make their meshes of pieces offer them as [`Pieced`]; all else is left alone. What
//! was welded is kept by its content, so that after an edit only what changed is welded again.

use std::fmt;

use sapwood_geom::{Digest, FixedMap, Pieces, Shared, SharedMesh, fixed_state};

use super::{Body, DrawList, DrawRow};
use crate::{At, Handlers, Pieced, RenderNode, SiteId};

/// Welds pieces met in walks; keeps what it made for the next walk.
///
/// Call [`meet`](Self::meet) for every node of a walk in pre-order, and then
/// [`welded`](Self::welded).
pub struct WeldPieces {
    handlers: Handlers<Met>,
    met: Met,
    /// What was welded, by the digest of its pieces.
    kept: FixedMap<Digest, SharedMesh>,
}

/// What a walk has met so far.
struct Met {
    /// The pieces of the plan that the walk entered last, until its mesh is met.
    offered: Option<(SiteId, Shared<Pieces>)>,
    /// Pieces by the digest of the mesh that they stand for.
    by_mesh: FixedMap<Digest, Shared<Pieces>>,
}

/// What welding made of how much.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PiecesReport {
    /// Meshes that were welded.
    pub n_welded: usize,
    /// Meshes that were welded earlier and are used again.
    pub n_kept: usize,
    /// Vertices of all pieces, each mesh counted once.
    pub n_vertices_before: u64,
    /// Vertices of the welded meshes, each counted once.
    pub n_vertices: u64,
}

impl fmt::Debug for WeldPieces {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} meshes to be welded, {} kept", self.met.by_mesh.len(), self.kept.len())
    }
}

impl Default for WeldPieces {
    fn default() -> Self {
        Self::new()
    }
}

impl Met {
    fn new() -> Self {
        Self { offered: None, by_mesh: FixedMap::with_hasher(fixed_state()) }
    }
}

impl WeldPieces {
    /// Nothing met yet, and nothing kept.
    pub fn new() -> Self {
        let handlers = Handlers::new().on_interface::<dyn Pieced>(
            |met: &mut Met, pieced: &(dyn Pieced + 'static), at: &At<'_, ()>| {
                met.offered = pieced.pieces().map(|pieces| (at.site(), pieces.clone()));
            },
        );
        Self { handlers, met: Met::new(), kept: FixedMap::with_hasher(fixed_state()) }
    }

    /// Takes note of a mesh, if its plan offers pieces.
    pub fn meet(&mut self, at: &At<'_, ()>) {
        self.handlers.handle(&mut self.met, at);
        let RenderNode::Mesh { mesh, .. } = at.node() else { return };
        if let Some((_, pieces)) = self.met.offered.take_if(|(site, _)| *site == at.site()) {
            self.met.by_mesh.insert(Digest::of(mesh), pieces);
        }
    }

    /// The list with welded meshes in the place of those that were met since the last call. The
    /// list must be of the view that was walked over; it stays as it is.
    ///
    /// What was welded for earlier lists and is not met any more is forgotten.
    pub fn welded(&mut self, list: &DrawList) -> (DrawList, PiecesReport) {
        let met = std::mem::replace(&mut self.met, Met::new());
        let mut report = PiecesReport::default();
        let mut kept: FixedMap<Digest, SharedMesh> = FixedMap::with_hasher(fixed_state());
        let mut weld = |pieces: &Shared<Pieces>| {
            let digest = pieces.digest();
            if let Some(mesh) = kept.get(&digest) {
                return mesh.clone();
            }
            let mesh = match self.kept.get(&digest) {
                Some(mesh) => {
                    report.n_kept += 1;
                    mesh.clone()
                }
                None => {
                    report.n_welded += 1;
                    SharedMesh::new(pieces.weld())
                }
            };
            report.n_vertices_before += pieces.mesh.n_vertices() as u64;
            report.n_vertices += mesh.n_vertices() as u64;
            kept.insert(digest, mesh.clone());
            mesh
        };
        let mut row = |row: &DrawRow| match met.by_mesh.get(&Digest::of(&row.mesh)) {
            Some(pieces) => DrawRow { mesh: weld(pieces), follows: None, ..row.clone() },
            None => row.clone(),
        };
        let mut body =
            |body: &Body| Body { rows: body.rows.iter().map(&mut row).collect(), ..body.clone() };
        let bodies = list.bodies.iter().map(&mut body).collect();
        let occurrences = list.occurrences.clone();
        self.kept = kept;
        (DrawList { bodies, occurrences }, report)
    }
}
