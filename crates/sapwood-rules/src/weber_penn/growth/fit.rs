//! How long stems may grow under an envelope (Weber and Penn 1995, section 4.6).
//!
//! A stem is tried with its clones and without children; it is shortened until all its segments
//! end inside, by the same draws, or given up. Where the envelope comes from is left to others.

use std::ops::Range;

use glam::{Affine3, Vec3};
use sapwood_geom::{Aabb, Envelope, Profile, Side, Sphere};

use super::children::{THINNEST, held_radius};
use super::grow::grow;
use super::stem::{StemSeed, Stems};
use crate::weber_penn::{Crown, Level, PruningParams, Target};

/// Halvings of the interval in which the greatest length that fits is sought: it is found to
/// 1/4096 of the whole.
const HALVINGS: u32 = 12;

/// Stems that would be shortened to less than this share of the tree's size are given up
/// (Arbaro's).
const SHORTEST_FITTING: f32 = 0.001;

/// By how much a length that a rounding let through is taken back, and how often.
const TAKEN_BACK: f32 = 1.0 - 1.0 / 1024.0;
const MOST_TAKEN_BACK: u32 = 16;

/// An envelope, and how firmly stems are held inside of it.
#[derive(Clone, Debug)]
pub struct Limit {
    envelope: Envelope,
    to_envelope: Option<Affine3>,
    ratio: f32,
    holds_trunks: bool,
}

impl Limit {
    /// An envelope that stands in tree space. `ratio` is the paper's PruneRatio: 0 leaves stems
    /// alone, 1 holds them fully inside.
    ///
    /// Trunks and roots are shortened where they leave the envelope again after they were inside;
    /// what stands outside from its foot is kept.
    pub fn new(envelope: Envelope, ratio: f32) -> Self {
        Self { envelope, to_envelope: None, ratio, holds_trunks: true }
    }

    /// The same envelope in the frame that `to_envelope` leads to from tree space.
    pub fn seen_through(self, to_envelope: Affine3) -> Self {
        Self { to_envelope: Some(to_envelope), ..self }
    }

    /// What a species prunes itself by, if it does: the shape that it names, or else the paper's
    /// solid of revolution for a tree of this size in metres. That one shapes crowns and does not
    /// hold trunks.
    pub fn of_species(crown: &Crown, scale_tree: f32) -> Option<Self> {
        let PruningParams { ratio, width, width_peak, power_low, power_high, ref envelope } =
            crown.pruning;
        if ratio <= 0.0 {
            return None;
        }
        if let Some(envelope) = envelope {
            return Some(Self::new(envelope.clone(), ratio));
        }
        let envelope = Envelope::revolution(Profile {
            base: crown.base_size * scale_tree,
            top: scale_tree,
            width: width * scale_tree,
            peak: width_peak,
            power_low,
            power_high,
        });
        Some(Self { envelope, to_envelope: None, ratio, holds_trunks: false })
    }

    /// On which side everything within these metres of a point in tree space lies.
    fn side_of(&self, sphere: Sphere) -> Side {
        let sphere = self.to_envelope.map_or(sphere, |to| sphere.transformed(&to));
        self.envelope.side_of(&sphere)
    }

    /// On which side a box in tree space lies.
    pub fn side_of_box(&self, aabb: &Aabb) -> Side {
        let aabb = self.to_envelope.map_or(*aabb, |to| aabb.transformed(&to));
        self.envelope.side_of_box(&aabb)
    }

    fn contains(&self, point: Vec3) -> bool {
        let point = self.to_envelope.map_or(point, |to| to.transform_point3(point));
        self.envelope.contains(point)
    }
}

/// How long each of the stems that grow from `seeds` may be under limits, as a share of its
/// length: 1 leaves it as it is, 0 gives it up.
///
/// Limits with a ratio below 1 come first, one after the other, and blend the shares by it; then
/// all that hold fully at once, so that what one of them shortens does not leave another. Nothing
/// is grown for stems that lie wholly to one side of each envelope. `level`, `target` and `charge`
/// are those of [`grow`], which is asked twice for the others, and more often where stems turn
/// toward a point.
pub fn fit<E>(
    seeds: &[StemSeed],
    crown: &Crown,
    level: &Level,
    target: &Target,
    limits: &[Limit],
    charge: &mut impl FnMut(usize) -> Result<(), E>,
) -> Result<Vec<f32>, E> {
    let are_trunks = seeds.first().is_some_and(|first| first.level == 0);
    fit_standing(are_trunks, seeds, crown, level, target, limits, charge)
}

