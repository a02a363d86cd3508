//! Leaves turned from the frames of their segments into their own, four at a time.
//!
//! Where a leaf sits and by which angles it turns comes from one draw after the other; the turns
//! themselves do not depend on each other. They give the same bits as [`Frame`]'s turns, one at a
//! time, would.

use glam::{Affine3, Mat3, Vec3};
use sapwood_geom::{atan2_4, sin_cos_4};
use wide::f32x4;

use super::attraction::PARALLEL;
use super::frame::Frame;
use crate::weber_penn::{LeafParams, LeafTarget};

/// Four vectors, by their coordinates.
type Vectors = [f32x4; 3];

/// Leaves that wait to be turned.
pub(super) struct LeafTurns<'a> {
    params: &'a LeafParams,
    target: &'a LeafTarget,
    n: usize,
    frames: [Frame; 4],
    sizes: [f32; 4],
    round: [f32; 4],
    down: [f32; 4],
    roll: [f32; 4],
}

/// A leaf before it is turned.
pub(super) struct Unturned {
    /// The segment's frame where the leaf sits.
    pub(super) frame: Frame,
    /// The angle about the segment's z.
    pub(super) round: f32,
    /// The angle from the segment's z.
    pub(super) down: f32,
    /// The angle about its own z, of leaves that are scattered.
    pub(super) roll: f32,
    /// How long the axes of its place shall be.
    pub(super) size: f32,
}

impl<'a> LeafTurns<'a> {
    pub(super) fn new(params: &'a LeafParams, target: &'a LeafTarget) -> Self {
        Self {
            params,
            target,
            n: 0,
            frames: [Frame::IDENTITY; 4],
            sizes: [1.0; 4],
            round: [0.0; 4],
            down: [0.0; 4],
            roll: [0.0; 4],
        }
    }

    /// Takes a leaf in; whenever there are four, their places come out.
    pub(super) fn add(&mut self, leaf: Unturned, places: &mut Vec<Affine3>) {
        let i = self.n;
        self.frames[i] = leaf.frame;
        self.sizes[i] = leaf.size;
        self.round[i] = leaf.round;
        self.down[i] = leaf.down;
        self.roll[i] = leaf.roll;
        self.n += 1;
        if self.n == 4 {
            self.turn(places);
        }
    }

    /// Lets the last few out.
    pub(super) fn finish(mut self, places: &mut Vec<Affine3>) {
        self.turn(places);
    }

    fn turn(&mut self, places: &mut Vec<Affine3>) {
        let column = |of: fn(&Frame) -> Vec3| {
            let columns = self.frames.each_ref().map(of);
            [0, 1, 2].map(|axis| f32x4::new(columns.map(|column| column[axis])))
        };
        let mut four = Four {
            origin: column(|frame| frame.origin),
            x: column(|frame| frame.axes.x_axis),
            y: column(|frame| frame.axes.y_axis),
            z: column(|frame| frame.axes.z_axis),
        };
        four.turn_z(self.round);
        four.turn_x(self.down);
        match *self.target {
            LeafTarget::Outward => four.bend(self.params.bend),
            LeafTarget::Direction(direction) => {
                let toward = direction.normalize_or_zero().to_array().map(f32x4::splat);
                four.turn_toward(toward, self.params.attraction);
            }
            LeafTarget::Point(point) => {
                let toward = self.frames.map(|frame| (point - frame.origin).normalize_or_zero());
                let toward = [0, 1, 2].map(|axis| f32x4::new(toward.map(|to| to[axis])));
                four.turn_toward(toward, self.params.attraction);
            }
            LeafTarget::Scattered => four.turn_z(self.roll),
        }
        let [x, y, z] = [four.x, four.y, four.z].map(|axis| axis.map(f32x4::to_array));
        let vector = |of: &[[f32; 4]; 3], i: usize| Vec3::new(of[0][i], of[1][i], of[2][i]);
        places.extend((0..self.n).map(|i| {
            let axes = Mat3::from_cols(vector(&x, i), vector(&y, i), vector(&z, i));
            Affine3::from_mat3_translation(axes * self.sizes[i], self.frames[i].origin)
        }));
        self.n = 0;
    }
}

/// Four frames.
struct Four {
    origin: Vectors,
    x: Vectors,
    y: Vectors,
    z: Vectors,
}

