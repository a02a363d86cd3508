//! What fades with the distance: drawn, counted, written, picked and pictured by the same limits.

use sapwood::geom::glam::{Affine3, Vec2, Vec3};
use sapwood::geom::{Mesh, Polyline, Ray, Shared, SharedMesh, content};
use sapwood::graph::{
    DrawList, Eye, Facing, Fading, Falloff, Material, Merge, Named, PickOptions, Stretch, Struck,
};
use sapwood::scene::{
    Component, Context, Group, Rule, RuleError, RuleSet, Scene, Transform, ViewId, Viewer,
};

use super::super::kinds::{all_compiled, checked_scene};

/// Eight tiles in a row along x as one mesh, as instances and as lines, above each other.
#[derive(Clone, Copy)]
struct Tiles {
    keeps_coverage: bool,
}

content!(Tiles { keeps_coverage });

impl Named for Tiles {
    const NAME: &'static str = "tiles";
}

impl Component for Tiles {}

struct TilesRule;

/// A tile: two triangles in the plane of x and y.
fn tile() -> Mesh {
    let corners = [[0.0, 0.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5]];
    Mesh {
        positions: corners.map(|[x, y]| Vec3::new(x, y, 0.0)).to_vec(),
        normals: vec![Vec3::Z; 4],
        uvs: corners.map(|[x, y]| Vec2::new(x, y)).to_vec(),
        indices: vec![0, 1, 2, 0, 2, 3],
    }
}

impl Rule for TilesRule {
    type Component = Tiles;
    type Data = ();
    const NAME: &'static str = "tiles";

    fn init(&self, tiles: &Tiles, cx: &mut Context<'_>) -> Result<(), RuleError> {
        // Four of the eight are left at 40 m, none at 80 m; in masses of one they go from the end.
        let shown = Falloff(vec![Stretch::even(f32::INFINITY, 1.0, 80.0)]);
        let fading = Fading {
            shown,
            replaced: Falloff::default(),
            mass: 1,
            ends: None,
            keeps_coverage: false,
        };
        let places =
            [0, 1, 2, 3, 4, 5, 6, 7].map(|x| Affine3::from_translation(Vec3::X * x as f32));
        let mut row = Mesh::default();
        places.iter().for_each(|place| row.append(&tile(), place));
        let ends = Some(Shared::new((1..=8).map(|i| 2 * i).collect()));
        let grey = || Material::matte("grey", 0.5, 0.5, 0.5).into();
        cx.fading(Fading { ends, ..fading.clone() }, |cx| cx.mesh(SharedMesh::new(row), grey()));
        let line = |place: &Affine3| Polyline {
            points: [Vec3::Y * 4.0, Vec3::new(0.5, 4.0, 0.0)]
                .map(|point| place.transform_point3(point))
                .to_vec(),
            radii: vec![0.1; 2],
        };
        let lines = Shared::new(places.iter().map(line).collect());
        let keeps_coverage = tiles.keeps_coverage;
        let mass = if keeps_coverage { 4 } else { 1 };
        cx.transform(Affine3::from_translation(Vec3::Y * 2.0), |cx| {
            // Measured from here, 2 m above.
            cx.fading(Fading { keeps_coverage, mass, ..fading.clone() }, |cx| {
                cx.instances(SharedMesh::new(tile()), grey(), Shared::new(places.to_vec()));
            });
        });
        // What is drawn nearby is left out.
        let (shown, replaced) = (Falloff::none(), fading.shown.clone());
        cx.fading(Fading { shown, replaced, ..fading }, |cx| cx.lines(lines));
        Ok(())
    }
}

fn tiles(keeps_coverage: bool) -> (Scene, ViewId) {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let tiles = scene.add(Tiles { keeps_coverage });
    for x in [0.0, 1000.0] {
        let place = scene.add_to(root, Transform::translation(x, 0.0, 0.0)).unwrap();
        scene.append(place, tiles).unwrap();
    }
    let rules = RuleSet::new().with(TilesRule);
    let view = scene.open_view(root, &rules.over(&sapwood::standard_rules())).unwrap();
    (scene, view)
}

fn look_from(scene: &mut Scene, view: ViewId, eye: Option<Vec3>) -> DrawList {
    scene.set_moving::<Viewer>(view, eye.map(Eye::new)).unwrap();
    scene.draw_list(view, 1000).unwrap()
}

/// Triangles of single meshes, instances and lines that are drawn.
fn drawn(list: &DrawList) -> [u64; 3] {
    let mut drawn = [0; 3];
    for (_, row) in list.placed_rows() {
        match row.instances {
            None => drawn[0] += row.n_triangles(),
            Some(_) => drawn[1] += row.n_copies() as u64,
        }
    }
    drawn[2] = list.placed_lines().map(|(_, row)| row.drawn().len() as u64).sum();
    drawn
}

