//! How pushes stand against each other, and what runs when that changes.

use sapwood::geom::content;
use sapwood::graph::{Label, Material, Named};
use sapwood::scene::{
    Attribute, Children, Component, Context, Group, Handle, Held, HeldGeometry, MaterialSlot,
    NodeId, PushMode, Rule, RuleError, RuleSet, Scene, Slot, Style, StyleSlot, Transform, ViewId,
};

use super::super::kinds::*;
use super::sizes;

const MODES: [PushMode; 4] =
    [PushMode::Normal, PushMode::Force, PushMode::Protect, PushMode::Inherit];

/// A slot that merges: words in the order in which they were pushed.
enum Words {}
impl Slot for Words {
    type Value = String;
    type Rate = Held;
    const NAME: &'static str = "words";
    const MERGES: bool = true;
    fn default() -> String {
        String::new()
    }
    fn merge(inherited: &String, pushed: &String) -> String {
        format!("{inherited}{pushed}")
    }
}

/// A slot of which the last push counts.
enum Last {}
impl Slot for Last {
    type Value = String;
    type Rate = Held;
    const NAME: &'static str = "last";
    fn default() -> String {
        String::new()
    }
}

/// Shows both slots as a text.
#[derive(Debug, Clone)]
struct Sign {}
content!(Sign {});
impl Named for Sign {
    const NAME: &'static str = "sign";
}
impl Component for Sign {}

struct SignRule;
impl Rule for SignRule {
    type Component = Sign;
    type Data = ();
    const NAME: &'static str = "sign";
    fn init(&self, _: &Sign, cx: &mut Context<'_>) -> Result<(), RuleError> {
        let text = format!("{} {}", cx.read::<Last>(), cx.read::<Words>());
        cx.label(Label::new(&text, 1.0));
        Ok(())
    }
}

/// Pushes several times at once, the outermost first.
#[derive(Debug, Clone)]
struct Nested {
    modes: Vec<usize>,
}
content!(Nested { modes });
impl Named for Nested {
    const NAME: &'static str = "nested";
}
impl Component for Nested {
    const CHILDREN: Children = Children::Many;
}

struct NestedRule;
impl Rule for NestedRule {
    type Component = Nested;
    type Data = ();
    const NAME: &'static str = "nested";
    fn init(&self, nested: &Nested, cx: &mut Context<'_>) -> Result<(), RuleError> {
        fn push(depth: usize, modes: &[usize], cx: &mut Context<'_>) {
            match modes {
                [] => cx.children(),
                [mode, rest @ ..] => {
                    let (mode, word) = (MODES[*mode], depth.to_string());
                    cx.push_as::<Last>(mode, word.clone(), |cx| {
                        cx.push_as::<Words>(mode, word, |cx| push(depth + 1, rest, cx));
                    });
                }
            }
        }
        push(0, &nested.modes, cx);
        Ok(())
    }
}

fn sign_rules() -> RuleSet {
    RuleSet::new().with(SignRule).with(NestedRule).over(&rules())
}

/// What a sign shows below pushes of words 0, 1, 2 and so on, the outermost first.
fn shown_below(modes: &[PushMode]) -> String {
    let (mut last, mut words, mut is_forced) = (String::new(), String::new(), false);
    for (word, mode) in modes.iter().enumerate() {
        let counts = match mode {
            PushMode::Inherit => false,
            PushMode::Protect => true,
            PushMode::Normal | PushMode::Force => !is_forced,
        };
        if counts {
            is_forced = *mode == PushMode::Force;
            last = word.to_string();
            words.push_str(&last);
        }
    }
    format!("{last} {words}")
}

fn signs(scene: &mut Scene, view: ViewId) -> Vec<String> {
    let list = scene.draw_list(view, 1000).unwrap();
    list.placed_labels().map(|(_, label)| label.text.clone()).collect()
}

/// Every list of modes of this length.
fn all_modes(n: usize) -> impl Iterator<Item = Vec<usize>> {
    (0..4usize.pow(n as u32))
        .map(move |all| (0..n).map(|i| all / 4usize.pow(i as u32) % 4).collect())
}

#[test]
fn what_the_modes_mean() {
    use PushMode::{Force, Inherit, Normal, Protect};
    let check = |modes: &[PushMode], expected: &str| assert_eq!(shown_below(modes), expected);
    check(&[Normal, Normal], "1 01");
    check(&[Force, Normal], "0 0");
    check(&[Force, Force], "0 0");
    check(&[Force, Protect], "1 01");
    check(&[Force, Protect, Normal], "2 012");
    check(&[Force, Protect, Force], "2 012");
    check(&[Force, Inherit, Normal], "0 0");
    check(&[Normal, Force, Normal], "1 01");
    check(&[Inherit, Inherit], " ");
}

