//! From seeds to stems: segments, curvature, clones (Weber and Penn 1995, sections
//! 4.1, 4.2 and 4.8).

use std::collections::VecDeque;

use sapwood_geom::{Purpose, StreamPath};

use super::attraction::Attraction;
use super::curve::{Curvature, helix_radius};
use super::frame::Frame;
use super::split::Splits;
use super::stem::{Segment, Stem, StemSeed, Stems};
use super::variation::Draws;
use crate::weber_penn::{Crown, Dialect, Level, Target};

// Keys of clones below their stem's path; children are numbered from 0.
const CLONE_KEY: u64 = 1 << 63;

/// Grows stems of one level, with their clones and segments, from their seeds.
///
/// `level` is the set of parameters of the seeds' level and `target` stands in tree space.
/// `charge` is told of every stem, segment and waiting clone before memory is taken for it, and
/// ends the growth by an error: split counts multiply, and only the caller knows a limit. Draws
/// depend on a seed's path and on nothing else, so a seed with another length grows the same
/// shape.
pub fn grow<E>(
    seeds: &[StemSeed],
    crown: &Crown,
    level: &Level,
    target: &Target,
    charge: &mut impl FnMut(usize) -> Result<(), E>,
) -> Result<Stems, E> {
    let mut growth = Growth {
        crown,
        level,
        target,
        curvature: Curvature::new(level, crown.dialect),
        stems: Stems::default(),
        waiting: VecDeque::new(),
    };
    let n_segments = seeds.len().saturating_mul(level.curve_res as usize);
    if level.seg_splits == 0.0 && level.base_splits == 0 {
        // Nothing splits: the numbers are known.
        charge(seeds.len().saturating_add(n_segments))?;
        growth.stems.stems.reserve_exact(seeds.len());
        growth.stems.segments.reserve_exact(n_segments);
        for (i, seed) in seeds.iter().enumerate() {
            growth.stem(seed, i, Start::of(seed), &mut |_| Ok(()))?;
        }
        return Ok(growth.stems);
    }
    for (i, seed) in seeds.iter().enumerate() {
        growth.waiting.push_back(Start::of(seed));
        while let Some(start) = growth.waiting.pop_front() {
            charge(1 + (level.curve_res - start.segment) as usize)?;
            growth.stem(seed, i, start, charge)?;
        }
    }
    Ok(growth.stems)
}

/// Where a stem or a clone begins.
struct Start {
    path: StreamPath,
    clone_of: Option<u32>,
    /// The index of its first segment along the stem.
    segment: u32,
    /// The frame before that segment's curvature.
    frame: Frame,
    /// What each segment turns about local x to undo a split.
    correction: f32,
    /// See [`Segment::share`].
    share: f32,
    /// See [`Splits::probability`].
    probability: f32,
}

impl Start {
    fn of(seed: &StemSeed) -> Self {
        Self {
            path: seed.path,
            clone_of: None,
            segment: 0,
            frame: seed.frame,
            correction: 0.0,
            share: 1.0,
            probability: 1.0,
        }
    }
}

struct Growth<'a> {
    crown: &'a Crown,
    level: &'a Level,
    target: &'a Target,
    curvature: Curvature,
    stems: Stems,
    waiting: VecDeque<Start>,
}

impl Growth<'_> {
    /// Grows one stem or clone from its start to its tip; its clones are left waiting.
    fn stem<E>(
        &mut self,
        seed: &StemSeed,
        seed_index: usize,
        start: Start,
        charge: &mut impl FnMut(usize) -> Result<(), E>,
    ) -> Result<(), E> {
        let (crown, level) = (self.crown, self.level);
        let curve_res = level.curve_res;
        let tree_gen = crown.dialect == Dialect::TreeGen;
        let Start { path, clone_of, segment: first, mut frame, .. } = start;
        let Start { mut correction, mut share, probability, .. } = start;
        let length = seed.length / curve_res as f32;
        let stem = Stem {
            seed: StemSeed { path, ..*seed },
            seed_index: seed_index as u32,
            first_segment: self.stems.segments.len() as u32,
            n_segments: curve_res - first,
            curve_res,
            start: first,
            clone_of,
            taper: level.taper,
            helix_radius: helix_radius(level.curve_v, length),
            length_base: match seed.level {
                0 if tree_gen => crown.base_size * seed.length,
                0 => crown.base_size * seed.scale_tree,
                _ => level.base_size * seed.length,
            },
        };
        let index = self.stems.stems.len() as u32;
        self.stems.stems.push(stem);

        let draws = |purpose| Draws::new(path, Purpose(purpose), crown.variation);
        let (mut tilts, mut sideways) = (draws("curve"), draws("bend"));
        let attraction = Attraction::new(crown, self.target, seed.level, curve_res);
        let origin = clone_of.is_none();
        let mut splits = Splits::new(crown, level, seed.level, path, origin, probability);
        // tree-gen's stems do not curve where they split.
        let mut curves = origin || !tree_gen;
        let mut z_foot = first as f32 / curve_res as f32;
        let mut radius_foot = stem.radius_at(z_foot);
        for s in first..curve_res {
            if s > 0 {
                if curves {
                    frame = self.curvature.turned(frame, s, correction, &mut tilts, &mut sideways);
                }
                curves = true;
                frame = attraction.turned(frame);
            }
            let z_end = (s + 1) as f32 / curve_res as f32;
            let radius_end = stem.radius_at(z_end);
            let segment = Segment {
                stem: index,
                frame,
                offset: seed.length * z_foot,
                length,
                radius_foot,
                radius_end,
                z_foot,
                z_end,
                share,
            };
            frame.origin = segment.end();
            self.stems.segments.push(segment);
            (z_foot, radius_foot) = (z_end, radius_end);

            let remaining = curve_res - s - 1;
            let clones = if remaining > 0 { splits.count(s) } else { 0 };
            if clones > 0 {
                charge(clones)?;
                share = splits.shared(share, s, clones);
                let (continued, owed) = splits.direction(frame, s, 0, clones, correction);
                for i in 1..=clones {
                    let (frame, correction) = splits.direction(frame, s, i, clones, correction);
                    self.waiting.push_back(Start {
                        path: path.child(CLONE_KEY | u64::from(s) << 32 | i as u64),
                        clone_of: Some(index),
                        segment: s + 1,
                        frame,
                        correction,
                        share,
                        probability: splits.probability(),
                    });
                }
                (frame, correction) = (continued, owed);
                curves = !tree_gen;
            }
        }
        Ok(())
    }
}