#[test]
fn less_is_drawn_from_further_away_and_nothing_is_compiled() {
    let (mut scene, view) = tiles(false);
    // Without an eye as from nearby, at both places.
    assert_eq!(drawn(&look_from(&mut scene, view, None)), [32, 16, 0]);
    scene.take_log();
    let bound = scene.bounds(view).unwrap();
    // The other place is far away, and all its tiles are lines.
    for (distance, expected) in [
        (0.0, [16, 7, 8]),
        (20.0, [12, 5, 10]),
        (40.0, [8, 3, 12]),
        (75.0, [0, 0, 16]),
        (90.0, [0, 0, 16]),
    ] {
        let list = look_from(&mut scene, view, Some(Vec3::Z * distance));
        assert_eq!(drawn(&list), expected, "from {distance} m");
        let (_, n_triangles) = list.n_vertices_and_triangles();
        assert_eq!(n_triangles, expected[0] + 2 * expected[1]);
        // Whoever cannot draw by parts gets the same.
        let cut = list.as_drawn();
        assert!(cut.bodies.iter().all(|body| {
            body.rows.iter().all(|row| row.range.is_none())
                && body.lines.iter().all(|row| row.range.is_none())
        }));
        assert_eq!((drawn(&cut), cut.n_vertices_and_triangles().1), (expected, n_triangles));
        let merged = list.merged_by_material(Merge::All { max_triangles: n_triangles }).unwrap();
        assert_eq!(merged.n_vertices_and_triangles().1, n_triangles);
        let smooth = list.with_smooth_normals(1.0);
        assert_eq!(smooth.n_vertices_and_triangles().1, n_triangles);
        // A file has the same bytes as one of that.
        let bytes = [&list, &*cut].map(|list| sapwood::io::glb_bytes(list).unwrap());
        assert_eq!(bytes[0], bytes[1]);
    }
    assert_eq!(all_compiled(&mut scene), []);
    assert_eq!(scene.bounds(view).unwrap(), bound);
    let report = scene.verify(view, 10).unwrap();
    assert!(report.is_clean(), "{report:?}");
}

/// Eight tiles that turn to the eye, and once more within that.
struct Signs;

content!(Signs {});

impl Named for Signs {
    const NAME: &'static str = "signs";
}

impl Component for Signs {}

struct SignsRule;

impl Rule for SignsRule {
    type Component = Signs;
    type Data = ();
    const NAME: &'static str = "signs";

    fn init(&self, _: &Signs, cx: &mut Context<'_>) -> Result<(), RuleError> {
        let shown = Falloff(vec![Stretch::even(f32::INFINITY, 1.0, 80.0)]);
        let replaced = Falloff::default();
        let fading = Fading { shown, replaced, mass: 1, ends: None, keeps_coverage: false };
        let places = Shared::new(vec![Affine3::IDENTITY; 8]);
        let tiles = |cx: &mut Context<'_>| {
            let grey = Material::matte("grey", 0.5, 0.5, 0.5).into();
            cx.instances(SharedMesh::new(tile()), grey, places.clone());
        };
        cx.fading(fading, |cx| {
            cx.transform(Affine3::from_translation(Vec3::X * 30.0), |cx| {
                cx.facing(Facing::Eye, |cx| {
                    tiles(cx);
                    cx.facing(Facing::Axis(Vec3::Y), tiles);
                });
            });
        });
        Ok(())
    }
}

#[test]
fn what_turns_to_the_eye_fades_by_the_distance_of_what_has_it_fade() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    for x in [0.0, 10.0] {
        let place = scene.add_to(root, Transform::translation(x, 0.0, 0.0)).unwrap();
        scene.add_to(place, Signs).unwrap();
    }
    let rules = RuleSet::new().with(SignsRule);
    let view = scene.open_view(root, &rules.over(&sapwood::standard_rules())).unwrap();
    for (x, expected) in [(0.0, 2 * (8 + 7)), (-40.0, 2 * (4 + 3)), (-70.0, 2), (-90.0, 0)] {
        let list = look_from(&mut scene, view, Some(Vec3::X * x));
        assert_eq!(drawn(&list), [0, expected, 0], "from {x} m");
    }
    let report = scene.verify(view, 10).unwrap();
    assert!(report.is_clean(), "{report:?}");
}

#[test]
fn places_at_one_distance_share_what_is_left() {
    let (mut scene, view) = tiles(false);
    let list = look_from(&mut scene, view, Some(Vec3::new(500.0, 0.0, 0.0)));
    assert_eq!((list.bodies.len(), list.occurrences.len()), (1, 2));
    let list = look_from(&mut scene, view, Some(Vec3::new(10.0, 0.0, 0.0)));
    assert_eq!((list.bodies.len(), list.occurrences.len()), (2, 2));
}

