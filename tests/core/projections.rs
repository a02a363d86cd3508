//! Projections: only the answer counts as read.

use sapwood::geom::{SharedMesh, content};
use sapwood::graph::{Material, Named};
use sapwood::scene::{
    Component, Context, Group, Placement, Projection, Rule, RuleError, RuleSet, Scene, SlotReader,
};

use super::kinds::*;

/// Which stretch of the x axis a component stands in.
struct Stretch {
    len: f32,
}
content!(Stretch { len });
impl Projection for Stretch {
    type Output = i32;
    const NAME: &'static str = "stretch";
    fn compute(&self, slots: &mut SlotReader<'_>) -> i32 {
        (slots.read::<Placement>().translation.x / self.len).floor() as i32
    }
}

/// A component as large as the numbers of the short and the long stretch that it stands in.
#[derive(Debug, Clone)]
struct Settled {}
content!(Settled {});
impl Named for Settled {
    const NAME: &'static str = "settled";
}
impl Component for Settled {}

struct SettledRule;
impl Rule for SettledRule {
    type Component = Settled;
    type Data = ();
    const NAME: &'static str = "settled";
    fn init(&self, _: &Settled, cx: &mut Context<'_>) -> Result<(), RuleError> {
        let (short, long) = (cx.project(Stretch { len: 10.0 }), cx.project(Stretch { len: 100.0 }));
        let mesh = triangle((1 + short + 100 * long) as f32);
        cx.mesh(SharedMesh::new(mesh), Material::matte("m", 1.0, 1.0, 1.0).into());
        Ok(())
    }
}

fn settled_rules() -> RuleSet {
    RuleSet::new().with(SettledRule).over(&rules())
}

#[test]
fn moving_inside_a_cell_runs_nothing_and_crossing_runs_one() {
    let mut scene = checked_scene();
    let moved = scene.add(at(1));
    let group = scene.add_to(moved, Group).unwrap();
    scene.add_to(group, Settled {}).unwrap();
    let view = scene.open_view(moved, &settled_rules()).unwrap();
    for (x, size, runs) in [
        (1, 1.0, 1),
        (5, 1.0, 0),
        (9, 1.0, 0),
        (10, 2.0, 1),
        (12, 2.0, 0),
        (9, 1.0, 0),
        (105, 111.0, 1),
        (15, 2.0, 0),
    ] {
        scene.edit(moved, |moved| *moved = at(x)).unwrap();
        let bounds = scene.bounds(view).unwrap().aabb;
        assert_eq!((bounds.min.x, bounds.size().x), (x as f32, size));
        assert_eq!(compiled(&mut scene, "settled"), runs, "at {x}");
    }
}

#[test]
fn what_is_shared_is_compiled_once_for_each_cell() {
    let mut scene = Scene::new();
    scene.set_logging(true);
    let root = scene.add(Group);
    let shared = scene.add(Group);
    scene.add_to(shared, Settled {}).unwrap();
    let parents: Vec<_> = (0..200)
        .map(|x| {
            let moved = scene.add_to(root, at(x)).unwrap();
            scene.append(moved, shared).unwrap();
            moved
        })
        .collect();
    let view = scene.open_view(root, &settled_rules()).unwrap();
    scene.bounds(view).unwrap();
    assert_eq!(compiled(&mut scene, "settled"), 20);
    assert_eq!(scene.count(view).unwrap().components_of("settled"), 200);
    scene.edit(parents[3], |moved| *moved = at(155)).unwrap();
    scene.bounds(view).unwrap();
    assert_eq!(compiled(&mut scene, "settled"), 0);
    scene.edit(parents[3], |moved| *moved = at(255)).unwrap();
    assert_eq!(scene.bounds(view).unwrap().aabb.max.x, 255.0 + 1.0 + 25.0 + 200.0);
    assert_eq!(compiled(&mut scene, "settled"), 1);
}
