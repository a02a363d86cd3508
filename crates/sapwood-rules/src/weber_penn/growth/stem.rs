//! Grown stems as flat arrays: what surfaces, children, leaves and pruning read.
//!
//! Everything is in tree space: z up, metres, the tree's foot at the origin. A stem's `z` is its
//! unit position, 0 at the base and 1 at the tip; an *offset* is the same place in metres from
//! the base. A clone keeps counting both from the base of the stem that it split from.

use std::f32::consts::TAU;
use std::ops::Range;

use glam::Vec3;
use sapwood_geom::{StreamPath, content, sin_cos};

use super::frame::Frame;
use super::taper::taper_radius;

/// All that a stem needs from its parent to grow by itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StemSeed {
    /// Where the stem's random streams start.
    pub path: StreamPath,
    /// Its level; 0 is the trunk.
    pub level: u8,
    /// Its base, z along its first segment.
    pub frame: Frame,
    /// Its length in metres.
    pub length: f32,
    /// Its base radius in metres, before flare.
    pub radius: f32,
    /// The base radius that it would have if its parent were thick enough for any.
    pub free_radius: f32,
    /// Metres from the parent's base to where it grows; 0 for a trunk.
    pub offset: f32,
    /// The parent's length in metres; 0 for a trunk.
    pub parent_length: f32,
    /// The parent's radius there, in metres: so much of the stem lies inside the parent.
    pub parent_radius: f32,
    /// The greatest length of its level relative to the parent's, as drawn for this stem.
    pub length_child_max: f32,
    /// The size of the tree in metres, drawn once per tree; in tree-gen's dialect for each of
    /// several trunks.
    pub scale_tree: f32,
}

content!(StemSeed {
    path,
    level,
    frame,
    length,
    radius,
    free_radius,
    offset,
    parent_length,
    parent_radius,
    length_child_max,
    scale_tree,
});

/// A straight piece of a stem; on a helix, one turn round its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// The stem it belongs to, an index into [`Stems::stems`].
    pub stem: u32,
    /// Its foot, z along it.
    pub frame: Frame,
    /// Metres from the stem's base to its foot.
    pub offset: f32,
    /// Its length in metres.
    pub length: f32,
    /// The radius in metres at its foot, by taper alone.
    pub radius_foot: f32,
    /// The radius in metres at its end, by taper alone.
    pub radius_end: f32,
    /// The stem's z at its foot.
    pub z_foot: f32,
    /// The stem's z at its end.
    pub z_end: f32,
    /// The share of the children and leaves that it would carry on a stem that never split; in
    /// tree-gen's dialect of the children alone.
    pub share: f32,
}

content!(Segment { stem, frame, offset, length, radius_foot, radius_end, z_foot, z_end, share });

impl Segment {
    /// The middle of its end, which is the foot of the next.
    pub fn end(&self) -> Vec3 {
        self.frame.origin + self.length * self.frame.axes.z_axis
    }
}

/// A stem, or a clone that split from one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stem {
    /// What it grew from; a clone has its origin's, with a path of its own.
    pub seed: StemSeed,
    /// Which of the seeds handed to growth, counted from 0.
    pub seed_index: u32,
    /// The first of its segments in [`Stems::segments`].
    pub first_segment: u32,
    /// How many segments it has of its own.
    pub n_segments: u32,
    /// nCurveRes: how many segments a stem of its level has from base to tip.
    pub curve_res: u32,
    /// The index along the stem of its first own segment; 0 unless it is a clone.
    pub start: u32,
    /// The stem it split from, an earlier index into [`Stems::stems`]: the clone's first segment
    /// stands on the end of that stem's segment `start - 1`.
    pub clone_of: Option<u32>,
    /// nTaper.
    pub taper: f32,
    /// The radius in metres of the helix that its centre line winds, 0 for none.
    pub helix_radius: f32,
    /// Metres from the base that stay without children.
    pub length_base: f32,
}

content!(Stem {
    seed,
    seed_index,
    first_segment,
    n_segments,
    curve_res,
    start,
    clone_of,
    taper,
    helix_radius,
    length_base,
});

