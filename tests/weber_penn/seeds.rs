//! Seeds: which trees regrow when they are moved, and which are one and the same.

use sapwood::geom::{Digest, Digester, FixedSet, fixed_state};
use sapwood::rules::weber_penn::{Seed, Tree};
use sapwood::scene::{Group, Handle, NodeId, Scene, Transform, ViewId};

use super::trees::*;

/// Nine places in a row, 10 m apart, below one species.
struct Grove {
    scene: Scene,
    view: ViewId,
    group: Handle<Group>,
    places: Vec<Handle<Transform>>,
}

fn place(x: f32) -> Transform {
    Transform::translation(x, 0.0, 0.0)
}

/// A grove of nine; `tree` tells what stands at each place.
fn grove(mut tree: impl FnMut(&mut Scene, usize) -> NodeId) -> Grove {
    let mut scene = checked_scene();
    let family = scene.add(sapling().attribute());
    let group = scene.add_to(family, Group).unwrap();
    let places: Vec<_> =
        (0..9).map(|i| scene.add_to(group, place(10.0 * i as f32)).unwrap()).collect();
    for (i, place) in places.iter().enumerate() {
        let tree = tree(&mut scene, i);
        scene.append(*place, tree).unwrap();
    }
    let view = scene.open_view(family, &sapwood::standard_rules()).unwrap();
    Grove { scene, view, group, places }
}

/// One component under all nine places.
fn shared(seed: Seed) -> Grove {
    let mut tree = None;
    grove(|scene, _| *tree.get_or_insert_with(|| scene.add(Tree { seed }).id()))
}

/// A component for each place.
fn separate(seed: Seed) -> Grove {
    grove(|scene, _| scene.add(Tree { seed }).id())
}

impl Grove {
    fn compiled(&mut self) -> Vec<(&'static str, usize)> {
        compiled(&mut self.scene, self.view)
    }

    fn move_to(&mut self, i: usize, x: f32) {
        self.scene.edit(self.places[i], |transform| *transform = place(x)).unwrap();
    }

    /// What stands at each place, in the place's own frame.
    fn trees(&mut self) -> Vec<Digest> {
        let list = self.scene.draw_list(self.view, 1_000_000).unwrap();
        let tree = |occurrence: &sapwood::graph::Occurrence| {
            let mut digester = Digester::new();
            for row in &list.bodies[occurrence.body as usize].rows {
                digester.add(&row.local).add(&*row.mesh);
                digester.add(&row.instances.as_deref());
            }
            digester.finish()
        };
        list.occurrences.iter().map(tree).collect()
    }

    fn n_bodies_and_occurrences(&mut self) -> (usize, usize) {
        let list = self.scene.draw_list(self.view, 1_000_000).unwrap();
        (list.bodies.len(), list.occurrences.len())
    }
}

fn n_different(trees: &[Digest]) -> usize {
    let mut set: FixedSet<Digest> = FixedSet::with_hasher(fixed_state());
    set.extend(trees.iter().copied());
    set.len()
}

