//! How far things reach as seen from a direction, and the camera that has just that in view.

use sapwood_geom::Aabb;
use sapwood_geom::glam::{Affine3, Mat3, Vec2, Vec3};
use sapwood_graph::{DrawList, Lens};

use crate::{PictureError, PlacedCamera};

/// Pixels of a cell that nothing is on, along each edge, so that cells do not show in each other.
const MARGIN: u32 = 2;

/// How wide cells are at most, and at least, for their height.
const WIDEST: f32 = 4.0;
const NARROWEST: f32 = 0.125;

/// Points that everything lies between.
pub(super) struct Points {
    points: Vec<Vec3>,
    aabb: Aabb,
}

/// What a picture from one direction shows.
pub(super) struct Frame {
    pub(super) camera: PlacedCamera,
    /// The middle of the picture, on the plane of the board.
    center: Vec3,
    /// Metres to the right and upwards, half of the picture each.
    right: Vec3,
    up: Vec3,
}

impl Frame {
    /// A point of the board, from 0 to 1 to the right and upwards.
    pub(super) fn corner(&self, x: f32, y: f32) -> Vec3 {
        self.center + self.right * (2.0 * x - 1.0) + self.up * (2.0 * y - 1.0)
    }
}

impl Points {
    /// Those of everything that a list draws.
    pub(super) fn of(list: &DrawList) -> Self {
        let list = list.as_drawn();
        let mut points = Vec::new();
        for (world, row) in list.placed_rows() {
            // Of what is repeated, boxes will do where they are simpler.
            let boxed = row.mesh.bound().aabb.corners();
            let mesh = row.mesh.positions.as_slice();
            match &row.instances {
                None => points.extend(mesh.iter().map(|point| world.transform_point3(*point))),
                Some(places) => {
                    let each = if mesh.len() > boxed.len() { &boxed } else { mesh };
                    for place in places.iter().map(|place| world * *place) {
                        points.extend(each.iter().map(|point| place.transform_point3(*point)));
                    }
                }
            }
        }
        for (world, row) in list.placed_lines() {
            for line in row.lines.iter() {
                let ball = |at: usize| {
                    let radius = line.radii.get(at).copied().unwrap_or(0.0);
                    let along = move |axis: Vec3| [axis * radius, axis * -radius];
                    [Vec3::X, Vec3::Y, Vec3::Z].into_iter().flat_map(along)
                };
                let balls = line.points.iter().enumerate();
                let balls = balls.flat_map(|(at, point)| ball(at).map(move |by| *point + by));
                points.extend(balls.map(|point| world.transform_point3(point)));
            }
        }
        points.retain(|point| point.is_finite());
        let aabb = Aabb::of_points(points.iter().copied());
        Self { points, aabb }
    }

    pub(super) fn center(&self) -> Vec3 {
        self.aabb.center()
    }

    /// Pixels of a cell that has room for the highest and the widest side.
    pub(super) fn cell(&self, toward: &[Vec3], rows: u32) -> Result<[u32; 2], PictureError> {
        let mut reach = Vec2::ZERO;
        for toward in toward {
            let (min, max) = self.seen(self.axes(*toward)?);
            reach = reach.max(max - min);
        }
        if reach.max_element() <= 0.0 {
            return Err(PictureError::Empty);
        }
        let aspect = (reach.x / reach.y.max(f32::MIN_POSITIVE)).clamp(NARROWEST, WIDEST);
        let columns = libm::ceilf(aspect * (rows - 2 * MARGIN) as f32) as u32 + 2 * MARGIN;
        Ok([columns.next_multiple_of(4), rows])
    }

    /// The frame that everything just fits into, seen from a direction.
    pub(super) fn frame(&self, toward: Vec3, size: [u32; 2]) -> Result<Frame, PictureError> {
        let axes = self.axes(toward)?;
        let (min, max) = self.seen(axes);
        let [width, height] = size.map(|pixels| pixels as f32);
        let room = Vec2::new(width, height) - 2.0 * MARGIN as f32;
        let pixel = ((max - min) / room).max_element().max(f32::MIN_POSITIVE);
        let middle = 0.5 * (min + max);
        // In depth, the board stands in the middle of everything.
        let depth = axes.z_axis.dot(self.center());
        let center = axes * middle.extend(depth);
        let lens = Lens::Orthographic { height: pixel * height };
        let away = self.aabb.size().length().max(pixel * height);
        let camera = PlacedCamera::look_at(lens, center + axes.z_axis * away, center)?;
        let camera = PlacedCamera {
            world: Affine3::from_mat3_translation(axes, camera.world.translation),
            ..camera
        };
        let right = axes.x_axis * (0.5 * pixel * width);
        let up = axes.y_axis * (0.5 * pixel * height);
        Ok(Frame { camera, center, right, up })
    }

    /// The axes of a camera in this direction.
    fn axes(&self, toward: Vec3) -> Result<Mat3, PictureError> {
        if self.aabb.is_empty() {
            return Err(PictureError::Empty);
        }
        let lens = Lens::Orthographic { height: 1.0 };
        Ok(PlacedCamera::look_at(lens, toward, Vec3::ZERO)?.world.matrix3)
    }

    /// From where to where everything reaches along the first two of these axes.
    fn seen(&self, axes: Mat3) -> (Vec2, Vec2) {
        let mut reach = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        for point in &self.points {
            let seen = Vec2::new(axes.x_axis.dot(*point), axes.y_axis.dot(*point));
            reach = (reach.0.min(seen), reach.1.max(seen));
        }
        reach
    }
}