impl Stem {
    /// The radius in metres at `z`, by taper alone: without flare, lobes or any late factor.
    pub fn radius_at(&self, z: f32) -> f32 {
        taper_radius(self.taper, self.seed.radius, self.seed.length, z)
    }

    /// The length in metres of each of its segments.
    pub fn segment_length(&self) -> f32 {
        self.seed.length / self.curve_res as f32
    }

    /// Where its own segments begin: 0, or where a clone split off.
    pub fn z_start(&self) -> f32 {
        self.start as f32 / self.curve_res as f32
    }

    /// Its segments' places in [`Stems::segments`].
    pub fn segment_range(&self) -> Range<usize> {
        let first = self.first_segment as usize;
        first..first + self.n_segments as usize
    }
}

/// Stems with their clones and segments, as flat arrays.
///
/// A stem's segments are contiguous and run from base to tip; a clone comes after the stem that
/// it split from; stems are in the order of their seeds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stems {
    /// The stems.
    pub stems: Vec<Stem>,
    /// All segments, stem by stem.
    pub segments: Vec<Segment>,
}

content!(Stems { stems, segments });

impl Stems {
    /// The segments of a stem, from base to tip.
    pub fn segments_of(&self, stem: usize) -> &[Segment] {
        &self.segments[self.stems[stem].segment_range()]
    }

    /// The segment at whose end a clone begins; nothing for stems that are none.
    pub(crate) fn segment_before(&self, stem: &Stem) -> Option<usize> {
        let origin = &self.stems[stem.clone_of? as usize];
        let before = stem.start.checked_sub(origin.start + 1)?;
        (before < origin.n_segments).then_some((origin.first_segment + before) as usize)
    }

    /// The own segment of `stem` at an offset in metres, the nearest one beyond its ends.
    pub fn segment_at(&self, stem: usize, offset: f32) -> &Segment {
        let s = &self.stems[stem];
        let index = (offset / s.segment_length()) as u32;
        let own = index.saturating_sub(s.start).min(s.n_segments - 1);
        &self.segments[(s.first_segment + own) as usize]
    }

    /// The centre line at an offset in metres from the base, helix included.
    pub fn center_at(&self, stem: usize, offset: f32) -> Vec3 {
        self.center_in(stem, self.segment_at(stem, offset), offset)
    }

    /// The centre line within a known segment of `stem`, helix included.
    pub fn center_in(&self, stem: usize, segment: &Segment, offset: f32) -> Vec3 {
        let along = offset - segment.offset;
        let radius = self.stems[stem].helix_radius;
        if radius == 0.0 {
            return segment.frame.origin + along * segment.frame.axes.z_axis;
        }
        let (sin, cos) = sin_cos(TAU * along / segment.length);
        segment.frame.point(Vec3::new(radius * cos - radius, radius * sin, along))
    }

    /// The unit direction of the centre line at an offset in metres, helix included.
    pub fn tangent_at(&self, stem: usize, offset: f32) -> Vec3 {
        let segment = self.segment_at(stem, offset);
        let radius = self.stems[stem].helix_radius;
        if radius == 0.0 {
            return segment.frame.axes.z_axis;
        }
        let turn = TAU / segment.length;
        let (sin, cos) = sin_cos(turn * (offset - segment.offset));
        let speed = radius * turn;
        (segment.frame.axes * Vec3::new(-speed * sin, speed * cos, 1.0)).normalize()
    }

    /// The segment's axes, standing on the centre line at an offset in metres.
    pub fn frame_at(&self, stem: usize, offset: f32) -> Frame {
        let segment = self.segment_at(stem, offset);
        segment.frame.at(self.center_in(stem, segment, offset))
    }

    /// The radius in metres of `stem` at `z`, by taper alone.
    pub fn radius_at(&self, stem: usize, z: f32) -> f32 {
        self.stems[stem].radius_at(z)
    }
}

/// A leaf.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leaf {
    /// Its foot beyond the petiole: z along the leaf, y its upper normal.
    pub frame: Frame,
    /// Its length in metres.
    pub length: f32,
    /// Its width in metres.
    pub width: f32,
    /// The stem it grows on, an index into [`Stems::stems`].
    pub stem: u32,
}

content!(Leaf { frame, length, width, stem });
