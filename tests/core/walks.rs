//! Walks: four orders, interests, handlers, parts, and traversals that others write.

use sapwood::geom::glam::Vec3;
use sapwood::geom::{Aabb, Bound, content};
use sapwood::graph::{
    Approach, Everything, Fallbacks, Handlers, Inside, Interest, Named, Offers, Order, Part,
    Provide, RenderNode, Supplied, Supply, Under, discover, traverse, walk,
};
use sapwood::scene::{Component, Context, Group, Rule, RuleError, RuleSet, Scene, ViewId};

use super::kinds::*;

#[derive(Debug, Clone)]
struct Bead {
    weight: u32,
}
content!(Bead { weight });
impl Named for Bead {
    const NAME: &'static str = "bead";
}
impl Part for Bead {}

/// Emits plain components far apart, each with a bound told before, and strings beads.
#[derive(Debug, Clone)]
struct Necklace {
    n: u32,
}
content!(Necklace { n });
impl Named for Necklace {
    const NAME: &'static str = "necklace";
}
impl Component for Necklace {}

/// What the rule makes beside the fragment.
struct Clasp {
    n: u32,
}
content!(Clasp { n });

struct NecklaceRule;
impl Rule for NecklaceRule {
    type Component = Necklace;
    type Data = Clasp;
    const NAME: &'static str = "necklace";
    fn init(&self, necklace: &Necklace, cx: &mut Context<'_>) -> Result<Clasp, RuleError> {
        cx.parts((0..necklace.n).map(|weight| Bead { weight }).collect::<Vec<_>>());
        for i in 0..necklace.n {
            let size = 1.0 + i as f32 / 16.0;
            let corners = [Vec3::ZERO, Vec3::new(size, size, 0.0)];
            let at = sapwood::geom::glam::Affine3::from_translation(Vec3::X * 10.0 * i as f32);
            cx.transform(at, |cx| {
                cx.emit_keyed(u64::from(i), Plain { size }, Some(Bound::of_points(corners)));
            });
        }
        Ok(Clasp { n: necklace.n })
    }
    fn interfaces(offers: &mut Offers<Clasp>) {
        offers.offer::<dyn Shines>(|clasp| clasp);
    }
}

fn all_rules() -> RuleSet {
    RuleSet::new().with(NecklaceRule).over(&rules())
}

/// A group of a plain component of size 1, a group of sizes 2 and 3, and one of size 4.
fn small_tree() -> (Scene, ViewId) {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    scene.add_to(root, Plain { size: 1.0 }).unwrap();
    let moved = scene.add_to(root, at(7)).unwrap();
    let group = scene.add_to(moved, Group).unwrap();
    scene.add_to(group, Plain { size: 2.0 }).unwrap();
    scene.add_to(group, Plain { size: 3.0 }).unwrap();
    scene.add_to(root, Plain { size: 4.0 }).unwrap();
    let view = scene.open_view(root, &all_rules()).unwrap();
    (scene, view)
}

/// Names of plans, and sizes of triangles, as a walk meets them.
fn met<I: Interest>(scene: &mut Scene, view: ViewId, order: Order, interest: &I) -> String {
    let mut words = Vec::new();
    scene
        .traverse(view, order, interest, &mut |at| match at.node() {
            RenderNode::Group => words.push(at.plan().kind.name()[..1].to_owned()),
            RenderNode::Transform(_) => words.push("*".to_owned()),
            RenderNode::Mesh { mesh, .. } => words.push(mesh.positions[1].x.to_string()),
            _ => {}
        })
        .unwrap();
    words.join(" ")
}

#[test]
fn four_orders() {
    let (mut scene, view) = small_tree();
    for (order, expected) in [
        (Order::Pre, "v g p 1 t * g p 2 p 3 p 4"),
        (Order::In, "1 p g 2 p 3 p g * t 4 p v"),
        (Order::Post, "1 p 2 p 3 p g * t 4 p g v"),
        (Order::Level, "v g p t p 1 * 4 g p p 2 3"),
    ] {
        assert_eq!(met(&mut scene, view, order, &Everything), expected, "{order:?}");
    }
}

