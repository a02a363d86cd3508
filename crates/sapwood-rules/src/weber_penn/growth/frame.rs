//! A place and an orientation: what a stem, a segment or a leaf starts from.

use glam::{Affine3, Mat3, Vec3};
use sapwood_geom::{content, sin_cos};

/// A right-handed orthonormal frame in tree space, in metres; local z runs along the stem.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Where it stands.
    pub origin: Vec3,
    /// Its axes, as columns.
    pub axes: Mat3,
}

content!(Frame { origin, axes });

impl Frame {
    /// The frame of tree space itself.
    pub const IDENTITY: Self = Self { origin: Vec3::ZERO, axes: Mat3::IDENTITY };

    /// The point at these local coordinates.
    pub fn point(&self, local: Vec3) -> Vec3 {
        self.origin + self.axes * local
    }

    /// The same axes elsewhere.
    pub fn at(self, origin: Vec3) -> Self {
        Self { origin, ..self }
    }

    /// Turned about its own x axis by `angle`: z moves toward -y.
    pub fn turned_x(self, angle: f32) -> Self {
        let (sin, cos) = sin_cos(angle);
        let Mat3 { x_axis, y_axis, z_axis } = self.axes;
        let axes =
            Mat3::from_cols(x_axis, cos * y_axis + sin * z_axis, cos * z_axis - sin * y_axis);
        Self { axes, ..self }
    }

    /// Turned about its own y axis by `angle`: z moves toward x.
    pub fn turned_y(self, angle: f32) -> Self {
        let (sin, cos) = sin_cos(angle);
        let Mat3 { x_axis, y_axis, z_axis } = self.axes;
        let axes =
            Mat3::from_cols(cos * x_axis - sin * z_axis, y_axis, cos * z_axis + sin * x_axis);
        Self { axes, ..self }
    }

    /// Turned about its own z axis by `angle`: x moves toward y.
    pub fn turned_z(self, angle: f32) -> Self {
        let (sin, cos) = sin_cos(angle);
        let Mat3 { x_axis, y_axis, z_axis } = self.axes;
        let axes =
            Mat3::from_cols(cos * x_axis + sin * y_axis, cos * y_axis - sin * x_axis, z_axis);
        Self { axes, ..self }
    }

    /// Its z axis tilted by `angle` toward the local direction at `bearing` from x to y.
    pub fn tilted(self, angle: f32, bearing: f32) -> Self {
        let (sin_b, cos_b) = sin_cos(bearing);
        let (sin, cos) = sin_cos(angle);
        let Mat3 { x_axis, y_axis, z_axis } = self.axes;
        // The part of x and y along the bearing turns with z, the part across it stays.
        let toward = cos_b * x_axis + sin_b * y_axis;
        let turned = cos * toward - sin * z_axis;
        let change = turned - toward;
        let axes = Mat3::from_cols(
            x_axis + cos_b * change,
            y_axis + sin_b * change,
            cos * z_axis + sin * toward,
        );
        Self { axes, ..self }
    }

    /// Turned by `angle` about an axis of unit length in tree space, through its own origin.
    pub fn turned_about(self, axis: Vec3, angle: f32) -> Self {
        let (sin, cos) = sin_cos(angle);
        let turn = |v: Vec3| cos * v + sin * axis.cross(v) + (1.0 - cos) * axis.dot(v) * axis;
        let Mat3 { x_axis, y_axis, z_axis } = self.axes;
        Self { axes: Mat3::from_cols(turn(x_axis), turn(y_axis), turn(z_axis)), ..self }
    }

    /// Turned by `angle` about an axis parallel to the tree's z, through its own origin.
    pub fn turned_about_tree_z(self, angle: f32) -> Self {
        let (sin, cos) = sin_cos(angle);
        let turn = |v: Vec3| Vec3::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y, v.z);
        let Mat3 { x_axis, y_axis, z_axis } = self.axes;
        Self { axes: Mat3::from_cols(turn(x_axis), turn(y_axis), turn(z_axis)), ..self }
    }

    /// The angle between its z axis and the tree's, 0 to pi.
    pub fn declination(&self) -> f32 {
        libm::acosf(self.axes.z_axis.z.clamp(-1.0, 1.0))
    }

    /// The frame as a transform from local to tree space.
    pub fn affine(&self) -> Affine3 {
        Affine3::from_mat3_translation(self.axes, self.origin)
    }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

    use super::*;

    fn check(frame: Frame, z: Vec3) {
        assert!(frame.axes.z_axis.abs_diff_eq(z, 1e-6), "{frame:?}");
        assert!((frame.axes.transpose() * frame.axes).abs_diff_eq(Mat3::IDENTITY, 1e-6));
        assert!((frame.axes.determinant() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn turns_are_right_handed() {
        let up = Frame::IDENTITY;
        check(up.turned_x(FRAC_PI_2), -Vec3::Y);
        check(up.turned_y(FRAC_PI_2), Vec3::X);
        check(up.turned_z(0.7), Vec3::Z);
        check(up.turned_about(Vec3::X, FRAC_PI_2), -Vec3::Y);
        check(up.turned_y(FRAC_PI_2).turned_about_tree_z(FRAC_PI_2), Vec3::Y);
        assert!(up.turned_z(FRAC_PI_2).axes.x_axis.abs_diff_eq(Vec3::Y, 1e-6));
    }

    #[test]
    fn a_tilt_leans_toward_its_bearing() {
        let half = std::f32::consts::FRAC_1_SQRT_2;
        check(Frame::IDENTITY.tilted(FRAC_PI_2, 0.0), Vec3::X);
        check(Frame::IDENTITY.tilted(FRAC_PI_4, FRAC_PI_2), Vec3::new(0.0, half, half));
        // A tilt toward -y is a turn about x.
        let turned = Frame::IDENTITY.turned_z(0.3).turned_x(0.4);
        let tilted = Frame::IDENTITY.turned_z(0.3).tilted(0.4, -FRAC_PI_2);
        assert!(turned.axes.abs_diff_eq(tilted.axes, 1e-6));
    }

    #[test]
    fn a_child_turned_down_keeps_its_y_to_the_sky() {
        let child = Frame::IDENTITY.turned_z(1.0).turned_x(FRAC_PI_2);
        assert!((child.axes.y_axis.z - 1.0).abs() < 1e-6);
        assert!(child.axes.x_axis.z.abs() < 1e-6);
    }
}
