//! How stems sway in the wind (Weber and Penn 1995, wind sway): extra turns between segments, on
//! top of a curvature that stays.
//!
//! Every segment is a joint, which hangs on the one before it; a stem's first hangs on the segment
//! of its parent that it grows on, and does not turn itself. When a stem is where follows from a
//! stream of its own, so nothing else of a tree depends on it. A rig holds what grows together
//! with all that it hangs on.

use std::f32::consts::{PI, SQRT_2};

use sapwood_geom::{Content, Digester, Purpose, Shared, Stream, StreamPath, content};
use sapwood_graph::{Joint, Rig, Swing};

use super::{Segment, Stem, Stems};

/// How trees sway.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SwayParams {
    /// How much faster than by the paper's formula, which has trunks sway once in two hours: in it
    /// seconds can only have been milliseconds.
    pub time_scale: f32,
    /// The largest turn of one segment, in radians, in a wind of 10 m/s without gusts; less in less
    /// wind. By the paper's amplitudes alone thin stems would turn many times as far.
    pub largest_turn: f32,
    /// The wind without gusts, in metres per second, beyond which trees sway no further: bounds
    /// make room for so much.
    pub strongest: f32,
}

content!(SwayParams { time_scale, largest_turn, strongest });

impl Default for SwayParams {
    fn default() -> Self {
        Self { time_scale: 1000.0, largest_turn: 10.0f32.to_radians(), strongest: 20.0 }
    }
}

/// What the stems that grow next hang on.
#[derive(Clone, Debug, PartialEq)]
pub struct Riding {
    /// All joints so far, those of the stems that carry the next ones last.
    pub rig: Shared<Rig>,
    /// For each stem that grows next, by its path, the joint that it hangs on, in the order of their
    /// seeds.
    pub on: Vec<(StreamPath, u32)>,
}

impl Content for Riding {
    fn write(&self, digester: &mut Digester) {
        digester.add(&self.rig).add(&self.on);
    }
}

impl Riding {
    /// The joint of the first segment of `stems`, which the rig was made for.
    pub(crate) fn first_joint(&self, stems: &Stems) -> u32 {
        self.rig.joints.len().saturating_sub(stems.segments.len()) as u32
    }
}

/// The rig of stems on what carries them: all of its joints, then one for each segment.
pub(crate) fn rig_of(stems: &Stems, carried: Option<&Riding>, params: &SwayParams) -> Rig {
    let fixed = || Rig { strongest: params.strongest, ..Rig::default() };
    let mut rig = carried.map_or_else(fixed, |carried| Rig::clone(&carried.rig));
    let first = rig.joints.len() as u32;
    rig.joints.reserve_exact(stems.segments.len());
    rig.swings.reserve_exact(stems.stems.len());
    let mut seeds = carried.map_or(&[][..], |carried| &carried.on).iter();
    for (index, stem) in stems.stems.iter().enumerate() {
        let mut parent = match stem.clone_of {
            Some(_) => stems.segment_before(stem).map(|segment| first + segment as u32),
            // Stems are in the order of their seeds, of which some may not have grown.
            None => seeds.find(|(path, _)| *path == stem.seed.path).map(|(_, joint)| *joint),
        };
        let swing = rig.swings.len() as u32;
        rig.swings.push(swing_of(stem, params));
        for (i, segment) in (stem.start..).zip(stems.segments_of(index)) {
            rig.joints.push(Joint {
                parent,
                origin: segment.frame.origin,
                x: segment.frame.axes.x_axis,
                y: segment.frame.axes.y_axis,
                swing,
                amplitude: if i == 0 { 0.0 } else { amplitude(stem, segment, params) },
                level: stem.seed.level,
            });
            parent = Some(rig.joints.len() as u32 - 1);
        }
    }
    rig
}

/// When a stem is where. Its offsets are within ten turns: the fast sine turns seven times then.
fn swing_of(stem: &Stem, params: &SwayParams) -> Swing {
    let mut stream = Stream::new(stem.seed.path, Purpose("sway"));
    let offsets = [stream.between(0.0, 20.0 * PI), stream.between(0.0, 20.0 * PI)];
    let rate = params.time_scale * (stem.seed.radius / stem.seed.length) / 15.0;
    let rate = if rate.is_finite() { rate } else { 0.0 };
    Swing { rates: [rate, Swing::FAST * rate], offsets }
}

