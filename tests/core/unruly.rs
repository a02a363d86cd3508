//! Unruly rules: rings, reads that depend on reads, panics where none is expected, and
//! interruptions that a rule keeps to itself. The scene stays right, and every call returns.

use sapwood::geom::content;
use sapwood::geom::glam::Affine3;
use sapwood::graph::{Interrupted, Named};
use sapwood::scene::{
    Attribute, Budget, Component, Context, Group, Held, Moving, Projection, Rule, RuleError,
    RuleSet, Scene, Slot, SlotReader, ViewError, VisitContext, built_in_rules,
};

use super::kinds::{Plain, PlainRule, Size, checked_scene};

macro_rules! kind {
    ($kind:ident, $name:literal) => {
        struct $kind;
        content!($kind {});
        impl Named for $kind {
            const NAME: &'static str = $name;
        }
        impl Component for $kind {}
    };
}

macro_rules! rule {
    ($rule:ident, $kind:ident, $name:literal, $cx:ident => $init:expr) => {
        struct $rule;
        impl Rule for $rule {
            type Component = $kind;
            type Data = ();
            const NAME: &'static str = $name;
            fn init(&self, _: &$kind, $cx: &mut Context<'_>) -> Result<(), RuleError> {
                $init
            }
        }
    };
}

kind!(Both, "both");
kind!(Hen, "hen");
kind!(Egg, "egg");
rule!(BothRule, Both, "both", cx => { cx.emit(Hen); cx.emit(Egg); Ok(()) });
rule!(HenRule, Hen, "hen", cx => { cx.emit(Egg); Ok(()) });
rule!(EggRule, Egg, "egg", cx => { cx.emit(Hen); Ok(()) });

#[test]
fn two_kinds_that_emit_each_other_are_told_the_same_from_wherever_they_are_met() {
    let rules = RuleSet::new().with(BothRule).with(HenRule).with(EggRule).over(&built_in_rules());
    let mut scene = checked_scene();
    let root = scene.add(Group);
    scene.add_to(root, Both).unwrap();
    let view = scene.open_view(root, &rules).unwrap();
    assert!(scene.bounds(view).unwrap().is_empty());
    let counts = scene.count(view).unwrap();
    assert_eq!((counts.components_of("hen"), counts.components_of("egg")), (1, 1));
    let why = scene.diagnostics(view, 10).unwrap();
    let why: Vec<String> = why.into_iter().map(|(_, why)| why.to_string()).collect();
    let message = "the component contains itself with nothing changed";
    assert_eq!(why, [format!("egg: {message}"), format!("hen: {message}")]);
    let dump = scene.dump(view, 100).unwrap();
    for first in ["hen", "egg"] {
        let mut scene = checked_scene();
        let root = scene.add(Group);
        match first {
            "hen" => scene.add_to(root, Hen).map(|hen| hen.id()),
            _ => scene.add_to(root, Egg).map(|egg| egg.id()),
        }
        .unwrap();
        scene.add_to(root, Both).unwrap();
        let view = scene.open_view(root, &rules).unwrap();
        let text = scene.dump(view, 100).unwrap();
        let below: Vec<&str> = text.lines().skip_while(|line| !line.contains("both")).collect();
        assert_eq!(below, dump.lines().skip(1).collect::<Vec<_>>(), "{text}");
    }
}

enum Asked {}
impl Slot for Asked {
    type Value = bool;
    type Rate = Held;
    const NAME: &'static str = "asked";
    fn default() -> bool {
        false
    }
}

/// Reads the size only when asked to; fails to think of negative sizes.
struct SizeIfAsked;
content!(SizeIfAsked {});
impl Projection for SizeIfAsked {
    type Output = f32;
    const NAME: &'static str = "size_if_asked";
    fn compute(&self, slots: &mut SlotReader<'_>) -> f32 {
        if !*slots.read::<Asked>() {
            return 0.0;
        }
        let size = *slots.read::<Size>();
        assert!(size >= 0.0, "no size is negative");
        size
    }
}

kind!(Curious, "curious");
rule!(CuriousRule, Curious, "curious", cx => {
    let size = cx.project(SizeIfAsked);
    cx.emit(Plain { size });
    Ok(())
});

fn curious_rules() -> RuleSet {
    RuleSet::new().with(CuriousRule).with(PlainRule).over(&built_in_rules())
}

#[test]
fn a_projection_that_reads_more_is_not_taken_for_one_that_read_less() {
    let mut scene = checked_scene();
    let attribute = scene.add(Attribute::new().with::<Size>(0.0));
    scene.add_to(attribute, Curious).unwrap();
    let view = scene.open_view(attribute, &curious_rules()).unwrap();
    let width = |scene: &mut Scene| scene.bounds(view).unwrap().aabb.size().x;
    assert_eq!(width(&mut scene), 0.0);
    // The result is the same; what it was made from is not.
    scene.push::<Asked>(attribute, true).unwrap();
    assert_eq!(width(&mut scene), 0.0);
    scene.push::<Size>(attribute, 5.0).unwrap();
    assert_eq!(width(&mut scene), 5.0);
}

#[test]
fn a_projection_that_panics_fails_its_component_until_its_slots_are_mended() {
    let mut scene = checked_scene();
    let attribute = scene.add(Attribute::new().with::<Asked>(true).with::<Size>(2.0));
    scene.add_to(attribute, Curious).unwrap();
    let view = scene.open_view(attribute, &curious_rules()).unwrap();
    assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 2.0);
    scene.push::<Size>(attribute, -1.0).unwrap();
    assert!(scene.bounds(view).unwrap().is_empty());
    let why = scene.diagnostics(view, 10).unwrap().remove(0).1.to_string();
    assert_eq!(why, "curious: rule curious panicked: no size is negative");
    scene.push::<Size>(attribute, 3.0).unwrap();
    assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 3.0);
    assert_eq!(scene.diagnostics(view, 10).unwrap(), []);
}

