//! Ingredients: what rules make of what other components compile to, and what runs for it.

use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use sapwood::geom::{Digester, Shared, SharedMesh, content};
use sapwood::graph::{Interrupted, Material, Named};
use sapwood::scene::{
    Action, Attribute, Budget, CancelToken, Component, Context, Group, Handle, Rule, RuleError,
    RuleSet, Scene, ViewError, ViewId,
};

use super::kinds::*;

/// A row of numbers, as a picture would be: its rule reads [`Size`].
#[derive(Debug, Clone)]
struct Dye {
    n: u32,
}
content!(Dye { n });
impl Named for Dye {
    const NAME: &'static str = "dye";
}
impl Component for Dye {}

type Numbers = Shared<Vec<f32>>;

/// Fails for sizes above 90, panics above 95; draws a box where it is shown.
struct DyeRule {
    factor: f32,
}

impl Rule for DyeRule {
    type Component = Dye;
    type Data = Numbers;
    const NAME: &'static str = "dye";
    fn settings(&self, digester: &mut Digester) {
        digester.add(&self.factor);
    }
    fn init(&self, dye: &Dye, cx: &mut Context<'_>) -> Result<Numbers, RuleError> {
        let size = *cx.read::<Size>();
        assert!(size <= 95.0, "too large, on purpose");
        if size > 90.0 {
            return Err(RuleError::Failed("no such dye".to_owned()));
        }
        cx.reserve_triangles(1)?;
        cx.mesh(SharedMesh::new(triangle(50.0)), Material::matte("m", 1.0, 0.0, 0.0).into());
        Ok(Shared::new(vec![size.floor() * self.factor; dye.n as usize]))
    }
}

/// A box as large as its dye is dark. It reads nothing but that, and may show the dye too.
#[derive(Debug, Clone)]
pub(super) struct Cloth {
    pub(super) n: u32,
    pub(super) shows_dye: bool,
}
content!(Cloth { n, shows_dye });
impl Named for Cloth {
    const NAME: &'static str = "cloth";
}
impl Component for Cloth {}

struct ClothRule;
impl Rule for ClothRule {
    type Component = Cloth;
    type Data = ();
    const NAME: &'static str = "cloth";
    fn init(&self, cloth: &Cloth, cx: &mut Context<'_>) -> Result<(), RuleError> {
        let dye = cx.ingredient::<Numbers>(Dye { n: cloth.n })?;
        let size = dye.iter().sum();
        cx.mesh(SharedMesh::new(triangle(size)), Material::matte("m", 1.0, 0.0, 0.0).into());
        if cloth.shows_dye {
            cx.emit(Dye { n: cloth.n });
        }
        Ok(())
    }
}

fn cloth(n: u32) -> Cloth {
    Cloth { n, shows_dye: false }
}

pub(super) fn dyed_by(factor: f32) -> RuleSet {
    RuleSet::new().with(DyeRule { factor }).with(ClothRule).with(TowerRule).over(&rules())
}

/// Two pieces of cloth, one below an attribute, and a box, all in one view.
struct Shop {
    scene: Scene,
    view: ViewId,
    attribute: Handle<Attribute>,
    first: Handle<Cloth>,
}

fn shop(size: f32) -> Shop {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let first = scene.add_to(root, cloth(2)).unwrap();
    let attribute = scene.add_to(root, Attribute::new().with::<Size>(size)).unwrap();
    let group = scene.add_to(attribute, Group).unwrap();
    scene.add_to(group, cloth(2)).unwrap();
    scene.add_to(group, Plain { size: 0.5 }).unwrap();
    let view = scene.open_view(root, &dyed_by(1.0)).unwrap();
    Shop { scene, view, attribute, first }
}

fn width(scene: &mut Scene, view: ViewId) -> f32 {
    scene.bounds(view).unwrap().aabb.max.x
}

fn messages(scene: &mut Scene, view: ViewId) -> Vec<String> {
    let found = scene.diagnostics(view, 100).unwrap();
    found.into_iter().map(|(_, diagnostic)| diagnostic.to_string()).collect()
}

