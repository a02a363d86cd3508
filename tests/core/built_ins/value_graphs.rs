//! Value sub-graphs: what they answer, and what runs when that changes.

use sapwood::geom::content;
use sapwood::geom::glam::Affine3;
use sapwood::graph::Named;
use sapwood::scene::{
    Attribute, Children, Component, EditError, Group, Handle, Held, NodeId, Placement, PushMode,
    Question, Scene, Selector, Slot, Switch, Transform, ViewId,
};

use super::super::kinds::*;
use super::{errors, places, sizes};

/// A slot whose offers are added up.
enum Sum {}
impl Slot for Sum {
    type Value = f32;
    type Rate = Held;
    const NAME: &'static str = "sum";
    const COMBINES: bool = true;
    fn default() -> f32 {
        -1.0
    }
    fn combine(earlier: &f32, later: &f32) -> f32 {
        earlier + later
    }
}

/// Offers a share of a sum, and its number as a size.
#[derive(Debug, Clone)]
struct Share {
    value: f32,
}
content!(Share { value });
impl Named for Share {
    const NAME: &'static str = "share";
}
impl Component for Share {
    const CHILDREN: Children = Children::Many;
    fn answer(&self, question: &mut Question) {
        question.offer::<Sum>(self.value);
        question.offer::<Size>(self.value);
        question.children();
    }
}

/// An attribute over a leaf, and a value sub-graph that begins with a group.
struct Asking {
    scene: Scene,
    view: ViewId,
    attribute: Handle<Attribute>,
    top: Handle<Group>,
}

impl Asking {
    fn new(attribute: Attribute) -> Self {
        let mut scene = checked_scene();
        let attribute = scene.add(attribute);
        let group = scene.add_to(attribute, Group).unwrap();
        scene.add_to(group, Sized).unwrap();
        scene.add_to(group, Placed).unwrap();
        let top = scene.add(Group);
        scene.set_value_graph(attribute, Some(top.id())).unwrap();
        let view = scene.open_view(attribute, &rules()).unwrap();
        Self { scene, view, attribute, top }
    }

