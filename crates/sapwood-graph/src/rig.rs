//! Rigs: joints that sway in the wind, and what follows them.
//!
//! Geometry is made once, at rest. A rig tells about what, and how far, its parts turn; vertices
//! and instances each follow one joint. What moves is a number for each joint, which whoever
//! draws works out anew for every picture ([`Poses`](crate::Poses)): nothing is compiled. Where a
//! rig's joints come from is not known here.

use sapwood_geom::glam::{Affine3, Mat3, Vec3};
use sapwood_geom::{Aabb, Bound, content, sin_cos};

use crate::Wind;

/// Joints, each after the one that it hangs on.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rig {
    /// How joints sway; those of one stem share a row.
    pub swings: Vec<Swing>,
    /// The joints.
    pub joints: Vec<Joint>,
    /// The wind without gusts, in metres per second, beyond which nothing sways further: bounds
    /// make room for so much.
    pub strongest: f32,
}

content!(Rig { swings, joints, strongest });

/// When something is where: two sines for each of two axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swing {
    /// How fast the slow and the fast sine's angles grow, in radians per second.
    pub rates: [f32; 2],
    /// The slow sine's angle at time 0, about x and about y; the fast one's is 0.7 of it.
    pub offsets: [f32; 2],
}

content!(Swing { rates, offsets });

/// Where something turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint {
    /// The number of the joint that it hangs on, which stands before it; nothing where it hangs on
    /// what does not move.
    pub parent: Option<u32>,
    /// What it turns about, at rest, in the frame of the rig.
    pub origin: Vec3,
    /// The first axis that it turns about, at rest, of unit length.
    pub x: Vec3,
    /// The second axis, square to the first, which turns about that.
    pub y: Vec3,
    /// The row of its [`Swing`].
    pub swing: u32,
    /// By how many radians it would turn about each axis where the wind's shares are 1; 0 where it
    /// is rigid.
    pub amplitude: f32,
    /// What sways together or not at all, counted from what carries the rest: the level of a stem.
    /// All levels from 31 on are one.
    pub level: u8,
}

content!(Joint { parent, origin, x, y, swing, amplitude, level });

/// A set of levels, as [`Joint::level`] counts them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Levels(u32);

impl Levels {
    /// No level.
    pub const NONE: Self = Self(0);
    /// Every level.
    pub const ALL: Self = Self(u32::MAX);

    /// This set with one level more.
    pub fn with(self, level: u8) -> Self {
        Self(self.0 | 1 << level.min(31))
    }

    /// The levels of either set.
    pub fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Whether a level is in the set.
    pub fn contains(self, level: u8) -> bool {
        self.0 & 1 << level.min(31) != 0
    }

    /// Whether the set is empty.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }
}

impl Swing {
    /// The angle of the fast sine for each radian of the slow one.
    pub const FAST: f32 = 0.7;

    /// How far joints are turned about x and y at a time in seconds, as shares of their
    /// amplitudes.
    pub fn at(&self, shares: [f32; 2], time: f64) -> [f32; 2] {
        // In 64 bits, and within one turn: a clock may have run for months.
        let turned = self.rates.map(|rate| {
            let angle = (f64::from(rate) * time).rem_euclid(std::f64::consts::TAU);
            if angle.is_finite() { angle as f32 } else { 0.0 }
        });
        self.offsets.map(|offset| {
            let slow = sin_cos(offset + turned[0]).0;
            let fast = sin_cos(Self::FAST * offset + turned[1]).0;
            shares[0] * slow + shares[1] * fast
        })
    }

    /// The swing whose sines both turn a whole number of times, at least once, in so many seconds;
    /// what stands still does so on.
    pub fn looping(&self, seconds: f32) -> Self {
        let rates = self.rates.map(|rate| {
            let turn = std::f32::consts::TAU / seconds;
            if rate == 0.0 { 0.0 } else { (rate / turn).round().max(1.0) * turn }
        });
        Self { rates, ..*self }
    }
}

impl Joint {
    /// The turn by these angles, first about x and then about the y axis that this leads to.
    pub fn turn(&self, angles: [f32; 2]) -> Mat3 {
        let [(sin_x, cos_x), (sin_y, cos_y)] = angles.map(sin_cos);
        let rest = Mat3::from_cols(self.x, self.y, self.x.cross(self.y));
        let Mat3 { x_axis, y_axis, z_axis } = rest;
        let y = cos_x * y_axis + sin_x * z_axis;
        let z = cos_x * z_axis - sin_x * y_axis;
        let turned = Mat3::from_cols(cos_y * x_axis - sin_y * z, y, cos_y * z + sin_y * x_axis);
        turned * rest.transpose()
    }