#[test]
fn an_ingredient_is_compiled_once_for_all_who_ask() {
    let Shop { mut scene, view, .. } = shop(1.0);
    assert_eq!(width(&mut scene, view), 2.0);
    let log = scene.take_log();
    let events: Vec<_> = log
        .iter()
        .filter(|event| ["cloth", "dye"].contains(&event.kind.name()))
        .map(|event| (event.action, event.kind.name()))
        .collect();
    let (compiled, reused) = (Action::Compiled, Action::Reused);
    let both = [(compiled, "cloth"), (compiled, "dye"), (compiled, "cloth"), (reused, "dye")];
    assert_eq!(events, both);
    assert_eq!(scene.count(view).unwrap().components_of("dye"), 0, "it is not shown");
}

#[test]
fn an_ingredient_is_shared_with_a_child_of_equal_content() {
    let mut scene = checked_scene();
    let root = scene.add(Cloth { n: 2, shows_dye: true });
    let view = scene.open_view(root, &dyed_by(1.0)).unwrap();
    assert_eq!(width(&mut scene, view), 50.0);
    assert_eq!(all_compiled(&mut scene), [("cloth", 1), ("dye", 1)]);
    assert_eq!(scene.count(view).unwrap().components_of("dye"), 1);
}

#[test]
fn a_slot_that_only_the_ingredient_reads_recompiles_both_and_nothing_else() {
    let Shop { mut scene, view, attribute, .. } = shop(1.0);
    width(&mut scene, view);
    scene.take_log();
    scene.push::<Size>(attribute, 7.0).unwrap();
    assert_eq!(width(&mut scene, view), 14.0);
    assert_eq!(all_compiled(&mut scene), [("attribute", 1), ("cloth", 1), ("dye", 1)]);
    scene.push::<Size>(attribute, 1.0).unwrap();
    assert_eq!(width(&mut scene, view), 2.0);
    assert_eq!(all_compiled(&mut scene), [("attribute", 1)], "both are known for this size");
}

#[test]
fn an_equal_ingredient_made_anew_stops() {
    let Shop { mut scene, view, attribute, first } = shop(1.25);
    width(&mut scene, view);
    let (plans, sites) = (scene.n_plans(), scene.n_sites());
    scene.take_log();
    scene.edit(first, |_| ()).unwrap();
    width(&mut scene, view);
    assert_eq!(all_compiled(&mut scene), [("cloth", 1)]);
    assert_eq!((scene.n_plans(), scene.n_sites()), (plans, sites));

    // The ingredient is made again, equal and elsewhere in memory; the first plan of the cloth is
    // still the one that is shown.
    scene.edit(first, |cloth| cloth.n = 3).unwrap();
    scene.push::<Size>(attribute, 4.0).unwrap();
    width(&mut scene, view);
    scene.evict();
    scene.edit(first, |cloth| cloth.n = 2).unwrap();
    scene.push::<Size>(attribute, 1.25).unwrap();
    assert_eq!(width(&mut scene, view), 2.0);
    scene.evict();
    assert_eq!((scene.n_plans(), scene.n_sites()), (plans, sites));
}

#[test]
fn another_rule_for_the_ingredient_recompiles_both_and_nothing_else() {
    let Shop { mut scene, view, .. } = shop(3.0);
    assert_eq!(width(&mut scene, view), 6.0);
    scene.take_log();
    // Another setting of the same rule counts like another rule.
    scene.set_rules(view, &dyed_by(10.0)).unwrap();
    assert_eq!(width(&mut scene, view), 60.0);
    assert_eq!(all_compiled(&mut scene), [("cloth", 2), ("dye", 2)]);
    scene.set_rules(view, &dyed_by(1.0)).unwrap();
    assert_eq!(width(&mut scene, view), 6.0);
    assert_eq!(all_compiled(&mut scene), [], "the plans under the first rule are still there");
    let unserved = RuleSet::new().with(ClothRule).over(&rules());
    scene.set_rules(view, &unserved).unwrap();
    let why = "cloth: ingredient dye: the view has no rule for its kind";
    assert_eq!(messages(&mut scene, view), [why, why]);
    assert_eq!(all_compiled(&mut scene), [("cloth", 2)]);
    scene.set_rules(view, &dyed_by(1.0)).unwrap();
    assert_eq!(width(&mut scene, view), 6.0);
}

