//! The figures of a tree, in metres of the world that it stands in.

use glam::{Mat3, Vec2, Vec3};
use sapwood_geom::{Circle, convex_hull, smallest_circle};

use super::Survey;
use crate::weber_penn::Stems;

/// Points that a turn of a helix is measured at.
const POINTS_PER_TURN: u32 = 8;
/// How many of the longest branches are named.
const N_LONGEST: usize = 3;

/// What a tree comes to, in a frame with its axes along those of the world (y up) and its origin in
/// the tree's.
pub(in super::super) struct Figures {
    /// Where its trunks stand, each with its radius there.
    pub(in super::super) feet: Vec<(Vec3, f32)>,
    /// From the lowest foot to the highest point.
    pub(in super::super) height: f32,
    /// The height of the lowest foot.
    pub(in super::super) ground: f32,
    pub(in super::super) crown: Crown,
    /// By level, the trunks first.
    pub(in super::super) levels: Vec<LevelFigures>,
    /// The longest stems of the first level on the trunks, the longest first.
    pub(in super::super) longest: Vec<NamedBranch>,
    pub(in super::super) roots: LevelFigures,
    /// How far below the ground the roots reach.
    pub(in super::super) root_depth: f32,
    pub(in super::super) n_leaves: u64,
    /// How long the longest leaf is.
    pub(in super::super) leaf_length: f32,
}

/// What grows on the trunks, or the trunks themselves where nothing does.
#[derive(Default)]
pub(in super::super) struct Crown {
    /// Corners of the convex outline seen from above, as x and z of the frame; counter-clockwise
    /// with x to the right and z up, so clockwise with north up.
    pub(in super::super) outline: Vec<Vec2>,
    /// The smallest circle around it.
    pub(in super::super) disc: Circle,
    /// How high above the ground its lowest point lies.
    pub(in super::super) from: f32,
}

/// The stems of one level.
#[derive(Clone, Default)]
pub(in super::super) struct LevelFigures {
    pub(in super::super) n_stems: u64,
    /// How many of them split from others.
    pub(in super::super) n_clones: u64,
    pub(in super::super) shortest: f32,
    pub(in super::super) longest: f32,
    /// The lengths of all of them together.
    pub(in super::super) total: f64,
}

/// A stem that is long enough to be told of.
#[derive(Clone, Copy)]
pub(in super::super) struct NamedBranch {
    pub(in super::super) length: f32,
    /// How high above the ground it begins.
    pub(in super::super) height: f32,
    /// Where its tip lies from its foot, as x and z of the frame.
    pub(in super::super) toward: Vec2,
}

impl Figures {
    /// The figures of what grew, where `linear` leads from tree space to axes along the world's.
    pub(in super::super) fn of(survey: &Survey, linear: &Mat3) -> Self {
        let mut feet = Vec::new();
        let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
        let mut levels: Vec<LevelFigures> = Vec::new();
        let (mut trunks, mut above): (Vec<Vec3>, Vec<Vec3>) = Default::default();
        let mut longest: Vec<NamedBranch> = Vec::new();
        // What is scaled unevenly has no one thickness; it keeps its volume.
        let thickness = libm::cbrtf(linear.determinant().abs());
        for stems in &survey.stems {
            for (number, stem) in stems.stems.iter().enumerate() {
                let line = center_line(stems, number, linear);
                let (Some(foot), Some(tip)) = (line.first().copied(), line.last().copied()) else {
                    continue;
                };
                let length = length_of(&line);
                let level = usize::from(stem.seed.level);
                if levels.len() <= level {
                    levels.resize_with(level + 1, LevelFigures::default);
                }
                levels[level].add(length, stem.clone_of.is_some());
                high = line.iter().fold(high, |high, point| high.max(point.y));
                match level {
                    0 if stem.clone_of.is_none() => {
                        low = low.min(foot.y);
                        feet.push((foot, thickness * stem.radius_at(0.0)));
                    }
                    1 => {
                        let toward = Vec2::new(tip.x - foot.x, tip.z - foot.z);
                        longest.push(NamedBranch { length, height: foot.y, toward });
                    }
                    _ => {}
                }
                if level == 0 { &mut trunks } else { &mut above }.extend(line);
            }
        }
        for leaves in &survey.leaves {
            above.extend(leaves.tips.iter().map(|tip| *linear * *tip));
        }
        high = above.iter().fold(high, |high, point| high.max(point.y));
        // Of equal lengths the one that grew first.
        longest.sort_by(|a, b| b.length.total_cmp(&a.length));
        longest.truncate(N_LONGEST);
        let ground = if low.is_finite() { low } else { 0.0 };
        longest.iter_mut().for_each(|branch| branch.height -= ground);
        let (mut roots, mut lowest) = (LevelFigures::default(), ground);
        for stems in &survey.roots {
            for (number, stem) in stems.stems.iter().enumerate() {
                let line = center_line(stems, number, linear);
                roots.add(length_of(&line), stem.clone_of.is_some());
                lowest = line.iter().fold(lowest, |lowest, point| lowest.min(point.y));
            }
        }
        let tallies = || survey.leaves.iter();
        Self {
            feet,
            height: (high - ground).max(0.0),
            ground,
            crown: Crown::around(if above.is_empty() { &trunks } else { &above }, ground),
            levels,
            longest,
            roots,
            root_depth: ground - lowest,
            n_leaves: tallies().map(|leaves| leaves.tips.len() as u64).sum(),
            leaf_length: thickness * tallies().fold(0.0, |most: f32, some| most.max(some.length)),
        }
    }
}

