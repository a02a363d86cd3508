//! What runs: sharing, read sets, and edits of what was read.

use sapwood::geom::SharedMesh;
use sapwood::graph::Material;
use sapwood::scene::{
    Attribute, Component, Context, Group, Handle, NodeId, Rule, RuleError, RuleSet, Scene, Switch,
    Transform, ViewId,
};

use super::kinds::*;

/// One component under a thousand transforms.
struct Shared {
    scene: Scene,
    view: ViewId,
    parents: Vec<Handle<Transform>>,
}

fn share<C: Component>(component: C, levels: usize) -> Shared {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let mut shared: NodeId = scene.add(component).id();
    for _ in 0..levels {
        let group = scene.add(Group);
        scene.append(group, shared).unwrap();
        shared = group.id();
    }
    let parents = (0..1000)
        .map(|i| {
            let parent = scene.add_to(root, at(i)).unwrap();
            scene.append(parent, shared).unwrap();
            parent
        })
        .collect();
    let view = scene.open_view(root, &rules()).unwrap();
    Shared { scene, view, parents }
}

/// Inits of `kind` when compiled cold, and after one parent moved.
fn check<C: Component>(component: C, levels: usize, kind: &str, cold: usize, moved: usize) {
    let Shared { mut scene, view, parents } = share(component, levels);
    scene.bounds(view).unwrap();
    assert_eq!(compiled(&mut scene, kind), cold, "cold");
    scene.edit(parents[17], |transform| *transform = at(5000)).unwrap();
    let bounds = scene.bounds(view).unwrap();
    assert!(bounds.aabb.max.x >= 5001.0, "{bounds:?}");
    let ran = all_compiled(&mut scene);
    let of_kind = ran.iter().find(|(name, _)| *name == kind).map_or(0, |(_, n)| *n);
    assert_eq!(of_kind, moved, "{ran:?}");
    assert_eq!(ran.iter().find(|(name, _)| *name == "transform"), Some(&("transform", 1)));
    assert_eq!(scene.count(view).unwrap().components_of(kind), 1000);
    scene.bounds(view).unwrap();
    assert_eq!(all_compiled(&mut scene), []);
}

#[test]
fn what_reads_nothing_is_compiled_once_under_a_thousand_parents() {
    check(Plain { size: 1.0 }, 0, "plain", 1, 0);
}

#[test]
fn what_reads_placement_is_compiled_once_for_each_of_a_thousand_parents() {
    check(Placed, 0, "placed", 1000, 1);
}

#[test]
fn two_levels_of_sharing_change_nothing_of_that() {
    check(Plain { size: 1.0 }, 2, "plain", 1, 0);
    check(Placed, 2, "placed", 1000, 1);
}

#[test]
fn a_slot_that_only_a_grandchild_reads_leaves_the_grandparent_alone() {
    check(Grandparent, 0, "grandparent", 1, 0);
    check(Grandparent, 0, "placed", 1000, 1);
    check(Grandparent, 2, "placed", 1000, 1);
}

#[test]
fn a_second_view_under_the_same_rules_compiles_nothing() {
    let Shared { mut scene, view, parents } = share(Placed, 1);
    let first = scene.bounds(view).unwrap();
    scene.take_log();
    let root = scene.parents(parents[0]).next().unwrap();
    let second = scene.open_view(root, &rules()).unwrap();
    assert_eq!(scene.bounds(second).unwrap(), first);
    assert_eq!(all_compiled(&mut scene), []);
}

struct OtherPlainRule;
impl Rule for OtherPlainRule {
    type Component = Plain;
    type Data = ();
    const NAME: &'static str = "other_plain";
    fn init(&self, plain: &Plain, cx: &mut Context<'_>) -> Result<(), RuleError> {
        let mesh = SharedMesh::new(triangle(2.0 * plain.size));
        cx.mesh(mesh, Material::matte("m", 1.0, 1.0, 0.0).into());
        Ok(())
    }
}

#[test]
fn a_replaced_rule_recompiles_its_kind_only() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    scene.add_to(root, Plain { size: 1.0 }).unwrap();
    scene.add_to(root, Placed).unwrap();
    let moved = scene.add_to(root, at(3)).unwrap();
    scene.add_to(moved, Plain { size: 3.0 }).unwrap();
    let view = scene.open_view(root, &rules()).unwrap();
    scene.bounds(view).unwrap();
    scene.take_log();
    let other = RuleSet::new().with(OtherPlainRule).over(&rules());
    scene.set_rules(view, &other).unwrap();
    assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 9.0);
    assert_eq!(all_compiled(&mut scene), [("plain", 2)]);
    scene.set_rules(view, &rules()).unwrap();
    assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 6.0);
    assert_eq!(all_compiled(&mut scene), [], "the plans of the first rule are still there");
}

