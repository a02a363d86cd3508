//! Welding by union: whatever is solid in a view becomes one closed surface.
//!
//! Rules that know their solids offer them as [`Solids`]; elsewhere meshes that are closed already
//! are taken as they are. What is open, what is repeated as instances, and lines, lights and so on
//! are left alone.
//!
//! What grows on something is joined with it before that is joined with what it grows on itself;
//! what was joined is kept by its content, so that after an edit of one branch that branch is
//! joined again, and what it grows on with it, and nothing else.

mod gathered;
mod groups;

use std::fmt;
use std::sync::Arc;

use sapwood_geom::glam::Affine3;
use sapwood_geom::{
    Digest, Mended, SharedMesh, Solid, SolidReport, Union, UnionError, UnionStep, UnionWork,
    Unions, dressed,
};

use super::{Body, DrawList, DrawRow, Occurrence, Remaining, Standing};
use crate::{At, Handlers, Kind, Named, RenderNode, Solids};
use gathered::Gathered;

/// The kind of the body that holds what was welded.
struct Welded;

impl Named for Welded {
    const NAME: &'static str = "welded";
}

/// Gathers solids in walks, and joins them; keeps what it made for the next walk.
///
/// Call [`meet`](Self::meet) for every node of a walk in pre-order, and then [`join`](Self::join).
/// A walk that ends early leaves behind what it has met until then: call [`clear`](Self::clear)
/// before the next one.
pub struct WeldUnion {
    handlers: Handlers<Gathered>,
    cut_handlers: Handlers<Gathered, Standing>,
    gathered: Gathered,
    unions: Unions,
}

/// What joining solids made.
#[derive(Clone, Debug)]
pub struct WeldedUnion {
    /// What was drawn, with one body, at the root, in the place of what was joined. The body has a
    /// mesh for each material; together they are closed: wherever two of their triangles meet, they
    /// have an edge with equal positions at both ends. Vertices at one position are several where
    /// normals or texture coordinates differ.
    pub list: DrawList,
    /// The same surface without materials, normals and texture coordinates: one index buffer.
    pub union: Arc<Union>,
    /// What it took.
    pub report: WeldReport,
}

/// What joining solids took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeldReport {
    /// How many solids were joined.
    pub n_solids: usize,
    /// How many triangles they had.
    pub n_triangles_before: u64,
    /// How many triangles the union has.
    pub n_triangles: u64,
    /// What was joined for this, and what was there from earlier.
    pub work: UnionWork,
    /// What was mended, also earlier.
    pub mended: Mended,
    /// The union's faults, all of them 0, its components and its volume.
    pub checked: SolidReport,
}

impl fmt::Debug for WeldUnion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} solids to be welded", self.gathered.solids.len())
    }
}

impl Default for WeldUnion {
    fn default() -> Self {
        Self::new()
    }
}

