//! Pruning: what lies inside keeps its sharing, what lies outside goes uncompiled, what crosses is
//! cut; handlers decide about parts.

use std::cell::Cell;

use sapwood::geom::glam::{Affine3, Vec2, Vec3};
use sapwood::geom::{Aabb, Envelope, Mesh, Shared, SharedMesh, Sphere, content};
use sapwood::graph::{
    DrawList, Fate, Interrupted, Kind, Named, Part, Prune, PruneHandlers, PruneLimits, Shown,
    prune_compiled,
};
use sapwood::scene::{
    Action, Budget, Component, Context, Group, HeldGeometry, HeldInstances, Rule, RuleError,
    RuleSet, Scene, Transform, ViewId,
};

/// A cube of edge length 1 about the origin, each face with corners of its own.
fn cube() -> SharedMesh {
    let mut mesh = Mesh::default();
    for (normal, u) in [
        (Vec3::X, Vec3::Y),
        (Vec3::NEG_X, Vec3::Z),
        (Vec3::Y, Vec3::Z),
        (Vec3::NEG_Y, Vec3::X),
        (Vec3::Z, Vec3::X),
        (Vec3::NEG_Z, Vec3::Y),
    ] {
        let (v, first) = (normal.cross(u), mesh.positions.len() as u32);
        for (x, y) in [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)] {
            mesh.positions.push(normal * 0.5 + u * x + v * y);
            mesh.normals.push(normal);
            mesh.uvs.push(Vec2::new(x + 0.5, y + 0.5));
        }
        mesh.indices.extend([0, 1, 2, 0, 2, 3].map(|i| first + i));
    }
    SharedMesh::new(mesh)
}

fn held() -> HeldGeometry {
    HeldGeometry { mesh: cube(), material: None }
}

/// One cube at many places along x.
fn row_of_cubes(scene: &mut Scene, places: impl IntoIterator<Item = f32>) -> ViewId {
    let root = scene.add(Group);
    let cube = scene.add(held());
    for x in places {
        let place = scene.add_to(root, Transform::translation(x, 0.0, 0.0)).unwrap();
        scene.append(place, cube).unwrap();
    }
    scene.open_view(root, &sapwood::standard_rules()).unwrap()
}

fn pruned(scene: &mut Scene, view: ViewId, envelope: Envelope) -> DrawList {
    scene.prune(view, &Prune::to(envelope), &PruneHandlers::new(), 1000).unwrap()
}

/// The area of everything in a list, and its box.
fn area(list: &DrawList) -> (f32, Aabb) {
    let once = [Affine3::IDENTITY];
    let mut all = Mesh::default();
    for (world, row) in list.placed_rows() {
        assert_eq!(row.mesh.fault(), None);
        for at in row.instances.as_ref().map_or(&once[..], |instances| instances) {
            all.append(&row.mesh, &(world * *at));
        }
    }
    let triangles = all.indices.chunks_exact(3).map(|t| {
        let [a, b, c] = [t[0], t[1], t[2]].map(|i| all.positions[i as usize]);
        (b - a).cross(c - a).length() / 2.0
    });
    (triangles.sum(), all.bound().aabb)
}

#[test]
fn what_lies_inside_stays_shared_and_what_crosses_is_cut() {
    let mut scene = Scene::new();
    let view = row_of_cubes(&mut scene, (0..10).map(|i| 2.0 * i as f32));
    let whole = scene.draw_list(view, 1000).unwrap();
    // Through the middle of the fifth cube.
    let list = pruned(&mut scene, view, Envelope::half_space(Vec3::X, 8.0));
    assert_eq!(list.occurrences.len(), 5);
    assert_eq!(list.bodies.len(), 2);
    assert!(list.bodies[0].rows[0].mesh.is_same(&whole.bodies[0].rows[0].mesh));
    let (area, aabb) = area(&list);
    assert!((area - (4.0 * 6.0 + 3.0)).abs() < 1e-4, "{area}");
    assert!((aabb.max.x - 8.0).abs() < 1e-5, "{aabb:?}");
    // Everything, and nothing.
    let far = Sphere { center: Vec3::ZERO, radius: 100.0 };
    let all = pruned(&mut scene, view, Envelope::sphere(far));
    assert_eq!((all.bodies.len(), all.occurrences.len()), (1, 10));
    let none = pruned(&mut scene, view, Envelope::sphere(far).complement());
    assert!(none.occurrences.is_empty() && none.bodies.is_empty());
}

