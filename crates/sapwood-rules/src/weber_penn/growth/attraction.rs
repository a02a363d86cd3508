//! Vertical attraction, and attraction to a direction or a point (Weber and Penn 1995, section
//! 4.8; the targets are this project's).

use std::f32::consts::PI;

use glam::Vec3;
use sapwood_geom::{atan2, sin_cos};

use super::frame::Frame;
use crate::weber_penn::Crown;
use crate::weber_penn::{Dialect, Target};

// Below this sine two directions count as parallel, and there is no axis to turn about.
pub(super) const PARALLEL: f32 = 1e-6;

/// What turns the segments of a stem; all but tropism act in equal parts over its segments.
#[derive(Clone, Copy)]
pub(crate) enum Attraction {
    None,
    /// The paper's: about local x, by the part of the stem's y that looks up.
    Up(f32),
    /// Arbaro's: straight up or down.
    StraightUp(f32),
    /// tree-gen's: ten degrees per unit of the cross product with a vector.
    Tropism(Vec3),
    Direction(Vec3, f32),
    Point(Vec3, f32),
}

/// tree-gen's tropism turns a segment so far, in radians, per unit of the cross product.
pub(crate) const TROPISM: f32 = 10.0 * PI / 180.0;

/// Whether stems of this level are attracted upward, to a direction or to a point: those of levels
/// 0 and 1 are not.
pub(crate) fn is_attracted(level: u8) -> bool {
    level >= 2
}

impl Attraction {
    /// The attraction of a stem of this level with so many segments.
    pub(crate) fn new(crown: &Crown, target: &Target, level: u8, curve_res: u32) -> Self {
        if !is_attracted(level) {
            return match (crown.target, crown.tropism) {
                // tree-gen's trunks and first branches feel what pulls sideways.
                (Target::Up, Some([x, y, _])) if x != 0.0 || y != 0.0 => {
                    Self::Tropism(Vec3::new(x, y, 0.0))
                }
                _ => Self::None,
            };
        }
        let strength = crown.attraction_up / curve_res as f32;
        match (*target, crown.tropism) {
            (Target::Up, Some(tropism)) => Self::Tropism(tropism.into()),
            _ if strength == 0.0 => Self::None,
            (Target::Up, None) => match crown.dialect {
                Dialect::Arbaro => Self::StraightUp(strength),
                Dialect::Paper | Dialect::TreeGen => Self::Up(strength),
            },
            (Target::Direction(direction), _) => {
                Self::Direction(direction.normalize_or_zero(), strength)
            }
            (Target::Point(point), _) => Self::Point(point, strength),
        }
    }

    /// The frame of a segment, after its curvature.
    pub(crate) fn turned(self, frame: Frame) -> Frame {
        match self {
            Self::None => frame,
            Self::Up(strength) => {
                // cos(orientation) is y_z itself. Positive turns about x lead down where y looks
                // up, so the curve upward is a negative one.
                let curve_up = strength * frame.declination() * frame.axes.y_axis.z;
                frame.turned_x(-curve_up)
            }
            Self::StraightUp(strength) => {
                let declination = frame.declination();
                let amount = (declination * sin_cos(declination).0).abs();
                turned_toward(frame, frame.axes.z_axis, Vec3::Z, |_| strength * amount)
            }
            Self::Tropism(tropism) => {
                let across = frame.axes.z_axis.cross(tropism);
                let amount = across.length();
                if amount <= PARALLEL {
                    return frame;
                }
                frame.turned_about(across / amount, TROPISM * amount)
            }
            Self::Direction(direction, strength) => {
                turned_toward(frame, frame.axes.z_axis, direction, |angle| strength * angle)
            }
            Self::Point(point, strength) => {
                let direction = (point - frame.origin).normalize_or_zero();
                turned_toward(frame, frame.axes.z_axis, direction, |angle| strength * angle)
            }
        }
    }
}

/// `frame` turned so that its unit vector `from` moves toward the unit vector `to`, by `amount`
/// of the angle between them; unturned where the two are parallel or `to` is zero.
pub(crate) fn turned_toward(
    frame: Frame,
    from: Vec3,
    to: Vec3,
    amount: impl FnOnce(f32) -> f32,
) -> Frame {
    let across = from.cross(to);
    let sine = across.length();
    if sine <= PARALLEL {
        return frame;
    }
    frame.turned_about(across / sine, amount(atan2(sine, from.dot(to))))
}

#[cfg(test)]
mod tests {
    use std::f32::consts::FRAC_PI_2;

