//! How finely stems are meshed: sides round them, rings along them, by level and as a whole.

use sapwood_geom::content;

use crate::weber_penn::{Stem, TrunkForm};

/// The most sides that a cross-section has.
const MOST_SIDES: f32 = 4096.0;

/// The most pieces that a stem's surface has along it.
const MOST_PIECES: u32 = 4096;

/// How finely stems are meshed, and how many leaves stand for all.
#[derive(Clone, Debug, PartialEq)]
pub struct Detail {
    /// 0 angular to 1 smooth: sides of a stem's cross-section; Arbaro's Smooth.
    pub smooth: f32,
    /// Factor on the number of sides, 1 for a tree seen from nearby; never fewer than 3 sides.
    pub sides: f32,
    /// Factor on the number of rings that curved profiles have between segment ends.
    pub rings: f32,
    /// Share of the segment ends that have a ring on stems of level 2 and above; the last end
    /// always has one.
    pub ends: f32,
    /// Share of the leaves that are drawn; fewer are larger, so that they cover as much.
    pub leaves: f32,
    /// Pixels along the edges of the images of bark and leaves, 1 to
    /// [`LARGEST_IMAGE`](sapwood_images::LARGEST_IMAGE).
    pub image_size: u32,
    /// Whether trunks are closed at the foot; all other stems begin inside their parent.
    pub closed_foot: bool,
    /// What stems of levels 0 to 3 have instead of what follows from the rest; deeper levels take the
    /// last.
    pub levels: [LevelDetail; 4],
}

content!(Detail { smooth, sides, rings, ends, leaves, image_size, closed_foot, levels });

/// How finely the stems of one level are meshed by somebody's own wish.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LevelDetail {
    /// Sides of the cross-section, 3 to 4096, before [`Detail::sides`] scales them. A stem that
    /// splits has at least 4.
    pub sides: Option<u32>,
    /// Pieces that the surface has along a whole stem, 1 to 4096, instead of one for each segment
    /// that grew; [`Detail::ends`] thins them as it does those. There are more where the profile is
    /// curved or clones leave, and fewer where two would be drawn into each other at a bend.
    pub segments: Option<u32>,
}

content!(LevelDetail { sides, segments });

impl Default for Detail {
    fn default() -> Self {
        Self {
            smooth: 0.5,
            sides: 1.0,
            rings: 1.0,
            ends: 1.0,
            leaves: 1.0,
            image_size: 256,
            closed_foot: true,
            levels: [LevelDetail::default(); 4],
        }
    }
}

impl Detail {
    /// A tree still to be recognised, in about a quarter of the triangles.
    pub fn draft() -> Self {
        Self {
            smooth: 0.0,
            sides: 0.5,
            rings: 0.25,
            ends: 0.0,
            leaves: 0.25,
            image_size: 64,
            ..Self::default()
        }
    }

    /// Sides of the cross-section of a stem of this level and base radius in metres: by level
    /// about 12, 6, 4 and 3, more where a branch is thick; or as many as its level
    /// [asks for](LevelDetail).
    pub fn n_sides(&self, level: u8, radius: f32) -> u32 {
        let factor = if self.sides > 0.0 { self.sides.min(64.0) } else { 0.0 };
        if let Some(sides) = self.of_level(level).sides {
            return (sides as f32 * factor).clamp(3.0, MOST_SIDES) as u32;
        }
        let smooth = self.smooth.clamp(0.0, 1.0);
        let by_level = match level {
            0 => 8.0 + 8.0 * smooth,
            1 => 4.0 + 4.0 * smooth,
            2 => 3.0 + 3.0 * smooth,
            _ => 3.0,
        };
        let by_radius = 3.0 + (8.0 + 8.0 * smooth) * radius.clamp(0.0, 1.0).sqrt();
        (by_level.max(by_radius) * factor).max(3.0) as u32
    }

    /// `n` rings for detail 1, at least `least`.
    pub(crate) fn n_rings(&self, n: f32, least: u32) -> u32 {
        ((n * self.rings.clamp(0.0, 16.0)).round() as u32).max(least)
    }

    /// What somebody wishes of a level.
    fn of_level(&self, level: u8) -> LevelDetail {
        self.levels[usize::from(level).min(3)]
    }

