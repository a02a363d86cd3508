//! Deep, wide and many: what must cost neither the machine's stack nor the number of paths.

use sapwood::geom::StreamPath;
use sapwood::geom::glam::Vec3;
use sapwood::scene::{
    Attribute, Budget, ChildPath, Group, LevelOfDetail, NodeId, PushMode, Scene, ViewId, Viewpoint,
};

use super::super::kinds::*;
use super::sizes;

fn on_a_small_stack(test: fn()) {
    let thread = std::thread::Builder::new().stack_size(2 << 20);
    thread.spawn(test).unwrap().join().unwrap();
}

/// A diamond of attributes, each over a group that holds the next one twice.
fn diamond(
    scene: &mut Scene,
    leaf: NodeId,
    depth: usize,
    attribute: impl Fn(usize) -> Attribute,
) -> NodeId {
    (0..depth).rev().fold(leaf, |below, level| {
        let above = scene.add(attribute(level));
        let group = scene.add_to(above, Group).unwrap();
        scene.append(group, below).unwrap();
        scene.append(group, below).unwrap();
        above.id()
    })
}

fn n_sized(scene: &mut Scene, view: ViewId) -> u64 {
    scene.count(view).unwrap().components_of("sized")
}

#[test]
fn a_diamond_of_forces_forty_deep_costs_what_forty_levels_cost() {
    for mode in [PushMode::Normal, PushMode::Force, PushMode::Protect] {
        let mut scene = checked_scene();
        let leaf = scene.add(Sized).id();
        let push = |level: usize| Attribute::new().with_as::<Size>(mode, 1.0 + level as f32);
        let top = diamond(&mut scene, leaf, 40, push);
        let view = scene.open_view(top, &rules()).unwrap();
        assert_eq!(n_sized(&mut scene, view), 1 << 40);
        let size = if mode == PushMode::Force { 1.0 } else { 40.0 };
        assert_eq!(scene.bounds(view).unwrap().aabb.max.x, size);
        scene.force_held::<Size>(view, 7.0).unwrap();
        let size = if mode == PushMode::Protect { 40.0 } else { 7.0 };
        assert_eq!(scene.bounds(view).unwrap().aabb.max.x, size);
        scene.evict();
        assert_eq!(scene.n_sites(), 40 * 2 + 2);
    }
}

#[test]
fn a_forced_path_does_not_tell_apart_what_pushes_something_else() {
    let mut scene = checked_scene();
    let leaf = scene.add(Attribute::new().with::<Size>(2.0));
    scene.add_to(leaf, Sized).unwrap();
    let top = diamond(&mut scene, leaf.id(), 40, |_| Attribute::new());
    let view = scene.open_view(top, &rules()).unwrap();
    scene.force_held::<ChildPath>(view, StreamPath::new(7)).unwrap();
    assert_eq!(n_sized(&mut scene, view), 1 << 40);
    assert_eq!(scene.n_sites(), 40 * 2 + 3);
}

#[test]
fn a_forced_path_that_changes_to_that_of_its_child_is_another() {
    let mut scene = checked_scene();
    let path = StreamPath::new(1);
    let force = |path| Attribute::new().with_as::<ChildPath>(PushMode::Force, path);
    let top = scene.add(force(path));
    let outer = scene.add_to(top, Group).unwrap();
    let inner = scene.add_to(outer, Group).unwrap();
    let pushes = Attribute::new().with::<ChildPath>(StreamPath::new(9));
    let leaf = scene.add_to(inner, pushes).unwrap();
    scene.add_to(leaf, Pathed {}).unwrap();
    let view = scene.open_view(top, &pathed_rules()).unwrap();
    let below = |path: StreamPath| path.child(0).child(0).child(0).child(0);
    assert_eq!(texts(&mut scene, view), [format!("{:?}", below(path))]);
    scene.edit(top, |top| *top = force(path.child(0))).unwrap();
    assert_eq!(texts(&mut scene, view), [format!("{:?}", below(path.child(0)))]);
}

/// Shows the path that it stands at.
#[derive(Debug, Clone)]
struct Pathed {}
sapwood::geom::content!(Pathed {});
impl sapwood::graph::Named for Pathed {
    const NAME: &'static str = "pathed";
}
impl sapwood::scene::Component for Pathed {}

struct PathedRule;
impl sapwood::scene::Rule for PathedRule {
    type Component = Pathed;
    type Data = ();
    const NAME: &'static str = "pathed";
    fn init(
        &self,
        _: &Pathed,
        cx: &mut sapwood::scene::Context<'_>,
    ) -> Result<(), sapwood::scene::RuleError> {
        let text = format!("{:?}", cx.read::<ChildPath>());
        cx.label(sapwood::graph::Label::new(&text, 1.0));
        Ok(())
    }
}

