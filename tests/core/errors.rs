//! What goes wrong stays where it arose: failures, panics, recursion, budgets, cancelling.

use std::sync::atomic::{AtomicU32, Ordering};

use sapwood::geom::{SharedMesh, content};
use sapwood::graph::{Interrupted, Material, Named};
use sapwood::scene::{
    Attribute, Budget, CancelToken, Component, Context, Group, Rule, RuleError, RuleSet, Scene,
    Transform, ViewError, ViewId,
};

use super::kinds::*;

/// Fails, panics, or draws, by the slot that it reads.
#[derive(Debug, Clone)]
struct Moody {}
content!(Moody {});
impl Named for Moody {
    const NAME: &'static str = "moody";
}
impl Component for Moody {}

struct MoodyRule;
impl Rule for MoodyRule {
    type Component = Moody;
    type Data = ();
    const NAME: &'static str = "moody_rule";
    fn init(&self, _: &Moody, cx: &mut Context<'_>) -> Result<(), RuleError> {
        let size = *cx.read::<Size>();
        cx.emit(Plain { size: 100.0 });
        if size == 2.0 {
            return Err(RuleError::Failed("size 2 is not to my taste".to_owned()));
        }
        assert!(size != 3.0, "size 3 is worse, on purpose");
        Ok(())
    }
}

/// Contains itself, a little larger each time where it grows.
#[derive(Debug, Clone)]
struct Endless {
    size: u32,
    grows: bool,
}
content!(Endless { size, grows });
impl Named for Endless {
    const NAME: &'static str = "endless";
}
impl Component for Endless {}

struct EndlessRule;
impl Rule for EndlessRule {
    type Component = Endless;
    type Data = ();
    const NAME: &'static str = "endless_rule";
    fn init(&self, endless: &Endless, cx: &mut Context<'_>) -> Result<(), RuleError> {
        cx.emit(Plain { size: endless.size as f32 });
        cx.emit(Endless { size: endless.size + u32::from(endless.grows), ..*endless });
        Ok(())
    }
}

fn all_rules() -> RuleSet {
    RuleSet::new().with(MoodyRule).with(EndlessRule).over(&rules())
}

fn messages(scene: &mut Scene, view: ViewId) -> Vec<(Vec<u32>, String)> {
    let found = scene.diagnostics(view, 100).unwrap();
    found.into_iter().map(|(path, diagnostic)| (path, diagnostic.to_string())).collect()
}

#[test]
fn failures_and_panics_leave_the_rest_intact_and_are_not_retried() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let plain = scene.add_to(root, Plain { size: 1.0 }).unwrap();
    let attribute = scene.add_to(root, Attribute::new().with::<Size>(2.0)).unwrap();
    let group = scene.add_to(attribute, Group).unwrap();
    scene.add_to(group, Moody {}).unwrap();
    scene.add_to(group, Sized).unwrap();
    let view = scene.open_view(root, &all_rules()).unwrap();
    assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 2.0);
    let fails = (vec![0, 1, 0, 0], "moody: size 2 is not to my taste".to_owned());
    assert_eq!(messages(&mut scene, view), std::slice::from_ref(&fails));
    assert_eq!(compiled(&mut scene, "moody"), 1);
    scene.edit(plain, |plain| plain.size = 4.0).unwrap();
    assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 4.0);
    assert_eq!(compiled(&mut scene, "moody"), 0, "nothing that it reads has changed");
    scene.push::<Size>(attribute, 3.0).unwrap();
    assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 4.0);
    let panics = messages(&mut scene, view);
    let why = "moody: rule moody_rule panicked: size 3 is worse, on purpose";
    assert_eq!(panics, [(vec![0, 1, 0, 0], why.to_owned())]);
    assert_eq!(compiled(&mut scene, "moody"), 1);
    scene.bounds(view).unwrap();
    scene.push::<Size>(attribute, 5.0).unwrap();
    assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 100.0);
    assert_eq!(messages(&mut scene, view), []);
    scene.push::<Size>(attribute, 2.0).unwrap();
    assert_eq!(messages(&mut scene, view), [fails]);
    assert_eq!(compiled(&mut scene, "moody"), 1, "only for the value 5; the failure was kept");
}

#[test]
fn a_kind_without_a_rule_is_named() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    scene.add_to(root, Plain { size: 1.0 }).unwrap();
    scene.add_to(root, Moody {}).unwrap();
    let view = scene.open_view(root, &rules()).unwrap();
    assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 1.0);
    let why = "moody: the view has no rule for components of kind moody";
    assert_eq!(messages(&mut scene, view), [(vec![0, 1], why.to_owned())]);
    scene.set_rules(view, &all_rules()).unwrap();
    assert_eq!(messages(&mut scene, view), []);
    assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 100.0);
}