#[test]
fn nested_attributes_in_every_combination_on_their_own_and_shared() {
    for n in [2, 3] {
        let mut scene = checked_scene();
        let root = scene.add(Group);
        let shared = scene.add(Sign {});
        let mut expected = Vec::new();
        for modes in all_modes(n) {
            let modes: Vec<PushMode> = modes.into_iter().map(|mode| MODES[mode]).collect();
            let mut below: NodeId = root.id();
            for (word, mode) in modes.iter().enumerate() {
                let word = word.to_string();
                let attribute = Attribute::new()
                    .with_as::<Words>(*mode, word.clone())
                    .with_as::<Last>(*mode, word);
                below = scene.add_to(below, attribute).unwrap().id();
            }
            scene.append(below, shared).unwrap();
            expected.push(shown_below(&modes));
        }
        let view = scene.open_view(root, &sign_rules()).unwrap();
        assert_eq!(signs(&mut scene, view), expected);
        // Compiled once for each text, however often that is shown.
        let mut texts = expected.clone();
        texts.sort_unstable();
        texts.dedup();
        assert_eq!(compiled(&mut scene, "sign"), texts.len());
    }
}

#[test]
fn pushes_of_one_rule_in_every_combination() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let shared = scene.add(Sign {});
    let mut expected = Vec::new();
    for modes in all_modes(2).chain(all_modes(3)) {
        let named: Vec<PushMode> = modes.iter().map(|mode| MODES[*mode]).collect();
        expected.push(shown_below(&named));
        let nested = scene.add_to(root, Nested { modes }).unwrap();
        scene.append(nested, shared).unwrap();
    }
    let view = scene.open_view(root, &sign_rules()).unwrap();
    assert_eq!(signs(&mut scene, view), expected);
    // What a view forces holds against all that does not protect itself.
    scene.force_held::<Words>(view, "f".to_owned()).unwrap();
    scene.force_held::<Last>(view, "f".to_owned()).unwrap();
    let forced = all_modes(2).chain(all_modes(3)).map(|modes| {
        let named = modes.iter().map(|mode| MODES[*mode]);
        let all: Vec<PushMode> = [PushMode::Force].into_iter().chain(named).collect();
        let numbers = |c: char| match c.to_digit(10) {
            None => c.to_string(),
            Some(0) => "f".to_owned(),
            Some(number) => (number - 1).to_string(),
        };
        shown_below(&all).chars().map(numbers).collect::<String>()
    });
    assert_eq!(signs(&mut scene, view), forced.collect::<Vec<_>>());
    scene.clear_held::<Words>(view).unwrap();
    scene.clear_held::<Last>(view).unwrap();
    scene.take_log();
    assert_eq!(signs(&mut scene, view), expected);
    assert_eq!(all_compiled(&mut scene), [], "all of it was there before");
}

/// Two bodies below attributes of their own, both below one attribute.
struct Styles {
    scene: Scene,
    view: ViewId,
    above: Handle<Attribute>,
    sides: [Handle<Attribute>; 2],
}

impl Styles {
    fn new(modes: [PushMode; 2]) -> Self {
        let mut scene = checked_scene();
        let above = scene.add(Attribute::new());
        let group = scene.add_to(above, Group).unwrap();
        let body = scene.add(HeldGeometry::plain(triangle(1.0)));
        let sides = modes.map(|mode| {
            let attribute = Attribute::new().with_as::<StyleSlot>(mode, Style::Solid);
            let side = scene.add_to(group, attribute).unwrap();
            scene.append(side, body).unwrap();
            side
        });
        let view = scene.open_view(above, &rules()).unwrap();
        Self { scene, view, above, sides }
    }

    /// How many bodies are drawn as surfaces, and how many as lines.
    fn n_drawn(&mut self) -> [usize; 2] {
        let list = self.scene.draw_list(self.view, 100).unwrap();
        [list.placed_rows().count(), list.placed_lines().count()]
    }

    fn push(&mut self, mode: PushMode, style: Style) {
        let set = |above: &mut Attribute| above.set_as::<StyleSlot>(mode, style);
        self.scene.edit(self.above, set).unwrap();
    }
}