#[test]
fn too_many_rows_are_refused_with_their_kind() {
    let mut scene = Scene::new();
    let view = row_of_cubes(&mut scene, [0.0, 2.0, 4.0]);
    let prune = Prune::to(Envelope::half_space(Vec3::Z, 0.0));
    let refused = scene.prune(view, &prune, &PruneHandlers::new(), 2).unwrap_err();
    assert!(refused.to_string().contains("held_geometry"), "{refused}");
}

#[test]
fn cutting_keeps_to_the_budget_and_can_be_stopped() {
    // Cubes in one mesh, turned against each other, that a ball cuts.
    let mut scene = Scene::new();
    let root = scene.add(Group);
    let mut mesh = Mesh::default();
    for i in 0..200 {
        mesh.append(&cube(), &Affine3::from_rotation_y(0.01 * i as f32));
    }
    let mesh = SharedMesh::new(mesh);
    scene.add_to(root, HeldGeometry { mesh, material: None }).unwrap();
    let view = scene.open_view(root, &sapwood::standard_rules()).unwrap();
    let ball = Sphere { center: Vec3::X, radius: 1.0 };
    let prune = Prune::to(Envelope::sphere(ball));
    let handlers = PruneHandlers::new();
    let cut = scene.prune(view, &prune, &handlers, 10).unwrap();
    let needed = cut.n_vertices_and_triangles().1;
    assert!(needed > 10_000);
    // Held geometry counts too, but was compiled before.
    let few = Budget { triangles: needed / 2, ..Budget::default() };
    scene.set_budget(view, few).unwrap();
    let refused = scene.prune(view, &prune, &handlers, 10).unwrap_err().to_string();
    let told = format!("more than {} triangles", needed / 2);
    assert!(refused.contains(&told) && refused.contains("held_geometry"), "{refused}");

    let supply = scene.supply(view).unwrap();
    for n_answers in [0, 1, 2] {
        let n = Cell::new(0);
        let goes_on = || n.replace(n.get() + 1) < n_answers;
        let limits = PruneLimits { goes_on: &goes_on, ..PruneLimits::NONE };
        let stopped = prune_compiled(&supply, &prune, &handlers, &limits);
        assert_eq!(stopped.unwrap_err(), Interrupted::Cancelled);
        assert_eq!(n.get(), n_answers + 1, "nobody asks again");
    }
    let drawn = prune_compiled(&supply, &prune, &handlers, &PruneLimits::NONE).unwrap().unwrap();
    assert_eq!(drawn.n_vertices_and_triangles(), cut.n_vertices_and_triangles());
}

#[test]
fn a_ball_cuts_a_cube_along_its_surface() {
    let mut scene = Scene::new();
    let view = row_of_cubes(&mut scene, [0.0]);
    let ball = Sphere { center: Vec3::ZERO, radius: 0.6 };
    let list = pruned(&mut scene, view, Envelope::sphere(ball));
    // Six discs of the radius at which the ball meets the faces.
    let expected = 6.0 * std::f32::consts::PI * (0.36 - 0.25);
    let (area, _) = area(&list);
    assert!((area / expected - 1.0).abs() < 0.01, "{area} for {expected}");
    for (world, row) in list.placed_rows() {
        for position in &row.mesh.positions {
            let away = world.transform_point3(*position).length();
            assert!(away < 0.6 + 1e-5, "{position} is {away} away");
        }
    }
}

#[test]
fn instances_are_kept_dropped_or_cut_one_by_one() {
    let mut scene = Scene::new();
    let places: Vec<_> =
        (0..10).map(|i| Affine3::from_translation(Vec3::X * 2.0 * i as f32)).collect();
    let (mesh, material) = (cube(), None);
    let held = HeldInstances { mesh: mesh.clone(), material, places: Shared::new(places) };
    let root = scene.add(held);
    let view = scene.open_view(root, &sapwood::standard_rules()).unwrap();
    let list = pruned(&mut scene, view, Envelope::half_space(Vec3::X, 8.0));
    let rows = &list.bodies[0].rows;
    assert_eq!(rows.len(), 2);
    assert!(rows[0].mesh.is_same(&mesh));
    assert_eq!(rows[0].instances.as_ref().map(|instances| instances.len()), Some(4));
    assert!(rows[1].instances.is_none());
    assert!((area(&list).0 - 27.0).abs() < 1e-4);
}

