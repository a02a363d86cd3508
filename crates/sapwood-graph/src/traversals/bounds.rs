//! Bounds of a fragment from the bounds of its children.
//!
//! Whoever supplies sites keeps the result with each of them, so that a bound is computed again
//! only where something below has changed.

use sapwood_geom::Bound;
use sapwood_geom::glam::Affine3;
use smallvec::SmallVec;

use crate::{Fragment, RenderNode};

/// The bound of a fragment and everything behind its links, in the fragment's own frame.
///
/// `child` tells the bound behind a link; where it knows none, nothing is known of the whole.
/// Costs the fragment's nodes and links, whatever the number of triangles.
pub fn fragment_bound(
    fragment: &Fragment,
    live: &[Affine3],
    mut child: impl FnMut(u32) -> Option<Bound>,
) -> Option<Bound> {
    let len = fragment.len();
    let mut bounds: SmallVec<[Bound; 8]> = smallvec::smallvec![Bound::EMPTY; len as usize];
    // Children stand behind their parents, so going backwards meets them first.
    for index in (0..len).rev() {
        let under = |bounds: &[Bound]| {
            let children = fragment.children(index).map(|child| bounds[child as usize]);
            children.fold(Bound::EMPTY, |all, each| all.union(&each))
        };
        bounds[index as usize] = match fragment.node(index) {
            RenderNode::Group
            | RenderNode::Fading(_)
            | RenderNode::Aspects(_)
            | RenderNode::Swaying(_) => under(&bounds),
            RenderNode::Transform(transform) => under(&bounds).transformed(transform),
            RenderNode::Live(value) => under(&bounds).transformed(&live[value as usize]),
            RenderNode::Facing(facing) => facing.bound_of(&under(&bounds)),
            RenderNode::Mesh { .. }
            | RenderNode::Instances { .. }
            | RenderNode::Lines(_)
            | RenderNode::Label(_) => fragment.drawn_bound(index)?,
            RenderNode::Light(_) | RenderNode::Camera(_) => Bound::EMPTY,
            RenderNode::Deferred(run) => {
                let mut all = Bound::EMPTY;
                for link in run.first..run.first + run.count {
                    all = all.union(&child(link)?);
                }
                all
            }
        };
    }
    Some(bounds[0])
}
