//! A view taken apart as text, and two views of one scene of which the second gives text.

use sapwood::geom::glam::Vec3;
use sapwood::graph::{Everything, Label, Order, RenderNode};
use sapwood::scene::{
    Action, Attribute, Context, Group, Placement, PushMode, Rotor, Rule, RuleError, RuleSet, Scene,
    Style, StyleSlot, Switch, Transform, ViewId,
};

use super::kinds::{Plain, rules};

#[test]
fn a_view_taken_apart() {
    let mut scene = Scene::new();
    let top = scene.add(Group);
    let shared = scene.add(Plain { size: 1.0 });
    let style = scene
        .add_to(top, Attribute::new().with_as::<StyleSlot>(PushMode::Force, Style::Wire))
        .unwrap();
    scene.append(style, shared).unwrap();
    let switch = scene.add_to(top, Switch { on: true }).unwrap();
    let place = scene.add_to(switch, Transform::translation(1.0, 0.0, 0.0)).unwrap();
    scene.append(place, shared).unwrap();
    let asked = scene.add_to(top, Attribute::new().asking::<Placement>()).unwrap();
    let values = scene.add(Transform::translation(0.0, 2.0, 0.0));
    scene.set_value_graph(asked, Some(values.id())).unwrap();
    let rotor = scene.add_to(asked, Rotor::new(Vec3::Y, 1.0)).unwrap();
    scene.add_to(rotor, Plain { size: -1.0 }).unwrap();
    scene
        .connect(place, values, "height", |place: &Transform, values: &mut Transform| {
            values.0.translation.y = place.0.translation.x;
        })
        .unwrap();
    let view = scene.open_view(top, &rules()).unwrap();
    let text = scene.explain(view, 100).unwrap();
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(concat!(env!("CARGO_MANIFEST_DIR"), "/../snapshots"));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!("explain", text));
    let short = scene.explain(view, 2).unwrap();
    assert_eq!(short.matches("lines more").count(), 3, "{short}");
}

/// Compiles boxes into words.
struct WordsRule;

impl Rule for WordsRule {
    type Component = Plain;
    type Data = ();
    const NAME: &'static str = "words";

    fn init(&self, plain: &Plain, cx: &mut Context<'_>) -> Result<(), RuleError> {
        let at = cx.read::<Placement>().translation;
        cx.label(Label::new(&format!("a box of {} m at {at}", plain.size), 0.1));
        Ok(())
    }
}

/// The labels of a view, a line each.
fn words(scene: &mut Scene, view: ViewId) -> String {
    let mut words = String::new();
    scene
        .traverse(view, Order::Pre, &Everything, &mut |at| {
            if let RenderNode::Label(label) = at.node() {
                words.push_str(&label.text);
                words.push('\n');
            }
        })
        .unwrap();
    words
}

#[test]
fn a_second_view_of_the_same_scene_gives_text() {
    let mut scene = Scene::new();
    let top = scene.add(Group);
    let plain = scene.add(Plain { size: 1.0 });
    for x in [0.0, 5.0] {
        let place = scene.add_to(top, Transform::translation(x, 0.0, 0.0)).unwrap();
        scene.append(place, plain).unwrap();
    }
    let shape = scene.open_view(top, &rules()).unwrap();
    let text = scene.open_view(top, &RuleSet::new().with(WordsRule).over(&rules())).unwrap();
    let told = "a box of 1 m at [0, 0, 0]\na box of 1 m at [5, 0, 0]\n";
    assert_eq!(words(&mut scene, text), told);
    let before = scene.bounds(shape).unwrap();

    scene.set_logging(true);
    scene.edit(plain, |plain| plain.size = 3.0).unwrap();
    assert_eq!(words(&mut scene, text), told.replace("1 m", "3 m"));
    assert_ne!(scene.bounds(shape).unwrap(), before);
    let compiled: Vec<_> = scene
        .take_log()
        .iter()
        .filter(|event| event.action == Action::Compiled)
        .map(|event| event.rule)
        .collect();
    assert_eq!(compiled, ["words", "words", "plain"], "the words read where they stand");
    assert_eq!(scene.draw_list(text, 100).unwrap().placed_labels().count(), 2);
}
