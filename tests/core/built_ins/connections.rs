//! Field connections: pulled when somebody looks, once, and never in a circle.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use sapwood::scene::{EditError, Group, Handle, NodeId, Scene, Transform, ViewId};

use super::super::kinds::*;
use super::{errors, sizes};

/// Counts how often connections were computed.
#[derive(Clone, Default)]
struct Calls(Arc<AtomicUsize>);

impl Calls {
    /// Lets one body be larger than another by `more`.
    fn enlarge(&self, scene: &mut Scene, source: Handle<Plain>, target: Handle<Plain>, more: f32) {
        let calls = self.clone();
        let drive = move |source: &Plain, target: &mut Plain| {
            calls.0.fetch_add(1, Ordering::Relaxed);
            target.size = source.size + more;
        };
        scene.connect(source, target, "size", drive).unwrap();
    }

    /// How often, since it was asked last.
    fn take(&self) -> usize {
        self.0.swap(0, Ordering::Relaxed)
    }
}

/// Bodies in a group, each one larger than the one before, and a view that does not show the
/// last one.
struct Chain {
    scene: Scene,
    view: ViewId,
    root: Handle<Group>,
    bodies: Vec<Handle<Plain>>,
    calls: Calls,
}

impl Chain {
    fn new(n: usize) -> Self {
        let mut scene = checked_scene();
        // Check mode looks more often than anybody else.
        scene.set_check_mode(false);
        let root = scene.add(Group);
        let bodies: Vec<_> = (0..n).map(|_| scene.add(Plain { size: 1.0 })).collect();
        let calls = Calls::default();
        for pair in bodies.windows(2) {
            calls.enlarge(&mut scene, pair[0], pair[1], 1.0);
        }
        for body in &bodies[..n - 1] {
            scene.append(root, *body).unwrap();
        }
        let view = scene.open_view(root, &rules()).unwrap();
        Self { scene, view, root, bodies, calls }
    }

    fn edit(&mut self, body: usize, size: f32) {
        self.scene.edit(self.bodies[body], |body| body.size = size).unwrap();
    }
}

#[test]
fn connections_are_computed_when_somebody_looks_and_once() {
    let mut chain = Chain::new(5);
    assert_eq!(chain.calls.take(), 0, "nobody has looked");
    assert_eq!(sizes(&mut chain.scene, chain.view), [1.0, 2.0, 3.0, 4.0]);
    assert_eq!(chain.calls.take(), 3, "nobody has looked at the last one");
    assert_eq!(sizes(&mut chain.scene, chain.view), [1.0, 2.0, 3.0, 4.0]);
    assert_eq!(chain.calls.take(), 0);
    chain.edit(0, 5.0);
    chain.edit(0, 6.0);
    assert_eq!(chain.calls.take(), 0);
    assert_eq!(chain.scene.get(chain.bodies[4]).unwrap().size, 10.0);
    assert_eq!(chain.calls.take(), 4);
    assert_eq!(sizes(&mut chain.scene, chain.view), [6.0, 7.0, 8.0, 9.0]);
    assert_eq!(chain.calls.take(), 0);
    chain.edit(1, 100.0);
    assert_eq!(sizes(&mut chain.scene, chain.view), [6.0, 7.0, 8.0, 9.0]);
    assert_eq!(chain.calls.take(), 3, "what was edited and what it drives");
}

#[test]
fn an_equal_result_stops_at_the_driven_component() {
    let mut chain = Chain::new(3);
    let constant = |_: &Plain, target: &mut Plain| target.size = 4.0;
    chain.scene.connect(chain.bodies[0], chain.bodies[1], "size", constant).unwrap();
    assert_eq!(sizes(&mut chain.scene, chain.view), [1.0, 4.0]);
    let plans = chain.scene.n_plans();
    chain.scene.take_log();
    chain.edit(0, 2.0);
    assert_eq!(sizes(&mut chain.scene, chain.view), [2.0, 4.0]);
    assert_eq!(all_compiled(&mut chain.scene), [("plain", 2)]);
    // The plan of what was edited stays for a while; that of what was driven is the same.
    assert_eq!(chain.scene.n_plans(), plans + 1);
}

#[test]
fn an_edit_of_other_fields_of_a_driven_component_is_seen_after_somebody_looked() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let source = scene.add(Plain { size: 2.0 });
    let moved = scene.add_to(root, Transform::translation(0.0, 1.0, 0.0)).unwrap();
    scene.add_to(moved, Plain { size: 1.0 }).unwrap();
    let drive = |source: &Plain, moved: &mut Transform| moved.0.translation.x = source.size;
    scene.connect(source, moved, "x", drive).unwrap();
    let view = scene.open_view(root, &rules()).unwrap();
    assert_eq!(super::places(&mut scene, view), [[2.0, 1.0, 0.0]]);
    scene.edit(moved, |moved| moved.0.translation.y = 7.0).unwrap();
    assert_eq!(super::places(&mut scene, view), [[2.0, 7.0, 0.0]]);
    assert_eq!(scene.get(moved).unwrap().0.translation.to_array(), [2.0, 7.0, 0.0]);
}

