//! Chains a million levels deep, on a stack of 2 MiB: nothing recurses, and nothing costs the
//! square of the depth.

use sapwood::graph::{Everything, Order};
use sapwood::scene::{Attribute, Component, Group, NodeId, Scene};

use super::kinds::*;

const DEPTH: usize = 1_000_000;

fn on_a_small_stack(test: fn()) {
    let thread = std::thread::Builder::new().stack_size(2 << 20);
    thread.spawn(test).unwrap().join().unwrap();
}

/// A chain of components made by `link`, the topmost first, with a leaf at the bottom.
fn chain<L: Component, C: Component>(
    scene: &mut Scene,
    depth: usize,
    mut link: impl FnMut(usize) -> L,
    leaf: C,
) -> Vec<NodeId> {
    let mut chain: Vec<NodeId> = vec![scene.add(leaf).id()];
    for level in (0..depth).rev() {
        let above = scene.add(link(level));
        scene.append(above, chain[chain.len() - 1]).unwrap();
        chain.push(above.id());
    }
    chain.reverse();
    chain
}

#[test]
fn a_chain_of_groups() {
    on_a_small_stack(|| {
        let mut scene = Scene::new();
        let nodes = chain(&mut scene, DEPTH, |_| Group, Plain { size: 2.0 });
        let leaf = scene.handle::<Plain>(nodes[DEPTH]).unwrap();
        assert!(scene.append(leaf, nodes[0]).is_err());
        let error = scene.append(nodes[DEPTH - 1], nodes[0]).unwrap_err();
        assert!(error.to_string().len() < 1000);
        let view = scene.open_view(nodes[0], &rules()).unwrap();
        assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 2.0);
        assert_eq!(scene.count(view).unwrap().components_of("group"), DEPTH as u64);
        let list = scene.draw_list(view, 10).unwrap();
        assert_eq!(list.occurrences.len(), 1);
        let dump = scene.dump(view, 3).unwrap();
        assert_eq!(dump, "group\n    group\n        group\n... 999999 lines more\n");
        assert_eq!(scene.diagnostics(view, 10).unwrap(), []);
        for order in [Order::Pre, Order::In, Order::Post, Order::Level] {
            let (mut n, mut deepest) = (0, 0);
            scene
                .traverse(view, order, &Everything, &mut |at| {
                    n += 1;
                    deepest = deepest.max(at.path().number());
                })
                .unwrap();
            // Each plan has its own group, and most have a deferred node.
            assert_eq!((n, deepest), (2 * DEPTH + 4, DEPTH as u32 + 1));
        }
        scene.edit(leaf, |leaf| leaf.size = 3.0).unwrap();
        assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 3.0);
        scene.evict();
        assert_eq!(scene.fault(), None);
        assert_eq!(scene.remove(nodes[0]).unwrap().len(), DEPTH + 1);
        assert_eq!(scene.n_nodes(), 0);
        assert!(scene.bounds(view).unwrap().is_empty());
    });
}

#[test]
fn a_chain_of_transforms_over_a_leaf_that_reads_its_place() {
    on_a_small_stack(|| {
        let mut scene = Scene::new();
        let step = |level: usize| at(usize::from(level.is_multiple_of(1000)));
        let nodes = chain(&mut scene, DEPTH, step, Placed);
        let view = scene.open_view(nodes[0], &rules()).unwrap();
        assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 1011.0);
        let top = scene.handle::<sapwood::scene::Transform>(nodes[0]).unwrap();
        scene.edit(top, |top| *top = at(11)).unwrap();
        assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 1021.0);
        // Dropped with everything compiled.
    });
}

#[test]
fn a_chain_of_groups_over_a_leaf_that_reads_its_place() {
    on_a_small_stack(|| {
        let depth = DEPTH / 4;
        let mut scene = Scene::new();
        let nodes = chain(&mut scene, depth, |_| Group, Placed);
        let top = scene.add(at(3));
        scene.append(top, nodes[0]).unwrap();
        let view = scene.open_view(top, &rules()).unwrap();
        assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 7.0);
        scene.edit(top, |top| *top = at(5)).unwrap();
        assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 11.0);
        let bottom = scene.add_to(nodes[depth - 1], Sized).unwrap();
        assert_eq!(scene.count(view).unwrap().components_of("sized"), 1);
        scene.remove(bottom).unwrap();
        assert_eq!(scene.count(view).unwrap().components_of("sized"), 0);
    });
}

#[test]
fn a_chain_of_pushes_with_a_reader_at_every_level() {
    on_a_small_stack(|| {
        let depth = DEPTH / 20;
        let mut scene = Scene::new();
        let mut below: NodeId = scene.add(Placed).id();
        for _ in 0..depth {
            let attribute = scene.add(Attribute::new().with::<Size>(2.0));
            let group = scene.add_to(attribute, Group).unwrap();
            scene.add_to(group, Placed).unwrap();
            scene.append(group, below).unwrap();
            below = attribute.id();
        }
        let top = scene.add(at(3));
        scene.append(top, below).unwrap();
        let view = scene.open_view(top, &rules()).unwrap();
        assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 7.0);
        scene.edit(top, |top| *top = at(4)).unwrap();
        assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 9.0);
        assert_eq!(scene.count(view).unwrap().components_of("placed"), depth as u64 + 1);
    });
}