#[test]
fn what_emits_itself_is_a_cycle() {
    let mut scene = checked_scene();
    let root = scene.add(Endless { size: 1, grows: false });
    let view = scene.open_view(root, &all_rules()).unwrap();
    assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 1.0);
    let found = messages(&mut scene, view);
    assert!(found.len() == 1 && found[0].1.contains("contains itself"), "{found:?}");
    assert!(compiled(&mut scene, "endless") <= 2);
}

#[test]
fn what_emits_ever_more_meets_the_depth_limit() {
    let mut scene = checked_scene();
    let root = scene.add(Endless { size: 1, grows: true });
    let view = scene.open_view(root, &all_rules()).unwrap();
    let budget = Budget { emitted_depth: 50, ..Budget::default() };
    scene.set_budget(view, budget).unwrap();
    assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 50.0);
    let found = messages(&mut scene, view);
    let why = ["plain", "endless"]
        .map(|kind| format!("{kind}: more than 50 emitted components lie above each other"));
    assert_eq!(found.iter().map(|(_, why)| why).collect::<Vec<_>>(), why.each_ref());
    scene.set_budget(view, Budget { emitted_depth: 60, ..budget }).unwrap();
    assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 60.0);
}

/// Draws as many triangles as it says, and asks to be cancelled on the way.
#[derive(Debug, Clone)]
struct Heavy {
    n: u32,
}
content!(Heavy { n });
impl Named for Heavy {
    const NAME: &'static str = "heavy";
}
impl Component for Heavy {}

struct HeavyRule;
impl Rule for HeavyRule {
    type Component = Heavy;
    type Data = ();
    const NAME: &'static str = "heavy";
    fn init(&self, heavy: &Heavy, cx: &mut Context<'_>) -> Result<(), RuleError> {
        cx.reserve_triangles(u64::from(heavy.n))?;
        let mut mesh = triangle(heavy.n as f32);
        mesh.indices = mesh.indices.repeat(heavy.n as usize);
        cx.mesh(SharedMesh::new(mesh), Material::matte("m", 1.0, 1.0, 1.0).into());
        Ok(())
    }
}

#[test]
fn an_exhausted_budget_is_told_and_not_remembered() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    for n in [10, 20, 30] {
        scene.add_to(root, Heavy { n }).unwrap();
    }
    let rules = RuleSet::new().with(HeavyRule).over(&rules());
    let view = scene.open_view(root, &rules).unwrap();
    let budget = Budget { triangles: 50, ..Budget::default() };
    scene.set_budget(view, budget).unwrap();
    let error = scene.bounds(view).unwrap_err();
    let (what, limit, component) = ("triangles", 50, "heavy");
    let why = Interrupted::Exhausted { what, limit, component };
    assert_eq!(error, ViewError::Interrupted(why.clone()));
    assert!(why.to_string().contains("more than 50 triangles"));
    assert!(scene.count(view).is_err());
    scene.take_log();
    scene.set_budget(view, Budget { triangles: 60, ..budget }).unwrap();
    assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 30.0);
    assert_eq!(compiled(&mut scene, "heavy"), 1, "what was compiled before is kept");
}

#[test]
fn a_budget_of_plans_ends_what_multiplies() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let view = scene.open_view(root, &rules()).unwrap();
    let budget = Budget { plans: 20, ..Budget::default() };
    scene.set_budget(view, budget).unwrap();
    for n in 0..30 {
        scene.add_to(root, Plain { size: n as f32 }).unwrap();
    }
    let why = Interrupted::Exhausted { what: "plans", limit: 20, component: "plain" };
    assert_eq!(scene.bounds(view), Err(ViewError::Interrupted(why)));
    scene.set_budget(view, Budget { plans: 40, ..budget }).unwrap();
    assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 29.0);
}

#[test]
fn what_nothing_shows_any_more_makes_room_in_the_budget() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let heavy = scene.add_to(root, Heavy { n: 30 }).unwrap();
    scene.add_to(root, Heavy { n: 10 }).unwrap();
    let rules = RuleSet::new().with(HeavyRule).over(&rules());
    let view = scene.open_view(root, &rules).unwrap();
    scene.set_budget(view, Budget { triangles: 50, ..Budget::default() }).unwrap();
    for n in 25..=40 {
        scene.edit(heavy, |heavy| heavy.n = n).unwrap();
        assert_eq!(scene.bounds(view).unwrap().aabb.max.x, n as f32);
    }
    scene.edit(heavy, |heavy| heavy.n = 41).unwrap();
    assert!(scene.bounds(view).is_err());
    scene.edit(heavy, |heavy| heavy.n = 5).unwrap();
    assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 10.0);
}