#[test]
fn a_diamond_computes_each_component_once() {
    let mut scene = checked_scene();
    scene.set_check_mode(false);
    let root = scene.add(Group);
    let calls = Calls::default();
    let top = scene.add(Plain { size: 1.0 });
    let mut above = [top, top];
    for _ in 0..40 {
        let row = [scene.add(Plain { size: 0.0 }), scene.add(Plain { size: 0.0 })];
        for body in row {
            calls.enlarge(&mut scene, above[0], body, 1.0);
            let counts = calls.clone();
            let drive = move |_: &Plain, _: &mut Plain| {
                counts.0.fetch_add(1, Ordering::Relaxed);
            };
            scene.connect(above[1], body, "other", drive).unwrap();
        }
        above = row;
    }
    scene.append(root, above[0]).unwrap();
    let view = scene.open_view(root, &rules()).unwrap();
    assert_eq!(sizes(&mut scene, view), [41.0]);
    assert_eq!(calls.take(), 39 * 4 + 2);
    scene.edit(top, |top| top.size = 2.0).unwrap();
    assert_eq!(sizes(&mut scene, view), [42.0]);
    assert_eq!(calls.take(), 39 * 4 + 2);
}

#[test]
fn a_chain_of_a_hundred_thousand_does_not_recurse() {
    let mut scene = Scene::new();
    let mut above = scene.add(Plain { size: 0.0 });
    let top = above;
    let drive = |above: &Plain, below: &mut Plain| below.size = above.size + 1.0;
    for _ in 0..100_000 {
        let below = scene.add(Plain { size: 0.0 });
        scene.connect(above, below, "size", drive).unwrap();
        above = below;
    }
    let view = scene.open_view(above, &rules()).unwrap();
    assert_eq!(sizes(&mut scene, view), [100_000.0]);
    scene.edit(top, |top| top.size = 1.0).unwrap();
    assert_eq!(sizes(&mut scene, view), [100_001.0]);
    let error = scene.connect(above, top, "size", drive).unwrap_err();
    assert!(error.to_string().len() < 1000, "{error}");
    scene.remove(top).unwrap();
    assert_eq!(sizes(&mut scene, view), [99_999.0]);
}