fn pathed_rules() -> sapwood::scene::RuleSet {
    sapwood::scene::RuleSet::new().with(PathedRule).over(&rules())
}

fn texts(scene: &mut Scene, view: ViewId) -> Vec<String> {
    let list = scene.draw_list(view, 100).unwrap();
    list.placed_labels().map(|(_, label)| label.text.clone()).collect()
}

#[test]
fn a_hundred_thousand_nested_forces() {
    on_a_small_stack(|| {
        let mut scene = Scene::new();
        let bottom = scene.add(Sized);
        let mut below: NodeId = bottom.id();
        for level in (0..100_000).rev() {
            // The lowest that protects itself counts, and whatever forces below it.
            let mode = if level == 70_000 { PushMode::Protect } else { PushMode::Force };
            let push = Attribute::new().with_as::<Size>(mode, level as f32);
            let above = scene.add(push);
            scene.append(above, below).unwrap();
            below = above.id();
        }
        let view = scene.open_view(below, &rules()).unwrap();
        assert_eq!(sizes(&mut scene, view), [70_001.0]);
        let top = scene.handle::<Attribute>(below).unwrap();
        scene.edit(top, |top| top.set_as::<Size>(PushMode::Force, 5.0)).unwrap();
        scene.set_logging(true);
        assert_eq!(sizes(&mut scene, view), [70_001.0]);
        assert_eq!(all_compiled(&mut scene), [("attribute", 1)]);
    });
}

#[test]
fn sites_stay_bounded_while_the_viewpoint_moves() {
    let mut scene = Scene::new();
    let root = scene.add(Group);
    for x in 0..100 {
        let moved = scene.add_to(root, at(x)).unwrap();
        let levels = LevelOfDetail { hysteresis: 0.1, ..LevelOfDetail::new([10.0, 30.0]) };
        let levels = scene.add_to(moved, levels).unwrap();
        for size in [1.0, 2.0, 3.0] {
            scene.add_to(levels, Plain { size }).unwrap();
        }
    }
    let view = scene.open_view(root, &rules()).unwrap();
    scene.set_budget(view, Budget { spare_plans: 1000, ..Budget::default() }).unwrap();
    let mut most = 0;
    for frame in 0..500 {
        scene.set_held::<Viewpoint>(view, Some(Vec3::X * (frame % 90) as f32)).unwrap();
        scene.bounds(view).unwrap();
        most = most.max(scene.n_sites());
    }
    // Two for each of the levels and those above them, and the spare ones.
    assert!(most < 2 * 501 + 1000 + 501, "{most}");
    assert!(scene.n_plans() < 2 * 501 + 1000 + 501, "{}", scene.n_plans());
}

#[test]
fn what_many_ask_and_what_drives_many_goes_in_time() {
    const MANY: usize = 100_000;
    let mut scene = Scene::new();
    let (root, other) = (scene.add(Group), scene.add(Group));
    let value = scene.add(Attribute::new().with::<Size>(2.0));
    let source = scene.add(Plain { size: 1.0 });
    let drive = |source: &Plain, target: &mut Plain| target.size = source.size;
    let mut add = |parent| {
        let attribute = scene.add_to(parent, Attribute::new().asking::<Size>()).unwrap();
        scene.set_value_graph(attribute, Some(value.id())).unwrap();
        let target = scene.add_to(parent, Plain { size: 0.0 }).unwrap();
        scene.connect(source, target, "size", drive).unwrap();
        (attribute, target)
    };
    let all: Vec<_> = (0..MANY).map(|_| add(root)).collect();
    (0..MANY).for_each(|_| {
        add(other);
    });
    scene.remove(other).unwrap();
    // In an order that is neither that of making nor its reverse.
    for i in 0..MANY {
        let (attribute, target) = all[i * 7919 % MANY];
        scene.set_value_graph(attribute, None).unwrap();
        scene.disconnect(target, "size").unwrap();
    }
    assert_eq!(scene.fault(), None);
    for (attribute, target) in &all {
        scene.set_value_graph(*attribute, Some(value.id())).unwrap();
        scene.connect(source, *target, "size", drive).unwrap();
    }
    scene.remove(value).unwrap();
    scene.remove(source).unwrap();
    assert!(all.iter().all(|(_, target)| scene.inputs(*target).count() == 0));
}

#[test]
fn a_chain_of_connections_is_made_from_either_end() {
    let mut scene = Scene::new();
    let bodies: Vec<_> = (0..50_000).map(|_| scene.add(Plain { size: 0.0 })).collect();
    let drive = |above: &Plain, below: &mut Plain| below.size = above.size + 1.0;
    for pair in bodies.windows(2).rev() {
        scene.connect(pair[0], pair[1], "size", drive).unwrap();
    }
    assert_eq!(scene.get(bodies[49_999]).unwrap().size, 49_999.0);
}