    /// The same joint in another frame.
    pub(crate) fn transformed(&self, transform: &Affine3) -> Self {
        let x = transform.transform_vector3(self.x).normalize_or(self.x);
        let y = transform.transform_vector3(self.y);
        let y = (y - x * x.dot(y)).normalize_or(self.y);
        Self { origin: transform.transform_point3(self.origin), x, y, ..*self }
    }

    /// By how many radians it turns at most, about both axes together, where the wind's shares add
    /// up to this.
    pub fn largest_turn(&self, shares: f32) -> f32 {
        std::f32::consts::SQRT_2 * self.amplitude.abs() * shares
    }
}

impl Rig {
    /// Where everything is that follows each joint: transforms from places at rest, in the frame of
    /// the rig. Joints of other levels than `levels` are rigid. Allocates nothing where `pose` has
    /// room.
    pub fn pose(&self, wind: Wind, time: f64, levels: Levels, pose: &mut Vec<Affine3>) {
        let shares = wind.shares(self.strongest);
        // Joints with one swing mostly follow each other.
        let (mut known, mut angles) = (u32::MAX, [0.0; 2]);
        pose.clear();
        pose.reserve(self.joints.len());
        for joint in &self.joints {
            let above = joint.parent.and_then(|parent| pose.get(parent as usize).copied());
            let above = above.unwrap_or(Affine3::IDENTITY);
            if joint.amplitude == 0.0 || !levels.contains(joint.level) {
                pose.push(above);
                continue;
            }
            if known != joint.swing {
                let swing = self.swings.get(joint.swing as usize);
                angles = swing.map_or([0.0; 2], |swing| swing.at(shares, time));
                known = joint.swing;
            }
            let turn = joint.turn(angles.map(|angle| joint.amplitude * angle));
            // About the joint's own place.
            let matrix3 = above.matrix3 * turn;
            let translation = above.transform_point3(joint.origin) - matrix3 * joint.origin;
            pose.push(Affine3 { matrix3, translation });
        }
    }

    /// A bound, in any wind, of balls that follow joints: each the joint's number, a middle at rest
    /// and a radius.
    pub fn bound_of(&self, balls: impl IntoIterator<Item = (u32, Vec3, f32)>) -> Bound {
        // For each joint a box around what follows it, and how far from the joint that is at most.
        let mut followed = vec![(Aabb::EMPTY, 0.0f32); self.joints.len()];
        for (number, middle, radius) in balls {
            let number = number as usize;
            let (Some(joint), Some((aabb, farthest))) =
                (self.joints.get(number), followed.get_mut(number))
            else {
                continue;
            };
            let around = Vec3::splat(radius);
            *aabb = aabb.with_point(middle - around).with_point(middle + around);
            *farthest = farthest.max(joint.origin.distance(middle) + radius);
        }
        let drifts = self.drifts(Wind::most(self.strongest));
        let all = drifts.iter().zip(&followed).filter(|(_, (aabb, _))| !aabb.is_empty());
        let all = all.map(|(drift, (aabb, farthest))| drift.bound_of(aabb, *farthest));
        Bound::of_box(all.fold(Aabb::EMPTY, Aabb::union))
    }

    /// How far each joint may carry things where the wind's shares add up to this.
    fn drifts(&self, shares: f32) -> Vec<Drift> {
        let mut drifts: Vec<Drift> = Vec::with_capacity(self.joints.len());
        for joint in &self.joints {
            let parent = joint.parent.map(|parent| parent as usize);
            let above = parent.and_then(|parent| Some((drifts.get(parent)?, &self.joints[parent])));
            let start = Drift { per_metre: 0.0, fixed: 0.0, root: joint.origin, way: 0.0 };
            let (above, step) = above.map_or((start, 0.0), |(drift, parent)| {
                (*drift, parent.origin.distance(joint.origin))
            });
            // A chord is shorter than its arc, and than the circle is wide.
            let turn = joint.largest_turn(shares).min(2.0);
            drifts.push(Drift {
                per_metre: above.per_metre + turn,
                fixed: above.fixed + above.per_metre * step,
                way: above.way + step,
                ..above
            });
        }
        drifts
    }