    /// Checks the sizes that the leaves see, and what ran for it.
    fn shows(&mut self, sized: f32, placed: f32, ran: &[(&'static str, usize)]) {
        assert_eq!(sizes(&mut self.scene, self.view), [sized, placed]);
        assert_eq!(all_compiled(&mut self.scene), ran);
    }
}

#[test]
fn an_edit_runs_the_asker_and_an_equal_answer_stops_there() {
    let mut asking = Asking::new(Attribute::new().asking::<Size>());
    asking.shows(1.0, 1.0, &[("attribute", 1), ("group", 1), ("placed", 1), ("sized", 1)]);
    let top = asking.top;
    let first = asking.scene.add_to(top, Share { value: 5.0 }).unwrap();
    asking.shows(5.0, 1.0, &[("attribute", 1), ("sized", 1)]);
    let last = asking.scene.add_to(top, Share { value: 6.0 }).unwrap();
    asking.shows(6.0, 1.0, &[("attribute", 1), ("sized", 1)]);
    asking.scene.edit(first, |first| first.value = 7.0).unwrap();
    asking.shows(6.0, 1.0, &[("attribute", 1)]);
    asking.scene.reorder(top, 0, 1).unwrap();
    asking.shows(7.0, 1.0, &[("attribute", 1), ("sized", 1)]);
    asking.scene.remove(last).unwrap();
    asking.shows(7.0, 1.0, &[("attribute", 1)]);
    asking.scene.remove(top).unwrap();
    assert_eq!(asking.scene.value_graph(asking.attribute), None);
    asking.shows(1.0, 1.0, &[("attribute", 1)]);
}

#[test]
fn what_is_asked_has_the_mode_that_the_attribute_gives_it() {
    let mut asking = Asking::new(Attribute::new().asking::<Size>());
    asking.scene.add_to(asking.top, Share { value: 5.0 }).unwrap();
    asking.scene.set_held::<Size>(asking.view, 2.0).unwrap();
    let check = |asking: &mut Asking, mode: PushMode, sized: f32| {
        asking.scene.edit(asking.attribute, |it| it.ask_as::<Size>(mode)).unwrap();
        assert_eq!(sizes(&mut asking.scene, asking.view), [sized, 1.0], "{mode:?}");
    };
    check(&mut asking, PushMode::Inherit, 2.0);
    check(&mut asking, PushMode::Normal, 5.0);
    asking.scene.force_held::<Size>(asking.view, 3.0).unwrap();
    check(&mut asking, PushMode::Normal, 3.0);
    check(&mut asking, PushMode::Force, 3.0);
    check(&mut asking, PushMode::Protect, 5.0);
}

#[test]
fn transforms_are_multiplied_in_order() {
    let mut scene = checked_scene();
    let quarter = Affine3::from_mat3(sapwood::geom::glam::Mat3::from_cols(
        sapwood::geom::glam::Vec3::Y,
        -sapwood::geom::glam::Vec3::X,
        sapwood::geom::glam::Vec3::Z,
    ));
    let moved = scene.add(at(100));
    scene.add_to(moved, Placed).unwrap();
    let top = scene.add(Transform(quarter));
    let inner = scene.add_to(top, Group).unwrap();
    let first = scene.add_to(inner, at(1)).unwrap();
    scene.add_to(first, Transform(quarter)).unwrap();
    scene.add_to(inner, at(10)).unwrap();
    scene.set_value_graph(moved, Some(top.id())).unwrap();
    let view = scene.open_view(moved, &rules()).unwrap();
    // Turned twice by a right angle, 10 m along x are 10 m back.
    assert_eq!(places(&mut scene, view), [[90.0, 1.0, 0.0]]);
    scene.take_log();
    scene.edit(first, |first| *first = at(2)).unwrap();
    assert_eq!(places(&mut scene, view), [[90.0, 2.0, 0.0]]);
    assert_eq!(all_compiled(&mut scene), [("placed", 1), ("transform", 1)]);
    // An attribute asks for a placement that moves nothing.
    let attribute = scene.add(Attribute::new().asking::<Placement>());
    scene.add_to(attribute, Placed).unwrap();
    scene.set_value_graph(attribute, Some(first.id())).unwrap();
    let view = scene.open_view(attribute, &rules()).unwrap();
    assert_eq!(places(&mut scene, view), [[0.0; 3]]);
    assert_eq!(sizes(&mut scene, view), [3.0]);
}

#[test]
fn a_slot_may_combine_what_is_offered_as_it_likes() {
    let mut scene = checked_scene();
    let top = scene.add(Share { value: 1.0 });
    let shared = scene.add(Share { value: 10.0 });
    for _ in 0..3 {
        scene.append(top, shared).unwrap();
    }
    let attribute = scene.add(Attribute::new().asking::<Sum>().asking::<Size>());
    scene.add_to(attribute, Summed {}).unwrap();
    let view = scene.open_view(attribute, &summed_rules()).unwrap();
    let check = |scene: &mut Scene, expected: f32| {
        assert_eq!(sizes(scene, view), [expected]);
    };
    check(&mut scene, -1.0);
    scene.set_value_graph(attribute, Some(top.id())).unwrap();
    check(&mut scene, 31.0);
    scene.edit(shared, |share| share.value = 5.0).unwrap();
    check(&mut scene, 16.0);
    scene.set_value_graph(attribute, Some(shared.id())).unwrap();
    check(&mut scene, 5.0);
    scene.set_value_graph(attribute, None).unwrap();
    check(&mut scene, -1.0);
}

/// As large as the sum.
#[derive(Debug, Clone)]
struct Summed {}
content!(Summed {});
impl Named for Summed {
    const NAME: &'static str = "summed";
}
impl Component for Summed {}

struct SummedRule;
impl sapwood::scene::Rule for SummedRule {
    type Component = Summed;
    type Data = ();
    const NAME: &'static str = "summed";
    fn init(
        &self,
        _: &Summed,
        cx: &mut sapwood::scene::Context<'_>,
    ) -> Result<(), sapwood::scene::RuleError> {
        let mesh = sapwood::geom::SharedMesh::new(triangle(*cx.read::<Sum>()));
        cx.mesh(mesh, sapwood::graph::Material::matte("m", 1.0, 1.0, 1.0).into());
        Ok(())
    }
}

fn summed_rules() -> sapwood::scene::RuleSet {
    sapwood::scene::RuleSet::new().with(SummedRule).over(&rules())
}

#[test]
fn switches_and_selectors_ask_and_are_asked() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let switch = scene.add_to(root, Switch { on: true }).unwrap();
    scene.add_to(switch, Plain { size: 1.0 }).unwrap();
    let selector = scene.add_to(root, Selector { shown: Some(0) }).unwrap();
    for size in [2.0, 3.0] {
        scene.add_to(selector, Plain { size }).unwrap();
    }
    let (is_on, choice) = (scene.add(Switch { on: false }), scene.add(Selector { shown: Some(1) }));
    let view = scene.open_view(root, &rules()).unwrap();
    assert_eq!(sizes(&mut scene, view), [1.0, 2.0]);
    scene.set_value_graph(switch, Some(is_on.id())).unwrap();
    scene.set_value_graph(selector, Some(choice.id())).unwrap();
    assert_eq!(sizes(&mut scene, view), [3.0]);
    scene.edit(choice, |choice| choice.shown = None).unwrap();
    assert_eq!(sizes(&mut scene, view), [] as [f32; 0]);
    scene.edit(is_on, |is_on| is_on.on = true).unwrap();
    assert_eq!(sizes(&mut scene, view), [1.0]);
    // What a selector does not show, and a switch hides, answers nothing.
    let inner = scene.add_to(is_on, Switch { on: false }).unwrap();
    assert_eq!(sizes(&mut scene, view), [] as [f32; 0]);
    scene.edit(is_on, |is_on| is_on.on = false).unwrap();
    scene.edit(inner, |inner| inner.on = true).unwrap();
    assert_eq!(sizes(&mut scene, view), [] as [f32; 0]);
    scene.set_value_graph(switch, None).unwrap();
    scene.set_value_graph(selector, None).unwrap();
    assert_eq!(sizes(&mut scene, view), [1.0, 2.0]);
}

#[test]
fn a_shared_sub_graph_serves_everybody_who_asks() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let value = scene.add(Share { value: 4.0 });
    let leaf = scene.add(Sized);
    let attributes: Vec<_> = (0..3)
        .map(|_| {
            let attribute = scene.add_to(root, Attribute::new().asking::<Size>()).unwrap();
            scene.append(attribute, leaf).unwrap();
            scene.set_value_graph(attribute, Some(value.id())).unwrap();
            attribute
        })
        .collect();
    let view = scene.open_view(root, &rules()).unwrap();
    assert_eq!(sizes(&mut scene, view), [4.0; 3]);
    scene.take_log();
    scene.edit(value, |value| value.value = 6.0).unwrap();
    assert_eq!(sizes(&mut scene, view), [6.0; 3]);
    assert_eq!(all_compiled(&mut scene), [("attribute", 3), ("sized", 1)]);
    // It goes with the last one that asks.
    scene.remove(attributes[0]).unwrap();
    scene.remove(attributes[1]).unwrap();
    assert_eq!(sizes(&mut scene, view), [6.0]);
    let gone = scene.remove(attributes[2]).unwrap();
    assert!(gone.contains(&value.id()) && gone.contains(&leaf.id()), "{gone:?}");
}