#[test]
fn in_order_is_after_the_first_child_and_before_the_rest() {
    let (mut scene, view) = small_tree();
    let mut deferred = Vec::new();
    scene
        .traverse(view, Order::In, &Everything, &mut |at| match at.node() {
            RenderNode::Deferred(run) => {
                deferred.push(format!("run of {} {}", run.count, run.kind))
            }
            RenderNode::Mesh { mesh, .. } => deferred.push(mesh.positions[1].x.to_string()),
            _ => {}
        })
        .unwrap();
    let expected = "1, run of 1 plain, 2, run of 2 plain, 3, run of 1 group, run of 1 transform, \
                    4, run of 1 plain, run of 1 group";
    assert_eq!(deferred.join(", "), expected);
}

#[test]
fn places_know_their_path_depth_and_world() {
    let (mut scene, view) = small_tree();
    let mut places = Vec::new();
    scene
        .traverse(view, Order::Pre, &Everything, &mut |at| {
            if at.plan().kind.name() == "plain" && at.enters_plan() {
                assert_eq!(at.index(), 0);
                places.push((at.path().links(), at.depth(), at.world().translation.x));
            }
        })
        .unwrap();
    assert_eq!(
        places,
        [
            (vec![0, 0], 4, 0.0),
            (vec![0, 1, 0, 0], 9, 7.0),
            (vec![0, 1, 0, 1], 9, 7.0),
            (vec![0, 2], 4, 0.0),
        ]
    );
}

#[test]
fn interests_choose_what_is_walked() {
    let (mut scene, view) = small_tree();
    let inside = |x: f32| {
        let point = Vec3::new(x, 0.1, 0.0);
        Inside(Aabb { min: point, max: point + Vec3::splat(0.01) })
    };
    scene.bounds(view).unwrap();
    assert_eq!(met(&mut scene, view, Order::Pre, &inside(8.5)), "v g t * g p 2 p 3");
    assert_eq!(met(&mut scene, view, Order::Pre, &inside(9.5)), "v g t * g p 3");
    assert_eq!(met(&mut scene, view, Order::Pre, &inside(3.5)), "v g p 4");
    assert_eq!(met(&mut scene, view, Order::Pre, &inside(30.0)), "v");
    assert_eq!(met(&mut scene, view, Order::Pre, &Under(vec![0, 1])), "v g t * g p 2 p 3");
    assert_eq!(met(&mut scene, view, Order::Pre, &Under(vec![0, 1, 0, 1])), "v g t * g p 3");
    assert_eq!(met(&mut scene, view, Order::Pre, &Under(vec![0, 9])), "v g");
}

/// Goes so many links deep.
struct UpTo(u32);
impl Interest for UpTo {
    type State = u32;
    fn start(&self) -> u32 {
        0
    }
    fn enter(&self, depth: &u32, _: &Approach<'_>) -> Option<u32> {
        (*depth < self.0).then_some(depth + 1)
    }
}

#[test]
fn an_interest_pushes_a_state_and_steers_compiling() {
    let (mut scene, view) = small_tree();
    let mut states = Vec::new();
    scene
        .traverse(view, Order::Pre, &UpTo(2), &mut |at| {
            if at.enters_plan() {
                states.push(*at.state());
            }
        })
        .unwrap();
    assert_eq!(states, [0, 1, 2, 2, 2]);
    assert_eq!(all_compiled(&mut scene), [("group", 1), ("plain", 2), ("transform", 1)]);
}

#[test]
fn what_is_foreseen_outside_is_not_compiled() {
    let mut scene = checked_scene();
    let root = scene.add(Necklace { n: 100 });
    let view = scene.open_view(root, &all_rules()).unwrap();
    let inside = Inside(Aabb { min: Vec3::new(35.0, -1.0, -1.0), max: Vec3::new(56.0, 1.0, 1.0) });
    let sizes = met(&mut scene, view, Order::Pre, &inside);
    let sizes: Vec<&str> = sizes.split(' ').filter(|word| word.contains('.')).collect();
    assert_eq!(sizes, ["1.25", "1.3125"]);
    assert_eq!(all_compiled(&mut scene), [("necklace", 1), ("plain", 2)]);
    assert_eq!(scene.count(view).unwrap().components_of("plain"), 100);
    assert_eq!(all_compiled(&mut scene), [("plain", 98)]);
}

#[test]
fn parts_are_counted_wherever_they_occur() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let necklace = scene.add(Necklace { n: 5 });
    for i in 0..3 {
        let moved = scene.add_to(root, at(i)).unwrap();
        scene.append(moved, necklace).unwrap();
    }
    let view = scene.open_view(root, &all_rules()).unwrap();
    let counts = scene.count(view).unwrap();
    assert_eq!((counts.parts_of("bead"), counts.components_of("plain")), (15, 15));
    scene.edit(necklace, |necklace| necklace.n = 6).unwrap();
    assert_eq!(scene.count(view).unwrap().parts_of("bead"), 18);
    assert!(scene.dump(view, 3).unwrap().contains("transform"));
    assert!(scene.dump(view, 100).unwrap().contains("necklace, 6 bead"));
}