#[test]
fn two_views_with_two_rules_for_the_ingredient_share_everything_else() {
    let Shop { mut scene, view, first, .. } = shop(3.0);
    assert_eq!(width(&mut scene, view), 6.0);
    scene.take_log();
    let root = scene.parents(first).next().unwrap();
    let other = scene.open_view(root, &dyed_by(10.0)).unwrap();
    assert_eq!(width(&mut scene, other), 60.0);
    assert_eq!(all_compiled(&mut scene), [("cloth", 2), ("dye", 2)]);
    let same = scene.open_view(root, &dyed_by(1.0)).unwrap();
    assert_eq!(width(&mut scene, same), 6.0);
    assert_eq!(all_compiled(&mut scene), []);
    assert_eq!(width(&mut scene, view), 6.0);
}

#[test]
fn who_asks_for_what_fails_or_panics_fails_and_says_so() {
    let Shop { mut scene, view, attribute, .. } = shop(91.0);
    let why = "cloth: ingredient dye: no such dye";
    assert_eq!(messages(&mut scene, view), [why]);
    assert_eq!(width(&mut scene, view), 2.0, "the other piece is unharmed");
    scene.take_log();
    scene.push::<Size>(attribute, 96.0).unwrap();
    let why = "cloth: ingredient dye: rule dye panicked: too large, on purpose";
    assert_eq!(messages(&mut scene, view), [why]);
    assert_eq!(all_compiled(&mut scene), [("attribute", 1), ("cloth", 1), ("dye", 1)]);
    scene.bounds(view).unwrap();
    assert_eq!(all_compiled(&mut scene), [], "neither is tried again");
    scene.push::<Size>(attribute, 5.0).unwrap();
    assert_eq!(messages(&mut scene, view), [] as [&str; 0]);
    assert_eq!(width(&mut scene, view), 10.0);
}

/// Asks for a dye as if it were something else.
struct WrongRule;
impl Rule for WrongRule {
    type Component = Plain;
    type Data = ();
    const NAME: &'static str = "wrong";
    fn init(&self, _: &Plain, cx: &mut Context<'_>) -> Result<(), RuleError> {
        cx.ingredient::<String>(Dye { n: 1 }).map(|_| ())
    }
}

#[test]
fn data_of_another_type_than_asked_for_is_named() {
    let mut scene = checked_scene();
    let root = scene.add(Plain { size: 1.0 });
    let view = scene.open_view(root, &RuleSet::new().with(WrongRule).over(&dyed_by(1.0))).unwrap();
    let found = messages(&mut scene, view);
    let [message] = found.as_slice() else { panic!("{found:?}") };
    let begins = "plain: ingredient dye: rule dye makes data of type ";
    assert!(message.starts_with(begins), "{message}");
    assert!(message.ends_with(">, not alloc::string::String"), "{message}");
}

/// A tower of towers: made of the one below it, or of itself. What it makes of errors does not
/// matter to the limit.
#[derive(Debug, Clone)]
struct Tower {
    height: u32,
    forgives: bool,
}
content!(Tower { height, forgives });
impl Named for Tower {
    const NAME: &'static str = "tower";
}
impl Component for Tower {}

/// Towers of this height stand on the one below; 100 and above stand on each other in a ring of
/// three.
struct TowerRule;
impl Rule for TowerRule {
    type Component = Tower;
    type Data = f32;
    const NAME: &'static str = "tower";
    fn init(&self, tower: &Tower, cx: &mut Context<'_>) -> Result<f32, RuleError> {
        let Tower { height, forgives } = *tower;
        let below = match height {
            0 => return Ok(*cx.read::<Size>()),
            100.. => 100 + (height + 1) % 3,
            _ => height - 1,
        };
        let below = match cx.ingredient::<f32>(Tower { height: below, forgives }) {
            Err(_) if forgives => 0.0,
            below => *below?,
        };
        cx.mesh(SharedMesh::new(triangle(below + 1.0)), Material::matte("m", 1.0, 0.0, 0.0).into());
        Ok(below + 1.0)
    }
}

const TOO_HIGH: &str = "tower: ingredient tower: more than 16 ingredients are made of each other, \
                        or they are made of themselves";

