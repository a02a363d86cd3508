//! Turning things to whoever looks.

use sapwood_geom::glam::{Affine3, Mat3, Vec3};
use sapwood_geom::{Bound, Content, Digester};

/// From where somebody looks, in a root's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eye {
    /// Where the eye is.
    pub position: Vec3,
    /// Upwards in the picture; need not have unit length.
    pub up: Vec3,
    /// Rows of pixels for each degree of the picture's height, above 0: what fades with the
    /// distance fades later where more can be seen of it.
    pub rows_per_degree: f32,
}

impl Eye {
    /// The rows for each degree of a picture of 1000 rows whose field of view is 60 degrees high.
    pub const REFERENCE_ROWS: f32 = 1000.0 / 60.0;

    /// An eye with the y axis upwards that sees as much as the reference.
    pub fn new(position: Vec3) -> Self {
        Self { position, up: Vec3::Y, rows_per_degree: Self::REFERENCE_ROWS }
    }
}

impl Content for Eye {
    fn write(&self, digester: &mut Digester) {
        digester.add(&self.position).add(&self.up).add(&self.rows_per_degree);
    }
}

/// How something turns its +z axis to the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Facing {
    /// About its origin, upright in the picture.
    Eye,
    /// About a line through its origin along this axis of unit length, as far as that takes
    /// it.
    Axis(Vec3),
}

impl Facing {
    /// The turn, in the frame that `world` leads to the root from, for an eye in the root's
    /// frame. No turn where there is none to choose: the eye at the origin or on the axis, a
    /// flat frame, no eye.
    pub fn turn(&self, world: &Affine3, eye: Option<&Eye>) -> Affine3 {
        let Some(eye) = eye else { return Affine3::IDENTITY };
        if world.matrix3.determinant() == 0.0 {
            return Affine3::IDENTITY;
        }
        let to_local = world.inverse();
        let there = to_local.transform_point3(eye.position);
        let (ahead, upwards) = match *self {
            Self::Eye => (there, to_local.transform_vector3(eye.up)),
            Self::Axis(axis) => (there - axis * there.dot(axis), axis),
        };
        let (Some(z), Some(up)) = (ahead.try_normalize(), upwards.try_normalize()) else {
            return Affine3::IDENTITY;
        };
        match *self {
            // Whoever looks straight along the up direction has it fall out of the picture.
            Self::Eye => {
                let x = up.cross(z).try_normalize().unwrap_or_else(|| z.any_orthonormal_vector());
                Affine3::from_mat3(Mat3::from_cols(x, z.cross(x), z))
            }
            // Only about the axis: what leans away from it keeps leaning.
            Self::Axis(axis) => {
                let rest = Vec3::Z - axis * axis.z;
                let from = rest.try_normalize().unwrap_or_else(|| axis.any_orthonormal_vector());
                let (sine, cosine) = (axis.dot(from.cross(z)), from.dot(z));
                Affine3::from_axis_angle(axis, libm::atan2f(sine, cosine))
            }
        }
    }

    /// A bound of everything inside `bound`, however it is turned.
    pub fn bound_of(&self, bound: &Bound) -> Bound {
        match *self {
            Self::Eye => bound.turned_about_origin(),
            Self::Axis(axis) => bound.turned_about_axis(axis),
        }
    }
}

impl Content for Facing {
    fn write(&self, digester: &mut Digester) {
        match self {
            Self::Eye => digester.add(&0u8),
            Self::Axis(axis) => digester.add(&1u8).add(axis),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn looking(facing: Facing, world: Affine3, from: Vec3) -> (Vec3, Vec3) {
        let eye = Eye::new(from);
        let turned = world * facing.turn(&world, Some(&eye));
        (turned.transform_vector3(Vec3::Z), turned.transform_vector3(Vec3::Y))
    }

    #[test]
    fn what_faces_the_eye_looks_at_it_and_stays_upright() {
        let world = Affine3::from_rotation_x(0.7) * Affine3::from_rotation_z(2.0);
        let world = Affine3::from_translation(Vec3::new(3.0, 1.0, -2.0)) * world;
        let from = Vec3::new(-4.0, 2.0, 5.0);
        let (ahead, up) = looking(Facing::Eye, world, from);
        let direction = (from - world.translation).normalize();
        assert!(ahead.distance(direction) < 1e-5, "{ahead}");
        assert!(up.cross(ahead).dot(Vec3::Y).abs() < 1e-5 && up.y > 0.0, "{up}");
    }

    #[test]
    fn what_turns_about_an_axis_keeps_it() {
        let (ahead, up) =
            looking(Facing::Axis(Vec3::Y), Affine3::IDENTITY, Vec3::new(5.0, 9.0, 0.0));
        assert!(up.distance(Vec3::Y) < 1e-6, "{up}");
        assert!(ahead.distance(Vec3::X) < 1e-6, "{ahead}");
    }

    #[test]
    fn without_a_turn_to_choose_there_is_none() {
        let turn = |facing: Facing, from| facing.turn(&Affine3::IDENTITY, Some(&Eye::new(from)));
        assert_eq!(turn(Facing::Eye, Vec3::ZERO), Affine3::IDENTITY);
        assert_eq!(turn(Facing::Axis(Vec3::Y), Vec3::new(0.0, 8.0, 0.0)), Affine3::IDENTITY);
        assert!(turn(Facing::Eye, Vec3::new(0.0, 8.0, 0.0)).is_finite());
        assert_eq!(Facing::Eye.turn(&Affine3::IDENTITY, None), Affine3::IDENTITY);
    }

    #[test]
    fn turned_points_stay_inside_the_bound() {
        let points =
            [Vec3::new(1.0, 2.0, 3.0), Vec3::new(1.5, -2.0, 0.0), Vec3::new(0.0, 1.0, 4.0)];
        let axis = Vec3::new(1.0, 2.0, -0.5).normalize();
        for facing in [Facing::Eye, Facing::Axis(axis)] {
            let bound = facing.bound_of(&Bound::of_points(points));
            for i in 0..64 {
                let angle = i as f32;
                let from = Vec3::new(libm::cosf(angle), libm::sinf(angle * 0.7), libm::sinf(angle));
                let eye = Eye::new(from * 20.0);
                let turn = facing.turn(&Affine3::IDENTITY, Some(&eye));
                for point in points {
                    let point = turn.transform_point3(point);
                    assert!(bound.aabb.contains(point), "{facing:?} {point} {bound:?}");
                    let distance = point.distance(bound.sphere.center);
                    assert!(distance <= bound.sphere.radius, "{facing:?} {point}");
                }
            }
        }
    }
}
