//! Welding by identity: whatever is made of pieces in a view becomes one mesh for each plan.
//!
//! Rules that make their meshes of pieces offer them as [`Pieced`]; all else is left alone. What
//! was welded is kept by its content, so that after an edit only what changed is welded again.
//! What a pruning cuts is welded first and cut then, so that caps close the welded surface.

use std::fmt;
use std::sync::Arc;

use sapwood_geom::{Digest, FixedMap, Pieces, Shared, SharedMesh, fixed_state};

use super::{Body, DrawList, DrawRow, Remaining, Standing};
use crate::{At, Handlers, Pieced, RenderNode, SiteId};

/// Welds pieces met in walks; keeps what it made for the next walk.
///
/// Call [`meet`](Self::meet) for every node of a walk in pre-order, and then
/// [`welded`](Self::welded). A walk that ends early leaves behind what it has met until then: call
/// [`clear`](Self::clear) before the next one.
pub struct WeldPieces {
    handlers: Handlers<Met>,
    cut_handlers: Handlers<Met, Standing>,
    met: Met,
    /// What was welded for the last list, by the digest of its pieces.
    kept: FixedMap<Digest, Welded>,
}

/// What a walk has met so far.
struct Met {
    /// The pieces of the plan that the walk entered last, until its mesh is met.
    offered: Option<(SiteId, Shared<Pieces>)>,
    /// By the digest of a mesh that is drawn, what comes in its place.
    by_mesh: FixedMap<Digest, Instead>,
    /// What was welded for this walk, by the digest of its pieces.
    welded: FixedMap<Digest, Welded>,
    report: PiecesReport,
}

/// What comes in the place of a mesh.
enum Instead {
    /// All of these, welded.
    Whole(Shared<Pieces>),
    /// What a cut leaves of them; nothing where it leaves nothing.
    Cut(Option<SharedMesh>),
}

/// Pieces that were welded.
#[derive(Clone)]
struct Welded {
    mesh: SharedMesh,
    /// The triangle of the pieces that each of its own was; nothing where all are still there.
    of: Option<Arc<[u32]>>,
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
    /// Vertices of the welded meshes, each counted once, before any are cut.
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
        Self {
            offered: None,
            by_mesh: FixedMap::with_hasher(fixed_state()),
            welded: FixedMap::with_hasher(fixed_state()),
            report: PiecesReport::default(),
        }
    }

    /// Notes what a plan offers for its mesh.
    fn offer(&mut self, site: SiteId, pieced: &dyn Pieced) {
        self.offered = pieced.pieces().map(|pieces| (site, pieces.clone()));
    }

    /// What the plan offers for a mesh: the first one takes it.
    fn taken(&mut self, site: SiteId) -> Option<Shared<Pieces>> {
        let offered = self.offered.take_if(|(offering, _)| *offering == site);
        offered.map(|(_, pieces)| pieces)
    }

    /// The welded pieces, from `kept` if they are there.
    fn weld(&mut self, pieces: &Shared<Pieces>, kept: &FixedMap<Digest, Welded>) -> Welded {
        let digest = pieces.digest();
        if let Some(welded) = self.welded.get(&digest) {
            return welded.clone();
        }
        let report = &mut self.report;
        let welded = match kept.get(&digest) {
            Some(welded) => {
                report.n_kept += 1;
                welded.clone()
            }
            None => {
                report.n_welded += 1;
                let (mesh, of) = pieces.weld_telling();
                let is_all = of.len() == pieces.mesh.n_triangles();
                Welded { mesh: SharedMesh::new(mesh), of: (!is_all).then(|| of.into()) }
            }
        };
        report.n_vertices_before += pieces.mesh.n_vertices() as u64;
        report.n_vertices += welded.mesh.n_vertices() as u64;
        self.welded.insert(digest, welded.clone());
        welded
    }
}

impl WeldPieces {
    /// Nothing met yet, and nothing kept.
    pub fn new() -> Self {
        let handlers = Handlers::new().on_interface::<dyn Pieced>(
            |met: &mut Met, pieced: &(dyn Pieced + 'static), at: &At<'_, ()>| {
                met.offer(at.site(), pieced);
            },
        );
        let cut_handlers = Handlers::new().on_interface::<dyn Pieced>(
            |met: &mut Met, pieced: &(dyn Pieced + 'static), at: &At<'_, Standing>| {
                met.offer(at.site(), pieced);
            },
        );
        let kept = FixedMap::with_hasher(fixed_state());
        Self { handlers, cut_handlers, met: Met::new(), kept }
    }

    /// Takes note of a mesh, if its plan offers pieces.
    pub fn meet(&mut self, at: &At<'_, ()>) {
        self.handlers.handle(&mut self.met, at);
        let RenderNode::Mesh { mesh, .. } = at.node() else { return };
        if let Some(pieces) = self.met.taken(at.site()) {
            self.met.by_mesh.insert(Digest::of(mesh), Instead::Whole(pieces));
        }
    }

    /// Takes note of what a pruning ([`prune_each`](super::prune_each)) leaves of a mesh, if its
    /// plan offers pieces: these are welded, and the result is cut where the mesh is.
    ///
    /// The list that is handed to [`welded`](Self::welded) must be that of the same pruning.
    pub fn meet_remaining(&mut self, remaining: &Remaining<'_>, at: &At<'_, Standing>) {
        self.cut_handlers.handle(&mut self.met, at);
        let RenderNode::Mesh { mesh, .. } = at.node() else { return };
        let Some(pieces) = self.met.taken(at.site()) else { return };
        let Some(left) = remaining.mesh(at, mesh) else { return };
        let instead = if left.is_same(mesh) {
            Instead::Whole(pieces)
        } else {
            let welded = self.met.weld(&pieces, &self.kept);
            Instead::Cut(remaining.stand_in(at, &welded.mesh, welded.of.as_deref()))
        };
        self.met.by_mesh.insert(Digest::of(&left), instead);
    }

    /// Forgets what was met since the last call of [`welded`](Self::welded), as in a walk that was
    /// interrupted; what was welded earlier is kept.
    pub fn clear(&mut self) {
        self.met = Met::new();
    }

    /// The list with welded meshes in the place of those that were met since the last call. The
    /// list must be of the view that was walked over; it stays as it is.
    ///
    /// What was welded for earlier lists and is not met any more is forgotten.
    pub fn welded(&mut self, list: &DrawList) -> (DrawList, PiecesReport) {
        let mut met = std::mem::replace(&mut self.met, Met::new());
        let by_mesh = std::mem::replace(&mut met.by_mesh, FixedMap::with_hasher(fixed_state()));
        let mut row = |row: &DrawRow| {
            let mesh = match by_mesh.get(&Digest::of(&row.mesh)) {
                None => return Some(row.clone()),
                Some(Instead::Whole(pieces)) => met.weld(pieces, &self.kept).mesh,
                Some(Instead::Cut(left)) => left.clone()?,
            };
            Some(DrawRow { mesh, follows: None, ..row.clone() })
        };
        let mut body = |body: &Body| Body {
            rows: body.rows.iter().filter_map(&mut row).collect(),
            ..body.clone()
        };
        let bodies = list.bodies.iter().map(&mut body).collect();
        let occurrences = list.occurrences.clone();
        self.kept = met.welded;
        (DrawList { bodies, occurrences }, met.report)
    }
}