impl WeldUnion {
    /// Nothing gathered yet.
    pub fn new() -> Self {
        let handlers = Handlers::new().on_interface::<dyn Solids>(
            |gathered: &mut Gathered, solids: &(dyn Solids + 'static), at: &At<'_, ()>| {
                gathered.offer(at.site(), || solids.solids());
            },
        );
        let cut_handlers = Handlers::new().on_interface::<dyn Solids>(
            |gathered: &mut Gathered, solids: &(dyn Solids + 'static), at: &At<'_, Standing>| {
                gathered.offer(at.site(), || solids.solids());
            },
        );
        Self { handlers, cut_handlers, gathered: Gathered::new(), unions: Unions::new() }
    }

    /// Takes what the node shows, if that is solid.
    pub fn meet(&mut self, at: &At<'_, ()>) {
        let place = self.gathered.enter(at);
        self.handlers.handle(&mut self.gathered, at);
        let RenderNode::Mesh { mesh, material } = at.node() else { return };
        let gathered = &mut self.gathered;
        match gathered.offered(at.site()) {
            Some(solids) => gathered.replace(mesh, &solids, material, at.world(), place),
            None => gathered.take_closed(mesh, material, at.world(), place),
        }
    }

    /// Takes what a pruning ([`prune_each`](super::prune_each)) leaves of what the node shows, if
    /// that is solid. Stems and the like are closed by caps where they are cut; what is clipped by
    /// the envelope, triangle by triangle, is open from then on and is left alone.
    ///
    /// The list that is handed to [`join`](Self::join) must be that of the same pruning.
    pub fn meet_remaining(&mut self, remaining: &Remaining<'_>, at: &At<'_, Standing>) {
        let place = self.gathered.enter(at);
        self.cut_handlers.handle(&mut self.gathered, at);
        let RenderNode::Mesh { mesh, material } = at.node() else { return };
        let gathered = &mut self.gathered;
        let offered = gathered.offered(at.site());
        let Some(left) = remaining.mesh(at, mesh) else { return };
        match offered {
            None => gathered.take_closed(&left, material, at.world(), place),
            Some(solids) => match remaining.solids(at, &solids) {
                Some(cut) => gathered.replace(&left, &cut, material, at.world(), place),
                None if left.is_same(mesh) => {
                    gathered.replace(mesh, &solids, material, at.world(), place);
                }
                None => {}
            },
        }
    }

    /// Forgets what was gathered since the last [`join`](Self::join), as of a walk that was
    /// interrupted; what was joined earlier is kept.
    pub fn clear(&mut self) {
        self.gathered = Gathered::new();
    }

    /// How many solids were gathered.
    pub fn n_solids(&self) -> usize {
        self.gathered.solids.len()
    }

    /// Joins what was gathered since the last call. The list must be of the view that was walked
    /// over; it stays as it is.
    ///
    /// What was joined for earlier lists and was not met any more is forgotten.
    ///
    /// # Errors
    /// See [`UnionError`]. What was gathered is forgotten then too, and what was joined earlier is
    /// kept.
    pub fn join(
        &mut self,
        list: &DrawList,
        max_triangles: u64,
        goes_on: &dyn Fn(UnionStep) -> bool,
    ) -> Result<WeldedUnion, UnionError> {
        let gathered = std::mem::replace(&mut self.gathered, Gathered::new());
        let groups = groups::of(&gathered);
        let Gathered { solids: placed, materials_of, materials, replaced, .. } = gathered;
        let solids: Vec<Solid> = placed.iter().map(|part| Solid::of_mesh(&part.mesh())).collect();
        let (union, work) = self.unions.join(&solids, &groups, max_triangles, goes_on)?;
        let report = WeldReport {
            n_solids: placed.len(),
            n_triangles_before: placed.iter().map(|part| part.shape.n_triangles() as u64).sum(),
            n_triangles: union.solid.triangles.len() as u64,
            work,
            mended: union.mended,
            checked: union.report,
        };
        drop(solids);
        let part = |number: u32| placed[number as usize].mesh();
        let meshes = dressed(&union, &part, &materials_of, materials.len());
        let mut body = Body { is_solid: true, ..Body::new(Kind::of::<Welded>()) };
        body.rows = meshes
            .into_iter()
            .zip(materials)
            .filter(|(mesh, _)| !mesh.is_empty())
            .map(|(mesh, material)| {
                DrawRow::new(Affine3::IDENTITY, SharedMesh::new(mesh), material)
            })
            .collect();
        let mut bodies: Vec<Body> = list.bodies.clone();
        for body in &mut bodies {
            body.rows.retain(|row| {
                row.instances.is_some() || !replaced.contains(&Digest::of(&row.mesh))
            });
        }
        let mut occurrences = list.occurrences.clone();
        let number = bodies.len() as u32;
        occurrences.insert(0, Occurrence { body: number, world: Affine3::IDENTITY });
        bodies.push(body);
        Ok(WeldedUnion { list: DrawList { bodies, occurrences }, union, report })
    }
}
