//! Meshes: which are used, whether they are within the limits, and then their geometry.

use std::sync::Arc;

use sapwood_geom::{FixedMap, FixedSet, SharedMesh, fixed_state};
use sapwood_scene::HeldGeometry;

use super::ReadLimits;
use super::buffers::Buffers;
use super::document::{List, parsed};
use super::materials::Look;
use super::primitives::{Primitive, UvUse};
use super::schema;
use super::unfolding::{TRIANGLE, Unfolding, VERTEX};
use super::warnings::Warnings;
use crate::{Error, ErrorKind};

/// What the meshes of a model would take.
#[derive(Default)]
pub(super) struct Sizes {
    primitives: u64,
    vertices: u64,
    triangles: u64,
}

impl Sizes {
    /// Whether all of this may be read; tells at the place `at` what goes too far.
    fn check(&self, limits: &ReadLimits, at: &str) -> Result<(), Error> {
        let sizes = [
            (self.primitives, limits.nodes, "primitives in the meshes of the scene"),
            (self.vertices, limits.vertices, "vertices in the meshes of the scene"),
            (self.triangles, limits.triangles, "triangles in the meshes of the scene"),
        ];
        match sizes.into_iter().find(|(found, limit, _)| found > limit) {
            Some((found, limit, what)) => {
                let at = at.to_owned();
                Err(Error::new(ErrorKind::OverLimit { at, found, what, limit }))
            }
            None => Ok(()),
        }
    }
}

/// Looks at all meshes in `used` and notes their materials in `materials`, with `None` for the
/// standard's own, and where each was met first. Gives back how many parts each mesh has.
pub(super) fn look_at(
    buffers: &Buffers<'_>,
    used: &[usize],
    limits: &ReadLimits,
    mut unfolding: Unfolding,
    materials: &mut Vec<(Option<usize>, String)>,
    warnings: &mut Warnings,
) -> Result<Vec<u64>, Error> {
    let mut n_parts = vec![0; used.len()];
    let mut known = FixedSet::with_hasher(fixed_state());
    let mut sizes = Sizes::default();
    let mut seen: FixedMap<Option<usize>, ()> = FixedMap::with_hasher(fixed_state());
    each_primitive(buffers, used, warnings, |mesh, raw, primitive, at| {
        n_parts[mesh] += 1;
        if seen.insert(raw.material, ()).is_none() {
            materials.push((raw.material, format!("{at}.material")));
        }
        sizes.primitives += 1;
        // What is equal but for its material is most often read once.
        if known.insert((raw.attributes.clone(), raw.indices, raw.mode)) {
            sizes.vertices = sizes.vertices.saturating_add(primitive.n_vertices() as u64);
            sizes.triangles = sizes.triangles.saturating_add(primitive.n_triangles() as u64);
            take(&mut unfolding, primitive, at)?;
        }
        sizes.check(limits, at)
    })?;
    Ok(n_parts)
}

/// Counts what reading a primitive takes.
fn take(unfolding: &mut Unfolding, primitive: &Primitive<'_>, at: &str) -> Result<(), Error> {
    unfolding.take(primitive.n_vertices() as u64, VERTEX, at)?;
    unfolding.take(primitive.n_triangles() as u64, TRIANGLE, at)
}

/// Reads all meshes in `used`, in their order; what equal primitives draw is read once.
pub(super) fn read(
    buffers: &Buffers<'_>,
    used: &[usize],
    looks: &FixedMap<Option<usize>, Look>,
    unfolding: &mut Unfolding,
    warnings: &mut Warnings,
) -> Result<Vec<Vec<HeldGeometry>>, Error> {
    let mut meshes: Vec<Vec<HeldGeometry>> = Vec::new();
    meshes.resize_with(used.len(), Vec::new);
    let mut known: FixedMap<_, SharedMesh> = FixedMap::with_hasher(fixed_state());
    // They were told when the meshes were looked at.
    let mut told = Warnings::default();
    each_primitive(buffers, used, &mut told, |mesh, raw, primitive, at| {
        let Look { material, uv_use } = &looks[&raw.material];
        let UvUse { set, transform } = *uv_use;
        let attributes = &raw.attributes;
        let accessors = (attributes.positions, attributes.normals, attributes.uvs(set));
        let key = (accessors, raw.indices, raw.mode, transform.to_cols_array().map(f32::to_bits));
        let geometry = match known.get(&key) {
            Some(geometry) => geometry.clone(),
            None => {
                take(unfolding, primitive, at)?;
                let read = primitive.read(buffers, attributes, *uv_use, warnings)?;
                let geometry = SharedMesh::new(read);
                known.insert(key, geometry.clone());
                geometry
            }
        };
        meshes[mesh].push(HeldGeometry { mesh: geometry, material: Some(Arc::clone(material)) });
        Ok(())
    })?;
    Ok(meshes)
}

/// Hands every primitive with triangles of the meshes in `used` to `take`, with the place of its
/// mesh in `used`.
fn each_primitive<'b>(
    buffers: &'b Buffers<'_>,
    used: &[usize],
    warnings: &mut Warnings,
    mut take: impl FnMut(usize, &schema::Primitive, &Primitive<'b>, &str) -> Result<(), Error>,
) -> Result<(), Error> {
    for (place, index) in used.iter().enumerate() {
        let at = List::Meshes.entry(*index);
        let mesh: schema::Mesh<'_> = buffers.document.get(List::Meshes, *index, &at)?;
        for (number, raw) in mesh.primitives.0.into_iter().enumerate() {
            let at = format!("{at}.primitives[{number}]");
            let raw: schema::Primitive = parsed(raw, &at)?;
            if let Some(primitive) = Primitive::of(buffers, &raw, &at, warnings)? {
                take(place, &raw, &primitive, &at)?;
            }
        }
    }
    Ok(())
}