enum Time {}
impl Slot for Time {
    type Value = f32;
    type Rate = Moving;
    const NAME: &'static str = "time";
    fn default() -> f32 {
        0.0
    }
}

kind!(Clock, "clock");
struct ClockRule;
impl Rule for ClockRule {
    type Component = Clock;
    type Data = ();
    const NAME: &'static str = "clock";
    fn init(&self, _: &Clock, cx: &mut Context<'_>) -> Result<(), RuleError> {
        cx.live(|cx| cx.emit(Plain { size: 1.0 }));
        Ok(())
    }
    fn visit(&self, (): &(), cx: &VisitContext<'_>, live: &mut [Affine3]) {
        let time = *cx.read::<Time>();
        assert!(time != 1.0, "one o'clock is not for me");
        live[0] = Affine3::from_translation([time, 0.0, 0.0].into());
    }
}

#[test]
fn a_visit_that_panics_leaves_the_view_usable_and_is_told() {
    let rules = RuleSet::new().with(ClockRule).with(PlainRule).over(&built_in_rules());
    let mut scene = checked_scene();
    let root = scene.add(Group);
    scene.add_to(root, Clock).unwrap();
    scene.add_to(root, Plain { size: 0.5 }).unwrap();
    let view = scene.open_view(root, &rules).unwrap();
    assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 1.0);
    scene.set_moving::<Time>(view, 1.0).unwrap();
    assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 1.0, "as it was before");
    let why = scene.diagnostics(view, 10).unwrap().remove(0).1.to_string();
    assert_eq!(why, "clock: visit of rule clock panicked: one o'clock is not for me");
    scene.set_moving::<Time>(view, 2.0).unwrap();
    assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 3.0);
    assert_eq!(scene.diagnostics(view, 10).unwrap(), []);
}

kind!(Secretive, "secretive");
rule!(SecretiveRule, Secretive, "secretive", cx => {
    // Takes a refusal for a failure of its own.
    cx.reserve_triangles(100).map_err(|_| RuleError::Failed("no room".to_owned()))?;
    cx.emit(Plain { size: 1.0 });
    Ok(())
});

#[test]
fn an_interruption_that_a_rule_hides_is_not_remembered() {
    let rules = RuleSet::new().with(SecretiveRule).with(PlainRule).over(&built_in_rules());
    let mut scene = checked_scene();
    let root = scene.add(Secretive);
    let view = scene.open_view(root, &rules).unwrap();
    scene.set_budget(view, Budget { triangles: 50, ..Budget::default() }).unwrap();
    let why = Interrupted::Exhausted { what: "triangles", limit: 50, component: "secretive" };
    assert_eq!(scene.bounds(view), Err(ViewError::Interrupted(why)));
    scene.set_budget(view, Budget::default()).unwrap();
    assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 1.0);
}

kind!(Litter, "litter");
rule!(LitterRule, Litter, "litter", cx => {
    (0..9).for_each(|_| cx.emit(Plain { size: 1.0 }));
    Ok(())
});

#[test]
fn equal_components_are_one_plan_in_the_budget_and_check_mode_costs_none() {
    let rules = RuleSet::new().with(LitterRule).with(PlainRule).over(&built_in_rules());
    let mut scene = checked_scene();
    let root = scene.add(Litter);
    let budget = Budget { plans: 9, ..Budget::default() };
    for _ in 0..2 {
        let view = scene.open_view(root, &rules).unwrap();
        scene.set_budget(view, budget).unwrap();
        assert_eq!(scene.count(view).unwrap().components_of("plain"), 9);
    }
}

mod elsewhere {
    use super::*;

    // The same kind, name and version as another rule, and another Rust type.
    rule!(LitterRule, Litter, "litter", _cx => Ok(()));

    pub(super) fn rules() -> RuleSet {
        RuleSet::new().with(LitterRule).with(PlainRule).over(&built_in_rules())
    }
}

#[test]
fn two_rule_types_of_one_name_are_two_rules() {
    let mut scene = checked_scene();
    let root = scene.add(Litter);
    let rules = RuleSet::new().with(LitterRule).with(PlainRule).over(&built_in_rules());
    let view = scene.open_view(root, &rules).unwrap();
    assert_eq!(scene.count(view).unwrap().components_of("plain"), 9);
    scene.set_rules(view, &elsewhere::rules()).unwrap();
    assert_eq!(scene.count(view).unwrap().components_of("plain"), 0);
}

#[test]
fn a_closed_view_stays_closed_when_another_takes_its_place() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let first = scene.open_view(root, &built_in_rules()).unwrap();
    scene.close_view(first).unwrap();
    let second = scene.open_view(root, &built_in_rules()).unwrap();
    assert_ne!(first, second);
    assert_eq!(scene.count(first), Err(ViewError::Closed));
    assert_eq!(scene.close_view(first), Err(ViewError::Closed));
    assert!(scene.cancel_token(first).is_err());
    assert!(scene.count(second).is_ok());
}

#[test]
fn rule_sets_may_have_very_many_layers() {
    let mut rules = curious_rules();
    for _ in 0..100_000 {
        rules = RuleSet::new().over(&rules);
    }
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let view = scene.open_view(root, &rules).unwrap();
    assert!(scene.bounds(view).unwrap().is_empty());
    drop(rules);
}
