//! What grows where: trees into branches, branches into children, and children into branches or
//! twigs.

use std::sync::Arc;

use glam::{Affine3, Vec3};
use sapwood_geom::{Content, Digest, Digester, Shared, StreamPath};
use sapwood_graph::{Interrupted, Named};
use sapwood_scene::{ChildPath, Context, Placement, Projection, Rule, RuleError, SlotReader};

use super::super::growth::{Reach, children_on, is_attracted};
use super::super::slots::{
    CrownSlot, DetailSlot, FadingSlot, IsPrunedSlot, LeafTargetSlot, LeavesSlot, LevelSlot,
    RootsSlot, StemTargetSlot, TrunkFormSlot,
};
use super::super::{
    Branch, Children, Crown, LeafTarget, Leaves, Level, Seed, Segment, Stem, StemSeed, StemSurface,
    Stems, Target, Tree, Twigs, grow, trunks,
};
use super::leaves::emit_leaves_beside;
use super::pruning::{IsPruned, fitted};
use super::roots::emit_roots;

/// The parameters of a level.
pub(super) fn level(cx: &mut Context<'_>, n: usize) -> Arc<Level> {
    match n {
        0 => cx.read::<LevelSlot<0>>(),
        1 => cx.read::<LevelSlot<1>>(),
        2 => cx.read::<LevelSlot<2>>(),
        _ => cx.read::<LevelSlot<3>>(),
    }
}

/// Charges rows of stems, segments or seeds to the budget of parts.
pub(super) fn charging<'c>(
    cx: &'c mut Context<'_>,
) -> impl FnMut(usize) -> Result<(), Interrupted> + 'c {
    |rows| cx.reserve_parts(rows as u64)
}

/// Turns tree space, z up, into the frame of the component, y up.
pub(super) fn upright() -> Affine3 {
    // Exact quarter turn: z to y, y to -z.
    Affine3::from_cols(Vec3::X, Vec3::NEG_Z, Vec3::Y, Vec3::ZERO)
}

/// Compiles a tree into its trunks.
pub(super) struct TreeRule;

impl Rule for TreeRule {
    type Component = Tree;
    type Data = ();
    const NAME: &'static str = "weber_penn.tree";

    fn init(&self, tree: &Tree, cx: &mut Context<'_>) -> Result<(), RuleError> {
        plant(tree, cx, |seeds, reach, cx| {
            for (key, seed) in (0..).zip(seeds) {
                let foreseen = reach.bound(seed.frame.origin, seed.length);
                cx.emit_keyed(key, Branch { seed }, foreseen);
            }
        })
    }
}

