//! Solids: a body whose meshes are one closed surface is written as one that is known to be, by the
//! extension `EXT_mesh_manifold`.
//!
//! All its primitives share their vertices and one view of indices, and one more primitive, without
//! materials, tells which vertices at equal positions are one. Whoever does not know the extension
//! reads the same triangles.

use gltf_json as json;
use json::Index;
use json::accessor::{ComponentType, IndexComponentType};
use json::buffer::Target;
use json::validation::{Checked::Valid, USize64};
use sapwood_geom::glam::Vec3;
use sapwood_geom::{FixedMap, FixedSet, fixed_state};

use super::buffer::{BufferBuilder, VERTEX, index_size};
use crate::parts::Part;

/// The extension's name.
pub(super) const NAME: &str = "EXT_mesh_manifold";

/// How a body's primitives are one surface.
pub(super) struct Manifold {
    n_vertices: u64,
    n_indices: u64,
    /// Places in the list of all indices where the surface has another vertex, and that one.
    merges: Vec<(u32, u32)>,
}

impl Manifold {
    /// The surface of a body's parts; nothing where there are none, or where they are not closed:
    /// where an edge has not exactly two triangles, of opposite directions.
    pub(super) fn of(parts: &[Part<'_>]) -> Option<Self> {
        if parts.is_empty() {
            return None;
        }
        let sizes = parts.iter().map(Part::size);
        let (n_vertices, n_indices) =
            sizes.fold((0, 0), |all, (vertices, indices)| (all.0 + vertices, all.1 + indices));
        // Numbers are 32 bits long, and the greatest restarts primitives.
        if n_vertices.max(n_indices) >= u64::from(u32::MAX) || !parts.iter().all(Part::is_triangles)
        {
            return None;
        }
        let mut firsts: FixedMap<[u32; 3], u32> = FixedMap::with_hasher(fixed_state());
        let mut surface = Vec::with_capacity(n_indices as usize);
        let (mut merges, mut vertex) = (Vec::new(), 0);
        for part in parts {
            part.each_mesh(|mesh| {
                let first_of = |(number, point): (u32, &Vec3)| {
                    let key = (*point + 0.0).to_array().map(f32::to_bits);
                    *firsts.entry(key).or_insert(number)
                };
                let ones: Vec<u32> = (vertex..).zip(&mesh.positions).map(first_of).collect();
                for index in &mesh.indices {
                    let one = *ones.get(*index as usize).ok_or(())?;
                    if one != vertex + index {
                        merges.push((surface.len() as u32, one));
                    }
                    surface.push(one);
                }
                vertex += mesh.positions.len() as u32;
                Ok::<_, ()>(())
            })
            .ok()?;
        }
        is_closed(&surface).then_some(Self { n_vertices, n_indices, merges })
    }

    /// Bytes that the body takes in the binary chunk.
    pub(super) fn byte_length(&self) -> u64 {
        let size = index_size(self.n_vertices);
        let n = self.merges.len() as u64;
        VERTEX as u64 * self.n_vertices
            + (self.n_indices * size).next_multiple_of(4)
            + 4 * n
            + (n * size).next_multiple_of(4)
    }
}

/// Whether every edge has two triangles of opposite directions, and no more.
fn is_closed(surface: &[u32]) -> bool {
    let sides = || {
        let triangles = surface.chunks_exact(3);
        triangles.flat_map(|t| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])])
    };
    let mut edges = FixedSet::with_capacity_and_hasher(surface.len(), fixed_state());
    sides().all(|(from, to)| from != to && edges.insert((from, to)))
        && sides().all(|(from, to)| edges.contains(&(to, from)))
}

/// What a body that is one surface became.
pub(super) struct Written {
    /// The accessors of positions, normals and texture coordinates, which all primitives share.
    pub(super) attributes: [Index<json::Accessor>; 3],
    /// The indices of each part.
    pub(super) indices: Vec<Index<json::Accessor>>,
    /// What the extension says of the mesh.
    pub(super) extension: json::Value,
}