impl Crown {
    fn around(points: &[Vec3], ground: f32) -> Self {
        let from = points.iter().fold(f32::INFINITY, |from, point| from.min(point.y));
        let outline = convex_hull(points.iter().map(|point| Vec2::new(point.x, point.z)));
        match smallest_circle(outline.iter().copied()) {
            Some(disc) => Self { outline, disc, from: from - ground },
            None => Self::default(),
        }
    }
}

impl LevelFigures {
    fn add(&mut self, length: f32, is_clone: bool) {
        self.shortest = if self.n_stems == 0 { length } else { self.shortest.min(length) };
        self.longest = self.longest.max(length);
        self.n_stems += 1;
        self.n_clones += u64::from(is_clone);
        self.total += f64::from(length);
    }
}

fn length_of(line: &[Vec3]) -> f32 {
    line.windows(2).map(|ends| ends[0].distance(ends[1])).sum()
}

/// The centre line of a stem, from its foot to its tip.
fn center_line(stems: &Stems, stem: usize, linear: &Mat3) -> Vec<Vec3> {
    let n = if stems.stems[stem].helix_radius == 0.0 { 1 } else { POINTS_PER_TURN };
    let segments = stems.segments_of(stem);
    let mut line = Vec::with_capacity(n as usize * segments.len() + 1);
    for segment in segments {
        let at = |i: u32| segment.offset + segment.length * i as f32 / n as f32;
        line.extend((0..n).map(|i| *linear * stems.center_in(stem, segment, at(i))));
    }
    line.extend(segments.last().map(|last| *linear * last.end()));
    line
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use sapwood_geom::{Shared, StreamPath};

    use super::*;
    use crate::weber_penn::survey::LeafTally;
    use crate::weber_penn::{
        Crown as CrownParams, LeafParams, LeafTarget, Level, Species, Target, children, grow,
        leaves, trunks,
    };

    fn survey(species: &Species) -> Survey {
        let free = &mut |_: usize| Ok::<(), Infallible>(());
        let crown = CrownParams::new(species);
        let levels = Level::all(species);
        let Ok(seeds) = trunks(&crown, &levels[0], StreamPath::new(7), free);
        let mut survey = Survey::default();
        let Ok(mut stems) = grow(&seeds, &crown, &levels[0], &Target::Up, free);
        for level in &levels[1..species.levels as usize] {
            let Ok(seeds) = children(&stems, &crown, None, level, free);
            survey.stems.push(Shared::new(stems));
            Ok(stems) = grow(&seeds, &crown, level, &Target::Up, free);
        }
        let params = LeafParams::new(species);
        let Ok(grown) = leaves(&stems, &crown, &params, &LeafTarget::Outward, free);
        survey.leaves.push(Shared::new(LeafTally::of(&grown)));
        survey.stems.push(Shared::new(stems));
        survey
    }

    /// From tree space, z up, to the world's axes, y up.
    fn upright() -> Mat3 {
        Mat3::from_cols(Vec3::X, Vec3::NEG_Z, Vec3::Y)
    }

    #[test]
    fn figures_are_those_of_what_grew() {
        let mut species = Species { scale: 8.0, ..Species::default() };
        species.leaves.count = 6;
        let survey = survey(&species);
        let figures = Figures::of(&survey, &upright());
        assert_eq!(figures.feet.len(), 1);
        assert!((figures.levels[0].longest - 8.0).abs() < 1e-4);
        let stems: u64 = figures.levels.iter().map(|level| level.n_stems).sum();
        assert_eq!(stems, survey.stems.iter().map(|stems| stems.stems.len() as u64).sum());
        assert_eq!(figures.n_leaves, survey.leaves[0].tips.len() as u64);
        // Every tip of a leaf lies in the disc, and the outline reaches to its border.
        let Circle { center, radius } = figures.crown.disc;
        let away = |x: f32, z: f32| Vec2::new(x, z).distance(center);
        for tip in &survey.leaves[0].tips {
            let tip = upright() * *tip;
            assert!(away(tip.x, tip.z) <= radius * 1.000_01);
            assert!(tip.y <= figures.height * 1.000_01 && tip.y >= figures.crown.from - 1e-4);
        }
        let farthest = figures.crown.outline.iter().map(|corner| away(corner.x, corner.y));
        assert!((farthest.fold(0.0, f32::max) - radius).abs() < 1e-4 * radius);
        assert!(figures.longest.is_sorted_by(|a, b| a.length >= b.length));
        assert_eq!(figures.longest[0].length, figures.levels[1].longest);
    }

    #[test]
    fn a_tree_twice_as_large_has_figures_twice_as_large() {
        let survey = survey(&Species::default());
        let once = Figures::of(&survey, &upright());
        let twice = Figures::of(&survey, &(2.0 * upright()));
        let pairs = [
            (once.height, twice.height),
            (once.crown.disc.radius, twice.crown.disc.radius),
            (once.crown.from, twice.crown.from),
            (once.feet[0].1, twice.feet[0].1),
            (once.longest[0].length, twice.longest[0].length),
        ];
        for (once, twice) in pairs {
            assert!((2.0 * once - twice).abs() < 1e-4 * twice.abs(), "{once} {twice}");
        }
    }

    #[test]
    fn nothing_has_no_figures() {
        let figures = Figures::of(&Survey::default(), &upright());
        assert_eq!((figures.height, figures.n_leaves, figures.levels.len()), (0.0, 0, 0));
        assert!(figures.crown.outline.is_empty());
    }
}