    /// How many pieces the surface has along segment `i` of a whole stem, where somebody has wished
    /// for a number of them: none where it has no ring at the segment's end.
    pub(super) fn n_pieces(&self, stem: &Stem, i: u32) -> Option<u32> {
        let wished = self.of_level(stem.seed.level).segments?.min(MOST_PIECES);
        let n = if stem.seed.level < 2 {
            wished
        } else {
            (wished as f32 * self.ends.clamp(0.0, 1.0)) as u32
        };
        let (n, of) = (u64::from(n.max(1)), u64::from(stem.curve_res.max(1)));
        // As many before the end of each segment as come nearest from below; all before the last.
        let before = |end: u64| end * n / of;
        Some((before(u64::from(i) + 1) - before(u64::from(i))) as u32)
    }

    /// Whether a stem of this level has a ring at the end of segment `i` of `n`, where nobody has
    /// wished for a number of pieces.
    pub(super) fn has_ring(&self, level: u8, i: usize, n: usize) -> bool {
        // How many of the first ends have one; rounded down, so that share 1 is all of them.
        let rings = |ends: usize| (ends as f32 * self.ends.clamp(0.0, 1.0)) as u32;
        level < 2 || i + 1 == n || rings(i) < rings(i + 1)
    }

    pub(super) fn section(&self, level: u8, radius: f32, form: &TrunkForm) -> SectionKey {
        if level == 0 && form.lobes > 0 && form.lobe_depth != 0.0 {
            // A multiple of four, so that points fall on peaks and hollows.
            let finer = (self.sides * (0.5 + self.smooth)).round().clamp(1.0, 16.0) as u32;
            let sides = match self.of_level(level).sides {
                Some(_) => self.n_sides(level, radius),
                None => form.lobes.saturating_mul(4 * finer).min(MOST_SIDES as u32),
            };
            return SectionKey { sides, lobed: true };
        }
        SectionKey { sides: self.n_sides(level, radius), lobed: false }
    }
}

/// What the cross-section of a stem is like.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) struct SectionKey {
    pub(super) sides: u32,
    pub(super) lobed: bool,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::weber_penn::{Frame, StemSeed};
    use sapwood_geom::StreamPath;

    fn stem(level: u8, curve_res: u32) -> Stem {
        let seed = StemSeed {
            path: StreamPath::new(0),
            level,
            frame: Frame::IDENTITY,
            length: 1.0,
            radius: 0.1,
            free_radius: 0.1,
            offset: 0.0,
            parent_length: 0.0,
            parent_radius: 0.0,
            length_child_max: 1.0,
            scale_tree: 1.0,
        };
        Stem {
            seed,
            seed_index: 0,
            first_segment: 0,
            n_segments: curve_res,
            curve_res,
            start: 0,
            clone_of: None,
            taper: 1.0,
            helix_radius: 0.0,
            length_base: 0.0,
        }
    }

    #[test]
    fn a_stem_has_as_many_pieces_as_its_level_asks_for() {
        for (segments, curve_res) in [(1, 5), (3, 5), (5, 5), (7, 5), (20, 3), (1000, 1)] {
            let mut detail = Detail::default();
            detail.levels[1].segments = Some(segments);
            let stem = stem(1, curve_res);
            let pieces = (0..curve_res).map(|i| detail.n_pieces(&stem, i).unwrap());
            assert_eq!(pieces.sum::<u32>(), segments, "{segments} of {curve_res}");
            assert!(detail.n_pieces(&stem, curve_res - 1) > Some(0), "one ends at the tip");
            assert_eq!(detail.n_pieces(&self::stem(2, curve_res), 0), None);
        }
        let mut detail = Detail::draft();
        detail.levels[3].segments = Some(8);
        assert_eq!(detail.n_pieces(&stem(5, 1), 0), Some(1), "twigs of a draft have one");
    }

    #[test]
    fn sides_are_those_that_a_level_asks_for() {
        let mut detail = Detail::default();
        detail.levels[2].sides = Some(7);
        assert_eq!((detail.n_sides(2, 0.3), detail.n_sides(1, 0.0)), (7, 6));
        detail.sides = 0.5;
        assert_eq!(detail.n_sides(2, 0.3), 3);
        detail.levels[0].sides = Some(13);
        let lobed = TrunkForm { lobes: 5, lobe_depth: 0.1, ..TrunkForm::new(&Default::default()) };
        detail.sides = 1.0;
        assert_eq!(detail.section(0, 0.3, &lobed).sides, 13);
    }
}
