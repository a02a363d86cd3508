//! Meshes: which are used, whether they are within the limits, and then their geometry.

use std::sync::Arc;

use sapwood_geom::{FixedMap, SharedMesh, fixed_state};
use sapwood_scene::HeldGeometry;

use super::ReadLimits;
use super::buffers::Buffers;
use super::document::{List, parsed};
use super::materials::Look;
use super::primitives::{Primitive, UvUse};
use super::schema;
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
/// standard's own, and where each was met first.
pub(super) fn look_at(
    buffers: &Buffers<'_>,
    used: &[usize],
    limits: &ReadLimits,
    materials: &mut Vec<(Option<usize>, String)>,
    warnings: &mut Warnings,
) -> Result<(), Error> {
    let mut sizes = Sizes::default();
    let mut seen: FixedMap<Option<usize>, ()> = FixedMap::with_hasher(fixed_state());
    each_primitive(buffers, used, warnings, |_, raw, primitive, at| {
        if seen.insert(raw.material, ()).is_none() {
            materials.push((raw.material, format!("{at}.material")));
        }
        sizes.primitives += 1;
        sizes.vertices = sizes.vertices.saturating_add(primitive.n_vertices() as u64);
        sizes.triangles = sizes.triangles.saturating_add(primitive.n_triangles() as u64);
        sizes.check(limits, at)
    })
}

/// Reads all meshes in `used`, in their order; what equal primitives draw is read once.
pub(super) fn read(
    buffers: &Buffers<'_>,
    used: &[usize],
    looks: &FixedMap<Option<usize>, Look>,
    warnings: &mut Warnings,
) -> Result<Vec<Vec<HeldGeometry>>, Error> {
    let mut meshes: Vec<Vec<HeldGeometry>> = Vec::new();
    meshes.resize_with(used.len(), Vec::new);
    let mut known: FixedMap<_, SharedMesh> = FixedMap::with_hasher(fixed_state());
    // They were told when the meshes were looked at.
    let mut told = Warnings::default();
    each_primitive(buffers, used, &mut told, |mesh, raw, primitive, _| {
        let Look { material, uv_use } = &looks[&raw.material];
        let UvUse { set, transform } = *uv_use;
        let attributes = &raw.attributes;
        let accessors = (attributes.positions, attributes.normals, attributes.uvs(set));
        let key = (accessors, raw.indices, raw.mode, transform.to_cols_array().map(f32::to_bits));
        let geometry = match known.get(&key) {
            Some(geometry) => geometry.clone(),
            None => {
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
