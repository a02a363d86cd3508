//! Wide groups, many places and deep diamonds: what must not cost the square, or the number of
//! occurrences.

use sapwood::geom::{Bound, content};
use sapwood::graph::Named;
use sapwood::scene::{
    Component, Context, Group, NodeId, Rule, RuleError, RuleSet, Scene, Switch, Transform,
};

use super::kinds::*;

const MANY: usize = 100_000;

#[test]
fn children_of_alternating_kinds_are_compiled_in_one_go() {
    let mut scene = Scene::new();
    let root = scene.add(Group);
    for i in 0..MANY / 2 {
        scene.add_to(root, at(i)).unwrap();
        scene.add_to(root, Plain { size: 1.0 }).unwrap();
    }
    let view = scene.open_view(root, &rules()).unwrap();
    assert_eq!(scene.count(view).unwrap().components_of("plain"), MANY as u64 / 2);
    assert_eq!(scene.n_sites(), MANY + 2);
}

/// Emits many components, each with a bound told before.
#[derive(Debug, Clone)]
struct Swarm {}
content!(Swarm {});
impl Named for Swarm {
    const NAME: &'static str = "swarm";
}
impl Component for Swarm {}

struct SwarmRule;
impl Rule for SwarmRule {
    type Component = Swarm;
    type Data = ();
    const NAME: &'static str = "swarm";
    fn init(&self, _: &Swarm, cx: &mut Context<'_>) -> Result<(), RuleError> {
        let bound = Bound::of_points([sapwood::geom::glam::Vec3::ZERO]);
        for i in 0..MANY {
            cx.emit_keyed(i as u64, Plain { size: (i % 10) as f32 }, Some(bound));
        }
        Ok(())
    }
}

#[test]
fn many_emitted_children_with_foreseen_bounds() {
    let mut scene = Scene::new();
    let root = scene.add(Swarm {});
    let rules = RuleSet::new().with(SwarmRule).over(&rules());
    let view = scene.open_view(root, &rules).unwrap();
    assert_eq!(scene.count(view).unwrap().components_of("plain"), MANY as u64);
    assert_eq!(scene.n_sites(), 12, "ten different children, the swarm and the root");
}

#[test]
fn one_component_at_a_hundred_thousand_places_that_it_reads() {
    let mut scene = Scene::new();
    let root = scene.add(Group);
    let shared = scene.add(Group);
    scene.add_to(shared, Placed).unwrap();
    let mut first = None;
    for i in 0..MANY {
        let moved = scene.add_to(root, at(i)).unwrap();
        scene.append(moved, shared).unwrap();
        first.get_or_insert(moved);
    }
    let view = scene.open_view(root, &rules()).unwrap();
    scene.set_logging(true);
    scene.bounds(view).unwrap();
    assert_eq!(compiled(&mut scene, "placed"), MANY);
    // The second, for plans of an earlier edit are compared with all of these.
    let placed = scene.children(shared).next().unwrap();
    let placed = scene.handle::<Placed>(placed).unwrap();
    scene.edit(placed, |_| ()).unwrap();
    scene.bounds(view).unwrap();
    assert_eq!(compiled(&mut scene, "placed"), MANY);
    scene.edit(first.unwrap(), |first| *first = Transform::translation(-7.0, 0.0, 0.0)).unwrap();
    scene.bounds(view).unwrap();
    assert_eq!(compiled(&mut scene, "placed"), 1);
}

#[test]
fn one_edit_among_many_runs_one_rule() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let mut leaves = Vec::new();
    for _ in 0..100 {
        let group = scene.add_to(root, Group).unwrap();
        for i in 0..100 {
            let moved = scene.add_to(group, at(i)).unwrap();
            leaves.push(scene.add_to(moved, Plain { size: 1.0 }).unwrap());
        }
    }
    let view = scene.open_view(root, &rules()).unwrap();
    scene.bounds(view).unwrap();
    scene.take_log();
    for (i, leaf) in leaves.iter().enumerate().step_by(7) {
        scene.edit(*leaf, |leaf| leaf.size = 200.0 + i as f32).unwrap();
        assert!(scene.bounds(view).unwrap().aabb.max.y == 200.0 + i as f32);
        assert_eq!(all_compiled(&mut scene), [("plain", 1)]);
        assert_eq!(scene.take_log(), [], "nothing else was looked for");
    }
}

/// A diamond of forty levels, of which `leaf` is the bottom: 2^40 occurrences.
fn diamond(scene: &mut Scene, leaf: NodeId) -> NodeId {
    let mut below = leaf;
    for _ in 0..40 {
        let group = scene.add(Group);
        for _ in 0..2 {
            scene.append(group, below).unwrap();
        }
        below = group.id();
    }
    below
}

#[test]
fn what_draws_nothing_costs_nothing_however_often_it_occurs() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let switch = scene.add(Switch { on: false });
    let leaf = scene.add_to(switch, Plain { size: 1.0 }).unwrap();
    let top = diamond(&mut scene, switch.id());
    scene.append(root, top).unwrap();
    scene.append(root, leaf).unwrap();
    let view = scene.open_view(root, &rules()).unwrap();
    assert_eq!(scene.draw_list(view, 10).unwrap().occurrences.len(), 1);
    assert_eq!(scene.diagnostics(view, 10).unwrap(), []);
    let dump = scene.dump(view, 4).unwrap();
    let n_lines = (1u64 << 41) - 1 + 1 + 2 - 4;
    assert_eq!(dump.lines().last().unwrap(), format!("... {n_lines} lines more"));
}

#[test]
fn faults_are_found_below_a_diamond() {
    let mut scene = checked_scene();
    let bad = scene.add(Transform::translation(f32::NAN, 0.0, 0.0));
    let top = diamond(&mut scene, bad.id());
    let view = scene.open_view(top, &rules()).unwrap();
    let found = scene.diagnostics(view, 3).unwrap();
    assert_eq!(found.len(), 3);
    let last = |i: usize| found[i].0[38..].to_vec();
    assert_eq!(
        (found[0].0.len(), last(0), last(1), last(2)),
        (41, vec![0, 0, 0], vec![0, 0, 1], vec![0, 1, 0])
    );
}
