//! The rays of a camera, and how wide a pixel is along them.

use sapwood_geom::Ray32;
use sapwood_geom::glam::{Affine3, Vec3};
use sapwood_graph::Lens;

use crate::PlacedCamera;
use crate::placed::aspect;

/// A camera made ready for many rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Gaze {
    world: Affine3,
    lens: Lens,
    /// Half the picture's width and height, as slopes or in metres.
    reach: [f32; 2],
    size: [f32; 2],
    near: f32,
    far: f32,
    pub(crate) width: PixelWidth,
}

/// How wide a pixel is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PixelWidth {
    /// In metres, at the eye.
    pub(crate) base: f32,
    /// How much wider with each metre away.
    pub(crate) slope: f32,
}

impl PixelWidth {
    /// In metres, so far along a ray.
    pub(crate) fn at(self, distance: f32) -> f32 {
        self.base + self.slope * distance
    }
}

impl Gaze {
    pub(crate) fn new(camera: &PlacedCamera, size: [u32; 2]) -> Self {
        let lens = camera.camera.lens;
        let up = match lens {
            Lens::Perspective { vertical_angle } => libm::tanf(0.5 * vertical_angle),
            Lens::Orthographic { height } => 0.5 * height,
        };
        let pixel = 2.0 * up / size[1] as f32;
        let width = match lens {
            Lens::Perspective { .. } => PixelWidth { base: 0.0, slope: pixel },
            Lens::Orthographic { .. } => PixelWidth { base: pixel, slope: 0.0 },
        };
        Self {
            world: camera.upright(),
            lens,
            reach: [up * aspect(size), up],
            size: size.map(|pixels| pixels as f32),
            near: camera.camera.near,
            far: camera.camera.far.unwrap_or(f32::INFINITY),
            width,
        }
    }

    /// Where the eye is.
    pub(crate) fn eye(&self) -> Vec3 {
        self.world.translation
    }

    /// The ray through a point of the picture, in pixels from the upper left corner, with a
    /// direction of unit length, and how far it goes.
    pub(crate) fn ray(&self, x: f32, y: f32) -> (Ray32, f32) {
        let across = (2.0 * x / self.size[0] - 1.0) * self.reach[0];
        let upward = (1.0 - 2.0 * y / self.size[1]) * self.reach[1];
        let (start, along) = match self.lens {
            Lens::Perspective { .. } => (Vec3::ZERO, Vec3::new(across, upward, -1.0)),
            Lens::Orthographic { .. } => (Vec3::new(across, upward, 0.0), Vec3::NEG_Z),
        };
        // Near and far are depths, and a metre along the ray may be less of those.
        let length = along.length();
        let origin = self.world.transform_point3(start + along * self.near);
        let direction = self.world.matrix3 * along / length;
        (Ray32::new(origin, direction), (self.far - self.near) * length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ray_through_where_a_point_is_seen_leads_to_it() {
        let point = Vec3::new(0.3, 1.2, -0.4);
        let size = [640, 200];
        for lens in [Lens::Perspective { vertical_angle: 0.7 }, Lens::Orthographic { height: 5.0 }]
        {
            let eye = Vec3::new(4.0, 3.0, 7.0);
            let camera = PlacedCamera::look_at(lens, eye, Vec3::ZERO).unwrap();
            let [x, y] = camera.pixel_of(point, size).unwrap();
            let gaze = Gaze::new(&camera, size);
            let (ray, _) = gaze.ray(x, y);
            let along = (point - ray.origin).dot(ray.direction);
            assert!(ray.at(along).distance(point) < 1e-4, "{lens:?}");
            let (next, _) = gaze.ray(x + 1.0, y);
            let width = next.at(along).distance(ray.at(along));
            assert!((width / gaze.width.at(along) - 1.0).abs() < 0.05, "{lens:?}");
        }
    }
}
