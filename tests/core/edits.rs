//! Every edit: what it does, what it refuses, and that a view sees it at once.

use sapwood::geom::{Purpose, SharedMesh, Stream, content};
use sapwood::graph::{Material, Named};
use sapwood::scene::{
    Attribute, Budget, ChildPath, Component, Context, EditError, Group, Handle, NodeId, Rule,
    RuleError, RuleSet, Scene, Switch, Transform, ViewId,
};

use super::kinds::*;

/// A root with three children of sizes 1, 2 and 3, seen by a view.
struct Three {
    scene: Scene,
    view: ViewId,
    root: Handle<Group>,
    children: [Handle<Plain>; 3],
}

impl Three {
    fn new() -> Self {
        let mut scene = checked_scene();
        let root = scene.add(Group);
        let children = [1.0, 2.0, 3.0].map(|size| scene.add_to(root, Plain { size }).unwrap());
        let view = scene.open_view(root, &rules()).unwrap();
        let mut three = Self { scene, view, root, children };
        three.shows(&[1.0, 2.0, 3.0]);
        three
    }

    /// Checks which triangles are drawn, in order.
    fn shows(&mut self, sizes: &[f32]) {
        assert_eq!(drawn(&mut self.scene, self.view), sizes);
        assert_eq!(self.scene.fault(), None);
    }
}

/// The sizes of all triangles that a view draws, in order.
fn drawn(scene: &mut Scene, view: ViewId) -> Vec<f32> {
    let list = scene.draw_list(view, 1000).unwrap();
    list.placed_rows().map(|(_, row)| row.mesh.positions[1].x).collect()
}

#[test]
fn children_are_added_inserted_and_appended() {
    let mut three = Three::new();
    let (root, [first, _, last]) = (three.root, three.children);
    let new = three.scene.add(Plain { size: 9.0 });
    three.shows(&[1.0, 2.0, 3.0]);
    three.scene.insert(root, 1, new).unwrap();
    three.shows(&[1.0, 9.0, 2.0, 3.0]);
    three.scene.append(root, first).unwrap();
    three.shows(&[1.0, 9.0, 2.0, 3.0, 1.0]);
    three.scene.insert(root, 5, last).unwrap();
    three.shows(&[1.0, 9.0, 2.0, 3.0, 1.0, 3.0]);
    assert_eq!(three.scene.children(root).count(), 6);
    assert_eq!(three.scene.parents(first).collect::<Vec<_>>(), [root.id(), root.id()]);
}

#[test]
fn children_are_detached_the_first_of_several() {
    let mut three = Three::new();
    let (root, [first, second, _]) = (three.root, three.children);
    three.scene.insert(root, 3, first).unwrap();
    three.scene.detach(root, first).unwrap();
    three.shows(&[2.0, 3.0, 1.0]);
    three.scene.detach(root, first).unwrap();
    three.shows(&[2.0, 3.0]);
    assert!(three.scene.get(first).is_some(), "what is detached stays in the scene");
    three.scene.insert(root, 0, second).unwrap();
    three.scene.reorder(root, 0, 2).unwrap();
    three.shows(&[2.0, 3.0, 2.0]);
    three.scene.detach(root, second).unwrap();
    three.shows(&[3.0, 2.0]);
}

#[test]
fn children_are_reordered_both_ways() {
    let mut three = Three::new();
    let root = three.root;
    three.scene.reorder(root, 0, 2).unwrap();
    three.shows(&[2.0, 3.0, 1.0]);
    three.scene.reorder(root, 2, 1).unwrap();
    three.shows(&[2.0, 1.0, 3.0]);
    three.scene.reorder(root, 1, 1).unwrap();
    three.shows(&[2.0, 1.0, 3.0]);
}

#[test]
fn children_are_reparented() {
    let mut three = Three::new();
    let (root, [first, ..]) = (three.root, three.children);
    let group = three.scene.add_to(root, Group).unwrap();
    three.scene.reparent(first, root, group).unwrap();
    three.shows(&[2.0, 3.0, 1.0]);
    assert_eq!(three.scene.parents(first).collect::<Vec<_>>(), [group.id()]);
    three.scene.reparent(group, root, root).unwrap();
    three.shows(&[2.0, 3.0, 1.0]);
}

#[test]
fn what_is_removed_takes_along_what_nobody_else_holds() {
    let mut three = Three::new();
    let (root, [first, second, _]) = (three.root, three.children);
    let group = three.scene.add_to(root, Group).unwrap();
    three.scene.reparent(first, root, group).unwrap();
    three.scene.append(group, second).unwrap();
    three.shows(&[2.0, 3.0, 1.0, 2.0]);
    let gone = three.scene.remove(group).unwrap();
    assert_eq!(gone, [group.id(), first.id()]);
    three.shows(&[2.0, 3.0]);
    let is_gone = |result: Result<(), EditError>, node: NodeId| {
        assert_eq!(result, Err(EditError::Gone { node }));
    };
    let scene = &mut three.scene;
    is_gone(scene.append(root, first), first.id());
    is_gone(scene.append(group, second), group.id());
    is_gone(scene.detach(root, group), group.id());
    is_gone(scene.detach(group, second), group.id());
    is_gone(scene.reparent(first, root, root), first.id());
    is_gone(scene.reparent(second, group, root), group.id());
    is_gone(scene.reparent(second, root, group), group.id());
    is_gone(scene.reorder(group, 0, 0), group.id());
    is_gone(scene.edit(first, |plain| plain.size = 7.0), first.id());
    is_gone(scene.remove(first).map(|_| ()), first.id());
    assert!(scene.add_to(group, Group).is_err());
    assert!(scene.get(first).is_none() && scene.kind(first).is_none());
    three.shows(&[2.0, 3.0]);
}

