//! Pictures that are kept, and changes that must not pass for them.

use sapwood::geom::glam::{Affine3, Quat, Vec3};
use sapwood::geom::{Bound, Image, Mesh, Shared};
use sapwood::graph::{
    Alpha, Diagnostic, DrawList, EnvId, Everything, Eye, Interrupted, Kind, Material, Order,
    PlanRef, Provide, SiteId, Supplied, Supply, Want,
};
use sapwood::picture::{Background, Ground, PictureOptions, PlacedCamera};
use sapwood::rules::weber_penn::{Branch, Seed, Tree};
use sapwood::scene::{
    Group, HeldGeometry, HeldInstances, NodeId, Scene, Style, StyleSlot, Transform, ViewId,
};

use super::compared::{Difference, check, kept};
use super::scenes::{ball, camera, cuboid, of_meshes, taken, try_taken};

fn aspen() -> (Scene, ViewId) {
    let species = sapwood::io::built_in("quaking_aspen").unwrap();
    let mut scene = Scene::new();
    let family = scene.add(species.attribute());
    scene.add_to(family, Tree { seed: Seed::Explicit(1) }).unwrap();
    let view = scene.open_view(family, &sapwood::standard_rules()).unwrap();
    (scene, view)
}

fn options() -> PictureOptions {
    let ground = Some(Ground::default());
    PictureOptions { size: [320, 384], samples: 4, ground, ..PictureOptions::default() }
}

fn aspen_camera() -> PlacedCamera {
    let (mut scene, view) = aspen();
    camera(&mut scene, view, options().size)
}

#[test]
fn an_aspen_on_the_ground() {
    let (mut scene, view) = aspen();
    let picture = taken(&mut scene, view, &aspen_camera(), &options());
    check("aspen", &picture.image);
}

#[test]
fn an_aspen_as_lines_and_as_edges() {
    let (mut scene, view) = aspen();
    let camera = aspen_camera();
    for (style, name) in [(Style::Skeleton, "aspen_skeleton"), (Style::Wire, "aspen_wire")] {
        scene.force_held::<StyleSlot>(view, style).unwrap();
        let background = Background::Color([1.0; 3]);
        let options = PictureOptions { background, ground: None, ..options() };
        check(name, &taken(&mut scene, view, &camera, &options).image);
    }
}

#[test]
fn balls_and_boxes_of_all_sorts() {
    let at = |x: f32, z: f32, y: f32| Affine3::from_translation(Vec3::new(x, y, z));
    let small = Affine3::from_scale(Vec3::splat(0.8));
    let matte = |red, green, blue| Material::matte("", red, green, blue);
    let mirror = Material { metallic: 1.0, roughness: 0.05, ..matte(0.9, 0.8, 0.6) };
    let glossy = Material { roughness: 0.3, ..matte(0.1, 0.2, 0.6) };
    let glowing = Material { emissive: [1.0, 0.3, 0.05], ..matte(0.0, 0.0, 0.0) };
    let checks =
        Image::from_fn(
            8,
            8,
            |x, y| {
                if (x + y) % 2 == 0 { [230, 220, 200, 255] } else { [60, 90, 70, 0] }
            },
        );
    let mut holed =
        Material { alpha: Alpha::Mask(0.5), double_sided: true, ..matte(1.0, 1.0, 1.0) };
    holed.images.base_color = Some(Shared::new(checks.clone()));
    let mut tiled = matte(1.0, 1.0, 1.0);
    tiled.images.base_color = Some(Shared::new(checks));
    let bumps = Image::from_fn(64, 64, |x, y| {
        let slope = |i: u32| 128.0 + 70.0 * (i as f32 * 0.79).sin();
        [slope(x) as u8, slope(y) as u8, 220, 255]
    });
    let mut bumpy = matte(0.6, 0.3, 0.2);
    bumpy.images.normal = Some(Shared::new(bumps));
    let half = Material { alpha: Alpha::Blend, base_color: [0.2, 0.7, 0.9, 0.4], ..glossy.clone() };
    let turned = Affine3::from_quat(Quat::from_rotation_y(0.6)) * small;
    let cube = || cuboid(Vec3::splat(-0.8), Vec3::splat(0.8));
    let (mut scene, view) = of_meshes(vec![
        (ball(24), mirror, at(0.0, 0.0, 1.0)),
        (ball(24), glossy, at(2.5, 0.0, 1.0)),
        (ball(24), bumpy, at(-2.5, 0.0, 1.0)),
        (cube(), tiled, at(-1.5, 2.4, 0.64) * turned),
        (cube(), holed, at(1.0, 2.4, 0.64) * turned),
        (ball(12), glowing, at(3.2, 2.6, 0.4) * Affine3::from_scale(Vec3::splat(0.4))),
        (cube(), half, at(2.4, 3.3, 0.64) * small),
    ]);
    let options = PictureOptions { size: [256, 160], ..options() };
    let camera = camera(&mut scene, view, options.size);
    check("shapes", &taken(&mut scene, view, &camera, &options).image);
    let options = PictureOptions { background: Background::Transparent, ground: None, ..options };
    check("shapes_transparent", &taken(&mut scene, view, &camera, &options).image);
}

