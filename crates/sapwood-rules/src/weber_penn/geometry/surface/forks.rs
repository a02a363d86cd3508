//! Where clones leave the stem that they split from, and which of them share its ring there.

use glam::Vec2;
use sapwood_geom::Fork;

use super::Tubes;
use crate::weber_penn::Stems;

/// The forks of a batch, found stem by stem.
#[derive(Default)]
pub(super) struct Forks {
    /// The segments at whose ends clones leave, with the clones; ascending.
    leaving: Vec<(u32, u32)>,
    forks: Vec<Fork>,
    /// For each stem the fork that it stands on and which of its tubes it is.
    standing: Vec<Option<(u32, u32)>>,
    /// On the tube last laid.
    on_tube: Vec<(ForkedRing, u32, u32)>,
}

/// A ring that forks.
#[derive(Clone, Copy)]
pub(super) struct ForkedRing {
    /// Its number on the tube.
    pub(super) ring: usize,
    /// The segment at whose end it is.
    pub(super) segment: usize,
    /// Whether the tube begins there.
    pub(super) is_foot: bool,
}

impl Forks {
    pub(super) fn of(stems: &Stems) -> Self {
        let mut leaving: Vec<(u32, u32)> = (0..)
            .zip(&stems.stems)
            .filter_map(|(clone, stem)| Some((stems.segment_before(stem)? as u32, clone)))
            .collect();
        leaving.sort_unstable();
        Self { leaving, standing: vec![None; stems.stems.len()], ..Self::default() }
    }

    /// The clones that leave at the end of a segment.
    fn at(&self, segment: usize) -> &[(u32, u32)] {
        let from = self.leaving.partition_point(|(at, _)| (*at as usize) < segment);
        let to = self.leaving.partition_point(|(at, _)| *at as usize <= segment);
        &self.leaving[from..to]
    }

    pub(super) fn any_leave(&self, segment: usize) -> bool {
        !self.at(segment).is_empty()
    }

    /// The segment at whose end a clone stands on a fork, if it does.
    pub(super) fn foot_of(&self, stems: &Stems, index: usize) -> Option<usize> {
        (*self.standing.get(index)?)?;
        stems.segment_before(&stems.stems[index])
    }

    /// The rings that fork on the tube last laid, ascending, each with its fork and which of the
    /// fork's tubes the tube is.
    pub(super) fn on_tube(&self) -> impl Iterator<Item = (ForkedRing, &Fork, usize)> + '_ {
        self.on_tube
            .iter()
            .map(|(ring, fork, tube)| (*ring, &self.forks[*fork as usize], *tube as usize))
    }
}

impl Tubes<'_> {
    /// Finds the rings at which the tube last laid forks.
    pub(super) fn find_forks(&mut self, index: usize) {
        let stem = &self.stems.stems[index];
        self.forks.on_tube.clear();
        if let (Some((fork, tube)), Some(segment)) =
            (self.forks.standing[index], self.stems.segment_before(stem))
        {
            let foot = ForkedRing { ring: 0, segment, is_foot: true };
            self.forks.on_tube.push((foot, fork, tube));
        }
        let first = stem.first_segment as usize;
        for i in 0..self.ends.len().saturating_sub(1) {
            let (segment, Some(ring)) = (first + i, self.ends[i]) else { continue };
            if !self.forks.any_leave(segment) || !self.may_fork(ring) {
                continue;
            }
            let Some(start) = self.joints[segment].map(|joint| joint.start) else { continue };
            let tangent = start.tangent.unwrap_or(start.x);
            let y = tangent.cross(start.x);
            let toward = |segment: usize| {
                let onward = self.stems.segments[segment].frame.axes.z_axis;
                Vec2::new(onward.dot(start.x), onward.dot(y))
            };
            let mut tubes = vec![toward(segment + 1)];
            let mut clones = Vec::new();
            for (_, clone) in self.forks.at(segment) {
                let stem = &self.stems.stems[*clone as usize];
                let is_alike = self.key_of(stem) == self.sections[self.section].0;
                let onward = self.stems.segments[stem.first_segment as usize].frame.axes.z_axis;
                // From a ring that it leaves too much sideways a tube would be inside out.
                if is_alike && tangent.dot(onward) > 0.2 {
                    tubes.push(toward(stem.first_segment as usize));
                    clones.push(*clone);
                }
            }
            let Some(fork) = Fork::new(&self.sections[self.section].1, &tubes) else { continue };
            let number = self.forks.forks.len() as u32;
            self.forks.forks.push(fork);
            let ring = ForkedRing { ring, segment, is_foot: false };
            self.forks.on_tube.push((ring, number, 0));
            for (tube, clone) in (1..).zip(clones) {
                self.forks.standing[clone as usize] = Some((number, tube));
            }
        }
    }

    /// Whether tubes can leave a ring: it is wide enough, and what goes on from there is long
    /// enough, to be told apart from a point on any of them.
    fn may_fork(&self, ring: usize) -> bool {
        let Some(kept) = self.sweep.kept(ring) else { return false };
        let is_own = kept > 0 && self.sweep.kept(ring - 1) != Some(kept);
        let goes_on = kept + 1 < self.sweep.n_kept() && !self.sweep.is_point(kept);
        let (here, length) = (self.rings[ring], self.length());
        let far = here.center.abs().max_element();
        let least = 1e-5f32.max(1e-4 * length.0).max(1e-5 * far);
        is_own && goes_on && here.radius > least && length.1 > 1e-4 * here.radius.max(far)
    }

    /// The length of the stem last laid, and that of its segments.
    fn length(&self) -> (f32, f32) {
        let stem = &self.stems.stems[self.index];
        (stem.seed.length, stem.segment_length())
    }
}