impl BufferBuilder {
    /// Adds the vertices and triangles of parts that are one surface; the error says what glTF does
    /// not allow.
    pub(super) fn add_manifold(
        &mut self,
        root: &mut json::Root,
        parts: &[Part<'_>],
        manifold: &Manifold,
    ) -> Result<Written, String> {
        let size = index_size(manifold.n_vertices) as usize;
        let attributes = self.add_vertices(root, parts, manifold.n_vertices as usize)?;
        let (mut numbers, mut vertex) = (Vec::with_capacity(manifold.n_indices as usize), 0);
        for part in parts {
            part.each_mesh(|mesh| {
                numbers.extend(mesh.indices.iter().map(|index| vertex + index));
                vertex += mesh.positions.len() as u32;
                Ok::<_, String>(())
            })?;
        }
        let whole = self.add_numbers(root, size, Some(Target::ElementArrayBuffer), &numbers);
        // Each part has its share of the view, and the whole surface all of it.
        let mut indices = Vec::with_capacity(parts.len());
        let mut start = 0;
        for part in parts {
            let n = part.size().1 as usize;
            let own = json::Accessor {
                byte_offset: (start > 0).then(|| USize64::from(start * size)),
                count: USize64::from(n),
                ..root.accessors[whole.value()].clone()
            };
            indices.push(root.push(own));
            start += n;
        }
        let mut extension = serde_json::json!({
            "manifoldPrimitive": {
                "attributes": { "POSITION": attributes[0].value() },
                "indices": whole.value(),
                "mode": 4,
            },
        });
        let Manifold { merges, .. } = manifold;
        if !merges.is_empty() {
            let (places, ones): (Vec<u32>, Vec<u32>) = merges.iter().copied().unzip();
            let at = self.add_numbers(root, 4, None, &places);
            let ones = self.add_numbers(root, size, None, &ones);
            let view = |accessor: Index<json::Accessor>, root: &json::Root| {
                root.accessors[accessor.value()].buffer_view.expect("it was made with a view")
            };
            let (indices, values) = (view(at, root), view(ones, root));
            root.accessors[whole.value()].sparse = Some(json::accessor::sparse::Sparse {
                count: USize64::from(merges.len()),
                indices: json::accessor::sparse::Indices {
                    buffer_view: indices,
                    byte_offset: USize64(0),
                    component_type: Valid(IndexComponentType(ComponentType::U32)),
                    extensions: None,
                    extras: None,
                },
                values: json::accessor::sparse::Values {
                    buffer_view: values,
                    byte_offset: USize64(0),
                    extensions: None,
                    extras: None,
                },
                extensions: None,
                extras: None,
            });
            extension["mergeIndices"] = at.value().into();
            extension["mergeValues"] = ones.value().into();
        }
        Ok(Written { attributes, indices, extension })
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use sapwood_geom::glam::Affine3;
    use sapwood_geom::{Mesh, SharedMesh};
    use sapwood_graph::{Body, DrawList, DrawRow, Kind, Material, Named, Occurrence};
    use sapwood_rules::weber_penn::{LeafShape, leaf_mesh};

    use super::*;
    use crate::gltf::document::Document;

    struct Solid;

    impl Named for Solid {
        const NAME: &'static str = "solid";
    }

    fn ball() -> Mesh {
        leaf_mesh(LeafShape::Sphere)
    }

    /// A ball in two materials with vertices of their own, without the first triangles of each.
    fn list(is_solid: bool, n_left_out: usize) -> DrawList {
        let half = |is_first: bool| {
            let triangles = ball().indices;
            let (one, other) = triangles.split_at(triangles.len() / 2);
            let indices = if is_first { one } else { other };
            Mesh { indices: indices[3 * n_left_out..].to_vec(), ..ball() }
        };
        let mut body = Body::new(Kind::of::<Solid>());
        for (is_first, name) in [(true, "snow"), (false, "earth")] {
            let material = Arc::new(Material::matte(name, 0.5, 0.5, 0.5));
            let (local, mesh) = (Affine3::IDENTITY, SharedMesh::new(half(is_first)));
            body.rows.push(DrawRow::new(local, mesh, material));
        }
        body.is_solid = is_solid;
        let occurrences = vec![Occurrence { body: 0, world: Affine3::IDENTITY }];
        DrawList { bodies: vec![body], occurrences }
    }

    /// The numbers of an accessor, with those that are sparse.
    fn numbers(document: &Document, index: usize) -> Vec<u32> {
        let bin = document.bin.as_deref().unwrap();
        let of_view = |view: usize, offset: u64, n: usize, size: usize| -> Vec<u32> {
            let start = document.root.buffer_views[view].byte_offset.map_or(0, |o| o.0) + offset;
            let bytes = &bin[start as usize..][..n * size];
            let whole = |b: &[u8]| b.iter().rev().fold(0, |n, byte| n << 8 | u32::from(*byte));
            bytes.chunks_exact(size).map(whole).collect()
        };
        let accessor = &document.root.accessors[index];
        let size = match accessor.component_type {
            Valid(json::accessor::GenericComponentType(ComponentType::U16)) => 2,
            _ => 4,
        };
        let (n, offset) = (accessor.count.0 as usize, accessor.byte_offset.map_or(0, |o| o.0));
        let mut found = of_view(accessor.buffer_view.unwrap().value(), offset, n, size);
        if let Some(sparse) = &accessor.sparse {
            let n = sparse.count.0 as usize;
            let places = of_view(sparse.indices.buffer_view.value(), 0, n, 4);
            let ones = of_view(sparse.values.buffer_view.value(), 0, n, size);
            assert!(places.is_sorted_by(|a, b| a < b));
            places.iter().zip(ones).for_each(|(at, one)| found[*at as usize] = one);
        }
        found
    }

    #[test]
    fn a_solid_of_several_materials_is_known_as_one_surface() {
        let document = Document::of(&list(true, 0)).unwrap();
        let mesh = serde_json::to_value(&document.root.meshes[0]).unwrap();
        let extension = &mesh["extensions"][NAME];
        let whole = extension["manifoldPrimitive"]["indices"].as_u64().unwrap() as usize;
        let surface = numbers(&document, whole);
        assert!(is_closed(&surface));
        assert_eq!(surface.len(), ball().indices.len());
        // What merges is told once more, for whoever does not look into accessors.
        let sparse = document.root.accessors[whole].sparse.as_ref().unwrap();
        for (name, view) in [
            ("mergeIndices", sparse.indices.buffer_view),
            ("mergeValues", sparse.values.buffer_view),
        ] {
            let told = &document.root.accessors[extension[name].as_u64().unwrap() as usize];
            assert_eq!((told.buffer_view, told.count), (Some(view), sparse.count), "{name}");
        }
        let primitives = &document.root.meshes[0].primitives;
        assert_eq!(primitives.len(), 2);
        assert_eq!(primitives[0].attributes, primitives[1].attributes);
        let position = primitives[0].attributes[&Valid(json::mesh::Semantic::Positions)].value();
        assert_eq!(extension["manifoldPrimitive"]["attributes"]["POSITION"], position);
        let own: Vec<u32> = primitives
            .iter()
            .flat_map(|primitive| numbers(&document, primitive.indices.unwrap().value()))
            .collect();
        assert!(!is_closed(&own) && own.len() == surface.len());
        assert_eq!(document.root.extensions_used, [NAME]);
        assert!(document.root.extensions_required.is_empty());
    }

    #[test]
    fn what_is_open_or_said_to_be_no_solid_is_written_as_everything_else() {
        for (is_solid, n_left_out) in [(true, 1), (false, 0)] {
            let list = list(is_solid, n_left_out);
            let document = Document::of(&list).unwrap();
            assert!(document.root.extensions_used.is_empty());
            assert!(document.root.meshes[0].extensions.is_none());
        }
    }

    #[test]
    fn a_solid_of_no_triangles_has_no_mesh() {
        for mut list in [list(true, 0), list(true, ball().n_triangles() / 2)] {
            if list.bodies[0].rows.iter().all(|row| !row.mesh.is_empty()) {
                list.bodies[0].rows.clear();
            }
            let document = Document::of(&list).unwrap();
            assert!(document.root.meshes.is_empty() && document.root.accessors.is_empty());
            assert!(document.root.extensions_used.is_empty());
        }
    }

    #[test]
    fn only_edges_with_two_triangles_of_opposite_directions_are_closed() {
        let tetrahedron = [0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3];
        assert!(is_closed(&tetrahedron) && is_closed(&[]));
        assert!(!is_closed(&tetrahedron[3..]));
        assert!(!is_closed(&[tetrahedron, tetrahedron].concat()));
        assert!(!is_closed(&[0, 1, 2, 0, 1, 2]) && !is_closed(&[0, 0, 1, 1, 0, 0]));
        assert!(is_closed(&[0, 1, 2, 2, 1, 0]));
    }
}