#[test]
fn a_forced_style_over_two_subtrees_of_which_one_protects_itself() {
    let mut styles = Styles::new([PushMode::Normal, PushMode::Protect]);
    assert_eq!(styles.n_drawn(), [2, 0]);
    assert_eq!(compiled(&mut styles.scene, "held_geometry"), 1);
    let mut check = |mode: PushMode, style: Style, n_drawn: [usize; 2], runs: usize| {
        styles.push(mode, style);
        styles.scene.take_log();
        assert_eq!(styles.n_drawn(), n_drawn, "{mode:?} {style:?}");
        let all = all_compiled(&mut styles.scene);
        let held = all.iter().find(|(kind, _)| *kind == "held_geometry");
        assert_eq!(held.map_or(0, |(_, n)| *n), runs, "{mode:?} {style:?}: {all:?}");
        assert!(all.iter().all(|(kind, _)| *kind != "group"), "{all:?}");
    };
    check(PushMode::Normal, Style::Solid, [2, 0], 0);
    check(PushMode::Normal, Style::Wire, [2, 0], 0);
    check(PushMode::Force, Style::Wire, [1, 1], 1);
    check(PushMode::Force, Style::Solid, [2, 0], 0);
    check(PushMode::Force, Style::Wire, [1, 1], 0);
    check(PushMode::Inherit, Style::Wire, [2, 0], 0);
    let [side, other] = styles.sides;
    styles.push(PushMode::Force, Style::Wire);
    let set = |mode| move |side: &mut Attribute| assert!(side.set_mode::<StyleSlot>(mode));
    styles.scene.edit(side, set(PushMode::Protect)).unwrap();
    assert_eq!(styles.n_drawn(), [2, 0]);
    styles.scene.edit(other, set(PushMode::Force)).unwrap();
    assert_eq!(styles.n_drawn(), [1, 1]);
}

#[test]
fn a_view_that_forces_a_style_leaves_the_other_alone() {
    let mut styles = Styles::new([PushMode::Normal, PushMode::Protect]);
    let other = styles.scene.open_view(styles.above, &rules()).unwrap();
    assert_eq!(styles.n_drawn(), [2, 0]);
    styles.scene.force_held::<StyleSlot>(styles.view, Style::Wire).unwrap();
    assert_eq!(styles.n_drawn(), [1, 1]);
    assert_eq!(sizes(&mut styles.scene, other), [1.0, 1.0]);
    styles.scene.set_held::<StyleSlot>(styles.view, Style::Wire).unwrap();
    assert_eq!(styles.n_drawn(), [2, 0]);
}

#[test]
fn a_material_is_inherited_or_its_own_unless_another_is_forced() {
    let mut scene = checked_scene();
    let above = scene.add(Attribute::new());
    let group = scene.add_to(above, Group).unwrap();
    scene.add_to(group, HeldGeometry::plain(triangle(1.0))).unwrap();
    let own = Material::matte("own", 1.0, 0.0, 0.0);
    scene.add_to(group, HeldGeometry::new(triangle(2.0), own)).unwrap();
    let view = scene.open_view(above, &rules()).unwrap();
    let mut check = |push: Option<(PushMode, &str)>, names: [&str; 2], runs: usize| {
        scene
            .edit(above, |above| match push {
                None => {
                    above.clear::<MaterialSlot>();
                }
                Some((mode, name)) => {
                    above.set_as::<MaterialSlot>(mode, Material::matte(name, 0.0, 1.0, 0.0));
                }
            })
            .unwrap();
        scene.take_log();
        let list = scene.draw_list(view, 10).unwrap();
        let found: Vec<_> = list.placed_rows().map(|(_, row)| row.material.name.clone()).collect();
        assert_eq!(found, names, "{push:?}");
        assert_eq!(compiled(&mut scene, "held_geometry"), runs, "{push:?}");
    };
    check(None, ["plain", "own"], 2);
    check(Some((PushMode::Normal, "a")), ["a", "own"], 1);
    check(Some((PushMode::Normal, "b")), ["b", "own"], 1);
    check(Some((PushMode::Force, "b")), ["b", "b"], 1);
    check(Some((PushMode::Force, "a")), ["a", "a"], 1);
    check(Some((PushMode::Inherit, "a")), ["plain", "own"], 0);
}

#[test]
fn a_forced_placement_counts_for_readers_and_moves_nothing() {
    let mut scene = checked_scene();
    let mode = PushMode::Force;
    let above = Attribute::new().with_as::<sapwood::scene::Placement>(mode, at(3).0);
    let above = scene.add(above);
    let moved = scene.add_to(above, at(5)).unwrap();
    scene.add_to(moved, Placed).unwrap();
    let view = scene.open_view(above, &rules()).unwrap();
    assert_eq!(super::places(&mut scene, view), [[5.0, 0.0, 0.0]]);
    assert_eq!(sizes(&mut scene, view), [4.0]);
    scene.take_log();
    scene.edit(moved, |moved| *moved = Transform::translation(6.0, 0.0, 0.0)).unwrap();
    assert_eq!(super::places(&mut scene, view), [[6.0, 0.0, 0.0]]);
    assert_eq!(all_compiled(&mut scene), [("transform", 1)]);
}
