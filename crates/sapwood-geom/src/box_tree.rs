//! Trees of boxes, to find the few of many things that a ray may meet.
//!
//! Building them is the work of the crate `obvhs`; going along a ray is done here, so that no
//! depth of tree overflows a stack, and so that what is met does not depend on the tree's shape.

mod descend;
mod wide;

use glam::Vec3A;
use obvhs::bvh2::{leaf_collapser, reinsertion::ReinsertionOptimizer};
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

use crate::{Aabb, Ray, Ray32};
use wide::{MOST_ITEMS, WideNode, along, widened, within};

/// Up to so many things are looked at one by one.
const FEW: usize = 8;

/// A tree over the boxes of things that have numbers from 0 on.
pub struct BoxTree {
    /// The box around all; empty where there is no thing with a box.
    all: Aabb,
    /// Empty where there are few things.
    nodes: Vec<WideNode>,
    /// The numbers of things, in the order of the tree's leaves.
    items: Vec<u32>,
}

impl BoxTree {
    /// A tree over `boxes`; those that are empty or not finite are left out.
    ///
    /// # Panics
    /// When there are more than 2^28 of them.
    pub fn new(boxes: impl IntoIterator<Item = Aabb>) -> Self {
        Self::with_leaves_of(FEW, boxes)
    }

    /// As [`new`](Self::new), for things that are dear to look at: each has a box of its own in
    /// the tree.
    ///
    /// # Panics
    /// When there are more than 2^28 of them.
    pub fn of_dear_things(boxes: impl IntoIterator<Item = Aabb>) -> Self {
        Self::with_leaves_of(1, boxes)
    }

    /// A tree whose leaves hold up to so many things where that pays.
    fn with_leaves_of(most: usize, boxes: impl IntoIterator<Item = Aabb>) -> Self {
        let mut items = Vec::new();
        let mut grown = Vec::new();
        let mut all = Aabb::EMPTY;
        for (item, aabb) in boxes.into_iter().enumerate() {
            if aabb.min.is_finite() && aabb.max.is_finite() && !aabb.is_empty() {
                items.push(item as u32);
                grown.push(aabb);
                all = all.union(aabb);
            }
        }
        if items.len() <= most {
            return Self { all, nodes: Vec::new(), items };
        }
        // Whoever goes along a ray rounds to `f32`, somewhere inside the whole. Not all by the
        // same: the builder pairs neighbours that suit each other best, and takes quadratic time
        // where all suit each other alike, as evenly spaced or equal things do.
        let slack = 1e-6 * all.min.abs().max(all.max.abs()).max_element();
        let grown: Vec<_> = grown
            .iter()
            .enumerate()
            .map(|(number, aabb)| {
                let uneven = (number as u32).wrapping_mul(0x9e37_79b9) >> 16;
                let slack = Vec3A::splat(slack * (1.0 + uneven as f32 / 8192.0));
                let (min, max) = (Vec3A::from(aabb.min), Vec3A::from(aabb.max));
                obvhs::aabb::Aabb::new(min - slack, max + slack)
            })
            .collect();
        assert!(items.len() <= MOST_ITEMS, "a tree holds up to {MOST_ITEMS} things");
        let numbers = (0..items.len() as u32).collect();
        let mut tree = PlocBuilder::with_capacity(items.len()).build(
            PlocSearchDistance::Low,
            &grown,
            numbers,
            SortPrecision::U64,
            2,
        );
        ReinsertionOptimizer::default().run(&mut tree, 0.02, None);
        leaf_collapser::collapse(&mut tree, most.div_ceil(2) as u32, 3.0);
        let items = tree.primitive_indices.iter().map(|number| items[*number as usize]).collect();
        Self { all, nodes: widened(&tree.nodes), items }
    }

    /// The numbers of all things that have a box, those together that lie together.
    pub fn leaves(&self) -> impl Iterator<Item = &[u32]> {
        let few = self.nodes.is_empty() && !self.items.is_empty();
        let of_nodes = self.nodes.iter().flat_map(WideNode::leaves);
        few.then_some(&self.items[..]).into_iter().chain(of_nodes.map(|run| &self.items[run]))
    }

    /// Calls `each` for the number of every thing whose box the ray meets nearer than `reach`, and
    /// of a few more, roughly from near to far. `each` tells how far the ray reaches from then
    /// on.
    pub fn along(&self, ray: &Ray, mut reach: f64, mut each: impl FnMut(u32) -> f64) {
        let Some([enters, _]) = ray.through(&self.all) else { return };
        if self.nodes.is_empty() {
            for item in &self.items {
                each(*item);
            }
            return;
        }
        // From where it enters the whole, and with unit length, the ray fits in `f32`.
        let length = ray.direction().length();
        let near = ray.at(enters).as_vec3();
        let direction = (ray.direction() / length).as_vec3();
        if !(near.is_finite() && direction.is_finite()) {
            return;
        }
        // The slack that the boxes were grown by also covers what `reach` is rounded by.
        let until = |reach: f64| ((reach - enters) * length * (1.0 + 1e-6)) as f32;
        let short = Ray32::new(near, direction);
        along(&self.nodes, &short, until(reach), |place| {
            reach = each(self.items[place as usize]);
            until(reach)
        });
    }
}