#[derive(Clone, Debug)]
struct Brick(u32);
impl sapwood::geom::Content for Brick {
    fn write(&self, digester: &mut sapwood::geom::Digester) {
        digester.add(&self.0);
    }
}
impl Named for Brick {
    const NAME: &'static str = "brick";
}
impl Part for Brick {}

/// Three bricks beside each other; emits a pile of its own where one is left.
#[derive(Clone, Debug)]
struct Pile {
    n_above: u32,
}
content!(Pile { n_above });
impl Named for Pile {
    const NAME: &'static str = "pile";
}
impl Component for Pile {}

struct PileRule;
impl Rule for PileRule {
    type Component = Pile;
    type Data = u32;
    const NAME: &'static str = "pile";
    fn init(&self, pile: &Pile, cx: &mut Context<'_>) -> Result<u32, RuleError> {
        let places = [0.0, 2.0, 4.0].map(|x| Affine3::from_translation(Vec3::X * x));
        let material = cx.read::<sapwood::scene::MaterialSlot>();
        cx.instances(cube(), material, Shared::new(places.to_vec()));
        cx.shows(Shown::each::<Brick>());
        cx.parts::<Brick>(vec![Brick(0), Brick(1), Brick(2)]);
        if pile.n_above > 0 {
            let above = Pile { n_above: pile.n_above - 1 };
            cx.transform(Affine3::from_translation(Vec3::Y * 2.0), |cx| cx.emit(above));
        }
        Ok(pile.n_above)
    }
}

#[test]
fn handlers_decide_about_parts_and_leave_notes_for_what_is_below() {
    let mut scene = Scene::new();
    let root = scene.add(Pile { n_above: 2 });
    let rules = RuleSet::new().with(PileRule).over(&sapwood::standard_rules());
    let view = scene.open_view(root, &rules).unwrap();
    // Each pile loses one brick more than the one below; the last one has nothing to stand on.
    let handlers = PruneHandlers::new().on_plan::<u32>(|pruning, _, at| {
        let n_gone = pruning.noted_above::<usize>(at).map_or(1, |n_gone| n_gone + 1);
        if n_gone == 3 {
            pruning.drop_all(at);
            return;
        }
        let fate = |brick| if brick < n_gone { Fate::Gone } else { Fate::Whole };
        pruning.decide::<Brick>(at, (0..3).map(fate).collect());
        pruning.note(at, n_gone);
    });
    let half = Prune::to(Envelope::half_space(Vec3::Z, 0.0));
    let list = scene.prune(view, &half, &handlers, 1000).unwrap();
    let numbers: Vec<_> = list
        .placed_rows()
        .map(|(_, row)| row.instances.as_ref().map_or(0, |instances| instances.len()))
        .collect();
    assert_eq!(numbers, [2, 1], "bricks that were decided about are not clipped");
    assert_eq!(list.bodies[0].kind, Kind::of::<Pile>());
}

#[test]
fn what_lies_outside_is_not_compiled() {
    // Trees tell how far they may reach, so one that stands outside is not grown.
    let species = sapwood::io::find_species("quaking_aspen").unwrap();
    let mut scene = Scene::new();
    scene.set_logging(true);
    let root = scene.add(species.attribute());
    let seed = sapwood::rules::weber_penn::Seed::Explicit(1);
    scene.add_to(root, sapwood::rules::weber_penn::Tree { seed }).unwrap();
    let view = scene.open_view(root, &sapwood::standard_rules()).unwrap();
    let list = pruned(&mut scene, view, Envelope::half_space(Vec3::X, -100.0));
    assert!(list.occurrences.is_empty());
    let log = scene.take_log();
    let compiled = log.iter().filter(|event| event.action == Action::Compiled);
    let kinds: Vec<_> = compiled.map(|event| event.kind.name()).collect();
    assert_eq!(kinds, ["attribute", "tree"]);
}
