//! Several views of one scene, layered rule sets, and a cache that may be emptied at any time.

use sapwood::geom::SharedMesh;
use sapwood::geom::{Purpose, Stream, StreamPath};
use sapwood::graph::Material;
use sapwood::scene::{
    Action, Attribute, Context, Group, Rule, RuleError, RuleSet, Scene, Transform, ViewError,
    built_in_rules,
};

use super::kinds::*;

struct TallPlainRule(f32);
impl Rule for TallPlainRule {
    type Component = Plain;
    type Data = ();
    const NAME: &'static str = "tall_plain";
    fn settings(&self, digester: &mut sapwood::geom::Digester) {
        digester.add(&self.0);
    }
    fn init(&self, plain: &Plain, cx: &mut Context<'_>) -> Result<(), RuleError> {
        let mesh = triangle(self.0 * plain.size);
        cx.mesh(SharedMesh::new(mesh), Material::matte("m", 1.0, 1.0, 1.0).into());
        Ok(())
    }
}

#[test]
fn the_highest_layer_that_has_a_rule_serves() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    scene.add_to(root, Plain { size: 1.0 }).unwrap();
    let lowest = built_in_rules();
    let plain = RuleSet::new().with(PlainRule).over(&lowest);
    let tall = RuleSet::new().with(TallPlainRule(3.0)).over(&plain);
    let placed = RuleSet::new().with(PlacedRule).over(&tall);
    let taller = RuleSet::new().with(TallPlainRule(5.0)).over(&RuleSet::new()).over(&placed);
    for (rules, height) in [(&plain, 1.0), (&tall, 3.0), (&placed, 3.0), (&taller, 5.0)] {
        let view = scene.open_view(root, rules).unwrap();
        assert_eq!(scene.bounds(view).unwrap().aabb.max.y, height);
    }
    assert_eq!(compiled(&mut scene, "plain"), 3, "equal rules share their plans");
    let view = scene.open_view(root, &lowest).unwrap();
    assert_eq!(scene.diagnostics(view, 10).unwrap().len(), 1);
}

#[test]
fn views_under_different_rules_see_the_same_edits() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let plain = scene.add_to(root, Plain { size: 1.0 }).unwrap();
    scene.add_to(root, Placed).unwrap();
    let low = scene.open_view(root, &rules()).unwrap();
    let tall = RuleSet::new().with(TallPlainRule(3.0)).over(&rules());
    let high = scene.open_view(root, &tall).unwrap();
    for size in [2.0, 4.0, 2.0] {
        scene.edit(plain, |plain| plain.size = size).unwrap();
        assert_eq!(scene.bounds(low).unwrap().aabb.max.y, size);
        assert_eq!(scene.bounds(high).unwrap().aabb.max.y, 3.0 * size);
    }
    assert_eq!(compiled(&mut scene, "placed"), 1);
}

#[test]
fn a_closed_view_yields_nothing_and_leaves_nothing() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    scene.add_to(root, Plain { size: 1.0 }).unwrap();
    let low = scene.open_view(root, &rules()).unwrap();
    scene.bounds(low).unwrap();
    let (plans, sites) = (scene.n_plans(), scene.n_sites());
    let tall = RuleSet::new().with(TallPlainRule(3.0)).over(&rules());
    let high = scene.open_view(root, &tall).unwrap();
    scene.bounds(high).unwrap();
    scene.take_log();
    scene.close_view(high).unwrap();
    let log = scene.take_log();
    let discarded: Vec<_> = log.iter().filter(|event| event.action == Action::Discarded).collect();
    assert!(discarded.len() == 1 && discarded[0].rule == "tall_plain", "{log:?}");
    assert_eq!(scene.bounds(high), Err(ViewError::Closed));
    assert_eq!(scene.close_view(high), Err(ViewError::Closed));
    assert!(scene.set_held::<Size>(high, 1.0).is_err() && scene.set_rules(high, &tall).is_err());
    assert_eq!(scene.bounds(low).unwrap().aabb.max.y, 1.0);
    assert_eq!((scene.n_plans(), scene.n_sites()), (plans, sites));
}

#[test]
fn evicting_keeps_what_is_shown_and_nothing_else() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let plain = scene.add_to(root, Plain { size: 1.0 }).unwrap();
    let view = scene.open_view(root, &rules()).unwrap();
    scene.bounds(view).unwrap();
    let (plans, sites) = (scene.n_plans(), scene.n_sites());
    for i in 0..10 {
        scene.edit(plain, |plain| plain.size = 2.0 + i as f32).unwrap();
        scene.bounds(view).unwrap();
    }
    assert!(scene.n_plans() > plans && scene.n_sites() > sites);
    scene.take_log();
    scene.evict();
    assert_eq!((scene.n_plans(), scene.n_sites()), (plans, sites));
    let log = scene.take_log();
    assert!(log.iter().all(|event| event.action == Action::Discarded));
    assert_eq!(log.len(), 10);
    assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 11.0);
    assert_eq!(scene.take_log(), []);
}

#[test]
fn a_view_whose_root_is_removed_shows_nothing() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    scene.add_to(root, Plain { size: 1.0 }).unwrap();
    let view = scene.open_view(root, &rules()).unwrap();
    scene.bounds(view).unwrap();
    scene.remove(root).unwrap();
    assert!(scene.open_view(root, &rules()).is_err());
    assert!(scene.bounds(view).unwrap().is_empty());
    let found = scene.diagnostics(view, 10).unwrap();
    assert_eq!(found[0].1.message, "the component was removed from the scene");
    scene.evict();
    assert!(scene.bounds(view).unwrap().is_empty());
}

#[test]
fn results_are_the_same_however_often_the_cache_is_emptied() {
    let run = |evicts: bool| {
        let mut scene = Scene::new();
        let root = scene.add(Group);
        let shared = scene.add(Group);
        scene.add_to(shared, Grandparent).unwrap();
        scene.add_to(shared, Sized).unwrap();
        let attributes: Vec<_> = (0..20)
            .map(|i| {
                let moved = scene.add_to(root, at(i)).unwrap();
                let attribute = scene.add_to(moved, Attribute::new().with::<Size>(1.0)).unwrap();
                scene.append(attribute, shared).unwrap();
                (moved, attribute)
            })
            .collect();
        let view = scene.open_view(root, &rules()).unwrap();
        let mut dice = Stream::new(StreamPath::new(5), Purpose("views"));
        let mut dumps = Vec::new();
        for _ in 0..200 {
            let (moved, attribute) = attributes[dice.bits() as usize % 20];
            let value = (dice.bits() % 9) as f32;
            if dice.unit() < 0.5 {
                scene
                    .edit(moved, |moved| *moved = Transform::translation(value, 0.0, 0.0))
                    .unwrap();
            } else {
                scene.push::<Size>(attribute, value).unwrap();
            }
            if dice.unit() < 0.3 && evicts {
                scene.evict();
            }
            dumps.push(scene.dump(view, 10_000).unwrap());
        }
        dumps
    };
    assert_eq!(run(true), run(false));
}