/// By how many radians a segment turns where the wind's shares are 1: the paper's a0, divided
/// among the stem's segments, within the largest turn.
fn amplitude(stem: &Stem, segment: &Segment, params: &SwayParams) -> f32 {
    let degrees = 4.0 * stem.seed.length * (1.0 - segment.z_foot) / segment.radius_foot;
    let each = (degrees / stem.curve_res as f32).to_radians();
    // About both axes at once, each by what the slow and the fast sine come to in a wind of 10.
    let most = params.largest_turn.max(0.0) / (SQRT_2 * 0.3);
    // Written so that it is the most where a stem has no radius.
    if each < most { each } else { most }
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use glam::Vec3;
    use sapwood_graph::{Levels, Wind};

    use super::*;
    use crate::weber_penn::growth::children_on;
    use crate::weber_penn::{Crown, Level, Species, Target, TrunkForm, grow, trunks};

    fn free(_: usize) -> Result<(), Infallible> {
        Ok(())
    }

    fn trunk(species: &Species, seed: u64) -> Stems {
        let (crown, level) = (Crown::new(species), Level::new(species, 0));
        let Ok(seeds) = trunks(&crown, &level, StreamPath::new(seed), &mut free);
        let Ok(stems) = grow(&seeds, &crown, &level, &Target::Up, &mut free);
        stems
    }

    /// A cone 8 m high of 4 segments, 0.8 m thick at its base.
    fn cone() -> Stems {
        let mut species = Species { scale: 8.0, scale_v: 0.0, ratio: 0.1, ..Species::default() };
        let level = &mut species.level[0];
        (level.length, level.length_v, level.taper, level.curve_res) = (1.0, 0.0, 1.0, 4);
        (level.curve, level.curve_v, level.seg_splits) = (0.0, 0.0, 0.0);
        let stems = trunk(&species, 1);
        let seed = &stems.stems[0].seed;
        assert!((seed.length - 8.0).abs() < 1e-5 && (seed.radius - 0.8).abs() < 1e-5, "{seed:?}");
        stems
    }

    #[test]
    fn amplitudes_are_the_papers_by_hand() {
        let free = SwayParams { largest_turn: 100.0, ..SwayParams::default() };
        let stems = cone();
        // a0 of a cone is 4 length / radius everywhere: 40 degrees, 10 for each of 4 segments.
        for segment in &stems.segments {
            let each = amplitude(&stems.stems[0], segment, &free);
            assert!((each.to_degrees() - 10.0).abs() < 1e-3, "{each}");
        }
        let mut cylinder = stems.clone();
        for (segment, each) in cylinder.segments.iter_mut().zip([10.0, 7.5, 5.0, 2.5]) {
            segment.radius_foot = 0.8;
            let amplitude = amplitude(&cylinder.stems[0], segment, &free);
            assert!((amplitude.to_degrees() - each).abs() < 1e-3);
        }
        // In a wind of 10 with gusts of 5 a1 is a fifth of a0, and a2 a tenth and half of a1 more.
        let shares = Wind::new(10.0, 5.0).shares(20.0);
        let a0 = 4.0f32.to_radians() * 8.0 / 0.8;
        assert!((shares[0] * a0 - 8.0f32.to_radians()).abs() < 1e-6);
        assert!((shares[1] * a0 - 8.0f32.to_radians()).abs() < 1e-6);
    }

    #[test]
    fn rates_and_offsets_are_the_papers() {
        let (stems, params) = (cone(), SwayParams::default());
        let swing = swing_of(&stems.stems[0], &params);
        // Radius to length is a tenth: a fifteenth of that each millisecond.
        assert!((swing.rates[0] - 0.1 * 1000.0 / 15.0).abs() < 1e-4, "{swing:?}");
        assert!((swing.rates[1] - 0.7 * swing.rates[0]).abs() < 1e-5);
        let mut stem = stems.stems[0];
        let (mut low, mut high) = (f32::MAX, f32::MIN);
        for seed in 0..1000 {
            stem.seed.path = StreamPath::new(seed);
            let [x, y] = swing_of(&stem, &params).offsets;
            assert_ne!(x, y);
            (low, high) = (low.min(x).min(y), high.max(x).max(y));
        }
        assert!((0.0..0.2).contains(&low), "{low}");
        assert!((20.0 * PI - 0.2..=20.0 * PI).contains(&high), "{high}");
    }

    #[test]
    fn no_segment_turns_further_than_the_largest_turn_scaled_with_the_wind() {
        let mut stems = cone();
        stems.stems[0].seed.radius = 1e-3;
        for (segment, radius) in stems.segments.iter_mut().zip([1e-3, 1e-9, 0.0, f32::NAN]) {
            segment.radius_foot = radius;
        }
        let params = SwayParams::default();
        let rig = rig_of(&stems, None, &params);
        assert_eq!(rig.fault(), None);
        for (wind, degrees) in [(10.0, 10.0), (5.0, 5.0), (20.0, 20.0), (80.0, 20.0)] {
            let mut largest = 0.0f32;
            for i in 0..4000 {
                let shares = Wind::new(wind, 0.0).shares(params.strongest);
                let swing = rig.swings[0].at(shares, f64::from(i) * 0.173);
                for joint in &rig.joints {
                    let turn = joint.turn(swing.map(|angle| joint.amplitude * angle));
                    let trace = turn.x_axis.x + turn.y_axis.y + turn.z_axis.z;
                    largest = largest.max(libm::acosf((0.5 * (trace - 1.0)).clamp(-1.0, 1.0)));
                }
            }
            let largest = largest.to_degrees();
            assert!(largest <= degrees + 0.01 && largest > 0.7 * degrees, "{wind}: {largest}");
        }
    }

    #[test]
    fn segments_hang_on_each_other_clones_on_theirs_and_children_on_their_parents() {
        let mut species = Species { levels: 2, ..Species::default() };
        species.level[0].seg_splits = 1.0;
        species.level[0].curve_res = 5;
        species.level[1].branches = 20;
        let (crown, level) = (Crown::new(&species), Level::new(&species, 1));
        let stems = trunk(&species, 3);
        let params = SwayParams::default();
        let rig = rig_of(&stems, None, &params);
        assert_eq!((rig.joints.len(), rig.fault()), (stems.segments.len(), None));
        assert!(stems.stems.len() > 4);
        let (mut on, form) = (Vec::new(), TrunkForm::new(&species));
        let mut note = |segment| on.push(segment as u32);
        let children = children_on(&stems, &crown, Some(&form), &level, &mut free, &mut note);
        let Ok(seeds) = children;
        assert_eq!(on.len(), seeds.len());
        for (seed, segment) in seeds.iter().zip(&on) {
            let segment = &stems.segments[*segment as usize];
            let to = seed.frame.origin - segment.frame.origin;
            let along = to.dot(segment.frame.axes.z_axis);
            assert!((-1e-4..=segment.length + 1e-4).contains(&along), "{along}");
        }
        let pairs = seeds.iter().map(|seed| seed.path).zip(on.iter().copied());
        let riding = Riding { rig: Shared::new(rig.clone()), on: pairs.collect() };
        // One of them did not grow.
        let left: Vec<_> = seeds.iter().copied().enumerate().filter(|(i, _)| *i != 7).collect();
        let grown: Vec<_> = left.iter().map(|(_, seed)| *seed).collect();
        let Ok(twigs) = grow(&grown, &crown, &level, &Target::Up, &mut free);
        let all = rig_of(&twigs, Some(&riding), &params);
        assert_eq!(all.fault(), None);
        let first = rig.joints.len();
        for stem in twigs.stems.iter().filter(|stem| stem.clone_of.is_none()) {
            let joint = &all.joints[first + stem.first_segment as usize];
            let seed = left[stem.seed_index as usize].0;
            assert_eq!((joint.parent, joint.amplitude), (Some(on[seed]), 0.0));
        }
        // However it sways, whatever follows a joint is where the joint before it ends.
        let mut pose = Vec::new();
        all.pose(Wind::new(12.0, 6.0), 4.0, Levels::ALL, &mut pose);
        let mut farthest = 0.0f32;
        for (joint, moved) in all.joints.iter().zip(&pose) {
            let at = moved.transform_point3(joint.origin);
            farthest = farthest.max(at.distance(joint.origin));
            if let Some(parent) = joint.parent {
                let end = pose[parent as usize].transform_point3(joint.origin);
                assert!(end.distance(at) < 1e-4);
            }
        }
        assert!(farthest > 0.1);
        assert_eq!(pose[0].transform_point3(Vec3::Z), Vec3::Z);
    }
}
