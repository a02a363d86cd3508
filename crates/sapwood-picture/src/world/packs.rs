//! Meshes that lie in the trees of clusters triangle by triangle.
//!
//! A tree of its own for each mesh costs a ray many jumps through memory, and the box of a twig
//! overlaps those of all its leaves. So a mesh lies in its cluster's tree by groups of a few
//! neighbouring triangles where it stands alone, unless it is so large that its own tree is as
//! good; and one of very few triangles lies there wherever it stands. Triangles stay in the frame
//! of their mesh, where a ray meets them at the same distance in both ways, bit by bit.

use sapwood_geom::{FixedMap, SharedMesh, TrianglePack, fixed_state};

use super::Item;

/// Up to so many triangles are looked at one after the other, wherever a mesh stands.
const FEW: usize = 8;

/// Meshes of more triangles keep to their own trees.
const MANY: usize = 4096;

/// The triangles of meshes in packs.
pub(crate) struct Packs {
    packs: Vec<TrianglePack>,
    /// The first pack of a mesh, and how many there are, by where it lies in memory: the world
    /// holds it, so that no other one comes to lie there.
    of_mesh: FixedMap<usize, (u32, u32)>,
}

impl Default for Packs {
    fn default() -> Self {
        Self { packs: Vec::new(), of_mesh: FixedMap::with_hasher(fixed_state()) }
    }
}

impl Packs {
    /// The packs of one item.
    #[inline]
    pub(crate) fn of(&self, first: u32, n_packs: u8) -> &[TrianglePack] {
        &self.packs[first as usize..][..usize::from(n_packs)]
    }

    /// Adds what stands for a mesh at a place. `alone` tells that the mesh is not about to be added
    /// at others; that it was before is known here.
    pub(super) fn put(
        &mut self,
        mesh: &SharedMesh,
        place: u32,
        alone: bool,
        items: &mut Vec<Item>,
    ) {
        let (n_triangles, address) = (mesh.n_triangles(), std::ptr::from_ref(&**mesh).addr());
        let known = self.of_mesh.get(&address).copied();
        let is_few = n_triangles <= FEW;
        if !is_few && (!alone || known.is_some() || n_triangles > MANY) {
            items.push(Item::Surface(place));
            return;
        }
        let (first, n) = known.unwrap_or_else(|| {
            let first = self.packs.len();
            let groups = mesh.bvh().groups();
            self.packs.extend(groups.flat_map(|group| TrianglePack::of(mesh, group)));
            let added = (first as u32, (self.packs.len() - first) as u32);
            self.of_mesh.insert(address, added);
            added
        });
        // Those of one place share what it takes to get there.
        let size = if is_few { n.max(1) } else { 1 };
        let firsts = (first..first + n).step_by(size as usize);
        items.extend(firsts.map(|first| Item::Triangles { place, first, n_packs: size as u8 }));
    }
}

#[cfg(test)]
mod tests {
    use sapwood_geom::Mesh;
    use sapwood_geom::glam::Vec3;

    use super::*;

    /// So many triangles in a row.
    fn row(n: u32) -> SharedMesh {
        let mut mesh = Mesh::default();
        for i in 0..n {
            let corner = Vec3::X * i as f32;
            mesh.positions.extend([corner, corner + Vec3::Y, corner + Vec3::Z]);
            mesh.indices.extend(3 * i..3 * i + 3);
        }
        SharedMesh::new(mesh)
    }

    fn put(packs: &mut Packs, mesh: &SharedMesh, alone: bool) -> Vec<Item> {
        let mut items = Vec::new();
        packs.put(mesh, 7, alone, &mut items);
        items
    }

    #[test]
    fn what_stands_alone_lies_open_and_copies_of_it_do_not() {
        let (mut packs, mesh) = (Packs::default(), row(40));
        let items = put(&mut packs, &mesh, true);
        assert!((10..=40).contains(&items.len()) && items.len() == packs.packs.len());
        let is_one = |item: &Item| matches!(item, Item::Triangles { place: 7, n_packs: 1, .. });
        assert!(items.iter().all(is_one));
        assert!(matches!(put(&mut packs, &mesh, true)[..], [Item::Surface(7)]));
        assert!(matches!(put(&mut packs, &row(40), false)[..], [Item::Surface(7)]));
        let many = row(MANY as u32 + 1);
        assert!(matches!(put(&mut packs, &many, true)[..], [Item::Surface(7)]));
    }

    #[test]
    fn few_triangles_lie_open_wherever_they_stand_and_are_packed_once() {
        let (mut packs, mesh) = (Packs::default(), row(6));
        for _ in 0..3 {
            let items = put(&mut packs, &mesh, false);
            assert!(matches!(items[..], [Item::Triangles { first: 0, n_packs: 2, .. }]));
        }
        assert_eq!(packs.packs.len(), 2);
    }
}