#[derive(Default)]
struct Jeweller {
    clasps: Vec<u32>,
    beads: u32,
}

#[test]
fn handlers_get_typed_plans_and_parts() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    scene.add_to(root, Necklace { n: 3 }).unwrap();
    scene.add_to(root, Necklace { n: 4 }).unwrap();
    let view = scene.open_view(root, &all_rules()).unwrap();
    let handlers = Handlers::<Jeweller>::new()
        .on_plan::<Clasp>(|jeweller, clasp, at| {
            assert_eq!(at.plan().kind.name(), "necklace");
            jeweller.clasps.push(clasp.n);
        })
        .on_parts::<Bead>(|jeweller, beads, _| {
            jeweller.beads += beads.iter().map(|bead| bead.weight).sum::<u32>();
        });
    let mut jeweller = Jeweller::default();
    scene
        .traverse(view, Order::Pre, &Everything, &mut |at| handlers.handle(&mut jeweller, at))
        .unwrap();
    assert_eq!((jeweller.clasps, jeweller.beads), (vec![3, 4], 3 + 6));
}

/// What some things do, whoever compiled them.
trait Shines {
    fn lumen(&self) -> u32;
}
impl Shines for Clasp {
    fn lumen(&self) -> u32 {
        self.n * 10
    }
}

/// Simpler data, which may stand in for a necklace.
struct Thread {
    metres: u32,
}

#[test]
fn the_exact_handler_goes_before_the_interface_and_that_before_the_fallback() {
    type Met = Vec<String>;
    let mut scene = checked_scene();
    let root = scene.add(Group);
    scene.add_to(root, Necklace { n: 3 }).unwrap();
    let view = scene.open_view(root, &all_rules()).unwrap();
    let mut met = |handlers: &Handlers<Met>| {
        let mut met = Met::new();
        scene
            .traverse(view, Order::Pre, &Everything, &mut |at| handlers.handle(&mut met, at))
            .unwrap();
        met.join(" ")
    };
    let fallbacks = Fallbacks::new()
        .with::<Necklace, Thread>(|plan| Thread { metres: plan.parts.of::<Bead>().len() as u32 });
    let mut handlers = Handlers::<Met>::new().with_fallbacks(&fallbacks);
    assert_eq!(met(&handlers), "");
    handlers = handlers.on_plan::<Thread>(|met, thread, at| {
        met.push(format!("{} {}m", at.plan().kind, thread.metres))
    });
    assert_eq!(met(&handlers), "necklace 3m");
    handlers =
        handlers.on_interface::<dyn Shines>(|met, it, _| met.push(format!("{}lm", it.lumen())));
    assert_eq!(met(&handlers), "30lm");
    handlers = handlers.on_plan::<Clasp>(|met, clasp, _| met.push(format!("clasp {}", clasp.n)));
    assert_eq!(met(&handlers), "clasp 3");
}

#[test]
fn a_foreign_traversal_steps_from_site_to_site() {
    let (mut scene, view) = small_tree();
    let mut supply = scene.supply(view).unwrap();
    let (env, root) = supply.root();
    assert!(!supply.is_settled(root));
    assert!(matches!(supply.enter(env, root, 0).1, Supplied::Unknown));
    discover(&mut supply, &Everything).unwrap();
    assert!(supply.is_settled(root));
    let mut n = 0;
    let mut stack = vec![(env, root)];
    while let Some((env, site)) = stack.pop() {
        n += 1;
        for link in 0..supply.plan(site).fragment.n_links() {
            match supply.enter(env, site, link) {
                (env, Supplied::Ready(child)) => stack.push((env, child)),
                (_, other) => panic!("{other:?}"),
            }
        }
    }
    assert_eq!(n, 8);
    let mut nodes = 0;
    walk(&supply, Order::Level, &Everything, &mut |_| nodes += 1);
    let mut again = 0;
    traverse(&mut supply, Order::Post, &Everything, &mut |_| again += 1).unwrap();
    assert_eq!(nodes, again);
    supply.begin_pass();
    assert!(supply.bound(root).is_some());
}
