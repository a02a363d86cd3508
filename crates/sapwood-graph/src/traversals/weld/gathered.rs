//! What walks gather of solids, until they are joined.

use std::sync::Arc;

use sapwood_geom::glam::Affine3;
use sapwood_geom::{Digest, FixedMap, FixedSet, Mesh, SharedMesh, fixed_state};

use crate::{At, Material, SiteId};

/// What a walk has gathered so far.
pub(super) struct Gathered {
    /// The plan that the walk entered last, until one of its meshes is met.
    offering: Option<SiteId>,
    /// What plans offer; a plan that occurs many times is asked once.
    offers: FixedMap<SiteId, Arc<[SharedMesh]>>,
    pub(super) solids: Vec<PlacedSolid>,
    /// The number of each solid's material.
    pub(super) materials_of: Vec<u32>,
    /// Where each solid stands: an index into `above`.
    pub(super) places_of: Vec<u32>,
    /// Of each place that was entered the one above it; a root stands above itself.
    pub(super) above: Vec<u32>,
    /// The first place of the walk.
    root: u32,
    pub(super) materials: Vec<Arc<Material>>,
    numbers: FixedMap<Digest, u32>,
    /// Meshes that the solids stand for.
    pub(super) replaced: FixedSet<Digest>,
}

/// A solid where it stands.
pub(super) struct PlacedSolid {
    /// In a frame of its own: shared by all occurrences.
    pub(super) shape: SharedMesh,
    world: Affine3,
}

impl PlacedSolid {
    /// The solid in the root's frame.
    pub(super) fn mesh(&self) -> Mesh {
        let mut placed = Mesh::default();
        placed.append(&self.shape, &self.world);
        placed
    }
}

impl Gathered {
    pub(super) fn new() -> Self {
        Self {
            offering: None,
            offers: FixedMap::with_hasher(fixed_state()),
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

    /// Takes what a plan offers to stand for all of its meshes.
    pub(super) fn offer(&mut self, site: SiteId, solids: impl FnOnce() -> Vec<Mesh>) {
        let shared = || solids().into_iter().map(SharedMesh::new).collect();
        self.offers.entry(site).or_insert_with(shared);
        self.offering = Some(site);
    }

    /// What a plan offers for one of its meshes: the first one takes everything. Nothing where it
    /// makes no offer.
    pub(super) fn offered(&mut self, site: SiteId) -> Option<Arc<[SharedMesh]>> {
        let solids = self.offers.get(&site)?;
        let is_first = self.offering.take_if(|offering| *offering == site).is_some();
        Some(if is_first { Arc::clone(solids) } else { Arc::default() })
    }

    /// Notes the place of the node, and gives its number; walks are told apart by their roots.
    pub(super) fn enter<S>(&mut self, at: &At<'_, S>) -> u32 {
        let path = at.path();
        if at.enters_plan() {
            if path.number() == 0 {
                self.root = self.above.len() as u32;
            }
            // A pruning does not visit what it drops: such places stand above themselves, and hold
            // nothing.
            let (next, place) = (self.above.len() as u32, self.root + path.number());
            self.above.extend(next..place);
            self.above.push(self.root + path.number_above());
        }
        self.root + path.number()
    }

    /// Takes solids in the place of a mesh.
    pub(super) fn replace(
        &mut self,
        mesh: &SharedMesh,
        solids: &[SharedMesh],
        material: &Arc<Material>,
        world: &Affine3,
        place: u32,
    ) {
        self.replaced.insert(Digest::of(mesh));
        self.add(solids, material, world, place);
    }

    /// Takes a mesh, if that is closed.
    pub(super) fn take_closed(
        &mut self,
        mesh: &SharedMesh,
        material: &Arc<Material>,
        world: &Affine3,
        place: u32,
    ) {
        if mesh.unsound().is_none() && !mesh.is_empty() && mesh.n_open_edges() == 0 {
            self.replace(mesh, std::slice::from_ref(mesh), material, world, place);
        }
    }

    fn add(
        &mut self,
        solids: &[SharedMesh],
        material: &Arc<Material>,
        world: &Affine3,
        place: u32,
    ) {
        let (materials, fresh) = (&mut self.materials, Digest::of(material));
        let number = *self.numbers.entry(fresh).or_insert_with(|| {
            materials.push(Arc::clone(material));
            materials.len() as u32 - 1
        });
        for solid in solids.iter().filter(|solid| !solid.is_empty()) {
            self.solids.push(PlacedSolid { shape: solid.clone(), world: *world });
            self.materials_of.push(number);
            self.places_of.push(place);
        }
    }
}