/// Finds the trunks of a tree, and adds what `emit` makes of them where they stand: in tree space,
/// below what the tree sets for all its stems.
pub(super) fn plant(
    tree: &Tree,
    cx: &mut Context<'_>,
    emit: impl FnOnce(Vec<StemSeed>, Reach, &mut Context<'_>),
) -> Result<(), RuleError> {
    let path = match tree.seed {
        Seed::Explicit(seed) => StreamPath::new(seed),
        Seed::Path => *cx.read::<ChildPath>(),
        Seed::Position { cell } if cell > 0.0 => cx.project(CellOf { cell }),
        Seed::Position { cell } => {
            return Err(RuleError::Failed(format!("seed cells of {cell} m have no size")));
        }
    };
    let crown = cx.read::<CrownSlot>();
    let trunk = level(cx, 0);
    let leaf_target = cx.project(LeafTargetInWorld);
    let upright = upright();
    let (stem_target, leaf_target) = match (&crown.target, &leaf_target) {
        (Target::Up, LeafTarget::Outward | LeafTarget::Scattered) => (Target::Up, leaf_target),
        _ => {
            let to_tree = (*cx.read::<Placement>() * upright).inverse();
            if !to_tree.is_finite() {
                return Err(RuleError::Failed(
                    "a tree scaled to nothing cannot turn toward a target in the world".into(),
                ));
            }
            (stem_target_in(&crown.target, &to_tree), leaf_target_in(&leaf_target, &to_tree))
        }
    };
    let seeds = trunks(&crown, &trunk, path, &mut charging(cx))?;
    let mut reach = cx.project(ForeseenReach { topped: false });
    let trunks = seeds.iter().map(|seed| (seed.frame.origin, seed.length)).collect();
    let is_pruned = cx.project(IsPruned { trunks, reach });
    if is_pruned {
        reach = cx.project(ForeseenReach { topped: true });
    }
    cx.transform(upright, |cx| {
        cx.push::<IsPrunedSlot>(is_pruned, |cx| {
            cx.push::<StemTargetSlot>(stem_target, |cx| {
                cx.push::<LeafTargetSlot>(leaf_target, |cx| emit(seeds, reach, cx));
            });
        });
    });
    Ok(())
}

/// How far a trunk may reach with everything on it, in steps: most edits of a level make another
/// tree within the same step, and the tree's own plan stays.
struct ForeseenReach {
    /// Whether trunks may have been shortened by an envelope.
    topped: bool,
}

impl Content for ForeseenReach {
    fn write(&self, digester: &mut Digester) {
        digester.add(&self.topped);
    }
}

impl Projection for ForeseenReach {
    type Output = Reach;
    const NAME: &'static str = "weber_penn.foreseen_reach";

    fn compute(&self, slots: &mut SlotReader<'_>) -> Reach {
        let crown = slots.read::<CrownSlot>();
        let trunk = slots.read::<LevelSlot<0>>();
        // What no stem grows by is not read.
        let mut levels = [trunk.clone(), trunk.clone(), trunk.clone(), trunk];
        if crown.levels > 1 {
            levels[1] = slots.read::<LevelSlot<1>>();
        }
        if crown.levels > 2 {
            levels[2] = slots.read::<LevelSlot<2>>();
        }
        if crown.levels > 3 {
            levels[3] = slots.read::<LevelSlot<3>>();
        }
        let form = slots.read::<TrunkFormSlot>();
        let share = slots.read::<DetailSlot>().leaves;
        let leaves = slots.read::<LeavesSlot>().longest_thinned(share);
        let levels = levels.each_ref().map(|level| &**level);
        let reach = Reach::new(&crown, levels, &form, &leaves, self.topped);
        let reach = reach.with_roots(&slots.read::<RootsSlot>(), &crown, levels[0]);
        let fading = slots.read::<FadingSlot>();
        reach.with_leaves_grown(fading.largest_growth()).rounded_up(crown.scale)
    }
}

fn stem_target_in(target: &Target, to_tree: &Affine3) -> Target {
    match *target {
        Target::Up => Target::Up,
        Target::Direction(v) => Target::Direction(to_tree.transform_vector3(v)),
        Target::Point(p) => Target::Point(to_tree.transform_point3(p)),
    }
}

fn leaf_target_in(target: &LeafTarget, to_tree: &Affine3) -> LeafTarget {
    match *target {
        LeafTarget::Outward => LeafTarget::Outward,
        LeafTarget::Scattered => LeafTarget::Scattered,
        LeafTarget::Direction(v) => LeafTarget::Direction(to_tree.transform_vector3(v)),
        LeafTarget::Point(p) => LeafTarget::Point(to_tree.transform_point3(p)),
    }
}

/// The stream path of the cell in which a tree stands.
struct CellOf {
    cell: f32,
}

impl Content for CellOf {
    fn write(&self, digester: &mut Digester) {
        self.cell.write(digester);
    }
}

impl Projection for CellOf {
    type Output = StreamPath;
    const NAME: &'static str = "weber_penn.cell";

    fn compute(&self, slots: &mut SlotReader<'_>) -> StreamPath {
        let place = slots.read::<Placement>().translation;
        let path = StreamPath::new(0);
        place.to_array().into_iter().fold(path, |path, x| {
            // Cells are centred on multiples of their size, so that a tree at the origin does
            // not change by a rounding error.
            let cell = (f64::from(x) / f64::from(self.cell)).round() as i64;
            path.child(cell.cast_unsigned())
        })
    }
}

/// What the leaves turn toward, in the world; the rest of the leaves is none of the tree's
/// business.
struct LeafTargetInWorld;

impl Content for LeafTargetInWorld {
    fn write(&self, _: &mut Digester) {}
}

impl Projection for LeafTargetInWorld {
    type Output = LeafTarget;
    const NAME: &'static str = "weber_penn.leaf_target_in_world";

    fn compute(&self, slots: &mut SlotReader<'_>) -> LeafTarget {
        slots.read::<LeavesSlot>().target
    }
}

/// Compiles a branch into its stem with clones, and what grows on it.
pub(super) struct BranchRule;

impl Rule for BranchRule {
    type Component = Branch;
    type Data = Shared<Stems>;
    const NAME: &'static str = "weber_penn.branch";

    fn init(&self, branch: &Branch, cx: &mut Context<'_>) -> Result<Shared<Stems>, RuleError> {
        let stems = branch_stems(branch, cx)?;
        emit_grown(&stems, cx);
        emit_roots(&stems, cx);
        Ok(stems)
    }
}

/// The stems of a branch, added as parts.
pub(super) fn branch_stems(
    branch: &Branch,
    cx: &mut Context<'_>,
) -> Result<Shared<Stems>, RuleError> {
    grown(cx, std::slice::from_ref(&branch.seed), Digest::of(branch))
}

/// Emits what draws stems, and what grows on them.
pub(super) fn emit_grown(stems: &Shared<Stems>, cx: &mut Context<'_>) {
    if !stems.stems.is_empty() {
        cx.emit(StemSurface { stems: stems.clone() });
        emit_growth(stems, cx);
    }
}

/// The first level whose stems are compiled in batches, all of a branch together: a component
/// for each would cost more than the stem itself.
const FIRST_IN_BATCHES: usize = 2;

/// Compiles what grows on stems into branches, or into twigs beyond those and on the last level.
pub(super) struct ChildrenRule;

/// What grows on stems, for whoever asks for it as an ingredient.
pub(super) enum Offspring {
    None,
    /// A branch for each seed.
    Branches(Shared<Vec<StemSeed>>),
    /// One batch of twigs.
    Twigs(Shared<Vec<StemSeed>>),
}

impl Content for Offspring {
    fn write(&self, digester: &mut Digester) {
        match self {
            Self::None => digester.add(&0u8),
            Self::Branches(seeds) => digester.add(&1u8).add(seeds),
            Self::Twigs(seeds) => digester.add(&2u8).add(seeds),
        };
    }
}

impl Rule for ChildrenRule {
    type Component = Children;
    type Data = Offspring;
    const NAME: &'static str = "weber_penn.children";

    fn init(&self, parents: &Children, cx: &mut Context<'_>) -> Result<Offspring, RuleError> {
        let offspring = offspring(parents, cx, &mut |_| ())?;
        match &offspring {
            Offspring::None => {}
            Offspring::Branches(seeds) => {
                seeds.iter().for_each(|seed| cx.emit(Branch { seed: *seed }))
            }
            Offspring::Twigs(seeds) => cx.emit(Twigs { seeds: seeds.clone() }),
        }
        emit_leaves_beside(parents, cx);
        Ok(offspring)
    }
}

/// What grows on stems; `on` is told for each seed the segment that it grows on.
pub(super) fn offspring(
    parents: &Children,
    cx: &mut Context<'_>,
    on: &mut impl FnMut(usize),
) -> Result<Offspring, RuleError> {
    let stems = &parents.stems;
    let Some(parent) = stems.stems.first() else { return Ok(Offspring::None) };
    let n = usize::from(parent.seed.level) + 1;
    let crown = cx.read::<CrownSlot>();
    let form = (n == 1).then(|| cx.read::<TrunkFormSlot>());
    let level = level(cx, n);
    let seeds = children_on(stems, &crown, form.as_deref(), &level, &mut charging(cx), on)?;
    if seeds.is_empty() {
        return Ok(Offspring::None);
    }
    if n < FIRST_IN_BATCHES && n as u32 + 1 < crown.levels {
        return Ok(Offspring::Branches(Shared::new(seeds)));
    }
    Ok(Offspring::Twigs(match form {
        // The seeds follow from these alone, so there is no need to read them all.
        None => {
            let mut digester = Digester::new();
            digester.add(Twigs::NAME).add(stems).add(&*crown).add(&*level);
            Shared::with_digest(digester.finish(), seeds)
        }
        // A trunk's form seldom changes what grows on it.
        Some(_) => Shared::new(seeds),
    }))
}

/// Compiles the stems of one level on one branch, and what grows on them.
pub(super) struct TwigsRule;

impl Rule for TwigsRule {
    type Component = Twigs;
    type Data = Shared<Stems>;
    const NAME: &'static str = "weber_penn.twigs";

    fn init(&self, twigs: &Twigs, cx: &mut Context<'_>) -> Result<Shared<Stems>, RuleError> {
        let stems = twig_stems(twigs, cx)?;
        emit_grown(&stems, cx);
        Ok(stems)
    }
}

/// The stems of twigs, added as parts.
pub(super) fn twig_stems(twigs: &Twigs, cx: &mut Context<'_>) -> Result<Shared<Stems>, RuleError> {
    grown(cx, &twigs.seeds, Digest::of(twigs))
}

/// Emits what grows on stems: the next level, or leaves on the last. Leaves on any other level are
/// emitted with the next one, so that stems which get some do not grow again.
fn emit_growth(stems: &Shared<Stems>, cx: &mut Context<'_>) {
    let Some(first) = stems.stems.first() else { return };
    if u32::from(first.seed.level) + 1 < cx.read::<CrownSlot>().levels {
        cx.emit(Children { stems: stems.clone() });
    } else {
        cx.emit(Leaves { stems: stems.clone() });
    }
}

/// Grows stems of one level and adds them as parts. `origin` is the digest of the seeds.
fn grown(
    cx: &mut Context<'_>,
    seeds: &[StemSeed],
    origin: Digest,
) -> Result<Shared<Stems>, RuleError> {
    let Some(first) = seeds.first() else { return Ok(Shared::new(Stems::default())) };
    let crown: Arc<Crown> = cx.read::<CrownSlot>();
    // A tree that is turned must not regrow the stems that no target attracts.
    let target =
        if is_attracted(first.level) { cx.read::<StemTargetSlot>() } else { Arc::new(Target::Up) };
    let level = level(cx, usize::from(first.level));
    let fitted = fitted(cx, seeds, &crown, &level, &target, false)?;
    let origin = fitted.as_ref().map_or(origin, Digest::of);
    let seeds = fitted.as_deref().unwrap_or(seeds);
    let stems = grow(seeds, &crown, &level, &target, &mut charging(cx))?;
    // The stems follow from these alone, so there is no need to read all segments again for
    // their digest.
    let mut digester = Digester::new();
    digester.add(Stem::NAME).add(&origin).add(&*crown).add(&*target).add(&*level);
    let stems = Shared::with_digest(digester.finish(), stems);
    add_stem_parts(&stems, cx);
    Ok(stems)
}

/// Adds stems and their segments as parts.
pub(super) fn add_stem_parts(stems: &Shared<Stems>, cx: &mut Context<'_>) {
    cx.parts::<Stem>(StemRows(stems.clone()));
    cx.parts::<Segment>(SegmentRows(stems.clone()));
}

/// The stems of a batch as parts.
struct StemRows(Shared<Stems>);

impl AsRef<[Stem]> for StemRows {
    fn as_ref(&self) -> &[Stem] {
        &self.0.stems
    }
}

/// The segments of a batch as parts.
struct SegmentRows(Shared<Stems>);

impl AsRef<[Segment]> for SegmentRows {
    fn as_ref(&self) -> &[Segment] {
        &self.0.segments
    }
}