#[test]
fn ingredients_above_each_other_are_limited_whichever_were_there_before() {
    for forgives in [false, true] {
        // From above, from below, and from the middle.
        for heights in [vec![18, 17, 16], (1..=18).collect(), vec![9, 18, 17, 12, 16]] {
            let mut scene = checked_scene();
            let root = scene.add(Group);
            let view = scene.open_view(root, &dyed_by(1.0)).unwrap();
            for height in &heights {
                let tower = scene.add_to(root, Tower { height: *height, forgives }).unwrap();
                let found = messages(&mut scene, view);
                let n_too_high = usize::from(*height > 16);
                assert_eq!(found, vec![TOO_HIGH; n_too_high], "{height} of {heights:?}");
                if *height <= 16 {
                    assert_eq!(width(&mut scene, view), *height as f32 + 1.0);
                }
                scene.detach(root, tower).unwrap();
            }
            assert!(compiled(&mut scene, "tower") > 16);
            // The errors answer to what they read, and change nothing.
            scene.add_to(root, Tower { height: 17, forgives }).unwrap();
            scene.set_held::<Size>(view, 5.0).unwrap();
            assert_eq!(messages(&mut scene, view), [TOO_HIGH]);
        }
    }
}

#[test]
fn what_is_made_of_itself_fails_whichever_is_asked_first() {
    for forgives in [false, true] {
        for heights in [[100, 101, 102], [102, 101, 100], [104, 100, 103]] {
            let mut scene = checked_scene();
            let root = scene.add(Group);
            let view = scene.open_view(root, &dyed_by(1.0)).unwrap();
            for height in heights {
                scene.add_to(root, Tower { height, forgives }).unwrap();
                assert!(messages(&mut scene, view).iter().all(|why| why == TOO_HIGH));
                assert!(compiled(&mut scene, "tower") <= 4);
            }
            assert_eq!(messages(&mut scene, view).len(), 3);
            assert!(scene.bounds(view).unwrap().is_empty());
        }
    }
}

/// Asks for many dyes, or, not being pure, for another one each time.
struct GreedyRule(Option<AtomicU32>);
impl Rule for GreedyRule {
    type Component = Plain;
    type Data = ();
    const NAME: &'static str = "greedy";
    fn init(&self, plain: &Plain, cx: &mut Context<'_>) -> Result<(), RuleError> {
        if let Some(n) = &self.0 {
            cx.ingredient::<Numbers>(Dye { n: n.fetch_add(1, Ordering::Relaxed) })?;
        }
        for n in 0..plain.size as u32 {
            cx.ingredient::<Numbers>(Dye { n })?;
            cx.ingredient::<Numbers>(Dye { n })?;
        }
        cx.mesh(SharedMesh::new(triangle(1.0)), Material::matte("m", 1.0, 0.0, 0.0).into());
        Ok(())
    }
}

#[test]
fn a_component_has_so_many_ingredients_and_no_more() {
    let mut scene = checked_scene();
    let root = scene.add(Plain { size: 256.0 });
    let rules = RuleSet::new().with(GreedyRule(None)).over(&dyed_by(1.0));
    let view = scene.open_view(root, &rules).unwrap();
    assert_eq!(width(&mut scene, view), 1.0);
    assert_eq!(all_compiled(&mut scene), [("dye", 256), ("plain", 1)]);
    scene.edit(root, |plain| plain.size = 257.0).unwrap();
    let too_many = "plain: more than 256 ingredients are asked for";
    assert_eq!(messages(&mut scene, view), [too_many]);
    assert_eq!(all_compiled(&mut scene), [("plain", 1)]);
    let rules = RuleSet::new().with(GreedyRule(Some(AtomicU32::new(1000)))).over(&dyed_by(1.0));
    scene.set_rules(view, &rules).unwrap();
    scene.set_check_mode(false);
    assert!(messages(&mut scene, view)[0].starts_with(too_many));
}

#[test]
fn a_budget_that_runs_out_for_an_ingredient_is_told_and_not_remembered() {
    for (plans, triangles, what, component) in [
        (3, 100, "plans", "cloth"),
        (2, 100, "plans", "dye"),
        (100, 1, "triangles", "cloth"),
        (100, 0, "triangles", "dye"),
    ] {
        let mut scene = checked_scene();
        let root = scene.add(cloth(2));
        let view = scene.open_view(root, &dyed_by(1.0)).unwrap();
        // The view's own plan is one of them.
        let plans = plans - 1;
        scene.set_budget(view, Budget { plans, triangles, ..Budget::default() }).unwrap();
        let limit = if what == "plans" { plans } else { triangles };
        let why = ViewError::Interrupted(Interrupted::Exhausted { what, limit, component });
        assert_eq!(scene.bounds(view), Err(why));
        let n_dyes = compiled(&mut scene, "dye");
        assert!(n_dyes <= 2, "making room does not begin again for ever: {n_dyes}");
        scene.set_budget(view, Budget::default()).unwrap();
        assert_eq!(width(&mut scene, view), 2.0);
    }
}