/// Looking into boxes.
impl BoxTree {
    /// Calls `each` for the number of every thing whose box meets `aabb`, and of a few more, in no
    /// order that means anything.
    pub fn within(&self, aabb: &Aabb, mut each: impl FnMut(u32)) {
        if self.nodes.is_empty() {
            self.items.iter().copied().for_each(each);
        } else {
            within(&self.nodes, aabb, |place| each(self.items[place as usize]));
        }
    }
}

/// Going along rays in single precision.
impl BoxTree {
    /// Calls `each` for the number of every thing whose box the ray meets nearer than `reach`, and
    /// of a few more, roughly from near to far, until `each` tells that the ray does not reach
    /// any farther than it went already. `each` tells how far the ray reaches from then on.
    #[inline]
    pub fn along32(&self, ray: &Ray32, reach: f32, mut each: impl FnMut(u32) -> f32) {
        if self.nodes.is_empty() {
            for item in &self.items {
                each(*item);
            }
        } else {
            along(&self.nodes, ray, reach, |place| each(self.items[place as usize]));
        }
    }
}

impl std::fmt::Debug for BoxTree {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "a tree over {} boxes", self.items.len())
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    fn met(tree: &BoxTree, ray: &Ray) -> Vec<u32> {
        let mut met = Vec::new();
        tree.along(ray, ray.max(), |item| {
            met.push(item);
            ray.max()
        });
        met.sort_unstable();
        met
    }

    fn cube(x: f32) -> Aabb {
        Aabb { min: Vec3::new(x, 0.0, 0.0), max: Vec3::new(x + 0.5, 1.0, 1.0) }
    }

    #[test]
    fn what_lies_on_the_ray_is_met() {
        let tree = BoxTree::new((0..100).map(|i| cube(i as f32)));
        let across = Ray::new(Vec3::new(41.25, 0.5, 9.0), Vec3::NEG_Z);
        let found = met(&tree, &across);
        assert!(found.contains(&41) && found.len() <= 4, "{found:?}");
        assert_eq!(met(&tree, &across.between(0.0, 5.0)), [0; 0]);
        let along = Ray::new(Vec3::new(-9.0, 0.5, 0.5), Vec3::X);
        assert_eq!(met(&tree, &along).len(), 100);
        let found = met(&tree, &along.between(0.0, 19.1));
        assert!((0..11).all(|i| found.contains(&i)) && found.len() <= 14, "{found:?}");
    }

    #[test]
    fn everything_is_in_one_leaf() {
        for n in [0, 1, 8, 9, 1000] {
            let tree = BoxTree::new((0..n).map(|i| cube(i as f32)));
            let mut found: Vec<u32> = tree.leaves().flatten().copied().collect();
            found.sort_unstable();
            assert!(found.into_iter().eq(0..n));
            assert!(tree.leaves().all(|leaf| !leaf.is_empty() && leaf.len() <= FEW));
        }
    }

    #[test]
    fn what_shares_a_place_with_a_box_is_found() {
        let tree = BoxTree::new((0..100).map(|i| cube(i as f32)));
        let mut found = Vec::new();
        let aabb = Aabb { min: Vec3::new(39.7, 0.2, 0.2), max: Vec3::new(42.0, 9.0, 0.3) };
        tree.within(&aabb, |item| found.push(item));
        found.sort_unstable();
        assert!([40, 41, 42].iter().all(|i| found.contains(i)) && found.len() < 12, "{found:?}");
    }

    #[test]
    fn boxes_that_are_none_are_left_out() {
        let none = Aabb { min: Vec3::NAN, max: Vec3::ONE };
        let tree = BoxTree::new([none, Aabb::EMPTY, cube(0.0)]);
        assert_eq!(met(&tree, &Ray::new(Vec3::new(0.25, 0.5, 9.0), Vec3::NEG_Z)), [2]);
        let empty = BoxTree::new([]);
        assert_eq!(met(&empty, &Ray::new(Vec3::ZERO, Vec3::X)), [0; 0]);
    }

    #[test]
    fn many_equal_boxes_and_long_rows_are_no_trouble() {
        // Where the builder cannot choose it takes hours for these.
        let n = 200_000;
        let ray = Ray::new(Vec3::new(0.25, 0.5, 9.0), Vec3::NEG_Z);
        assert_eq!(met(&BoxTree::new((0..n).map(|_| cube(0.0))), &ray).len(), n);
        let found = met(&BoxTree::new((0..n).map(|i| cube(i as f32))), &ray);
        assert!(found.contains(&0) && found.len() < 10, "{found:?}");
    }
}