/// Hands out all but what is behind one link.
struct Without<P> {
    inner: P,
    link: (SiteId, u32),
    nothing: Diagnostic,
}

impl<P: Supply> Supply for Without<P> {
    fn root(&self) -> (EnvId, SiteId) {
        self.inner.root()
    }

    fn plan(&self, site: SiteId) -> PlanRef<'_> {
        self.inner.plan(site)
    }

    fn enter(&self, env: EnvId, site: SiteId, link: u32) -> (EnvId, Supplied<'_>) {
        if (site, link) == self.link {
            return (env, Supplied::Failed(&self.nothing));
        }
        self.inner.enter(env, site, link)
    }

    fn is_settled(&self, site: SiteId) -> bool {
        self.inner.is_settled(site)
    }

    fn bound(&self, site: SiteId) -> Option<&Bound> {
        self.inner.bound(site)
    }

    fn eye(&self) -> Option<&Eye> {
        self.inner.eye()
    }
}

impl<P: Provide> Provide for Without<P> {
    fn provide(&mut self, wants: &[Want]) -> Result<(), Interrupted> {
        self.inner.provide(wants)
    }

    fn begin_pass(&mut self) {
        self.inner.begin_pass();
    }

    fn settle(&mut self) {
        self.inner.settle();
    }
}

/// The links that lead to the boughs of the trunk.
fn boughs(scene: &mut Scene, view: ViewId) -> Vec<(SiteId, u32)> {
    let mut found = Vec::new();
    scene
        .traverse(view, Order::Pre, &Everything, &mut |at| {
            if at.enters_plan() && at.plan().kind == Kind::of::<Branch>() {
                let path = at.path();
                let mut upward = path.sites_upward();
                let (_, link) = upward.next().unwrap();
                // The trunk is a branch too, below the tree itself.
                let (above, _) = upward.next().unwrap();
                found.push((above, link));
            }
        })
        .unwrap();
    found.remove(0);
    found
}

#[test]
fn a_bough_that_is_missing_does_not_pass() {
    let (mut scene, view) = aspen();
    let all = boughs(&mut scene, view);
    assert!(all.len() > 20, "{}", all.len());
    let camera = aspen_camera();
    let kept = kept("aspen");
    // Some are hidden behind the leaves of others; these are not.
    for link in all.into_iter().step_by(14) {
        let kind = Kind::of::<Branch>();
        let nothing = Diagnostic { kind, message: "left out".to_owned() };
        let mut without = Without { inner: scene.supply(view).unwrap(), link, nothing };
        let picture = try_taken(&mut without, &camera, &options()).unwrap();
        let difference = Difference::of(&kept, &picture.image);
        assert!(!difference.is_small(), "{link:?} {difference:?}");
    }
}

#[test]
fn a_sun_that_has_moved_by_ten_degrees_does_not_pass() {
    let (mut scene, view) = aspen();
    let camera = aspen_camera();
    for turn in [Quat::from_rotation_y(0.1745), Quat::from_rotation_y(-0.1745)] {
        let mut options = options();
        let sun = options.sun.as_mut().unwrap();
        sun.toward = turn * sun.toward;
        let picture = taken(&mut scene, view, &camera, &options);
        let difference = Difference::of(&kept("aspen"), &picture.image);
        assert!(!difference.is_small(), "{difference:?}");
    }
}

/// A scene that draws what a list holds.
fn of_list(list: &DrawList) -> (Scene, ViewId) {
    let mut scene = Scene::new();
    let root: NodeId = scene.add(Group).into();
    for (world, row) in list.placed_rows() {
        let place = scene.add_to(root, Transform(world)).unwrap();
        let (mesh, material) = (row.mesh.clone(), Some(row.material.clone()));
        match &row.instances {
            None => scene.add_to(place, HeldGeometry { mesh, material }).map(NodeId::from),
            Some(places) => {
                let places = places.clone();
                scene.add_to(place, HeldInstances { mesh, material, places }).map(NodeId::from)
            }
        }
        .unwrap();
    }
    let view = scene.open_view(root, &sapwood::standard_rules()).unwrap();
    (scene, view)
}

#[test]
fn leaves_whose_normals_point_the_other_way_do_not_pass() {
    let (mut scene, view) = aspen();
    let camera = aspen_camera();
    let list = scene.draw_list(view, 1_000_000).unwrap();
    let leaf = list.placed_rows().find_map(|(_, row)| {
        row.instances.as_ref().map(|_| (row.mesh.n_vertices(), row.mesh.n_triangles()))
    });
    let flipped = list.with_meshes(|mesh| {
        let mut mesh: Mesh = mesh.clone();
        if Some((mesh.n_vertices(), mesh.n_triangles())) == leaf {
            mesh.normals.iter_mut().for_each(|normal| *normal = -*normal);
        }
        mesh
    });
    for (list, passes) in [(list, true), (flipped, false)] {
        let (mut scene, view) = of_list(&list);
        let picture = taken(&mut scene, view, &camera, &options());
        let difference = Difference::of(&kept("aspen"), &picture.image);
        assert_eq!(difference.is_small(), passes, "{difference:?}");
    }
}
