//! Nodes of four boxes, so that a ray meets or misses four in one go.

use std::ops::Range;

use glam::Vec3;
use obvhs::bvh2::node::Bvh2Node;
use smallvec::SmallVec;
use wide::f32x4;

use crate::{Aabb, Ray32};

/// Boxes that a node holds.
pub(super) const WIDTH: usize = 4;

/// Set in a child that is a leaf: the place of its first item and, below, how many it has.
const LEAF: u32 = 1 << 31;

/// Bits that tell how many items a leaf has.
const COUNT_BITS: u32 = 3;

/// Things that a tree may hold at most.
pub(super) const MOST_ITEMS: usize = 1 << (31 - COUNT_BITS);

/// Four boxes, and what is in them. Boxes that are missing are empty: no ray enters them.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(super) struct WideNode {
    /// For each axis the least coordinates, then for each axis the largest.
    sides: [f32x4; 6],
    children: [u32; WIDTH],
}

/// Four boxes where those of the two-box tree below a node are largest, and so on downwards. The
/// first node is the root's.
pub(super) fn widened(nodes: &[Bvh2Node]) -> Vec<WideNode> {
    let mut wide = vec![WideNode::EMPTY];
    let mut todo = vec![(0, 0)];
    while let Some((from, to)) = todo.pop() {
        let mut boxes: SmallVec<[u32; WIDTH]> = SmallVec::new();
        boxes.push(from);
        while boxes.len() < WIDTH {
            let inner = boxes.iter().enumerate().filter(|(_, i)| !nodes[**i as usize].is_leaf());
            let area = |node: u32| nodes[node as usize].aabb().half_area();
            let Some((largest, _)) = inner.max_by(|a, b| area(*a.1).total_cmp(&area(*b.1))) else {
                break;
            };
            let first = nodes[boxes[largest] as usize].first_index;
            boxes[largest] = first;
            boxes.push(first + 1);
        }
        for (lane, from) in boxes.into_iter().enumerate() {
            let node = &nodes[from as usize];
            let child = if node.is_leaf() {
                LEAF | node.first_index << COUNT_BITS | node.prim_count
            } else {
                todo.push((from, wide.len()));
                wide.push(WideNode::EMPTY);
                wide.len() as u32 - 1
            };
            wide[to].set(lane, node, child);
        }
    }
    wide
}

impl WideNode {
    const EMPTY: Self = {
        let least = f32x4::new([f32::INFINITY; WIDTH]);
        let largest = f32x4::new([f32::NEG_INFINITY; WIDTH]);
        let sides = [least, least, least, largest, largest, largest];
        Self { sides, children: [0; WIDTH] }
    };

    fn set(&mut self, lane: usize, node: &Bvh2Node, child: u32) {
        for axis in 0..3 {
            self.sides[axis].as_mut_array()[lane] = node.min[axis];
            self.sides[3 + axis].as_mut_array()[lane] = node.max[axis];
        }
        self.children[lane] = child;
    }

    /// The box at one of the four places.
    pub(super) fn aabb(&self, lane: usize) -> Aabb {
        let side = |i: usize| self.sides[i].as_array()[lane];
        let [min, max] = [0, 3].map(|i| Vec3::new(side(i), side(i + 1), side(i + 2)));
        Aabb { min, max }
    }

    /// What is in the box at one of the four places.
    pub(super) fn child(&self, lane: usize) -> Child {
        let child = self.children[lane];
        if child & LEAF != 0 {
            let (first, count) = items(child);
            Child::Items(first as usize..(first + count) as usize)
        } else if child == 0 {
            // The first node is the root and below no other.
            Child::Nothing
        } else {
            Child::Node(child)
        }
    }

    /// The places of the things of every leaf in it.
    pub(super) fn leaves(&self) -> impl Iterator<Item = Range<usize>> {
        (0..WIDTH).filter_map(|lane| match self.child(lane) {
            Child::Items(places) => Some(places),
            Child::Node(_) | Child::Nothing => None,
        })
    }
}