/// Cancels its own view.
struct CancellingRule(CancelToken, AtomicBool);
impl Rule for CancellingRule {
    type Component = Dye;
    type Data = Numbers;
    const NAME: &'static str = "cancelling";
    fn init(&self, dye: &Dye, cx: &mut Context<'_>) -> Result<Numbers, RuleError> {
        if !self.1.swap(true, Ordering::Relaxed) {
            self.0.cancel();
        }
        cx.checkpoint()?;
        Ok(Shared::new(vec![1.0; dye.n as usize]))
    }
}

#[test]
fn cancelling_an_ingredient_cancels_who_asked() {
    let Shop { mut scene, view, .. } = shop(1.0);
    let token = scene.cancel_token(view).unwrap();
    let rule = CancellingRule(token.clone(), AtomicBool::new(false));
    scene.set_rules(view, &RuleSet::new().with(rule).over(&dyed_by(1.0))).unwrap();
    assert_eq!(scene.bounds(view), Err(ViewError::Interrupted(Interrupted::Cancelled)));
    scene.take_log();
    token.reset();
    assert_eq!(width(&mut scene, view), 2.0);
    assert_eq!(compiled(&mut scene, "dye"), 1);
}

#[test]
fn an_ingredient_lives_as_long_as_what_is_made_of_it() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let view = scene.open_view(root, &dyed_by(1.0)).unwrap();
    scene.bounds(view).unwrap();
    let bare = scene.n_plans();
    let tower = scene.add_to(root, Tower { height: 5, forgives: false }).unwrap();
    let first = scene.add_to(root, cloth(2)).unwrap();
    scene.bounds(view).unwrap();
    scene.evict();
    assert_eq!(scene.n_plans(), bare + 6 + 2);
    scene.take_log();
    scene.add_to(root, cloth(2)).unwrap();
    scene.bounds(view).unwrap();
    assert_eq!(compiled(&mut scene, "dye"), 0, "it was kept");
    scene.edit(first, |cloth| cloth.n = 3).unwrap();
    scene.detach(root, tower).unwrap();
    scene.bounds(view).unwrap();
    scene.evict();
    assert_eq!(scene.n_plans(), bare + 4);
    scene.close_view(view).unwrap();
    assert_eq!(scene.n_plans(), 0);
}

/// Makes another dye each time.
struct ImpureRule(AtomicU32);
impl Rule for ImpureRule {
    type Component = Dye;
    type Data = Numbers;
    const NAME: &'static str = "impure";
    fn init(&self, _: &Dye, _: &mut Context<'_>) -> Result<Numbers, RuleError> {
        Ok(Shared::new(vec![self.0.fetch_add(1, Ordering::Relaxed) as f32]))
    }
}

#[test]
#[should_panic(expected = "rule impure compiles dye differently")]
fn check_mode_looks_at_ingredients() {
    let Shop { mut scene, view, .. } = shop(1.0);
    let rules = RuleSet::new().with(ImpureRule(AtomicU32::new(0))).over(&dyed_by(1.0));
    scene.set_rules(view, &rules).unwrap();
    let _ = scene.bounds(view);
}

#[test]
fn what_something_is_made_of_is_explained() {
    let mut scene = checked_scene();
    let root = scene.add(cloth(2));
    let view = scene.open_view(root, &dyed_by(1.0)).unwrap();
    let text = scene.explain(view, 100).unwrap();
    let plans: Vec<&str> = text.lines().filter(|line| line.starts_with("  p")).collect();
    assert!(plans[1].contains(" by cloth, 1 triangle; reads dye by dye, size "), "{text}");
    assert!(plans[1].ends_with("; made of p3"), "{text}");
    assert!(plans[2].starts_with("  p3 dye ") && plans[2].contains("; reads size "), "{text}");
    assert!(text.contains("; found by dye by dye, size "), "{text}");
}