#[test]
fn parameters_and_slots_are_edited() {
    let mut three = Three::new();
    let (root, [first, ..]) = (three.root, three.children);
    let was = three.scene.edit(first, |plain| std::mem::replace(&mut plain.size, 5.0)).unwrap();
    assert_eq!(was, 1.0);
    three.shows(&[5.0, 2.0, 3.0]);
    let attribute = three.scene.add_to(root, Attribute::new()).unwrap();
    three.scene.add_to(attribute, Sized).unwrap();
    three.shows(&[5.0, 2.0, 3.0, 1.0]);
    three.scene.push::<Size>(attribute, 8.0).unwrap();
    three.shows(&[5.0, 2.0, 3.0, 8.0]);
    assert!(three.scene.edit(attribute, Attribute::clear::<Size>).unwrap());
    three.shows(&[5.0, 2.0, 3.0, 1.0]);
    let switch = three.scene.add_to(root, Switch { on: true }).unwrap();
    three.scene.reparent(first, root, switch).unwrap();
    three.shows(&[2.0, 3.0, 1.0, 5.0]);
    three.scene.edit(switch, |switch| switch.on = false).unwrap();
    three.shows(&[2.0, 3.0, 1.0]);
}

#[test]
fn a_refused_edit_changes_nothing() {
    let mut three = Three::new();
    let (root, [first, ..]) = (three.root, three.children);
    let transform = three.scene.add_to(root, at(0)).unwrap();
    let held = three.scene.add_to(transform, Plain { size: 4.0 }).unwrap();
    let stranger = three.scene.add(Plain { size: 9.0 });
    three.shows(&[1.0, 2.0, 3.0, 4.0]);
    let (revision, n) = (three.scene.revision(), three.scene.n_nodes());
    let scene = &mut three.scene;
    let refused = [
        scene.append(transform, stranger),
        scene.append(first, stranger),
        scene.insert(root, 5, stranger),
        scene.append(transform, root),
        scene.append(root, root),
        scene.detach(root, stranger),
        scene.detach(root, held),
        scene.reorder(root, 0, 4),
        scene.reorder(root, 4, 0),
        scene.reparent(first, root, transform),
        scene.reparent(first, transform, root),
        scene.add_to(transform, Group).map(|_| ()),
    ];
    for result in &refused {
        assert!(result.is_err());
    }
    assert_eq!(refused[0].clone().unwrap_err().to_string().split(' ').next(), Some("transform"));
    assert_eq!((scene.revision(), scene.n_nodes()), (revision, n));
    scene.take_log();
    three.shows(&[1.0, 2.0, 3.0, 4.0]);
    assert_eq!(three.scene.take_log(), []);
}

#[test]
fn a_cycle_is_refused_with_its_path() {
    let mut scene = Scene::new();
    let top = scene.add(Group);
    let mut chain = vec![top.id()];
    for _ in 0..20 {
        let below = scene.add(Group);
        scene.append(*chain.last().unwrap(), below).unwrap();
        chain.push(below.id());
    }
    let error = scene.append(chain[20], top).unwrap_err();
    let EditError::Cycle { path } = &error else { panic!("{error}") };
    assert_eq!(path.iter().map(|(node, _)| *node).collect::<Vec<_>>(), chain);
    assert!(path.iter().all(|(_, kind)| *kind == "group"));
    let text = error.to_string();
    assert!(text.starts_with("the edge would close a cycle: group ") && text.contains("14 more"));
    assert!(matches!(scene.append(top, top), Err(EditError::Cycle { path }) if path.len() == 1));
    let error = scene.reparent(chain[1], top, chain[5]).unwrap_err();
    assert!(matches!(error, EditError::Cycle { path } if path.len() == 5));
    assert_eq!(scene.children(top).collect::<Vec<_>>(), [chain[1]]);
    assert_eq!(scene.fault(), None);
}

#[test]
fn a_fresh_node_joins_a_huge_graph_at_once() {
    let mut scene = Scene::new();
    let root = scene.add(Group);
    let mut leaves = Vec::new();
    for x in 0..100_000 {
        let leaf = scene.add_to(root, at(x)).unwrap();
        leaves.push(leaf);
    }
    // Were the graph searched for each, this would take 10^10 steps.
    for _ in 0..100_000 {
        let fresh = scene.add(Group);
        scene.append(fresh, root).unwrap();
        scene.detach(fresh, root).unwrap();
        scene.remove(fresh).unwrap();
        let fresh = scene.add(Group);
        scene.append(root, fresh).unwrap();
        scene.detach(root, fresh).unwrap();
    }
    // From the back, where the parent's list is long and the child's ring is short.
    for leaf in leaves.iter().rev() {
        scene.detach(root, *leaf).unwrap();
    }
    assert_eq!(scene.children(root).count(), 0);
    assert_eq!(scene.fault(), None);
}