impl Four {
    /// As [`Frame::turned_x`].
    fn turn_x(&mut self, angles: [f32; 4]) {
        let [sin, cos] = sine_and_cosine(angles);
        let (y, z) = (self.y, self.z);
        self.y = [0, 1, 2].map(|i| cos * y[i] + sin * z[i]);
        self.z = [0, 1, 2].map(|i| cos * z[i] - sin * y[i]);
    }

    /// As [`Frame::turned_z`].
    fn turn_z(&mut self, angles: [f32; 4]) {
        let [sin, cos] = sine_and_cosine(angles);
        let (x, y) = (self.x, self.y);
        self.x = [0, 1, 2].map(|i| cos * x[i] + sin * y[i]);
        self.y = [0, 1, 2].map(|i| cos * y[i] - sin * x[i]);
    }

    /// Bent outward from the tree's axis, then up, by the share `b` of the angles.
    ///
    /// The paper's second turn is written with an angle it does not define there; this is its
    /// intent, a turn of the normal toward the sky about a horizontal axis.
    fn bend(&mut self, b: f32) {
        if b == 0.0 {
            return;
        }
        let (p, n) = (self.origin, self.y);
        // The angle from n to p about tree z, in (-180, 180] degrees.
        let across = n[0] * p[1] - n[1] * p[0];
        let theta = f32x4::new(atan2_4(across.into(), (n[0] * p[0] + n[1] * p[1]).into()));
        let [sin, cos] = sine_and_cosine((b * theta).into());
        let is_off = theta.simd_ne(f32x4::ZERO);
        for axis in [&mut self.x, &mut self.y, &mut self.z] {
            let [x, y, _] = *axis;
            axis[0] = is_off.select(cos * x - sin * y, x);
            axis[1] = is_off.select(sin * x + cos * y, y);
        }
        self.turn_toward([f32x4::ZERO, f32x4::ZERO, f32x4::ONE], b);
    }

    /// Turned so that y moves toward unit vectors, by a share of the angles between them;
    /// unturned where the two are parallel or the vectors are zero.
    fn turn_toward(&mut self, to: Vectors, share: f32) {
        if share == 0.0 {
            return;
        }
        let from = self.y;
        let across = cross(&from, &to);
        let sine = dot(&across, &across).sqrt();
        let is_turned = sine.simd_gt(f32x4::splat(PARALLEL));
        let axis = across.map(|part| part / sine);
        let angle = f32x4::new(atan2_4(sine.into(), dot(&from, &to).into()));
        let [sin, cos] = sine_and_cosine((share * angle).into());
        for v in [&mut self.x, &mut self.y, &mut self.z] {
            let turned = cross(&axis, v);
            let along = (1.0 - cos) * dot(&axis, v);
            for i in 0..3 {
                let turned = cos * v[i] + sin * turned[i] + along * axis[i];
                v[i] = is_turned.select(turned, v[i]);
            }
        }
    }
}

fn sine_and_cosine(angles: [f32; 4]) -> [f32x4; 2] {
    let (sin, cos) = sin_cos_4(angles);
    [f32x4::new(sin), f32x4::new(cos)]
}

fn dot(a: &Vectors, b: &Vectors) -> f32x4 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: &Vectors, b: &Vectors) -> Vectors {
    [a[1] * b[2] - b[1] * a[2], a[2] * b[0] - b[2] * a[0], a[0] * b[1] - b[0] * a[1]]
}

#[cfg(test)]
mod tests {
    use std::f32::consts::{FRAC_PI_2, TAU};

    use sapwood_geom::{Purpose, StreamPath, atan2};

    use super::super::attraction::turned_toward;
    use super::super::variation::Draws;
    use super::*;
    use crate::weber_penn::{Species, Variation};

    /// The places of leaves that are turned in this way.
    fn places(params: &LeafParams, target: &LeafTarget, leaves: Vec<Unturned>) -> Vec<Affine3> {
        let mut places = Vec::new();
        let mut turns = LeafTurns::new(params, target);
        leaves.into_iter().for_each(|leaf| turns.add(leaf, &mut places));
        turns.finish(&mut places);
        places
    }

    fn params(bend: f32, attraction: f32) -> LeafParams {
        LeafParams { bend, attraction, ..LeafParams::new(&Species::default()) }
    }

    fn leaf(frame: Frame) -> Unturned {
        Unturned { frame, round: 0.0, down: 0.0, roll: 0.0, size: 1.0 }
    }

    /// A leaf's frame bent outward, by the share `b` of the angles.
    fn bent(frame: Frame, b: f32) -> Frame {
        let place = places(&params(b, 0.0), &LeafTarget::Outward, vec![leaf(frame)])[0];
        Frame { origin: place.translation, axes: place.matrix3 }
    }

