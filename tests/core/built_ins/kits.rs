//! Kits: parts by name, parameters that drive them, and templates used wrongly.

use std::panic::{AssertUnwindSafe, catch_unwind};

use sapwood::geom::content;
use sapwood::graph::Named;
use sapwood::scene::{
    EditError, Group, Handle, Kit, KitRule, KitTemplate, RuleSet, Scene, Transform,
};

use super::super::kinds::*;
use super::{places, sizes};

/// The parameters of a lamp.
#[derive(Debug, Clone)]
struct Lamp {
    height: f32,
    bulb: f32,
}
content!(Lamp { height, bulb });
impl Named for Lamp {
    const NAME: &'static str = "lamp";
}

fn template() -> KitTemplate<Lamp> {
    KitTemplate::<Lamp>::new()
        .part("foot", Plain { size: 3.0 })
        .part("pole", Transform::translation(0.0, 1.0, 0.0))
        .part_under("pole", "bulb", Plain { size: 1.0 })
        .expose("pole", "height", |lamp, pole: &mut Transform| pole.0.translation.y = lamp.height)
        .expose("bulb", "size", |lamp, bulb: &mut Plain| bulb.size = lamp.bulb)
}

fn kit_rules() -> RuleSet {
    RuleSet::new().with(KitRule::<Lamp>::new()).over(&rules())
}

fn lamp(scene: &mut Scene, height: f32, bulb: f32) -> Handle<Kit<Lamp>> {
    scene.add_kit(&template(), Lamp { height, bulb }).unwrap()
}

#[test]
fn parameters_drive_parts_and_parts_are_found_by_name() {
    let mut scene = checked_scene();
    let kit = lamp(&mut scene, 2.0, 0.5);
    let view = scene.open_view(kit, &kit_rules()).unwrap();
    assert_eq!(sizes(&mut scene, view), [3.0, 0.5]);
    assert_eq!(places(&mut scene, view), [[0.0; 3], [0.0, 2.0, 0.0]]);
    assert_eq!(scene.get(kit).unwrap().names().collect::<Vec<_>>(), ["foot", "pole", "bulb"]);
    let foot: Handle<Plain> = scene.part(kit, "foot").unwrap();
    assert!(scene.part::<_, Transform>(kit, "foot").is_none(), "it is another component");
    assert!(scene.part::<_, Plain>(kit, "shade").is_none());
    scene.take_log();
    scene.edit(kit, |kit| kit.parameters.height = 5.0).unwrap();
    assert_eq!(places(&mut scene, view), [[0.0; 3], [0.0, 5.0, 0.0]]);
    // The bulb is looked at again, and found equal.
    assert_eq!(all_compiled(&mut scene), [("lamp", 1), ("plain", 1), ("transform", 1)]);
    scene.edit(foot, |foot| foot.size = 4.0).unwrap();
    assert_eq!(sizes(&mut scene, view), [4.0, 0.5]);
    assert_eq!(all_compiled(&mut scene), [("plain", 1)]);
    scene.remove(foot).unwrap();
    assert!(scene.part::<_, Plain>(kit, "foot").is_none());
    assert_eq!(sizes(&mut scene, view), [0.5]);
    assert_eq!(scene.remove(kit).unwrap().len(), 3);
    assert_eq!(scene.n_nodes(), 0);
}

#[test]
fn a_kit_at_two_places_is_one_kit_and_two_kits_are_two() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let [one, other] = [2.0, 3.0].map(|height| lamp(&mut scene, height, 1.0));
    for (x, kit) in [(0, one), (5, one), (9, other)] {
        let moved = scene.add_to(root, at(x)).unwrap();
        scene.append(moved, kit).unwrap();
    }
    let view = scene.open_view(root, &kit_rules()).unwrap();
    let heights = |scene: &mut Scene| -> Vec<f32> {
        places(scene, view).iter().map(|[_, y, _]| *y).filter(|y| *y > 0.0).collect()
    };
    assert_eq!(heights(&mut scene), [2.0, 2.0, 3.0]);
    scene.take_log();
    scene.edit(one, |kit| kit.parameters.height = 7.0).unwrap();
    assert_eq!(heights(&mut scene), [7.0, 7.0, 3.0]);
    assert_eq!(all_compiled(&mut scene), [("lamp", 1), ("plain", 1), ("transform", 1)]);
}

