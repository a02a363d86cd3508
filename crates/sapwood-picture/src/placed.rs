//! Cameras at their places, and where to place one so that everything is seen.

use sapwood_geom::Aabb;
use sapwood_geom::glam::{Affine3, Mat3, Vec3};
use sapwood_graph::{Camera, Eye, Lens};

use crate::camera::Gaze;
use crate::{PictureError, PictureOptions};

/// How many metres from the origin cameras, and what they are to see, may be.
const FARTHEST: f32 = 1e15;

/// A camera at its place.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedCamera {
    /// The camera, looking down the -z axis of its frame with +y up.
    pub camera: Camera,
    /// From its frame to the scene's; only where it stands and how it is turned count.
    pub world: Affine3,
}

impl PlacedCamera {
    /// The direction to the eye of a three-quarter view: from the right in front, somewhat above.
    pub const THREE_QUARTER: Vec3 = Vec3::new(0.6, 0.16, 1.0);

    /// The share of a picture that [`fit`](Self::fit) is asked to leave free on each side where
    /// nobody says otherwise.
    pub const MARGIN: f32 = 0.08;

    /// A camera at `eye` that has `target` in the middle and +y up in the picture, as far as it
    /// can.
    ///
    /// # Errors
    /// When the eye is where the target is, or one of them is nowhere or farther than 10^15 m.
    pub fn look_at(lens: Lens, eye: Vec3, target: Vec3) -> Result<Self, PictureError> {
        let reach = eye.abs().max(target.abs()).max_element();
        let Some(back) = (eye - target).try_normalize().filter(|_| reach <= FARTHEST) else {
            return Err(PictureError::Camera(format!("its eye {eye} has no way to {target}")));
        };
        let far = match lens {
            Lens::Perspective { .. } => None,
            // Everything behind the eye's plane is out of sight, nothing before it.
            Lens::Orthographic { .. } => Some(f32::MAX),
        };
        let near = (1e-4 * eye.distance(target)).max(f32::MIN_POSITIVE);
        let camera = Camera { name: String::new(), lens, near, far };
        let world = Affine3::from_mat3_translation(axes(back), eye);
        let placed = Self { camera, world };
        placed.fault().map_or(Ok(placed), |fault| Err(PictureError::Camera(fault)))
    }

    /// A camera that looks from the direction `from` and stands so that a box just fits into a
    /// picture of this size, with a share of `margin` left free at least on each side and exactly
    /// on two.
    ///
    /// An orthographic lens is made as high as it must be.
    ///
    /// # Errors
    /// When the box is empty or not finite, or any of the other values is of no use.
    pub fn fit(
        aabb: &Aabb,
        from: Vec3,
        lens: Lens,
        size: [u32; 2],
        margin: f32,
    ) -> Result<Self, PictureError> {
        if aabb.is_empty() {
            return Err(PictureError::Empty);
        }
        PictureOptions { size, ..PictureOptions::default() }.check()?;
        let fault = |fault: String| Err(PictureError::Camera(fault));
        let reach = aabb.min.abs().max(aabb.max.abs()).max_element();
        let is_near = reach <= FARTHEST && aabb.min.is_finite() && aabb.max.is_finite();
        if !is_near {
            return fault(format!("what it is to see reaches from {} to {}", aabb.min, aabb.max));
        }
        let Some(back) = from.try_normalize() else {
            return fault(format!("{from} is no direction to look from"));
        };
        if !(0.0..0.5).contains(&margin) {
            return fault(format!("a margin of {margin} (accepted: 0 to less than 0.5)"));
        }
        let aspect = aspect(size);
        let axes = axes(back);
        let center = aabb.center();
        let half = (aabb.max - aabb.min) * 0.5;
        // Something without extent is looked at as if it were small.
        let half = if half.max_element() > 0.0 { half } else { Vec3::splat(0.5) };
        let around_center = Aabb { min: -half, max: half };
        let corners = around_center.corners().map(|corner| axes.transpose() * corner);
        let inner = 1.0 - 2.0 * margin;
        let (lens, offset) = match lens {
            Lens::Perspective { vertical_angle } => {
                let tan = inner * libm::tanf(0.5 * vertical_angle);
                (lens, perspective_offset(&corners, [tan * aspect, tan]))
            }
            Lens::Orthographic { .. } => {
                let reach =
                    corners.iter().fold(Vec3::ZERO, |reach, corner| reach.max(corner.abs()));
                let height = 2.0 * (reach.x / aspect).max(reach.y) / inner;
                (Lens::Orthographic { height }, Vec3::new(0.0, 0.0, 2.0 * reach.z.max(height)))
            }
        };
        let eye = center + axes * offset;
        let distance = offset.z.max(f32::MIN_POSITIVE);
        let far = matches!(lens, Lens::Orthographic { .. }).then_some(1e3 * distance);
        let camera = Camera { name: String::new(), lens, near: 1e-4 * distance, far };
        let placed = Self { camera, world: Affine3::from_mat3_translation(axes, eye) };
        placed.fault().map_or(Ok(placed), fault)
    }