#[test]
fn a_circle_is_refused_and_its_path_named() {
    let mut chain = Chain::new(3);
    let names: Vec<(NodeId, &str)> = chain.bodies.iter().map(|b| (b.id(), "plain")).collect();
    let drive = |_: &Plain, _: &mut Plain| {};
    let mut check = |source: usize, target: usize, path: &[(NodeId, &'static str)]| {
        let (source, target) = (chain.bodies[source], chain.bodies[target]);
        let refused = chain.scene.connect(source, target, "other", drive);
        assert_eq!(refused, Err(EditError::Cycle { path: path.to_vec() }));
    };
    check(2, 0, &names);
    check(2, 1, &names[1..]);
    check(1, 1, &names[1..2]);
    assert_eq!(sizes(&mut chain.scene, chain.view), [1.0, 2.0]);
    let inputs: Vec<_> = chain.scene.inputs(chain.bodies[1]).collect();
    assert_eq!(inputs, [(chain.bodies[0].id(), "size")]);
}

#[test]
fn an_input_is_replaced_and_left_to_its_user_again() {
    let mut chain = Chain::new(3);
    let (scene, view) = (&mut chain.scene, chain.view);
    assert_eq!(sizes(scene, view), [1.0, 2.0]);
    let other = scene.add(Plain { size: 30.0 });
    chain.calls.enlarge(scene, other, chain.bodies[1], 5.0);
    assert_eq!(sizes(scene, view), [1.0, 35.0]);
    scene.edit(chain.bodies[0], |body| body.size = 2.0).unwrap();
    assert_eq!(sizes(scene, view), [2.0, 35.0]);
    assert_eq!(scene.disconnect(chain.bodies[1], "size"), Ok(true));
    assert_eq!(scene.disconnect(chain.bodies[1], "size"), Ok(false));
    assert_eq!(sizes(scene, view), [2.0, 1.0]);
    chain.calls.enlarge(scene, other, chain.bodies[1], 5.0);
    scene.remove(other).unwrap();
    assert_eq!(sizes(scene, view), [2.0, 1.0]);
    assert_eq!(scene.inputs(chain.bodies[1]).count(), 0);
    // What was driven goes; what drove it drives it no longer.
    scene.remove(chain.bodies[1]).unwrap();
    scene.edit(chain.bodies[0], |body| body.size = 3.0).unwrap();
    assert_eq!(sizes(scene, view), [3.0]);
}

#[test]
fn a_panic_fails_what_is_driven_and_nothing_else() {
    let mut chain = Chain::new(4);
    let (scene, view) = (&mut chain.scene, chain.view);
    let drive = |source: &Plain, target: &mut Plain| {
        assert!(source.size < 10.0, "too large on purpose");
        target.size = source.size;
    };
    scene.connect(chain.bodies[0], chain.bodies[1], "size", drive).unwrap();
    assert_eq!(sizes(scene, view), [1.0, 1.0, 2.0]);
    scene.edit(chain.bodies[0], |body| body.size = 10.0).unwrap();
    assert_eq!(sizes(scene, view), [10.0]);
    let message = "what drives input size panicked: too large on purpose".to_owned();
    assert_eq!(errors(scene, view), [("plain", message.clone()), ("plain", message)]);
    // Not tried again until something has changed.
    scene.take_log();
    assert_eq!(sizes(scene, view), [10.0]);
    assert_eq!(all_compiled(scene), []);
    scene.edit(chain.bodies[0], |body| body.size = 5.0).unwrap();
    assert_eq!(sizes(scene, view), [5.0, 5.0, 6.0]);
}

#[test]
fn what_is_driven_is_driven_at_all_its_places() {
    let mut chain = Chain::new(3);
    let (scene, view) = (&mut chain.scene, chain.view);
    let moved = scene.add_to(chain.root, at(5)).unwrap();
    scene.append(moved, chain.bodies[1]).unwrap();
    assert_eq!(sizes(scene, view), [1.0, 2.0, 2.0]);
    scene.take_log();
    scene.edit(chain.bodies[0], |body| body.size = 4.0).unwrap();
    assert_eq!(sizes(scene, view), [4.0, 5.0, 5.0]);
    assert_eq!(all_compiled(scene), [("plain", 2)]);
}

/// A component whose copying panics when it is large.
#[derive(Debug)]
struct Brittle {
    size: f32,
}
sapwood::geom::content!(Brittle { size });
impl sapwood::graph::Named for Brittle {
    const NAME: &'static str = "brittle";
}
impl sapwood::scene::Component for Brittle {}

impl Clone for Brittle {
    fn clone(&self) -> Self {
        assert!(self.size < 5.0, "too large to copy");
        Self { size: self.size }
    }
}

struct BrittleRule;
impl sapwood::scene::Rule for BrittleRule {
    type Component = Brittle;
    type Data = ();
    const NAME: &'static str = "brittle";

    fn init(
        &self,
        brittle: &Brittle,
        cx: &mut sapwood::scene::Context<'_>,
    ) -> Result<(), sapwood::scene::RuleError> {
        cx.label(sapwood::graph::Label::new("brittle", brittle.size));
        Ok(())
    }
}

#[test]
fn a_copy_that_panics_fails_its_component_alone() {
    let mut scene = Scene::new();
    let top = scene.add(Group);
    let source = scene.add_to(top, Plain { size: 1.0 }).unwrap();
    let brittle = scene.add_to(top, Brittle { size: 9.0 }).unwrap();
    let drive = |source: &Plain, brittle: &mut Brittle| brittle.size = source.size;
    scene.connect(source, brittle, "size", drive).unwrap();
    let rules = sapwood::scene::RuleSet::new().with(BrittleRule).over(&rules());
    let view = scene.open_view(top, &rules).unwrap();
    let found = scene.diagnostics(view, 9).unwrap();
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].1.message, "its copying panicked: too large to copy");
    assert!(scene.get(brittle).is_none() && scene.get(source).is_some());
    scene.edit(brittle, |brittle| brittle.size = 2.0).unwrap();
    assert!(scene.diagnostics(view, 9).unwrap().is_empty());
    assert_eq!(scene.get(brittle).unwrap().size, 1.0);
}

#[test]
fn handles_of_another_scene_are_refused() {
    let mut other = Scene::new();
    let foreign = other.add(Plain { size: 1.0 });
    let mut scene = Scene::new();
    scene.add(Group);
    let plain = scene.add(Plain { size: 2.0 });
    let copy = |source: &Plain, target: &mut Plain| target.size = source.size;
    assert!(scene.connect(plain, foreign, "size", copy).is_err());
    assert!(scene.connect(foreign, plain, "size", copy).is_err());
    assert_eq!(scene.get(plain).unwrap().size, 2.0);
}

#[test]
fn who_takes_over_an_input_takes_over_its_turn() {
    let mut scene = Scene::new();
    let (a, b) = (scene.add(Plain { size: 1.0 }), scene.add(Plain { size: 2.0 }));
    let target = scene.add(Plain { size: 0.0 });
    let set = |source: &Plain, target: &mut Plain| target.size = source.size;
    let double = |_: &Plain, target: &mut Plain| target.size *= 10.0;
    scene.connect(a, target, "first", set).unwrap();
    scene.connect(a, target, "second", double).unwrap();
    scene.connect(b, target, "first", set).unwrap();
    assert_eq!(scene.get(target).unwrap().size, 20.0);
    let inputs: Vec<_> = scene.inputs(target).collect();
    assert_eq!(inputs, [(b.id(), "first"), (a.id(), "second")]);
}