/// As [`fit`]; `stand` tells whether the stems begin at the ground, as trunks and roots do, and are
/// kept where they stand outside from their foot.
pub(crate) fn fit_standing<E>(
    stand: bool,
    seeds: &[StemSeed],
    crown: &Crown,
    level: &Level,
    target: &Target,
    limits: &[Limit],
    charge: &mut impl FnMut(usize) -> Result<(), E>,
) -> Result<Vec<f32>, E> {
    let mut shares = vec![1.0; seeds.len()];
    let soft = limits.iter().filter(|limit| limit.ratio < 1.0);
    let firm: Vec<&Limit> = limits.iter().filter(|limit| limit.ratio >= 1.0).collect();
    let steps = soft.map(|limit| vec![limit]).chain((!firm.is_empty()).then_some(firm));
    for limits in steps {
        // What earlier limits left; a stem's radius is nothing to its shape.
        let left: Vec<StemSeed> =
            seeds.iter().zip(&shares).map(|(seed, share)| scaled(seed, *share)).collect();
        let ratio = limits.first().map_or(1.0, |limit| limit.ratio.clamp(0.0, 1.0));
        let trial = Trial { crown, level, target, limits: &limits, stand };
        let fitting = trial.shares(&left, charge)?;
        for (share, fitting) in shares.iter_mut().zip(fitting) {
            *share *= 1.0 - (1.0 - fitting) * ratio;
        }
    }
    Ok(shares)
}

impl StemSeed {
    /// The seed of the same stem at a share of its length; nothing if it does not grow then.
    ///
    /// The base radius follows from the new length, as the paper has it.
    pub fn shortened(&self, share: f32, crown: &Crown) -> Option<Self> {
        if share >= 1.0 {
            return Some(*self);
        }
        let thinner = match self.level {
            0 => share,
            _ => libm::powf(share, crown.ratio_power),
        };
        let free_radius = self.free_radius * thinner;
        let radius = match self.level {
            0 => free_radius,
            _ => held_radius(free_radius, self.parent_radius, crown),
        };
        let grows = share > 0.0 && radius > THINNEST;
        grows.then_some(Self { length: share * self.length, radius, free_radius, ..*self })
    }
}

/// Growth that is looked at and thrown away.
struct Trial<'a> {
    crown: &'a Crown,
    level: &'a Level,
    target: &'a Target,
    /// All of these at once.
    limits: &'a [&'a Limit],
    /// Whether stems begin at the ground.
    stand: bool,
}