    /// From where the camera looks, for what turns to the eye: the value of the view's slot
    /// `Viewer`. What fades with the distance does so as in a picture of
    /// [reference](Eye::REFERENCE_ROWS) fineness, whatever the lens: as it is told by ranges alone.
    pub fn eye(&self) -> Eye {
        let up = self.world.matrix3.y_axis;
        Eye { position: self.world.translation, up, rows_per_degree: Eye::REFERENCE_ROWS }
    }

    /// The same for a picture of this size: what fades does so the later, the more rows of pixels a
    /// degree of the picture has, so that a telescope brings it near. Parallel rays have no
    /// degrees and count as the reference.
    pub fn eye_in(&self, size: [u32; 2]) -> Eye {
        let rows_per_degree = match self.camera.lens {
            Lens::Perspective { vertical_angle } => size[1] as f32 / vertical_angle.to_degrees(),
            Lens::Orthographic { .. } => Eye::REFERENCE_ROWS,
        };
        Eye { rows_per_degree, ..self.eye() }
    }

    /// What is wrong with the camera, in words, or nothing.
    pub fn fault(&self) -> Option<String> {
        if let Some(fault) = self.camera.fault() {
            return Some(fault);
        }
        let axes = self.world.matrix3;
        let is_sound = self.world.is_finite() && axes.determinant().abs() > 0.0;
        (!is_sound).then(|| format!("it is placed by {:?}", self.world))
    }

    /// Where a point of the scene lies in a picture of this size, in pixels from the upper left
    /// corner; nothing for points behind the camera.
    pub fn pixel_of(&self, point: Vec3, size: [u32; 2]) -> Option<[f32; 2]> {
        let seen = self.upright().inverse().transform_point3(point);
        if seen.z >= 0.0 {
            return None;
        }
        let [width, height] = size.map(|pixels| pixels as f32);
        let reach = match self.camera.lens {
            Lens::Perspective { vertical_angle } => -seen.z * libm::tanf(0.5 * vertical_angle),
            Lens::Orthographic { height } => 0.5 * height,
        };
        let (x, y) = (seen.x / (reach * aspect(size)), seen.y / reach);
        Some([0.5 * width * (1.0 + x), 0.5 * height * (1.0 - y)])
    }

    /// The ray through a point of a picture of this size, in pixels from the upper left corner: its
    /// origin, and its direction with unit length. For picking what a pixel shows.
    pub fn ray(&self, pixel: [f32; 2], size: [u32; 2]) -> (Vec3, Vec3) {
        let (ray, _) = Gaze::new(self, size).ray(pixel[0], pixel[1]);
        (ray.origin, ray.direction)
    }

    /// The place, with axes of unit length.
    pub(crate) fn upright(&self) -> Affine3 {
        let Mat3 { y_axis, z_axis, .. } = self.world.matrix3;
        let z = z_axis.normalize_or(Vec3::Z);
        let x = y_axis.cross(z).normalize_or(z.any_orthonormal_vector());
        let axes = Mat3::from_cols(x, z.cross(x), z);
        Affine3::from_mat3_translation(axes, self.world.translation)
    }
}

/// Width over height.
pub(crate) fn aspect([width, height]: [u32; 2]) -> f32 {
    width as f32 / height as f32
}

/// The axes of a camera that has `back`, of unit length, behind it, and +y up.
fn axes(back: Vec3) -> Mat3 {
    // Straight from above or below, -z is up.
    let up = if back.y.abs() < 0.9999 { Vec3::Y } else { Vec3::NEG_Z };
    let x = up.cross(back).normalize();
    Mat3::from_cols(x, back.cross(x), back)
}

