//! Pruning by the envelope that stands above a tree: which trees it concerns, and how long their
//! stems may be.
//!
//! Both are projections, so an envelope that is moved compiles again only the branches for which
//! something else comes out; a tree that lies wholly inside does not ask further.

use std::sync::Arc;

use glam::{Affine3, Vec3};
use sapwood_geom::{Content, Digester, Shared, Side};
use sapwood_scene::{Context, EnvelopeSlot, Placement, Projection, RuleError, SlotReader};

use super::super::growth::{Limit, Reach, fit_standing, is_attracted};
use super::super::slots::{
    CrownSlot, IsPrunedSlot, LevelSlot, PruneRatioSlot, RootsSlot, StemTargetSlot,
};
use super::super::{Crown, Level, StemSeed, Target};
use super::structure::upright;

/// A trial would have grown more rows than the view's budget allows parts.
struct TooMany;

/// The envelope as trees see it, if there is one that acts.
fn limit(slots: &mut SlotReader<'_>, from_tree: Affine3) -> Option<Limit> {
    let envelope = slots.read::<EnvelopeSlot>();
    let envelope = (*envelope).clone()?;
    let ratio = *slots.read::<PruneRatioSlot>();
    // Written so that a number that is not one leaves trees alone.
    if ratio > 0.0 {
        let to_world = *slots.read::<Placement>() * from_tree;
        Some(Limit::new(envelope, ratio).seen_through(to_world))
    } else {
        None
    }
}

/// Whether any of a tree's trunks may reach out of the envelope, with all that grows on them.
pub(super) struct IsPruned {
    /// Where trunks stand in tree space, and how long they are.
    pub(super) trunks: Vec<(Vec3, f32)>,
    pub(super) reach: Reach,
}

impl Content for IsPruned {
    fn write(&self, digester: &mut Digester) {
        digester.add(&self.reach).add(&self.trunks);
    }
}

impl Projection for IsPruned {
    type Output = bool;
    const NAME: &'static str = "weber_penn.is_pruned";

    fn compute(&self, slots: &mut SlotReader<'_>) -> bool {
        let Some(limit) = limit(slots, upright()) else { return false };
        let is_inside = |(foot, length): &(Vec3, f32)| {
            let bound = self.reach.bound(*foot, *length);
            bound.is_some_and(|bound| limit.side_of_box(&bound.aabb) == Side::Inside)
        };
        !self.trunks.iter().all(is_inside)
    }
}

/// How long stems may be under the envelope; in tree space.
struct Shares {
    seeds: Shared<Vec<StemSeed>>,
    /// Whether they are roots: these grow by parameters of their own, from the ground as trunks do.
    are_roots: bool,
    /// How many stems, segments and clones may be grown to be looked at and thrown away.
    most: u64,
}

impl Content for Shares {
    fn write(&self, digester: &mut Digester) {
        // Not how many may be tried: where that is too few, nothing that was read is remembered.
        digester.add(&self.seeds).add(&self.are_roots);
    }
}

impl Projection for Shares {
    /// Nothing where a trial grew too much; no shares where all stems are whole.
    type Output = Option<Vec<f32>>;
    const NAME: &'static str = "weber_penn.shares";

    fn compute(&self, slots: &mut SlotReader<'_>) -> Option<Vec<f32>> {
        let whole = Some(Vec::new());
        let Some(first) = self.seeds.first() else { return whole };
        let crown = slots.read::<CrownSlot>();
        // Both at once: a stem that the second shortens must not leave the first.
        let own = Limit::of_species(&crown, first.scale_tree);
        let limits: Vec<Limit> = own.into_iter().chain(limit(slots, Affine3::IDENTITY)).collect();
        if limits.is_empty() {
            return whole;
        }
        let (roots, levels);
        let level = if self.are_roots {
            roots = slots.read::<RootsSlot>();
            &roots.level
        } else {
            levels = match first.level {
                0 => slots.read::<LevelSlot<0>>(),
                1 => slots.read::<LevelSlot<1>>(),
                2 => slots.read::<LevelSlot<2>>(),
                _ => slots.read::<LevelSlot<3>>(),
            };
            &*levels
        };
        let up = || Arc::new(Target::Up);
        let target = if is_attracted(first.level) { slots.read::<StemTargetSlot>() } else { up() };
        let stand = self.are_roots || first.level == 0;
        let (seeds, trying) = (&self.seeds, &mut trying(self.most));
        let shares = fit_standing(stand, seeds, &crown, level, &target, &limits, trying).ok()?;
        Some(if shares.iter().all(|share| *share == 1.0) { Vec::new() } else { shares })
    }
}

/// Counts what is grown only to be thrown away.
fn trying(most: u64) -> impl FnMut(usize) -> Result<(), TooMany> {
    let mut left = most;
    move |rows| {
        left = left.checked_sub(rows as u64).ok_or(TooMany)?;
        Ok(())
    }
}

/// The seeds as long as the species' own envelope and the one above the tree let them be;
/// nothing where all are whole. Roots grow by the level of [`RootsSlot`].
pub(super) fn fitted(
    cx: &mut Context<'_>,
    seeds: &[StemSeed],
    crown: &Crown,
    level: &Level,
    target: &Target,
    are_roots: bool,
) -> Result<Option<Vec<StemSeed>>, RuleError> {
    let Some(first) = seeds.first() else { return Ok(None) };
    let most = cx.most_parts();
    let shares = if *cx.read::<IsPrunedSlot>() {
        cx.checkpoint()?;
        cx.project(Shares { seeds: Shared::new(seeds.to_vec()), are_roots, most })
    } else if let Some(limit) = Limit::of_species(crown, first.scale_tree) {
        cx.checkpoint()?;
        let stand = are_roots || first.level == 0;
        fit_standing(stand, seeds, crown, level, target, &[limit], &mut trying(most)).ok()
    } else {
        return Ok(None);
    };
    match shares {
        Some(shares) => Ok(shortened(seeds, &shares, crown)),
        None => {
            // As if all that had been kept.
            cx.reserve_parts(most.saturating_add(1))?;
            Ok(None)
        }
    }
}

fn shortened(seeds: &[StemSeed], shares: &[f32], crown: &Crown) -> Option<Vec<StemSeed>> {
    if shares.iter().all(|share| *share == 1.0) {
        return None;
    }
    let both = seeds.iter().zip(shares);
    Some(both.filter_map(|(seed, share)| seed.shortened(*share, crown)).collect())
}