/// What is in one of a node's boxes.
pub(super) enum Child {
    Nothing,
    Node(u32),
    /// The places of things in the order of the tree's leaves.
    Items(Range<usize>),
}

/// The place of a leaf's first item, and how many it has.
#[inline]
fn items(leaf: u32) -> (u32, u32) {
    ((leaf & !LEAF) >> COUNT_BITS, leaf & ((1 << COUNT_BITS) - 1))
}

/// Calls `each` with the place of every item in whose leaf's box the ray is before `reach`, roughly
/// from near to far. `each` tells how far the ray reaches from then on; below zero ends it.
#[inline]
pub(super) fn along(
    nodes: &[WideNode],
    ray: &Ray32,
    mut reach: f32,
    mut each: impl FnMut(u32) -> f32,
) {
    let inverse = ray.inverse().to_array();
    let origins = ray.origin.to_array().map(f32x4::splat);
    let inverses = inverse.map(f32x4::splat);
    // Where the ray goes down an axis, it enters by the larger side.
    let enters_by = [0, 1, 2].map(|axis| if inverse[axis] < 0.0 { 3 + axis } else { axis });
    let leaves_by = [0, 1, 2].map(|axis| if inverse[axis] < 0.0 { axis } else { 3 + axis });
    // Deep enough for any tree that is not made to be deep; else it goes on elsewhere.
    let mut stack: SmallVec<[(u32, f32); 64]> = SmallVec::new();
    stack.push((0, 0.0));
    while let Some((child, distance)) = stack.pop() {
        if distance > reach {
            continue;
        }
        if child & LEAF != 0 {
            let (first, count) = items(child);
            for place in first..first + count {
                reach = each(place);
            }
            continue;
        }
        let node = &nodes[child as usize];
        let (mut enters, mut leaves) = (f32x4::ZERO, f32x4::splat(reach));
        for axis in 0..3 {
            let (near, far) = (node.sides[enters_by[axis]], node.sides[leaves_by[axis]]);
            enters = enters.fast_max((near - origins[axis]) * inverses[axis]);
            leaves = leaves.fast_min((far - origins[axis]) * inverses[axis]);
        }
        let is_met = enters.simd_le(leaves).to_bitmask();
        let enters = enters.to_array();
        let bottom = stack.len();
        for (lane, (child, enters)) in node.children.into_iter().zip(enters).enumerate() {
            if is_met >> lane & 1 != 0 {
                stack.push((child, enters));
            }
        }
        // The nearest last, for the stack gives back the last first.
        let found = &mut stack[bottom..];
        for i in 1..found.len() {
            let mut j = i;
            while j > 0 && found[j - 1].1 < found[j].1 {
                found.swap(j - 1, j);
                j -= 1;
            }
        }
    }
}

/// Calls `each` with the place of every item in whose leaf's box something of the box is.
pub(super) fn within(nodes: &[WideNode], aabb: &Aabb, mut each: impl FnMut(u32)) {
    let (min, max) = (aabb.min.to_array().map(f32x4::splat), aabb.max.to_array().map(f32x4::splat));
    let mut stack: SmallVec<[u32; 64]> = SmallVec::new();
    stack.push(0);
    while let Some(child) = stack.pop() {
        if child & LEAF != 0 {
            let (first, count) = ((child & !LEAF) >> COUNT_BITS, child & ((1 << COUNT_BITS) - 1));
            (first..first + count).for_each(&mut each);
            continue;
        }
        let node = &nodes[child as usize];
        let mut is_met = 0xf;
        for axis in 0..3 {
            is_met &= node.sides[axis].simd_le(max[axis]).to_bitmask();
            is_met &= node.sides[3 + axis].simd_ge(min[axis]).to_bitmask();
        }
        for (lane, child) in node.children.into_iter().enumerate() {
            if is_met >> lane & 1 != 0 {
                stack.push(child);
            }
        }
    }
}
