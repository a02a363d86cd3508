//! Welding by union: whatever is solid in a view becomes one closed surface.
//!
//! Rules that know their solids offer them as [`Solids`]; elsewhere meshes that are closed already
//! are taken as they are. What is open, what is repeated as instances, and lines, lights and so on
//! are left alone.
//!
//! What grows on something is joined with it before that is joined with what it grows on itself;
//! what was joined is kept by its content, so that after an edit of one branch that branch is
//! joined again, and what it grows on with it, and nothing else.

use std::fmt;
use std::sync::Arc;

use sapwood_geom::glam::Affine3;
use sapwood_geom::{
    Digest, FixedMap, FixedSet, Member, Mended, Mesh, SharedMesh, Solid, SolidReport, Union,
    UnionError, UnionStep, UnionWork, Unions, dressed, fixed_state,
};

use super::{Body, DrawList, DrawRow, Occurrence};
use crate::{At, Handlers, Kind, Material, Named, RenderNode, SiteId, Solids};

/// The kind of the body that holds what was welded.
struct Welded;

impl Named for Welded {
    const NAME: &'static str = "welded";
}

/// Gathers solids in walks, and joins them; keeps what it made for the next walk.
///
/// Call [`meet`](Self::meet) for every node of a walk in pre-order, and then [`join`](Self::join).
pub struct WeldUnion {
    handlers: Handlers<Gathered>,
    gathered: Gathered,
    unions: Unions,
}

/// What a walk has gathered so far.
struct Gathered {
    /// The solids of the plan that the walk entered last, until one of its meshes is met.
    offered: Option<(SiteId, Option<Vec<Mesh>>)>,
    solids: Vec<Mesh>,
    /// The number of each solid's material.
    materials_of: Vec<u32>,
    /// Where each solid stands: an index into `above`.
    places_of: Vec<u32>,
    /// Of each place that was entered the one above it; a root stands above itself.
    above: Vec<u32>,
    /// The first place of the walk.
    root: u32,
    materials: Vec<Arc<Material>>,
    numbers: FixedMap<Digest, u32>,
    /// Meshes that the solids stand for.
    replaced: FixedSet<Digest>,
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
                gathered.offered = Some((at.site(), Some(solids.solids())));
            },
        );
        Self { handlers, gathered: Gathered::new(), unions: Unions::new() }
    }

    /// Takes what the node shows, if that is solid.
    pub fn meet(&mut self, at: &At<'_, ()>) {
        let place = self.gathered.enter(at);
        self.handlers.handle(&mut self.gathered, at);
        let RenderNode::Mesh { mesh, material } = at.node() else { return };
        let gathered = &mut self.gathered;
        match &mut gathered.offered {
            Some((site, solids)) if *site == at.site() => {
                // The first mesh of the plan takes them all.
                let solids = solids.take().unwrap_or_default();
                gathered.replaced.insert(Digest::of(mesh));
                gathered.add(solids, material, at.world(), place);
            }
            _ => {
                if mesh.unsound().is_none() && !mesh.is_empty() && mesh.n_open_edges() == 0 {
                    gathered.replaced.insert(Digest::of(mesh));
                    gathered.add(vec![Mesh::clone(mesh)], material, at.world(), place);
                }
            }
        }
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
    /// See [`UnionError`].
    pub fn join(
        &mut self,
        list: &DrawList,
        max_triangles: u64,
        goes_on: &dyn Fn(UnionStep) -> bool,
    ) -> Result<WeldedUnion, UnionError> {
        let gathered = std::mem::replace(&mut self.gathered, Gathered::new());
        let groups = gathered.groups();
        let Gathered { solids: meshes, materials_of, materials, replaced, .. } = gathered;
        let solids: Vec<Solid> = meshes.iter().map(Solid::of_mesh).collect();
        let (union, work) = self.unions.join(&solids, &groups, max_triangles, goes_on)?;
        let report = WeldReport {
            n_solids: meshes.len(),
            n_triangles_before: meshes.iter().map(|mesh| mesh.n_triangles() as u64).sum(),
            n_triangles: union.solid.triangles.len() as u64,
            work,
            mended: union.mended,
            checked: union.report,
        };
        let meshes = dressed(&union, &meshes, &materials_of, materials.len());
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
                follows: None,
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

impl Gathered {
    fn new() -> Self {
        Self {
            offered: None,
            solids: Vec::new(),
            materials_of: Vec::new(),
            places_of: Vec::new(),
            above: Vec::new(),
            root: 0,
            materials: Vec::new(),
            numbers: FixedMap::with_hasher(fixed_state()),
            replaced: FixedSet::with_hasher(fixed_state()),
        }
    }

    /// Notes the place of the node, and gives its number; walks are told apart by their roots.
    fn enter(&mut self, at: &At<'_, ()>) -> u32 {
        let path = at.path();
        if at.enters_plan() {
            if path.number() == 0 {
                self.root = self.above.len() as u32;
            }
            self.above.push(self.root + path.number_above());
        }
        self.root + path.number()
    }

    fn add(&mut self, solids: Vec<Mesh>, material: &Arc<Material>, world: &Affine3, place: u32) {
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
            self.places_of.push(place);
        }
    }

    /// What is joined first: where something below a place is solid itself and something else
    /// below it holds solids too, as a stem and what grows on it, they are a group. All that is left
    /// is the last group.
    fn groups(&self) -> Vec<Vec<Member>> {
        let mut groups = Vec::new();
        // Of each place what is below it and in no group yet, each with the number of its first
        // solid; whether it has solids itself; how many places right below hold any; and whether
        // one of these has them itself.
        let mut members: Vec<Vec<(u32, Member)>> = vec![Vec::new(); self.above.len()];
        for (solid, place) in (0..).zip(&self.places_of) {
            members[*place as usize].push((solid, Member::Solid(solid)));
        }
        let is_solid: Vec<bool> = members.iter().map(|own| !own.is_empty()).collect();
        let mut n_below = vec![0; members.len()];
        let mut is_on_solid = vec![false; members.len()];
        let mut all = Vec::new();
        // Places come after the ones above them.
        for place in (0..members.len()).rev() {
            let mut held = std::mem::take(&mut members[place]);
            if held.is_empty() {
                continue;
            }
            held.sort_unstable_by_key(|(first, _)| *first);
            if is_on_solid[place] && n_below[place] > 1 {
                let first = held[0].0;
                groups.push(held.into_iter().map(|(_, member)| member).collect());
                held = vec![(first, Member::Group(groups.len() as u32 - 1))];
            }
            let above = self.above[place] as usize;
            if above == place {
                all.append(&mut held);
            } else {
                n_below[above] += 1;
                is_on_solid[above] |= is_solid[place];
                members[above].append(&mut held);
            }
        }
        all.sort_unstable_by_key(|(first, _)| *first);
        if !matches!(&all[..], [(_, Member::Group(_))]) {
            groups.push(all.into_iter().map(|(_, member)| member).collect());
        }
        groups
    }
}