impl Trial<'_> {
    /// The greatest shares that fit.
    fn shares<E>(
        &self,
        seeds: &[StemSeed],
        charge: &mut impl FnMut(usize) -> Result<(), E>,
    ) -> Result<Vec<f32>, E> {
        let mut shares = vec![1.0; seeds.len()];
        let mut doubtful = Vec::new();
        for (i, seed) in seeds.iter().enumerate() {
            match self.side_of(seed) {
                Side::Inside => {}
                Side::Outside => shares[i] = 0.0,
                Side::Crossing => doubtful.push(i),
            }
        }
        if !doubtful.is_empty() {
            self.fit(seeds, &doubtful, &mut shares, charge)?;
        }
        for (seed, share) in seeds.iter().zip(&mut shares) {
            if *share < 1.0 && *share * seed.length < SHORTEST_FITTING * seed.scale_tree {
                *share = 0.0;
            }
        }
        Ok(shares)
    }

    /// The limits that hold the stems.
    fn holding(&self) -> impl Iterator<Item = &Limit> {
        self.limits.iter().copied().filter(|limit| !self.stand || limit.holds_trunks)
    }

    /// On which side of the limits a stem lies; what stands outside from its foot as a trunk does
    /// is as good as inside.
    fn side_of(&self, seed: &StemSeed) -> Side {
        // Segments end within the stem's length of its base.
        let reach = Sphere { center: seed.frame.origin, radius: 1.001 * seed.length };
        let mut side = Side::Inside;
        for limit in self.holding() {
            match limit.side_of(reach) {
                Side::Inside => {}
                Side::Outside if self.stand => {}
                Side::Outside => return Side::Outside,
                Side::Crossing => side = Side::Crossing,
            }
        }
        side
    }

    /// Finds the shares of the doubtful ones among the seeds.
    fn fit<E>(
        &self,
        seeds: &[StemSeed],
        doubtful: &[usize],
        shares: &mut [f32],
        charge: &mut impl FnMut(usize) -> Result<(), E>,
    ) -> Result<(), E> {
        let tried: Vec<StemSeed> = doubtful.iter().map(|i| seeds[*i]).collect();
        let stems = self.grown(&tried, charge)?;
        let mut shortened = Vec::new();
        for (place, stems_of) in by_seed(&stems, tried.len()).enumerate() {
            let base = tried[place].frame.origin;
            let share = if self.fits(&stems, stems_of.clone(), base, 1.0) {
                continue;
            } else if self.keeps_shape(tried[place].level) {
                // The same draws and the same turns: shorter stems are scaled ones.
                longest(|share| Ok(self.fits(&stems, stems_of.clone(), base, share)))?
            } else {
                longest(|share| self.fits_grown(&tried[place], share, charge))?
            };
            shares[doubtful[place]] = share;
            shortened.push(place);
        }
        // Scaling rounds otherwise than growing does.
        for _ in 0..MOST_TAKEN_BACK {
            shortened.retain(|place| shares[doubtful[*place]] > 0.0);
            if shortened.is_empty() {
                return Ok(());
            }
            let shorter = |place: &usize| scaled(&tried[*place], shares[doubtful[*place]]);
            let again: Vec<StemSeed> = shortened.iter().map(shorter).collect();
            let stems = self.grown(&again, charge)?;
            let mut ranges = by_seed(&stems, again.len());
            shortened.retain(|place| {
                let stems_of = ranges.next().unwrap_or_default();
                let is_out = !self.fits(&stems, stems_of, tried[*place].frame.origin, 1.0);
                if is_out {
                    shares[doubtful[*place]] *= TAKEN_BACK;
                }
                is_out
            });
        }
        shortened.iter().for_each(|place| shares[doubtful[*place]] = 0.0);
        Ok(())
    }

    /// Whether a shorter stem of this level has the shape of the longer one: turns toward a
    /// point depend on where a segment stands.
    fn keeps_shape(&self, level: u8) -> bool {
        !super::is_attracted(level) || !matches!(self.target, Target::Point(_))
    }

    fn grown<E>(
        &self,
        seeds: &[StemSeed],
        charge: &mut impl FnMut(usize) -> Result<(), E>,
    ) -> Result<Stems, E> {
        grow(seeds, self.crown, self.level, self.target, charge)
    }

    fn fits_grown<E>(
        &self,
        seed: &StemSeed,
        share: f32,
        charge: &mut impl FnMut(usize) -> Result<(), E>,
    ) -> Result<bool, E> {
        let stems = self.grown(&[scaled(seed, share)], charge)?;
        Ok(self.fits(&stems, 0..stems.stems.len(), seed.frame.origin, 1.0))
    }

    /// Whether a stem and its clones fit, were they scaled by `share` about `base`: all segments
    /// end inside; those of what stands do once one did.
    fn fits(&self, stems: &Stems, range: Range<usize>, base: Vec3, share: f32) -> bool {
        self.holding().all(|limit| {
            let is_inside = |end: Vec3| limit.contains(base + share * (end - base));
            if !self.stand {
                return range.clone().all(|stem| {
                    stems.segments_of(stem).iter().all(|segment| is_inside(segment.end()))
                });
            }
            standing_fits(stems, range.clone(), base, &is_inside)
        })
    }
}

/// Whether a trunk or root and its clones leave nothing that they were inside of.
fn standing_fits(
    stems: &Stems,
    range: Range<usize>,
    base: Vec3,
    is_inside: &dyn Fn(Vec3) -> bool,
) -> bool {
    let Some(first) = stems.stems.get(range.start) else { return true };
    let first = first.first_segment as usize;
    let mut inside: Vec<bool> = Vec::new();
    for stem in &stems.stems[range] {
        let before = stem.clone_of.map(|origin| {
            let origin = &stems.stems[origin as usize];
            (origin.first_segment + stem.start - 1 - origin.start) as usize - first
        });
        let mut was_inside = before.map_or_else(|| is_inside(base), |before| inside[before]);
        for segment in &stems.segments[stem.segment_range()] {
            let is = is_inside(segment.end());
            if was_inside && !is {
                return false;
            }
            was_inside = is;
            inside.push(is);
        }
    }
    true
}

/// The same seed with a share of its length, its radius left aside.
fn scaled(seed: &StemSeed, share: f32) -> StemSeed {
    StemSeed { length: share * seed.length, ..*seed }
}

/// The stems of each seed: they stand one after the other.
fn by_seed(stems: &Stems, n_seeds: usize) -> impl Iterator<Item = Range<usize>> + '_ {
    let mut next = 0;
    (0..n_seeds).map(move |seed| {
        let first = next;
        let n = stems.stems[first..].iter().take_while(|s| s.seed_index as usize == seed).count();
        next = first + n;
        first..next
    })
}

/// The greatest share below 1 that fits, by halving; 0 where none was met.
fn longest<E>(mut fits: impl FnMut(f32) -> Result<bool, E>) -> Result<f32, E> {
    let (mut fitting, mut too_long) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (fitting + too_long);
        if fits(middle)? { fitting = middle } else { too_long = middle }
    }
    Ok(fitting)
}