/// Where the eye has to be, on camera axes, so that all corners are seen under slopes of no more
/// than `slopes` to the sides and up and down, as near as can be.
fn perspective_offset(corners: &[Vec3], slopes: [f32; 2]) -> Vec3 {
    let most = |f: &dyn Fn(Vec3) -> f32| corners.iter().map(|c| f(*c)).fold(f32::MIN, f32::max);
    // Each corner allows the eye a wedge; the tip of all wedges of an axis together.
    let tip = |axis: usize| {
        let slope = slopes[axis];
        let (right, left) = (most(&|c| c[axis] + slope * c.z), most(&|c| slope * c.z - c[axis]));
        ((right - left) * 0.5, (right + left) * 0.5 / slope)
    };
    let tips = [tip(0), tip(1)];
    let z = tips[0].1.max(tips[1].1);
    // Where there is room, both sides are seen under the same slope.
    let middle = |axis: usize| {
        let slope = |x: f32, side: f32| most(&|c| side * (c[axis] - x) / (z - c.z));
        let (mut low, mut high) = (tips[axis].0 - z, tips[axis].0 + z);
        for _ in 0..64 {
            let x = 0.5 * (low + high);
            if slope(x, 1.0) > slope(x, -1.0) { low = x } else { high = x }
        }
        0.5 * (low + high)
    };
    let (x, y) =
        if tips[0].1 >= tips[1].1 { (tips[0].0, middle(1)) } else { (middle(0), tips[1].0) };
    Vec3::new(x, y, z)
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERSPECTIVE: Lens = Lens::Perspective { vertical_angle: 0.6 };
    const FLAT: Lens = Lens::Orthographic { height: 1.0 };

    /// The picture's part that a box covers, as shares from the left, right, top and bottom.
    fn margins(camera: &PlacedCamera, aabb: &Aabb, size: [u32; 2]) -> [f32; 4] {
        let mut margins = [f32::INFINITY; 4];
        for corner in aabb.corners() {
            let [x, y] = camera.pixel_of(corner, size).unwrap();
            let [w, h] = size.map(|pixels| pixels as f32);
            for (margin, share) in margins.iter_mut().zip([x / w, 1.0 - x / w, y / h, 1.0 - y / h])
            {
                *margin = margin.min(share);
            }
        }
        margins
    }

    #[test]
    fn a_box_touches_the_margin_within_a_pixel() {
        let boxes = [
            Aabb { min: Vec3::new(-3.0, -0.2, -2.5), max: Vec3::new(3.5, 14.0, 2.0) },
            Aabb { min: Vec3::new(100.0, 0.0, -40.0), max: Vec3::new(160.0, 1.0, 20.0) },
            Aabb { min: Vec3::ZERO, max: Vec3::new(0.0, 2.0, 0.0) },
        ];
        let sizes = [
            [1024, 1024],
            [1920, 1080],
            [1080, 1920],
            [640, 480],
            [300, 900],
            [2000, 500],
            [500, 2000],
            [257, 251],
            [1600, 200],
            [123, 777],
        ];
        let from = PlacedCamera::THREE_QUARTER;
        for aabb in boxes {
            for (size, lens) in sizes.iter().flat_map(|s| [(*s, PERSPECTIVE), (*s, FLAT)]) {
                let camera = PlacedCamera::fit(&aabb, from, lens, size, 0.08).unwrap();
                let margins = margins(&camera, &aabb, size);
                let [w, h] = size.map(|pixels| 1.0 / pixels as f32);
                let is_touched = |i: usize, pixel: f32| (margins[i] - 0.08).abs() <= pixel;
                let wide = is_touched(0, w) && is_touched(1, w);
                let high = is_touched(2, h) && is_touched(3, h);
                assert!(wide || high, "{size:?} {aabb:?}: {margins:?}");
                let least = margins.into_iter().fold(1.0, f32::min);
                assert!(least > 0.08 - w.max(h), "{size:?} {aabb:?}: {margins:?}");
                assert!((margins[0] - margins[1]).abs() <= w, "{margins:?}");
                assert!((margins[2] - margins[3]).abs() <= h, "{margins:?}");
            }
        }
    }

    #[test]
    fn what_cannot_be_looked_at_is_told() {
        let size = [10, 10];
        let fit = |aabb: Aabb, from, margin| {
            let camera = PlacedCamera::fit(&aabb, from, PERSPECTIVE, size, margin);
            camera.unwrap_err().to_string()
        };
        let cube = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
        let nowhere = Aabb { min: Vec3::ZERO, max: Vec3::INFINITY };
        assert!(fit(Aabb::EMPTY, Vec3::X, 0.1).contains("nothing to see"));
        assert!(fit(nowhere, Vec3::X, 0.1).contains("reaches from"));
        assert!(fit(cube, Vec3::ZERO, 0.1).contains("no direction"));
        assert!(fit(cube, Vec3::X, 0.5).contains("margin of 0.5"));
        let huge = Aabb { min: Vec3::splat(-3e38), max: Vec3::splat(3e38) };
        assert!(fit(huge, Vec3::X, 0.1).contains("reaches from"));
        let none = PlacedCamera::fit(&cube, Vec3::X, PERSPECTIVE, [0, 9], 0.1);
        assert!(none.unwrap_err().to_string().contains("0x9"));
        let look = |eye, target| PlacedCamera::look_at(PERSPECTIVE, eye, target);
        assert!(look(Vec3::ONE, Vec3::ONE).is_err());
        assert!(look(Vec3::NAN, Vec3::ONE).is_err());
        assert!(look(Vec3::ONE, Vec3::INFINITY).is_err());
        assert_eq!(look(Vec3::Y, Vec3::ZERO).unwrap().eye().up, Vec3::NEG_Z);
    }

    #[test]
    fn a_telescope_sees_more_rows_in_a_degree() {
        let rows = |degrees: f32, height| {
            let lens = Lens::Perspective { vertical_angle: degrees.to_radians() };
            let camera = PlacedCamera::look_at(lens, Vec3::Z, Vec3::ZERO).unwrap();
            assert_eq!(camera.eye().rows_per_degree, Eye::REFERENCE_ROWS);
            camera.eye_in([10, height]).rows_per_degree
        };
        assert!((rows(60.0, 1000) - Eye::REFERENCE_ROWS).abs() < 1e-4);
        assert!((rows(6.0, 500) - 5.0 * Eye::REFERENCE_ROWS).abs() < 1e-3);
        let flat = PlacedCamera::look_at(FLAT, Vec3::Z, Vec3::ZERO).unwrap();
        assert_eq!(flat.eye_in([10, 10]), flat.eye());
    }
}