#[test]
fn a_slot_reaches_who_reads_it_and_runs_nobody_else() {
    let mut scene = checked_scene();
    let attribute = scene.add(Attribute::new().with::<Size>(2.0));
    let group = scene.add_to(attribute, Group).unwrap();
    scene.add_to(group, Sized).unwrap();
    scene.add_to(group, Plain { size: 1.0 }).unwrap();
    let view = scene.open_view(attribute, &rules()).unwrap();
    assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 2.0);
    scene.take_log();
    scene.push::<Size>(attribute, 4.0).unwrap();
    assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 4.0);
    assert_eq!(all_compiled(&mut scene), [("attribute", 1), ("sized", 1)]);
}

#[test]
fn a_slot_that_nobody_reads_runs_nobody() {
    let mut scene = checked_scene();
    let attribute = scene.add(Attribute::new().with::<Size>(2.0));
    let group = scene.add_to(attribute, Group).unwrap();
    for _ in 0..10 {
        scene.add_to(group, Plain { size: 1.0 }).unwrap();
    }
    let view = scene.open_view(attribute, &rules()).unwrap();
    scene.bounds(view).unwrap();
    scene.take_log();
    scene.push::<Size>(attribute, 4.0).unwrap();
    scene.bounds(view).unwrap();
    assert_eq!(all_compiled(&mut scene), [("attribute", 1)]);
}

#[test]
fn a_slot_pushed_again_below_hides_the_one_above() {
    let mut scene = checked_scene();
    let outer = scene.add(Attribute::new().with::<Size>(2.0));
    let inner = scene.add_to(outer, Attribute::new().with::<Size>(3.0)).unwrap();
    scene.add_to(inner, Sized).unwrap();
    let view = scene.open_view(outer, &rules()).unwrap();
    scene.bounds(view).unwrap();
    scene.take_log();
    scene.push::<Size>(outer, 9.0).unwrap();
    assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 3.0);
    assert_eq!(all_compiled(&mut scene), [("attribute", 1)]);
    scene.edit(inner, |attribute| attribute.clear::<Size>()).unwrap();
    assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 9.0);
}

#[test]
fn a_value_at_the_root_of_a_view_is_inherited_by_all() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    scene.add_to(root, Sized).unwrap();
    scene.add_to(root, Plain { size: 1.0 }).unwrap();
    let view = scene.open_view(root, &rules()).unwrap();
    let other = scene.open_view(root, &rules()).unwrap();
    assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 1.0);
    assert_eq!(scene.bounds(other).unwrap().aabb.max.x, 1.0);
    scene.take_log();
    scene.set_held::<Size>(view, 7.0).unwrap();
    assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 7.0);
    assert_eq!(all_compiled(&mut scene), [("sized", 1)]);
    assert_eq!(scene.bounds(other).unwrap().aabb.max.x, 1.0, "the other view keeps its own");
}

#[test]
fn an_equal_result_stops() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let attribute = scene.add_to(root, Attribute::new().with::<Size>(2.0)).unwrap();
    let sized = scene.add_to(attribute, Sized).unwrap();
    let view = scene.open_view(root, &rules()).unwrap();
    scene.bounds(view).unwrap();
    let (plans, sites) = (scene.n_plans(), scene.n_sites());
    scene.take_log();
    scene.push::<Size>(attribute, 2.0).unwrap();
    scene.bounds(view).unwrap();
    assert_eq!(all_compiled(&mut scene), [("attribute", 1)]);
    scene.edit(sized, |_| ()).unwrap();
    scene.bounds(view).unwrap();
    assert_eq!(all_compiled(&mut scene), [("sized", 1)]);
    assert_eq!((scene.n_plans(), scene.n_sites()), (plans, sites));
}

#[test]
fn what_is_switched_off_is_not_compiled() {
    let mut scene = checked_scene();
    let switch = scene.add(Switch { on: false });
    let plain = scene.add_to(switch, Plain { size: 1.0 }).unwrap();
    let view = scene.open_view(switch, &rules()).unwrap();
    assert!(scene.bounds(view).unwrap().is_empty());
    scene.edit(plain, |plain| plain.size = 5.0).unwrap();
    assert!(scene.bounds(view).unwrap().is_empty());
    assert_eq!(compiled(&mut scene, "plain"), 0);
    scene.edit(switch, |switch| switch.on = true).unwrap();
    assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 5.0);
    assert_eq!(compiled(&mut scene, "plain"), 1);
}

#[test]
fn a_diamond_of_forty_levels_is_compiled_once() {
    let mut scene = checked_scene();
    let mut below: NodeId = scene.add(Plain { size: 1.0 }).id();
    for _ in 0..40 {
        let group = scene.add(Group);
        for x in 0..2 {
            let transform = scene.add_to(group, at(x)).unwrap();
            scene.append(transform, below).unwrap();
        }
        below = group.id();
    }
    let view = scene.open_view(below, &rules()).unwrap();
    assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 41.0);
    assert_eq!(all_compiled(&mut scene), [("group", 40), ("plain", 1), ("transform", 80)]);
    assert_eq!(scene.count(view).unwrap().components_of("plain"), 1 << 40);
    let error = scene.draw_list(view, 1000).unwrap_err();
    assert_eq!(error.to_string(), "more than 1000 rows would be drawn; plain occurs too often");
}
