//! Scenes for pictures, and how they are taken.

use std::ops::ControlFlow;

use sapwood::geom::glam::{Affine3, Vec2, Vec3};
use sapwood::geom::{Mesh, SharedMesh};
use sapwood::graph::{Lens, Material, Provide};
use sapwood::picture::{Picture, PictureError, PictureOptions, PlacedCamera, Studio};
use sapwood::scene::{Group, HeldGeometry, NodeId, Scene, Transform, ViewId};

/// A box between two corners, each side with normals of its own.
pub(super) fn cuboid(min: Vec3, max: Vec3) -> Mesh {
    let mut mesh = Mesh::default();
    for axis in 0..3 {
        for (side, sign) in [(min, -1.0), (max, 1.0)] {
            let mut normal = Vec3::ZERO;
            normal[axis] = sign;
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let first = mesh.positions.len() as u32;
            for (a, b) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
                let mut corner = Vec3::ZERO;
                corner[axis] = side[axis];
                corner[u] = min[u] + a * (max[u] - min[u]);
                corner[v] = min[v] + b * (max[v] - min[v]);
                mesh.positions.push(corner);
                mesh.normals.push(normal);
                mesh.uvs.push(Vec2::new(a, b));
            }
            let order = if sign > 0.0 { [0, 1, 2, 0, 2, 3] } else { [0, 2, 1, 0, 3, 2] };
            mesh.indices.extend(order.map(|i| first + i));
        }
    }
    mesh
}

/// The unit sphere, of `2 n` by `n` cells.
pub(super) fn ball(n: u32) -> Mesh {
    let mut mesh = Mesh::default();
    for i in 0..=n {
        for j in 0..=2 * n {
            let (u, v) = (j as f32 / (2 * n) as f32, i as f32 / n as f32);
            let (around, down) = (u * std::f32::consts::TAU, v * std::f32::consts::PI);
            let flat = Vec3::new(around.cos(), 0.0, -around.sin()) * down.sin();
            let point = (flat + Vec3::Y * down.cos()).normalize();
            mesh.positions.push(point);
            mesh.normals.push(point);
            mesh.uvs.push(Vec2::new(u, v));
        }
    }
    let row = 2 * n + 1;
    for i in 0..n {
        for j in 0..2 * n {
            let a = i * row + j;
            let (b, c, d) = (a + row, a + row + 1, a + 1);
            if i + 1 < n {
                mesh.indices.extend([a, b, c]);
            }
            if i > 0 {
                mesh.indices.extend([a, c, d]);
            }
        }
    }
    mesh
}

/// A scene of meshes at their places.
pub(super) fn of_meshes(things: Vec<(Mesh, Material, Affine3)>) -> (Scene, ViewId) {
    let mut scene = Scene::new();
    let root: NodeId = scene.add(Group).into();
    for (mesh, material, place) in things {
        let place = scene.add_to(root, Transform(place)).unwrap();
        let material = Some(material.into());
        scene.add_to(place, HeldGeometry { mesh: SharedMesh::new(mesh), material }).unwrap();
    }
    let view = scene.open_view(root, &sapwood::standard_rules()).unwrap();
    (scene, view)
}

/// A lens of half a radian.
pub(super) const LENS: Lens = Lens::Perspective { vertical_angle: 0.5 };

/// A camera that sees all of a view.
pub(super) fn camera(scene: &mut Scene, view: ViewId, size: [u32; 2]) -> PlacedCamera {
    let bounds = scene.bounds(view).unwrap().aabb;
    let from = PlacedCamera::THREE_QUARTER;
    PlacedCamera::fit(&bounds, from, LENS, size, PlacedCamera::MARGIN).unwrap()
}

/// A picture of a view.
pub(super) fn taken(
    scene: &mut Scene,
    view: ViewId,
    camera: &PlacedCamera,
    options: &PictureOptions,
) -> Picture {
    try_taken(&mut scene.supply(view).unwrap(), camera, options).unwrap()
}

pub(super) fn try_taken(
    provide: &mut dyn Provide,
    camera: &PlacedCamera,
    options: &PictureOptions,
) -> Result<Picture, PictureError> {
    Studio::new(provide).picture(camera, options, &mut |_| ControlFlow::Continue(()))
}