    /// What is wrong with the rig, in words, if anything is.
    pub fn fault(&self) -> Option<String> {
        let of = |(i, joint): (usize, &Joint)| {
            let is_unit = |v: Vec3| (v.length() - 1.0).abs() < 1e-3;
            let is_square = joint.x.dot(joint.y).abs() < 1e-3;
            if joint.parent.is_some_and(|parent| parent as usize >= i) {
                Some("hangs on one that does not stand before it")
            } else if joint.swing as usize >= self.swings.len() {
                Some("has no swing")
            } else if !(joint.origin.is_finite() && joint.amplitude.is_finite()) {
                Some("is not finite")
            } else if !(is_unit(joint.x) && is_unit(joint.y) && is_square) {
                Some("has axes that are not of unit length and square to each other")
            } else {
                None
            }
            .map(|why| format!("joint {i} {why}"))
        };
        let swing = |(i, swing): (usize, &Swing)| {
            let is_finite = swing.rates.iter().chain(&swing.offsets).all(|x| x.is_finite());
            (!is_finite).then(|| format!("swing {i} is not finite"))
        };
        let joints = self.joints.iter().enumerate().find_map(of);
        joints.or_else(|| self.swings.iter().enumerate().find_map(swing))
    }
}

/// How far something is carried by a joint and those that it hangs on: so much for each metre from
/// the joint, and a part that is the same everywhere.
#[derive(Clone, Copy, Debug)]
struct Drift {
    per_metre: f32,
    fixed: f32,
    /// The place of the first of these joints, and the way from there.
    root: Vec3,
    way: f32,
}