    use super::*;
    use crate::weber_penn::Species;

    fn crown(dialect: Dialect, attraction_up: f32) -> Crown {
        let dialect = Some(dialect);
        Crown::new(&Species { dialect, attraction_up, ..Species::default() })
    }

    // A stem at this declination that leans toward -y, so that its y looks up.
    fn leaning(declination: f32) -> Frame {
        Frame::IDENTITY.turned_x(declination)
    }

    #[test]
    fn trunk_and_first_branches_are_not_attracted() {
        for level in [0, 1] {
            let attraction = Attraction::new(&crown(Dialect::Paper, 1.0), &Target::Up, level, 1);
            assert_eq!(attraction.turned(leaning(1.0)), leaning(1.0));
        }
    }

    #[test]
    fn the_papers_attraction_lifts_by_declination_times_cosine_of_orientation() {
        let attraction = Attraction::new(&crown(Dialect::Paper, 0.6), &Target::Up, 2, 3);
        for declination in [0.3, 1.0, 1.5] {
            let lifted = attraction.turned(leaning(declination)).declination();
            let curve_up = 0.6 * declination * libm::sinf(declination) / 3.0;
            assert!((declination - lifted - curve_up).abs() < 1e-5);
            // A stem whose y looks down is lifted as well.
            let over = leaning(declination).turned_z(std::f32::consts::PI);
            let lifted = attraction.turned(over).declination();
            assert!((declination - lifted - curve_up).abs() < 1e-5);
        }
        // A stem that has rolled onto its side is not.
        let side = leaning(1.0).turned_z(FRAC_PI_2);
        assert!((attraction.turned(side).declination() - 1.0).abs() < 1e-5);
    }

    #[test]
    fn a_horizontal_stem_of_one_segment_is_brought_upright_by_1_and_hangs_by_minus_1() {
        for (strength, z) in [(1.0, 1.0), (-1.0, -1.0)] {
            let attraction = Attraction::new(&crown(Dialect::Paper, strength), &Target::Up, 2, 1);
            let turned = attraction.turned(leaning(FRAC_PI_2));
            assert!((turned.axes.z_axis.z - z).abs() < 1e-5);
        }
    }

    #[test]
    fn arbaros_attraction_pulls_straight_up() {
        let attraction = Attraction::new(&crown(Dialect::Arbaro, -0.6), &Target::Up, 3, 3);
        for roll in [0.0, 1.0, 4.0] {
            let frame = leaning(1.0).turned_z(roll);
            let pulled = attraction.turned(frame);
            let expected = 1.0 + 0.6 * libm::sinf(1.0) / 3.0;
            assert!((pulled.declination() - expected).abs() < 1e-5);
            // It stays in its vertical plane.
            assert!(pulled.axes.z_axis.x.abs() < 1e-6);
        }
    }

    #[test]
    fn a_direction_and_a_point_are_reached_by_strength_1_on_one_segment() {
        let toward = Vec3::new(0.6, 0.8, 0.0);
        let crown = crown(Dialect::Paper, 1.0);
        for target in [Target::Direction(3.0 * toward), Target::Point(5.0 * toward)] {
            let turned = Attraction::new(&crown, &target, 2, 1).turned(leaning(0.4));
            assert!(turned.axes.z_axis.abs_diff_eq(toward, 1e-5));
            let halfway = Attraction::new(&crown, &target, 2, 2).turned(leaning(0.4));
            let before = leaning(0.4).axes.z_axis.angle_between(toward);
            assert!((halfway.axes.z_axis.angle_between(toward) - before / 2.0).abs() < 1e-4);
        }
    }

    #[test]
    fn tropism_turns_ten_degrees_per_unit_of_the_cross_product() {
        let mut crown = crown(Dialect::TreeGen, 0.0);
        crown.tropism = Some([0.0, 0.0, 2.0]);
        let turned = Attraction::new(&crown, &Target::Up, 2, 7).turned(leaning(1.0));
        let expected = 1.0 - 20.0f32.to_radians() * libm::sinf(1.0);
        assert!((turned.declination() - expected).abs() < 1e-5);
    }

    #[test]
    fn nothing_turns_where_there_is_no_axis() {
        let crown = crown(Dialect::Arbaro, 2.0);
        let up = Frame::IDENTITY;
        for target in [Target::Up, Target::Direction(-Vec3::Z), Target::Point(Vec3::ZERO)] {
            assert_eq!(Attraction::new(&crown, &target, 2, 1).turned(up), up);
        }
    }
}
