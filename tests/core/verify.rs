//! Verifying: what is sound has no findings, and each planted fault is found where it is.

use std::sync::Arc;

use sapwood::geom::glam::{Affine3, Vec3};
use sapwood::geom::{Bound, Digester, Image, Mesh, Polyline, Ray, Shared, SharedMesh, content};
use sapwood::graph::{
    Alpha, Camera, Facing, Label, Lens, Light, LightShape, Material, Named, Part, PickOptions,
    Severity, Shown,
};
use sapwood::rules::weber_penn::{Seed, Tree};
use sapwood::scene::{Component, Context, Group, Rule, RuleError, RuleSet, Scene};

use super::kinds::*;

#[derive(Debug, Clone)]
struct Nail;
content!(Nail {});
impl Named for Nail {
    const NAME: &'static str = "nail";
}
impl Part for Nail {}

/// What a rule of the test draws.
#[derive(Debug, Clone)]
struct Planted;
content!(Planted {});
impl Named for Planted {
    const NAME: &'static str = "planted";
}
impl Component for Planted {}

type Draw = fn(&mut Context<'_>);

struct PlantedRule(u64, Draw);
impl Rule for PlantedRule {
    type Component = Planted;
    type Data = ();
    const NAME: &'static str = "planted";
    fn settings(&self, digester: &mut Digester) {
        digester.add(&self.0);
    }
    fn init(&self, _: &Planted, cx: &mut Context<'_>) -> Result<(), RuleError> {
        (self.1)(cx);
        Ok(())
    }
}

/// Draws it twice, in two places, and verifies.
fn check(expected: &str, draw: Draw) {
    let mut scene = Scene::new();
    let root = scene.add(Group);
    scene.add_to(root, Plain { size: 1.0 }).unwrap();
    let planted = scene.add_to(root, Planted).unwrap();
    scene.append(root, planted).unwrap();
    let rules = RuleSet::new().with(PlantedRule(0, draw)).over(&rules());
    let view = scene.open_view(root, &rules).unwrap();
    let report = scene.verify(view, 10).unwrap();
    let lines: Vec<String> = report.findings.iter().map(ToString::to_string).collect();
    let found = lines.join("\n");
    if expected.is_empty() {
        assert!(report.is_clean(), "{found}");
    } else {
        assert_eq!(report.findings.len(), 1, "{found}");
        assert!(found.starts_with(expected), "{found}\n{expected}");
        assert!(report.to_string().contains("1 faults in "), "{report}");
    }
}

fn stone() -> Arc<Material> {
    Material::matte("stone", 0.5, 0.5, 0.5).into()
}

fn broken(change: impl FnOnce(&mut Mesh)) -> SharedMesh {
    let mut mesh = triangle(1.0);
    change(&mut mesh);
    SharedMesh::new(mesh)
}

#[test]
fn faults_of_meshes_are_found() {
    check("", |cx| cx.mesh(broken(|_| {}), stone()));
    check("error: planted at 0/1: mesh: a triangle uses vertex 7 of 3", |cx| {
        cx.mesh(broken(|mesh| mesh.indices[1] = 7), stone());
    });
    check("error: planted at 0/1: mesh: a mesh has indices that are no triangle", |cx| {
        cx.mesh(broken(|mesh| mesh.indices.truncate(2)), stone());
    });
    check("error: planted at 0/1: mesh: the normal of vertex 2 is", |cx| {
        cx.mesh(broken(|mesh| mesh.normals[2] *= 1.1), stone());
    });
    check("error: planted at 0/1: mesh: the position of vertex 0 is", |cx| {
        cx.mesh(broken(|mesh| mesh.positions[0].y = f32::NAN), stone());
    });
    check("error: planted at 0/1: mesh: 3 positions, 3 normals, 2 texture", |cx| {
        cx.mesh(broken(|mesh| mesh.uvs.truncate(2)), stone());
    });
    check("error: planted at 0/1: mesh: triangle 0 is degenerate", |cx| {
        cx.mesh(broken(|mesh| mesh.indices[0] = 1), stone());
    });
    check("warning: planted at 0/1: mesh without triangles", |cx| {
        cx.mesh(SharedMesh::new(Mesh::default()), stone());
    });
}

#[test]
fn faults_of_looks_are_found() {
    check("error: planted at 0/1: material \"stone\": colour [2.0, 0.5", |cx| {
        cx.mesh(broken(|_| {}), Material::matte("stone", 2.0, 0.5, 0.5).into());
    });
    check("error: planted at 0/1: material \"stone\": metallic 0 and roughness NaN", |cx| {
        let material = Material { roughness: f32::NAN, ..Material::clone(&stone()) };
        cx.mesh(broken(|_| {}), material.into());
    });
    check("error: planted at 0/1: material \"stone\": is there from a coverage of -1", |cx| {
        let material = Material { alpha: Alpha::Mask(-1.0), ..Material::clone(&stone()) };
        cx.mesh(broken(|_| {}), material.into());
    });
    check("error: planted at 0/1: material \"stone\": 1 pixels in an image of 2 x 2", |cx| {
        let mut material = Material::clone(&stone());
        let image = Image { width: 2, height: 2, pixels: vec![[0; 4]] };
        material.images.normal = Some(Shared::new(image));
        cx.mesh(broken(|_| {}), material.into());
    });
}

#[test]
fn faults_of_everything_else_that_is_drawn_are_found() {
    check("warning: planted at 0/1: instance 1 is flat; and 1 more like it", |cx| {
        let places = [1.0, 0.0, 0.0].map(|scale| Affine3::from_scale(Vec3::splat(scale)));
        cx.instances(broken(|_| {}), stone(), Shared::new(places.to_vec()));
    });
    check("error: planted at 0/1: line 1: 1 points with 2 radii", |cx| {
        let line = |n| Polyline { points: vec![Vec3::ZERO], radii: vec![0.1; n] };
        cx.lines(Shared::new(vec![line(1), line(2)]));
    });
    check("error: planted at 0/1: light: colour", |cx| {
        let shape = LightShape::Directional;
        cx.light(Light { name: String::new(), color: [-1.0; 3], intensity: 1.0, shape });
    });
    check("error: planted at 0/1: camera: near 0", |cx| {
        let lens = Lens::Perspective { vertical_angle: 1.0 };
        cx.camera(Camera { name: String::new(), lens, near: 0.0, far: None });
    });
    check("error: planted at 0/1: label: letters 0 m high", |cx| cx.label(Label::new("a", 0.0)));
    check("error: planted at 0/1: turns about [0, 2, 0]", |cx| {
        cx.facing(Facing::Axis(Vec3::Y * 2.0), |_| {});
    });
    check("warning: planted at 0/1: transform 1 flattens what it places", |cx| {
        cx.transform(Affine3::from_scale(Vec3::X), |_| {});
    });
}

#[test]
fn faults_of_bounds_and_parts_are_found() {
    check("error: planted at 0/1: the bound foreseen for link 0 to a plain does not hold", |cx| {
        let bound = Bound::of_points([Vec3::ZERO, Vec3::X]);
        cx.emit_keyed(0, Plain { size: 2.0 }, Some(bound));
    });
    check("error: planted at 0/1: shows parts of kind nail that nothing here has", |cx| {
        cx.mesh(broken(|_| {}), stone());
        cx.shows(Shown::each::<Nail>());
    });
    check("error: planted at 0/1: shows row 1 of 1 parts of kind nail", |cx| {
        cx.instances(broken(|_| {}), stone(), Shared::new(vec![Affine3::IDENTITY; 2]));
        cx.shows(Shown::each::<Nail>());
        cx.parts(vec![Nail]);
    });
    check("error: planted at 0/1: spans of nail that are not in order up to 1", |cx| {
        cx.mesh(broken(|_| {}), stone());
        cx.shows(Shown::spans::<Nail>([4]));
        cx.parts(vec![Nail]);
    });
    check("error: planted at 0/1: rule planted panicked", |_| panic!("on purpose"));
}

#[test]
fn no_more_is_told_than_asked_for() {
    let mut scene = Scene::new();
    let root = scene.add(Group);
    for size in 0..20 {
        scene.add_to(root, Plain { size: f32::NAN * size as f32 }).unwrap();
        scene.add_to(root, Plain { size: size as f32 }).unwrap();
    }
    let view = scene.open_view(root, &rules()).unwrap();
    let report = scene.verify(view, 3).unwrap();
    // Each component whose mesh has no numbers, and once the mesh without a size.
    assert_eq!((report.findings.len(), report.n_more), (3, 18), "{report}");
    let report = scene.verify(view, 1).unwrap();
    assert_eq!((report.findings.len(), report.n_more), (1, 20), "{report}");
    assert!(report.to_string().contains("... and 20 more"), "{report}");
    assert_eq!(report.findings[0].severity, Severity::Error);
}

#[test]
fn trees_are_sound() {
    for name in ["quaking_aspen", "palm", "japanese_maple"] {
        let species = sapwood::io::built_in(name).unwrap();
        let mut scene = Scene::new();
        let family = scene.add(species.attribute());
        scene.add_to(family, Tree { seed: Seed::Explicit(1) }).unwrap();
        for rules in [sapwood::standard_rules(), sapwood::skeleton_rules()] {
            let view = scene.open_view(family, &rules).unwrap();
            let report = scene.verify(view, 10).unwrap();
            assert!(report.is_clean(), "{name}: {report}");
        }
    }
}

#[test]
fn an_unsound_mesh_of_a_rule_is_an_error_and_harms_nobody_else() {
    let draws: [Draw; 4] = [
        |cx| cx.mesh(broken(|mesh| mesh.indices = vec![0, 1, 7]), stone()),
        |cx| cx.mesh(broken(|mesh| mesh.normals.truncate(1)), stone()),
        |cx| cx.mesh(broken(|mesh| mesh.uvs.clear()), stone()),
        |cx| {
            let places = Shared::new(vec![Affine3::IDENTITY]);
            cx.instances(broken(|mesh| mesh.indices = vec![0, 1, 7]), stone(), places);
            cx.shows(Shown::each::<Nail>());
        },
    ];
    for draw in draws {
        let mut scene = Scene::new();
        let root = scene.add(Group);
        scene.add_to(root, Planted).unwrap();
        scene.add_to(root, Plain { size: 1.0 }).unwrap();
        let rules = RuleSet::new().with(PlantedRule(0, draw)).over(&rules());
        let view = scene.open_view(root, &rules).unwrap();
        let ray = Ray::new(Vec3::new(0.2, 0.2, 3.0), Vec3::NEG_Z);
        let hit = scene.pick(view, &ray, &PickOptions::default()).unwrap().unwrap();
        assert_eq!(hit.path, [0, 1]);
        let list = scene.draw_list(view, 10).unwrap().with_smooth_normals(1.0);
        assert_eq!(list.n_vertices_and_triangles().1, 1);
        let found = scene.diagnostics(view, 10).unwrap();
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(found[0].1.message.starts_with("mesh: "), "{found:?}");
    }
}