#[test]
fn what_is_larger_or_seen_more_finely_fades_later() {
    let (mut scene, view) = tiles(false);
    let at = |rows| Eye { rows_per_degree: rows, ..Eye::new(Vec3::new(0.0, 0.0, 40.0)) };
    let mut triangles = |rows| {
        scene.set_moving::<Viewer>(view, Some(at(rows))).unwrap();
        drawn(&scene.draw_list(view, 1000).unwrap())[0]
    };
    let reference = Eye::REFERENCE_ROWS;
    assert_eq!([0.5, 1.0, 2.0].map(|times| triangles(times * reference)), [0, 8, 12]);
}

#[test]
fn what_is_not_drawn_is_not_picked() {
    let (mut scene, view) = tiles(false);
    scene.set_moving::<Viewer>(view, Some(Eye::new(Vec3::Z * 40.0))).unwrap();
    let mut hit = |x: f32, y: f32| {
        let ray = Ray::new(Vec3::new(x, y, 40.0), Vec3::NEG_Z);
        let options = PickOptions { line_radius: Some(0.05), ..PickOptions::default() };
        let hit = scene.pick(view, &ray, &options).unwrap()?;
        Some(match hit.struck {
            Struck::Triangle { instance: None, .. } => "mesh",
            Struck::Triangle { instance: Some(_), .. } => "instance",
            Struck::Line { .. } => "line",
            Struck::Label => "label",
        })
    };
    assert_eq!((hit(2.2, 0.2), hit(3.2, 0.2), hit(4.2, 0.2)), (Some("mesh"), Some("mesh"), None));
    assert_eq!((hit(2.2, 2.2), hit(3.2, 2.2)), (Some("instance"), None));
    assert_eq!((hit(3.2, 4.0), hit(4.2, 4.0)), (None, Some("line")));
}

#[test]
fn pictures_see_what_is_drawn() {
    use sapwood::picture::Studio;
    let (mut scene, view) = tiles(false);
    scene.set_moving::<Viewer>(view, Some(Eye::new(Vec3::Z * 40.0))).unwrap();
    let mut supply = scene.supply(view).unwrap();
    let mut studio = Studio::new(&mut supply);
    let mut is_met =
        |x: f32, y: f32| studio.sight(Vec3::new(x, y, 40.0), Vec3::NEG_Z, 100.0).unwrap().is_some();
    assert_eq!([2.2, 3.2, 4.2].map(|x| is_met(x, 0.2)), [true, true, false]);
    assert_eq!([1.2, 2.2, 3.2].map(|x| is_met(x, 2.2)), [true, true, false]);
    assert_eq!([3.2, 4.2, 5.2].map(|x| is_met(x, 4.0)), [false, true, true]);
}

#[test]
fn what_is_left_can_cover_as_much() {
    let (mut scene, view) = tiles(true);
    let area = |list: &DrawList| -> f32 {
        let rows = list.placed_rows().filter(|(_, row)| row.instances.is_some());
        rows.map(|(_, row)| row.n_copies() as f32 * row.mesh.positions[2].x.powi(2)).sum()
    };
    let near = area(&look_from(&mut scene, view, None));
    let eye = Vec3::new(0.0, 2.0, 40.0);
    let list = look_from(&mut scene, view, Some(eye));
    assert_eq!(drawn(&list)[1], 4);
    // One of the two places is out of sight.
    assert!((area(&list) - 0.5 * near).abs() < 1e-3 * near, "{} {near}", area(&list));
    let bound = scene.bounds(view).unwrap().aabb;
    for (world, row) in list.placed_rows() {
        for place in row.instances.iter().flat_map(|instances| instances.iter()) {
            let corner = (world * *place).transform_point3(row.mesh.positions[2]);
            assert!(bound.contains(corner), "{corner} {bound:?}");
        }
    }
    // A tile that is drawn larger is met where it is.
    let edge = 0.5 * 2.0f32.sqrt() - 0.05;
    let ray = Ray::new(Vec3::new(edge, 2.0 + edge, 40.0), Vec3::NEG_Z);
    assert!(scene.pick(view, &ray, &PickOptions::default()).unwrap().is_some());
    let mut supply = scene.supply(view).unwrap();
    let mut studio = sapwood::picture::Studio::new(&mut supply);
    let origin = Vec3::new(edge, 2.0 + edge, 40.0);
    assert!(studio.sight(origin, Vec3::NEG_Z, 100.0).unwrap().is_some());
}
