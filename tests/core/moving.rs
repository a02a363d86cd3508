//! Moving slots: `visit` follows them, no `init` runs, and what rests is left alone.

use sapwood::geom::content;
use sapwood::geom::glam::{Affine3, Vec3};
use sapwood::graph::Named;
use sapwood::scene::{
    Action, Children, Component, Context, Group, Handle, Moving, Rule, RuleError, RuleSet, Scene,
    Slot, Switch, ViewId, VisitContext,
};

use super::kinds::*;

enum Time {}
impl Slot for Time {
    type Value = f32;
    type Rate = Moving;
    const NAME: &'static str = "time";
    fn default() -> f32 {
        1.0
    }
}

/// Moves its children along x with time.
#[derive(Debug, Clone)]
struct Sliding {
    speed: f32,
}
content!(Sliding { speed });
impl Named for Sliding {
    const NAME: &'static str = "sliding";
}
impl Component for Sliding {
    const CHILDREN: Children = Children::Many;
}

struct SlidingRule;
impl Rule for SlidingRule {
    type Component = Sliding;
    type Data = f32;
    const NAME: &'static str = "sliding";
    fn init(&self, sliding: &Sliding, cx: &mut Context<'_>) -> Result<f32, RuleError> {
        cx.live(Context::children);
        Ok(sliding.speed)
    }
    fn visit(&self, speed: &f32, cx: &VisitContext<'_>, live: &mut [Affine3]) {
        live[0] = Affine3::from_translation(Vec3::X * *speed * *cx.read::<Time>());
    }
}

struct Moves {
    scene: Scene,
    view: ViewId,
    switch: Handle<Switch>,
    sliding: Handle<Sliding>,
}

/// A sliding component behind a switch, beside a hundred that rest.
fn moves() -> Moves {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let resting = scene.add_to(root, Group).unwrap();
    for i in 0..100 {
        let moved = scene.add_to(resting, at(0)).unwrap();
        scene.add_to(moved, Plain { size: 1.0 + i as f32 / 1000.0 }).unwrap();
    }
    let switch = scene.add_to(root, Switch { on: true }).unwrap();
    let sliding = scene.add_to(switch, Sliding { speed: 10.0 }).unwrap();
    scene.add_to(sliding, Plain { size: 2.0 }).unwrap();
    let view = scene.open_view(root, &RuleSet::new().with(SlidingRule).over(&rules())).unwrap();
    Moves { scene, view, switch, sliding }
}

fn right(scene: &mut Scene, view: ViewId) -> f32 {
    scene.bounds(view).unwrap().aabb.max.x
}

fn ran(scene: &mut Scene) -> Vec<(Action, &'static str)> {
    scene.take_log().iter().map(|event| (event.action, event.kind.name())).collect()
}

#[test]
fn a_tick_visits_what_moves_and_nothing_else() {
    let Moves { mut scene, view, sliding, .. } = moves();
    assert_eq!(right(&mut scene, view), 12.0, "the first compile visits");
    assert_eq!(ran(&mut scene).iter().filter(|(a, _)| *a == Action::Visited).count(), 1);
    for tick in 2..10 {
        scene.set_moving::<Time>(view, tick as f32).unwrap();
        assert_eq!(right(&mut scene, view), 2.0 + 10.0 * tick as f32);
        assert_eq!(ran(&mut scene), [(Action::Visited, "sliding")]);
        assert_eq!(right(&mut scene, view), 2.0 + 10.0 * tick as f32);
        assert_eq!(ran(&mut scene), []);
    }
    let list = scene.draw_list(view, 1000).unwrap();
    assert!(list.placed_rows().any(|(world, _)| world.translation.x == 90.0));
    scene.edit(sliding, |sliding| sliding.speed = 20.0).unwrap();
    assert_eq!(right(&mut scene, view), 182.0);
    assert_eq!(ran(&mut scene), [(Action::Compiled, "sliding"), (Action::Visited, "sliding")]);
}

#[test]
fn two_views_have_two_times() {
    let Moves { mut scene, view, switch, .. } = moves();
    let root = scene.parents(switch).next().unwrap();
    let rules = RuleSet::new().with(SlidingRule).over(&rules());
    right(&mut scene, view);
    scene.take_log();
    let other = scene.open_view(root, &rules).unwrap();
    scene.set_moving::<Time>(other, 5.0).unwrap();
    assert_eq!(right(&mut scene, other), 52.0);
    assert_eq!(compiled(&mut scene, "sliding"), 0);
    assert_eq!(right(&mut scene, view), 12.0);
    scene.set_moving::<Time>(view, 3.0).unwrap();
    assert_eq!((right(&mut scene, view), right(&mut scene, other)), (32.0, 52.0));
}

#[test]
fn what_was_switched_off_while_time_went_by_is_where_it_belongs() {
    let Moves { mut scene, view, switch, .. } = moves();
    assert_eq!(right(&mut scene, view), 12.0);
    scene.edit(switch, |switch| switch.on = false).unwrap();
    assert_eq!(right(&mut scene, view), 1.099);
    scene.set_moving::<Time>(view, 7.0).unwrap();
    assert_eq!(right(&mut scene, view), 1.099);
    scene.edit(switch, |switch| switch.on = true).unwrap();
    assert_eq!(right(&mut scene, view), 72.0);
    scene.set_moving::<Time>(view, 8.0).unwrap();
    assert_eq!(right(&mut scene, view), 82.0);
}

#[test]
fn sliding_things_slide_inside_each_other() {
    let Moves { mut scene, view, sliding, .. } = moves();
    let inner = scene.add_to(sliding, Sliding { speed: 1.0 }).unwrap();
    scene.add_to(inner, Plain { size: 4.0 }).unwrap();
    assert_eq!(right(&mut scene, view), 15.0);
    scene.set_moving::<Time>(view, 2.0).unwrap();
    assert_eq!(right(&mut scene, view), 26.0);
}
