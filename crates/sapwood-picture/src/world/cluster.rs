//! Clusters: things in one frame, and the tree over them.

use sapwood_geom::glam::Affine3;
use sapwood_geom::{Aabb, BoxTree};

use super::World;

/// Things in one frame.
pub(crate) struct Cluster {
    pub(crate) items: Vec<Item>,
    /// Over the boxes of all items.
    pub(crate) tree: BoxTree,
    /// Around all items.
    pub(crate) aabb: Aabb,
    /// The cluster that holds this one, where that is one alone.
    pub(super) above: Option<u32>,
}

/// A thing that a ray may meet. Small, so that many fit into a processor's caches.
#[derive(Clone, Copy)]
pub(crate) enum Item {
    /// A few triangles of a mesh.
    Triangles {
        /// The number of the mesh's place.
        place: u32,
        /// Their first pack.
        first: u32,
        /// How many packs they fill.
        n_packs: u8,
    },
    /// A mesh with many triangles, by the number of its place.
    Surface(u32),
    /// A straight piece of a line, by its number.
    Line(u32),
    /// Another cluster, by the number of its place.
    Cluster(u32),
    /// The number of a link that is not filled.
    Waiting(u32),
    /// What turned out to draw nothing.
    Nothing,
}

/// Where a surface or a cluster stands in the cluster that holds it.
pub(crate) struct Place {
    /// From the frame of the cluster that holds it to its own.
    pub(crate) to_local: Affine3,
    /// The number of the surface or of the cluster.
    pub(crate) number: u32,
}

impl Cluster {
    pub(super) fn new(above: Option<u32>) -> Self {
        Self { items: Vec::new(), tree: BoxTree::new([]), aabb: Aabb::EMPTY, above }
    }

    /// The boxes of all items in the cluster's frame.
    pub(super) fn boxes(&self, world: &World) -> Vec<Aabb> {
        let place = |place: u32| {
            let Place { to_local, number } = &world.places[place as usize];
            (to_local.inverse(), *number as usize)
        };
        let boxes = self.items.iter().map(|item| match *item {
            Item::Triangles { place: at, first, n_packs } => {
                let (frame, _) = place(at);
                let packs = world.packs.of(first, n_packs).iter();
                packs.map(|pack| pack.aabb(&frame)).fold(Aabb::EMPTY, Aabb::union)
            }
            Item::Surface(at) => {
                let (frame, surface) = place(at);
                world.surfaces[surface].mesh.bound().transformed(&frame).aabb
            }
            Item::Line(piece) => world.lines[piece as usize].aabb(),
            Item::Cluster(at) => {
                let (frame, cluster) = place(at);
                world.clusters[cluster].aabb.transformed(&frame)
            }
            Item::Waiting(wait) => world.waits[wait as usize].bound.aabb,
            Item::Nothing => Aabb::EMPTY,
        });
        boxes.collect()
    }

    pub(super) fn set_tree(&mut self, boxes: &[Aabb]) {
        self.aabb = boxes.iter().copied().fold(Aabb::EMPTY, Aabb::union);
        self.tree = BoxTree::of_dear_things(boxes.iter().copied());
    }
}