fn number(compiled: &[(&'static str, usize)], kind: &str) -> usize {
    compiled.iter().find(|(name, _)| *name == kind).map_or(0, |(_, n)| *n)
}

#[test]
fn a_tree_seeded_by_its_place_regrows_alone_when_it_leaves_its_cell() {
    for mut grove in [shared(Seed::Position { cell: 2.0 }), separate(Seed::Position { cell: 2.0 })]
    {
        let cold = grove.compiled();
        let before = grove.trees();
        assert_eq!((number(&cold, "tree"), n_different(&before)), (9, 9));

        grove.move_to(4, 40.7);
        assert_eq!(grove.compiled(), [("transform", 1)], "still in its cell");
        assert_eq!(grove.trees(), before);

        grove.move_to(4, 43.0);
        let moved = grove.compiled();
        assert_eq!((number(&moved, "transform"), number(&moved, "tree")), (1, 1));
        // One trunk, and a limb for each child of it.
        assert_eq!(number(&moved, "branch"), 7);
        assert_eq!(number(&cold, "branch"), 9 * 7);
        let after = grove.trees();
        for i in 0..9 {
            assert_eq!(before[i] != after[i], i == 4, "{i}");
        }

        // Where another tree stood before, that very tree grows again.
        grove.move_to(4, 40.0);
        grove.compiled();
        assert_eq!(grove.trees(), before);
    }
}

#[test]
fn trees_in_one_cell_are_one_tree() {
    let mut grove = separate(Seed::Position { cell: 1000.0 });
    let cold = grove.compiled();
    assert_eq!((number(&cold, "tree"), number(&cold, "branch")), (9, 7));
    assert_eq!(n_different(&grove.trees()), 1);
}

#[test]
fn a_cell_without_size_is_an_error_of_the_tree_alone() {
    let mut grove = separate(Seed::Position { cell: 2.0 });
    let tree = grove.scene.children(grove.places[3]).next().unwrap();
    let tree = grove.scene.handle::<Tree>(tree).unwrap();
    for cell in [0.0, -1.0, f32::NAN] {
        grove.scene.edit(tree, |tree| tree.seed = Seed::Position { cell }).unwrap();
        grove.compiled();
        let diagnostics = grove.scene.diagnostics(grove.view, 10).unwrap();
        assert_eq!(diagnostics.len(), 1);
        let message = &diagnostics[0].1.message;
        assert!(message.starts_with("seed cells of"), "{message}");
        assert_eq!(grove.n_bodies_and_occurrences(), (8, 8));
    }
}

#[test]
fn a_tree_with_an_explicit_seed_stands_anywhere() {
    let mut grove = shared(Seed::Explicit(7));
    let cold = grove.compiled();
    assert_eq!((number(&cold, "tree"), number(&cold, "branch")), (1, 7));
    assert_eq!(grove.n_bodies_and_occurrences(), (1, 9));
    for i in 0..9 {
        grove.move_to(i, 3.0 + i as f32);
    }
    assert_eq!(grove.compiled(), [("transform", 9)]);
    assert_eq!(n_different(&grove.trees()), 1);
}

#[test]
fn trees_of_one_seed_share_everything_below_the_tree() {
    let mut grove = separate(Seed::Explicit(7));
    let cold = grove.compiled();
    assert_eq!((number(&cold, "tree"), number(&cold, "branch")), (9, 7));
    assert_eq!(grove.n_bodies_and_occurrences(), (9, 9));
    let list = grove.scene.draw_list(grove.view, 1_000_000).unwrap();
    let [first, rest @ ..] = &list.bodies[..] else { panic!("nothing is drawn") };
    for body in rest {
        let mut pairs = first.rows.iter().zip(&body.rows);
        assert!(pairs.all(|(a, b)| a.mesh.is_same(&b.mesh)));
    }
}

#[test]
fn a_tree_seeded_by_its_path_is_another_at_every_occurrence() {
    let mut grove = shared(Seed::Path);
    let cold = grove.compiled();
    assert_eq!(number(&cold, "tree"), 9);
    let before = grove.trees();
    assert_eq!(n_different(&before), 9);

    for i in 0..9 {
        grove.move_to(i, 5.0 - i as f32);
    }
    assert_eq!(grove.compiled(), [("transform", 9)]);
    assert_eq!(grove.trees(), before);

    grove.scene.reorder(grove.group, 0, 5).unwrap();
    assert_eq!(grove.compiled(), [("group", 1)]);
    let mut reordered = before.clone();
    let first = reordered.remove(0);
    reordered.insert(5, first);
    assert_eq!(grove.trees(), reordered);

    // One more among them leaves the others what they were.
    let more = grove.scene.add(place(99.0));
    let tree = grove.scene.children(grove.places[0]).next().unwrap();
    grove.scene.append(more, tree).unwrap();
    grove.scene.insert(grove.group, 0, more).unwrap();
    let ran = grove.compiled();
    assert_eq!((number(&ran, "group"), number(&ran, "transform"), number(&ran, "tree")), (1, 1, 1));
    let after = grove.trees();
    assert_eq!(after[1..], reordered[..]);
    assert_eq!(n_different(&after), 10);
}