    fn azimuth(v: Vec3) -> f32 {
        libm::atan2f(v.y, v.x)
    }

    #[test]
    fn bend_closes_its_share_of_the_angle_outward_and_of_the_angle_to_the_sky() {
        for (roll, azimuth_of_place) in [(0.3, 1.0), (2.0, -3.0), (-1.0, 2.5)] {
            let place = Vec3::new(libm::cosf(azimuth_of_place), libm::sinf(azimuth_of_place), 2.0);
            let leaf = Frame::IDENTITY.at(place).turned_z(roll).turned_x(0.8);
            let turned = bent(leaf, 0.25);
            let wrap = |a: f32| a - TAU * (a / TAU).round();
            let (before, after) = (azimuth(leaf.axes.y_axis), azimuth(turned.axes.y_axis));
            let theta = wrap(azimuth_of_place - before);
            assert!(wrap(after - before - 0.25 * theta).abs() < 1e-5);
            let (before, after) = (leaf.axes.y_axis.z.acos(), turned.axes.y_axis.z.acos());
            assert!((after - 0.75 * before).abs() < 1e-5);
        }
    }

    #[test]
    fn a_bend_of_1_turns_hanging_leaves_up_too() {
        let hanging = Frame::IDENTITY.at(Vec3::X).turned_x(FRAC_PI_2 + 1.0);
        assert!((bent(hanging, 1.0).axes.y_axis.z - 1.0).abs() < 1e-6);
    }

    #[test]
    fn leaves_on_the_axis_and_level_leaves_are_no_trouble() {
        for frame in [Frame::IDENTITY, Frame::IDENTITY.turned_x(FRAC_PI_2)] {
            assert!(bent(frame, 0.7).axes.is_finite());
        }
    }

    /// A leaf turned by the turns of single frames.
    fn turned(leaf: &Unturned, params: &LeafParams, target: &LeafTarget) -> Affine3 {
        let frame = leaf.frame.turned_z(leaf.round).turned_x(leaf.down);
        let toward = |to: Vec3| {
            let to = to.normalize_or_zero();
            turned_toward(frame, frame.axes.y_axis, to, |angle| params.attraction * angle)
        };
        let frame = match *target {
            LeafTarget::Outward => {
                let (p, n) = (frame.origin, frame.axes.y_axis);
                let theta = atan2(n.x * p.y - n.y * p.x, n.x * p.x + n.y * p.y);
                let frame = frame.turned_about_tree_z(params.bend * theta);
                turned_toward(frame, frame.axes.y_axis, Vec3::Z, |phi| params.bend * phi)
            }
            LeafTarget::Direction(direction) => toward(direction),
            LeafTarget::Point(point) => toward(point - frame.origin),
            LeafTarget::Scattered => frame.turned_z(leaf.roll),
        };
        Affine3::from_mat3_translation(frame.axes * leaf.size, frame.origin)
    }

    #[test]
    fn four_at_a_time_have_the_bits_of_one_whatever_they_turn_to() {
        let params = params(0.3, 0.6);
        let targets = [
            LeafTarget::Outward,
            LeafTarget::Direction(Vec3::new(1.0, -2.0, 3.0)),
            LeafTarget::Point(Vec3::new(0.5, 4.0, 9.0)),
            LeafTarget::Scattered,
        ];
        // Neither number fills fours.
        for (target, n) in targets.iter().zip([101, 102, 103, 3]) {
            let some = || -> Vec<Unturned> {
                let mut draws = Draws::new(StreamPath::new(7), Purpose("test"), Variation::Uniform);
                let mut angle = || draws.between(-TAU, TAU);
                let one = |_| Unturned {
                    frame: Frame::IDENTITY
                        .at(Vec3::new(angle(), angle(), angle()))
                        .turned_x(angle())
                        .turned_y(angle()),
                    round: angle(),
                    down: angle(),
                    roll: angle(),
                    size: angle(),
                };
                (0..n).map(one).collect()
            };
            let bits = |place: &Affine3| place.to_cols_array().map(f32::to_bits);
            let wanted: Vec<_> =
                some().iter().map(|leaf| bits(&turned(leaf, &params, target))).collect();
            let found: Vec<_> = places(&params, target, some()).iter().map(bits).collect();
            assert_eq!(found, wanted, "{target:?}");
        }
    }
}