#[test]
fn what_is_asked_may_be_driven_or_fail() {
    let mut asking = Asking::new(Attribute::new().asking::<Size>());
    let value = asking.scene.add_to(asking.top, Share { value: 5.0 }).unwrap();
    let source = asking.scene.add(Plain { size: 8.0 });
    let drive = |source: &Plain, share: &mut Share| {
        assert!(source.size < 10.0, "too large on purpose");
        share.value = source.size;
    };
    asking.scene.connect(source, value, "value", drive).unwrap();
    asking.shows(8.0, 1.0, &[("attribute", 1), ("group", 1), ("placed", 1), ("sized", 1)]);
    asking.scene.edit(source, |source| source.size = 9.0).unwrap();
    asking.shows(9.0, 1.0, &[("attribute", 1), ("sized", 1)]);
    asking.scene.edit(source, |source| source.size = 10.0).unwrap();
    assert_eq!(sizes(&mut asking.scene, asking.view), [] as [f32; 0]);
    let message = "what drives input value panicked: too large on purpose".to_owned();
    assert_eq!(errors(&mut asking.scene, asking.view), [("attribute", message)]);
}

#[test]
fn a_circle_through_a_value_sub_graph_is_refused_and_its_path_named() {
    let mut asking = Asking::new(Attribute::new().asking::<Size>());
    let (scene, attribute, top) = (&mut asking.scene, asking.attribute, asking.top);
    let inner = scene.add_to(top, Transform(Affine3::IDENTITY)).unwrap();
    let path = |nodes: &[(NodeId, &'static str)]| Err(EditError::Cycle { path: nodes.to_vec() });
    let named = [(attribute.id(), "attribute"), (top.id(), "group"), (inner.id(), "transform")];
    assert_eq!(scene.append(inner, attribute), path(&named));
    assert_eq!(scene.set_value_graph(top, Some(attribute.id())), path(&named[..2]));
    assert_eq!(scene.set_value_graph(inner, Some(inner.id())), path(&named[2..]));
    assert_eq!(scene.value_graph(inner), None);
}

#[test]
fn a_diamond_of_values_forty_levels_deep_fails_and_does_not_hang() {
    let mut asking = Asking::new(Attribute::new().asking::<Size>());
    let mut above = asking.top;
    for _ in 0..40 {
        let below = asking.scene.add(Group);
        asking.scene.append(above, below).unwrap();
        asking.scene.append(above, below).unwrap();
        above = below;
    }
    assert_eq!(sizes(&mut asking.scene, asking.view), [] as [f32; 0]);
    let errors = errors(&mut asking.scene, asking.view);
    assert_eq!(errors.len(), 1);
    assert!(errors[0].1.contains("occurrences"), "{errors:?}");
}
