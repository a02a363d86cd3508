//! Welding by union: whatever is solid in a view becomes one closed surface.
//!
//! Rules that know their solids offer them as [`Solids`]; elsewhere meshes that are closed already
//! are taken as they are. What is open, what is repeated as instances, and lines, lights and so on
//! are left alone.

use std::fmt;
use std::sync::Arc;

use sapwood_geom::glam::Affine3;
use sapwood_geom::{
    Digest, FixedMap, FixedSet, Mended, Mesh, SharedMesh, SolidReport, UnionError, UnionStep,
    fixed_state, union_of_meshes,
};

use super::{Body, DrawList, DrawRow, Occurrence};
use crate::{At, Handlers, Kind, Material, Named, RenderNode, SiteId, Solids};

/// The kind of the body that holds what was welded.
struct Welded;

impl Named for Welded {
    const NAME: &'static str = "welded";
}

/// Gathers solids in a walk, and joins them then. Call [`meet`](Self::meet) for every node of a
/// walk in pre-order.
pub struct WeldUnion {
    handlers: Handlers<Gathered>,
    gathered: Gathered,
}

/// What a walk has gathered so far.
struct Gathered {
    /// The solids of the plan that the walk entered last, until one of its meshes is met.
    offered: Option<(SiteId, Option<Vec<Mesh>>)>,
    solids: Vec<Mesh>,
    /// The number of each solid's material.
    materials_of: Vec<u32>,
    materials: Vec<Arc<Material>>,
    numbers: FixedMap<Digest, u32>,
    /// Meshes that the solids stand for.
    replaced: FixedSet<Digest>,
}

/// What joining solids made, and what it took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeldReport {
    /// How many solids were joined.
    pub n_solids: usize,
    /// How many triangles they had.
    pub n_triangles_before: u64,
    /// How many triangles the union has.
    pub n_triangles: u64,
    /// How many solids crossed themselves.
    pub n_rebuilt: usize,
    /// What was mended.
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
                gathered.offered = Some((at.site(), Some(solids.solids())));
            },
        );
        let gathered = Gathered {
            offered: None,
            solids: Vec::new(),
            materials_of: Vec::new(),
            materials: Vec::new(),
            numbers: FixedMap::with_hasher(fixed_state()),
            replaced: FixedSet::with_hasher(fixed_state()),
        };
        Self { handlers, gathered }
    }

    /// Takes what the node shows, if that is solid.
    pub fn meet(&mut self, at: &At<'_, ()>) {
        self.handlers.handle(&mut self.gathered, at);
        let RenderNode::Mesh { mesh, material } = at.node() else { return };
        let gathered = &mut self.gathered;
        match &mut gathered.offered {
            Some((site, solids)) if *site == at.site() => {
                // The first mesh of the plan takes them all.
                let solids = solids.take().unwrap_or_default();
                gathered.replaced.insert(Digest::of(mesh));
                gathered.add(solids, material, at.world());
            }
            _ => {
                if mesh.unsound().is_none() && !mesh.is_empty() && mesh.n_open_edges() == 0 {
                    gathered.replaced.insert(Digest::of(mesh));
                    gathered.add(vec![Mesh::clone(mesh)], material, at.world());
                }
            }
        }
    }

    /// How many solids were gathered.
    pub fn n_solids(&self) -> usize {
        self.gathered.solids.len()
    }

    /// The list with one body, at the root, in the place of what was gathered. The list must be
    /// of the view that was walked over.
    ///
    /// The body has a mesh for each material; together they are closed.
    ///
    /// # Errors
    /// See [`UnionError`].
    pub fn join(
        self,
        list: &DrawList,
        max_triangles: u64,
        goes_on: &dyn Fn(UnionStep) -> bool,
    ) -> Result<(DrawList, WeldReport), UnionError> {
        let Gathered { solids, materials_of, materials, replaced, .. } = self.gathered;
        let (meshes, union) =
            union_of_meshes(&solids, &materials_of, materials.len(), max_triangles, goes_on)?;
        let report = WeldReport {
            n_solids: solids.len(),
            n_triangles_before: solids.iter().map(|mesh| mesh.n_triangles() as u64).sum(),
            n_triangles: union.solid.triangles.len() as u64,
            n_rebuilt: union.n_rebuilt,
            mended: union.mended,
            checked: union.report,
        };
        let mut body = Body::new(Kind::of::<Welded>());
        body.rows = meshes
            .into_iter()
            .zip(materials)
            .filter(|(mesh, _)| !mesh.is_empty())
            .map(|(mesh, material)| DrawRow {
                local: Affine3::IDENTITY,
                mesh: SharedMesh::new(mesh),
                material,
                instances: None,
                range: None,
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
        Ok((DrawList { bodies, occurrences }, report))
    }
}

impl Gathered {
    fn add(&mut self, solids: Vec<Mesh>, material: &Arc<Material>, world: &Affine3) {
        let (materials, fresh) = (&mut self.materials, Digest::of(material));
        let number = *self.numbers.entry(fresh).or_insert_with(|| {
            materials.push(Arc::clone(material));
            materials.len() as u32 - 1
        });
        for solid in solids.iter().filter(|solid| !solid.is_empty()) {
            let mut placed = Mesh::default();
            placed.append(solid, world);
            self.solids.push(placed);
            self.materials_of.push(number);
        }
    }
}