/// A component that shows under which key it stands.
#[derive(Debug, Clone)]
struct Keyed {}
content!(Keyed {});
impl Named for Keyed {
    const NAME: &'static str = "keyed";
}
impl Component for Keyed {}

struct KeyedRule;
impl Rule for KeyedRule {
    type Component = Keyed;
    type Data = ();
    const NAME: &'static str = "keyed";
    fn init(&self, _: &Keyed, cx: &mut Context<'_>) -> Result<(), RuleError> {
        let path = *cx.read::<ChildPath>();
        let size = 1.0 + Stream::new(path, Purpose("size")).unit();
        cx.mesh(SharedMesh::new(triangle(size)), Material::matte("m", 1.0, 1.0, 1.0).into());
        Ok(())
    }
}

#[test]
fn a_child_keeps_its_key_when_the_order_changes() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let shared = scene.add(Keyed {});
    for _ in 0..4 {
        scene.append(root, shared).unwrap();
    }
    let rules = RuleSet::new().with(KeyedRule).over(&rules());
    let view = scene.open_view(root, &rules).unwrap();
    let before = drawn(&mut scene, view);
    assert_eq!(compiled(&mut scene, "keyed"), 4, "every occurrence has a key of its own");
    scene.reorder(root, 0, 3).unwrap();
    let [a, b, c, d] = before[..] else { panic!("{before:?}") };
    assert_eq!(drawn(&mut scene, view), [b, c, d, a]);
    assert_eq!(compiled(&mut scene, "keyed"), 0);
    scene.detach(root, shared).unwrap();
    scene.append(root, shared).unwrap();
    let after = drawn(&mut scene, view);
    assert_eq!(after[..3], [c, d, a]);
    assert!(!before.contains(&after[3]), "a key is never used twice");
}

#[test]
fn a_bulk_scope_is_one_revision() {
    let mut three = Three::new();
    let (root, [first, second, third]) = (three.root, three.children);
    let revision = three.scene.revision();
    three.scene.bulk(|scene| {
        scene.edit(first, |plain| plain.size = 4.0).unwrap();
        scene.bulk(|scene| scene.detach(root, second).unwrap());
        scene.edit(third, |plain| plain.size = 6.0).unwrap();
        scene.append(root, second).unwrap();
    });
    assert_eq!(three.scene.revision(), revision + 1);
    three.shows(&[4.0, 6.0, 2.0]);
    three.scene.bulk(|_| ());
    three.shows(&[4.0, 6.0, 2.0]);
}

#[test]
fn a_traversal_inside_a_bulk_scope_sees_what_was_edited_before_it() {
    let mut three = Three::new();
    let (view, [first, second, _]) = (three.view, three.children);
    three.scene.bulk(|scene| {
        scene.edit(first, |plain| plain.size = 4.0).unwrap();
        assert_eq!(drawn(scene, view), [4.0, 2.0, 3.0]);
        scene.edit(first, |plain| plain.size = 5.0).unwrap();
        scene.edit(second, |plain| plain.size = 6.0).unwrap();
    });
    three.shows(&[5.0, 6.0, 3.0]);
}

#[test]
fn a_panic_inside_a_bulk_scope_leaves_a_scene_that_works() {
    let mut three = Three::new();
    let first = three.children[0];
    let panic = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
        three.scene.bulk(|scene| {
            scene.edit(first, |plain| plain.size = 4.0).unwrap();
            scene.edit(first, |_| panic!("on purpose")).unwrap();
        });
    }));
    assert!(panic.is_err());
    three.shows(&[4.0, 2.0, 3.0]);
    three.scene.edit(first, |plain| plain.size = 7.0).unwrap();
    three.shows(&[7.0, 2.0, 3.0]);
}

#[test]
fn a_hundred_thousand_edits_leave_no_more_than_the_spare_plans() {
    let mut scene = Scene::new();
    let top = scene.add(at(0));
    let mut below: NodeId = top.id();
    for _ in 0..10 {
        let group = scene.add(Group);
        scene.append(below, group).unwrap();
        below = group.id();
    }
    let plain = scene.add_to(below, Plain { size: 1.0 }).unwrap();
    scene.add_to(below, Placed).unwrap();
    let view = scene.open_view(top, &rules()).unwrap();
    scene.set_budget(view, Budget { spare_plans: 1000, ..Budget::default() }).unwrap();
    for i in 0..100_000 {
        if i % 2 == 0 {
            scene.edit(plain, |plain| plain.size = (i % 7) as f32).unwrap();
        } else {
            scene.edit(top, |top| *top = Transform::translation(i as f32, 0.0, 0.0)).unwrap();
        }
        scene.bounds(view).unwrap();
        assert!(scene.n_plans() <= 1100 && scene.n_sites() <= 1100);
    }
}