impl Drift {
    /// A box around what lies in a box at rest, no further than so many metres from the joint.
    fn bound_of(&self, rest: &Aabb, farthest: f32) -> Aabb {
        if self.per_metre == 0.0 {
            return *rest;
        }
        // Turns add up in single precision.
        let by = Vec3::splat(1.001 * (self.per_metre * farthest + self.fixed));
        // However it turns, nothing is further from the first joint than by the way there.
        let most = Vec3::splat(1.001 * (self.way + farthest));
        Aabb {
            min: (rest.min - by).max(self.root - most),
            max: (rest.max + by).min(self.root + most),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn joint(parent: Option<u32>, z: f32, level: u8) -> Joint {
        Joint {
            parent,
            origin: Vec3::Z * z,
            x: Vec3::X,
            y: Vec3::Y,
            swing: u32::from(level),
            amplitude: 0.5,
            level,
        }
    }

    fn rig() -> Rig {
        let swing = |rate: f32, offset| Swing { rates: [rate, 0.7 * rate], offsets: [offset, 1.0] };
        Rig {
            swings: vec![swing(1.0, 0.3), swing(2.5, 40.0)],
            joints: vec![joint(None, 1.0, 0), joint(Some(0), 2.0, 0), joint(Some(1), 3.0, 1)],
            strongest: 20.0,
        }
    }

    fn posed(wind: Wind, time: f64, levels: Levels) -> Vec<Affine3> {
        let mut pose = Vec::new();
        rig().pose(wind, time, levels, &mut pose);
        pose
    }

    #[test]
    fn a_joint_turns_by_the_papers_two_sines() {
        let wind = Wind::new(10.0, 5.0);
        let swing = rig().swings[0];
        let [x, y] = swing.at(wind.shares(20.0), 2.0);
        let expected =
            |offset: f32| 0.2 * libm::sinf(offset + 2.0) + 0.2 * libm::sinf(0.7 * (offset + 2.0));
        assert!((x - expected(0.3)).abs() < 1e-6 && (y - expected(1.0)).abs() < 1e-6);
        let turn = joint(None, 0.0, 0).turn([0.5, 0.0]);
        assert!(
            (turn * Vec3::Z - Vec3::new(0.0, -libm::sinf(0.5), libm::cosf(0.5))).length() < 1e-6
        );
        let turn = joint(None, 0.0, 0).turn([0.0, 0.5]);
        assert!(
            (turn * Vec3::Z - Vec3::new(libm::sinf(0.5), 0.0, libm::cosf(0.5))).length() < 1e-6
        );
    }

    #[test]
    fn joints_carry_those_that_hang_on_them() {
        let pose = posed(Wind::new(8.0, 4.0), 3.0, Levels::ALL);
        for (number, joint) in rig().joints.iter().enumerate().skip(1) {
            let at = [pose[number - 1], pose[number]].map(|p| p.transform_point3(joint.origin));
            assert!(at[0].distance(at[1]) < 1e-6, "{number}");
            assert!(pose[number].matrix3.determinant() > 0.999);
        }
        assert!(pose[0].transform_point3(Vec3::Z * 3.0).distance(Vec3::Z * 3.0) > 0.05);
    }

    #[test]
    fn without_wind_or_levels_nothing_moves() {
        for pose in [
            posed(Wind::default(), 3.0, Levels::ALL),
            posed(Wind::new(8.0, 4.0), 3.0, Levels::NONE),
        ] {
            assert_eq!(pose, [Affine3::IDENTITY; 3]);
        }
        let pose = posed(Wind::new(8.0, 4.0), 3.0, Levels::NONE.with(0));
        assert_eq!(pose[1], pose[2]);
        assert_ne!(pose[0], pose[1]);
    }

    #[test]
    fn looping_swings_are_back_where_they_began() {
        let shares = [0.3, 0.2];
        for swing in rig().swings {
            let looping = swing.looping(6.0);
            let (start, end) = (looping.at(shares, 0.0), looping.at(shares, 6.0));
            assert_eq!(start, swing.at(shares, 0.0));
            assert!((0..2).all(|i| (start[i] - end[i]).abs() < 1e-5), "{start:?} {end:?}");
            let turn = std::f32::consts::TAU / 6.0;
            assert!((0..2).all(|i| (looping.rates[i] - swing.rates[i]).abs() < turn));
        }
        let still = Swing { rates: [0.0; 2], offsets: [1.0, 2.0] };
        assert_eq!(still.looping(6.0), still);
    }

    #[test]
    fn months_later_the_clock_is_as_exact() {
        let swing = Swing { rates: [1.0, 0.7], offsets: [0.0, 0.0] };
        let turns = std::f64::consts::TAU * 10.0 * 1e6;
        let [x, _] = swing.at([1.0, 0.0], turns + 0.25);
        assert!((x - libm::sinf(0.25)).abs() < 1e-5, "{x}");
    }

    #[test]
    fn bounds_hold_what_sways_in_any_wind() {
        let points: Vec<(u32, Vec3)> = (0..3)
            .flat_map(|j| {
                [(j, Vec3::new(0.2, 0.1, 1.5 + j as f32)), (j, Vec3::Z * (2.0 + j as f32))]
            })
            .collect();
        let bound = rig().bound_of(points.iter().map(|(joint, point)| (*joint, *point, 0.0)));
        for wind in [Wind::new(3.0, 1.0), Wind::new(20.0, 0.0), Wind::new(100.0, 300.0)] {
            for i in 0..200 {
                let pose = posed(wind, f64::from(i) * 0.37, Levels::ALL);
                for (joint, point) in &points {
                    let at = pose[*joint as usize].transform_point3(*point);
                    assert!(bound.aabb.contains(at), "{wind:?} {at}");
                }
            }
        }
        // Not much more than there must be.
        assert!(bound.aabb.size().max_element() < 9.0, "{bound:?}");
        let rigid = Rig { strongest: 0.0, ..rig() };
        let ball = rigid.bound_of([(2, Vec3::X, 0.5)]).aabb;
        assert_eq!((ball.min.x, ball.max), (0.5, Vec3::new(1.5, 0.5, 0.5)));
    }

    #[test]
    fn faults_are_told() {
        assert_eq!(rig().fault(), None);
        let faulty = |change: fn(&mut Rig)| {
            let mut rig = rig();
            change(&mut rig);
            rig.fault()
        };
        assert!(faulty(|rig| rig.joints[0].parent = Some(0)).is_some());
        assert!(faulty(|rig| rig.joints[1].swing = 2).is_some());
        assert!(faulty(|rig| rig.joints[1].x = Vec3::ONE).is_some());
        assert!(faulty(|rig| rig.joints[1].amplitude = f32::NAN).is_some());
        assert!(faulty(|rig| rig.swings[1].rates[0] = f32::NAN).is_some());
    }
}