#[test]
fn plans_of_earlier_edits_make_room_in_a_budget_of_plans() {
    let mut scene = checked_scene();
    let root = scene.add(at(0));
    scene.add_to(root, Group).unwrap();
    let view = scene.open_view(root, &rules()).unwrap();
    scene.set_budget(view, Budget { plans: 8, ..Budget::default() }).unwrap();
    for x in 0..50 {
        scene.edit(root, |root| *root = at(x)).unwrap();
        assert_eq!(scene.count(view).unwrap().components_of("group"), 1);
    }
}

/// A rule that cancels its own view at the third component.
struct CancellingRule(CancelToken, AtomicU32);
impl Rule for CancellingRule {
    type Component = Plain;
    type Data = ();
    const NAME: &'static str = "cancelling";
    fn init(&self, plain: &Plain, cx: &mut Context<'_>) -> Result<(), RuleError> {
        if self.1.fetch_add(1, Ordering::Relaxed) == 2 {
            self.0.cancel();
        }
        cx.checkpoint()?;
        cx.mesh(SharedMesh::new(triangle(plain.size)), Material::matte("m", 1.0, 1.0, 1.0).into());
        Ok(())
    }
}

#[test]
fn a_cancelled_compile_goes_on_where_it_stopped() {
    let mut scene = Scene::new();
    scene.set_logging(true);
    let root = scene.add(Group);
    for i in 0..6 {
        let moved = scene.add_to(root, at(i)).unwrap();
        scene.add_to(moved, Plain { size: 1.0 + i as f32 }).unwrap();
        scene.add_to(root, Placed).unwrap();
    }
    let plain = scene.open_view(root, &rules()).unwrap();
    let expected = scene.dump(plain, 1000).unwrap();
    let view = scene.open_view(root, &rules()).unwrap();
    let token = scene.cancel_token(view).unwrap();
    let rule = CancellingRule(token.clone(), AtomicU32::new(0));
    scene.set_rules(view, &RuleSet::new().with(rule).over(&rules())).unwrap();
    assert_eq!(scene.bounds(view), Err(ViewError::Interrupted(Interrupted::Cancelled)));
    assert_eq!(scene.bounds(view), Err(ViewError::Interrupted(Interrupted::Cancelled)));
    assert!(token.is_cancelled());
    scene.take_log();
    token.reset();
    assert_eq!(scene.dump(view, 1000).unwrap(), expected);
    assert_eq!(compiled(&mut scene, "plain"), 4, "two were compiled before");
}

struct ImpureRule(AtomicU32);
impl Rule for ImpureRule {
    type Component = Plain;
    type Data = ();
    const NAME: &'static str = "impure_rule";
    fn init(&self, _: &Plain, cx: &mut Context<'_>) -> Result<(), RuleError> {
        let size = self.0.fetch_add(1, Ordering::Relaxed) as f32;
        cx.mesh(SharedMesh::new(triangle(size)), Material::matte("m", 1.0, 1.0, 1.0).into());
        Ok(())
    }
}

#[test]
#[should_panic(expected = "rule impure_rule compiles plain differently")]
fn check_mode_names_a_rule_that_is_not_pure() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let shared = scene.add(Plain { size: 1.0 });
    for i in 0..2 {
        let moved = scene.add_to(root, at(i)).unwrap();
        scene.append(moved, shared).unwrap();
    }
    let rules = RuleSet::new().with(ImpureRule(AtomicU32::new(0))).over(&rules());
    let view = scene.open_view(root, &rules).unwrap();
    let _ = scene.bounds(view);
}

#[test]
fn a_rule_registered_twice_names_both_places() {
    let panic = std::panic::catch_unwind(|| {
        RuleSet::new().with(PlainRule).with(MoodyRule).with(ImpureRule(AtomicU32::new(0)))
    });
    let why = panic.unwrap_err().downcast::<String>().unwrap();
    assert!(why.contains("plain is registered twice, first at "), "{why}");
    assert!(why.contains("errors.rs"), "{why}");
}

#[test]
fn a_transform_that_is_not_finite_hides_what_is_below_it() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    scene.add_to(root, Plain { size: 1.0 }).unwrap();
    let bad = scene.add_to(root, Transform::translation(f32::NAN, 0.0, 0.0)).unwrap();
    scene.add_to(bad, Plain { size: 5.0 }).unwrap();
    let view = scene.open_view(root, &rules()).unwrap();
    assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 1.0);
    assert!(messages(&mut scene, view)[0].1.contains("not finite"));
    scene.edit(bad, |bad| *bad = at(1)).unwrap();
    assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 6.0);
}