#[test]
fn a_rule_set_may_show_the_whole_kit_as_something_else() {
    let mut scene = checked_scene();
    let kit = lamp(&mut scene, 2.0, 1.0);
    let view = scene.open_view(kit, &rules()).unwrap();
    let errors = super::errors(&mut scene, view);
    assert_eq!(errors.len(), 1, "without a rule for the kit there is nothing to see");
    assert!(errors[0].1.contains("lamp"), "{errors:?}");
}

#[test]
fn a_template_that_overfills_a_part_places_nothing() {
    let template = template().part_under("pole", "second", Plain { size: 1.0 });
    let mut scene = Scene::new();
    let refused = scene.add_kit(&template, Lamp { height: 1.0, bulb: 1.0 });
    assert!(matches!(refused, Err(EditError::Full { kind: "transform", .. })), "{refused:?}");
    assert_eq!(scene.n_nodes(), 0);
    assert_eq!(scene.fault(), None);
}

#[test]
fn templates_used_wrongly_name_kit_and_part() {
    let check = |misuse: fn() -> KitTemplate<Lamp>, expected: &str| {
        let panic = catch_unwind(AssertUnwindSafe(misuse)).err().unwrap();
        assert_eq!(panic.downcast_ref::<String>().unwrap(), expected);
    };
    check(|| template().part("foot", Group), "kit lamp has a part foot already");
    check(|| template().part_under("shade", "new", Group), "kit lamp has no part shade");
    check(|| template().expose("shade", "x", |_, _: &mut Plain| {}), "kit lamp has no part shade");
    check(
        || template().expose("foot", "x", |_, _: &mut Transform| {}),
        "part foot of kit lamp is a plain, no transform",
    );
}

/// The parameters of a row of two lamps.
#[derive(Debug, Clone)]
struct Row {
    height: f32,
}
content!(Row { height });
impl Named for Row {
    const NAME: &'static str = "row";
}

#[test]
fn a_kit_is_a_part_of_a_kit() {
    let low = Lamp { height: 1.0, bulb: 1.0 };
    let row = KitTemplate::<Row>::new()
        .kit("lamp", template(), low)
        .expose("lamp", "height", |row: &Row, lamp: &mut Kit<Lamp>| {
            lamp.parameters.height = row.height;
        })
        .part("twin", Plain { size: 9.0 })
        .wire("lamp", "twin", "size", |lamp: &Kit<Lamp>, twin: &mut Plain| {
            twin.size = lamp.parameters.height;
        });
    let mut scene = checked_scene();
    let rules = RuleSet::new().with(KitRule::<Row>::new()).over(&kit_rules());
    let kit = scene.add_kit(&row, Row { height: 7.0 }).unwrap();
    let view = scene.open_view(kit, &rules).unwrap();
    assert_eq!(sizes(&mut scene, view), [3.0, 1.0, 7.0]);
    assert_eq!(places(&mut scene, view)[1], [0.0, 7.0, 0.0]);
    scene.edit(kit, |kit| kit.parameters.height = 8.0).unwrap();
    assert_eq!(sizes(&mut scene, view), [3.0, 1.0, 8.0]);
    assert_eq!(places(&mut scene, view)[1], [0.0, 8.0, 0.0]);
    let lamp: Handle<Kit<Lamp>> = scene.part(kit, "lamp").unwrap();
    assert!(scene.part::<_, Plain>(lamp, "bulb").is_some());
}

#[test]
fn a_copy_of_a_kit_has_no_parts_of_another() {
    let mut scene = checked_scene();
    let kit = lamp(&mut scene, 2.0, 0.5);
    let copy = scene.get(kit).unwrap().clone();
    let copy = scene.add(copy);
    assert!(scene.part::<_, Plain>(copy, "foot").is_none());
    assert!(scene.part::<_, Plain>(kit, "foot").is_some());
}
