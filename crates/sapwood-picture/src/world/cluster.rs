//! Clusters: things in one frame, and the tree over them.

use sapwood_geom::glam::Affine3;
use sapwood_geom::{Aabb, BoxTree};

use super::{LinePiece, World};

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

/// A thing that a ray may meet.
pub(crate) enum Item {
    /// A mesh.
    Surface {
        /// Its number.
        surface: u32,
        /// From the cluster's frame to its own.
        to_local: Affine3,
    },
    /// A straight piece of a line.
    Line(LinePiece),
    /// Another cluster.
    Cluster {
        /// Its number.
        cluster: u32,
        /// From this cluster's frame to its own.
        to_local: Affine3,
    },
    /// The number of a link that is not filled.
    Waiting(u32),
    /// What turned out to draw nothing.
    Nothing,
}

impl Cluster {
    pub(super) fn new(above: Option<u32>) -> Self {
        Self { items: Vec::new(), tree: BoxTree::new([]), aabb: Aabb::EMPTY, above }
    }

    /// The boxes of all items in the cluster's frame.
    pub(super) fn boxes(&self, world: &World) -> Vec<Aabb> {
        let boxes = self.items.iter().map(|item| match item {
            Item::Surface { surface, to_local, .. } => {
                let bound = world.surfaces[*surface as usize].mesh.bound();
                bound.transformed(&to_local.inverse()).aabb
            }
            Item::Line(piece) => piece.aabb(),
            Item::Cluster { cluster, to_local } => {
                world.clusters[*cluster as usize].aabb.transformed(&to_local.inverse())
            }
            Item::Waiting(wait) => world.waits[*wait as usize].bound.aabb,
            Item::Nothing => Aabb::EMPTY,
        });
        boxes.collect()
    }

    pub(super) fn set_tree(&mut self, boxes: &[Aabb]) {
        self.aabb = boxes.iter().copied().fold(Aabb::EMPTY, Aabb::union);
        self.tree = BoxTree::of_dear_things(boxes.iter().copied());
    }
}
