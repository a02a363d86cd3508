//! Trees as a whole, for rules that tell of them instead of drawing them.
//!
//! The tree is compiled into one [`TreeSurvey`], and that asks for branches, twigs and what grows
//! on them as ingredients: the very plans that views have which draw the tree. What is made of the
//! survey stands in `map` and `text`.

use glam::Mat3;
use sapwood_geom::{Content, Digester, Shared};
use sapwood_scene::{Context, Placement, Projection, Rule, RuleError, SlotReader};

use super::super::slots::{CrownSlot, DetailSlot, LeafTargetSlot, LeavesSlot};
use super::super::survey::{Figures, LeafTally, Survey};
use super::super::{
    Branch, Children, Leaves, Roots, StemSeed, Stems, SurveyedBranches, SurveyedGrowth, Tree,
    TreeSurvey, Twigs, leaves,
};
use super::leaves::HasLeaves;
use super::roots::HasRoots;
use super::structure::{Offspring, plant};

/// How many branches are asked for at once: what a component may be made of is limited, and for
/// each ingredient that is missing its rule begins again.
const AT_ONCE: usize = 32;

/// Chunks of branches that one component asks for.
const MOST_CHUNKS: usize = 128;

/// Compiles a tree into its survey.
pub(super) struct SurveyedTreeRule;

impl Rule for SurveyedTreeRule {
    type Component = Tree;
    type Data = ();
    const NAME: &'static str = "weber_penn.surveyed_tree";

    fn init(&self, tree: &Tree, cx: &mut Context<'_>) -> Result<(), RuleError> {
        plant(tree, cx, |trunks, _, cx| {
            cx.emit(TreeSurvey { seed: tree.seed, trunks: Shared::new(trunks) });
        })
    }
}

/// The figures of a tree, and what leads from tree space to axes along the world's.
pub(super) fn surveyed(
    tree: &TreeSurvey,
    cx: &mut Context<'_>,
) -> Result<(Figures, Mat3), RuleError> {
    let linear = cx.project(LinearPart);
    if linear.determinant() == 0.0 || !linear.is_finite() {
        let why = "a tree scaled to nothing has no figures".to_owned();
        return Err(RuleError::Failed(why));
    }
    let mut survey = Survey::default();
    branches(&tree.trunks, cx, &mut survey)?;
    Ok((Figures::of(&survey, &linear), linear))
}

/// Adds branches with everything on them.
fn branches(
    seeds: &[StemSeed],
    cx: &mut Context<'_>,
    survey: &mut Survey,
) -> Result<(), RuleError> {
    // However many there are, they come in no more chunks than a component may be made of.
    for seeds in seeds.chunks(AT_ONCE.max(seeds.len().div_ceil(MOST_CHUNKS))) {
        let seeds = Shared::new(seeds.to_vec());
        survey.extend(cx.ingredient::<Survey>(SurveyedBranches { seeds })?);
    }
    Ok(())
}

/// How a component is turned and scaled: whoever reads this does not notice where it is moved to.
struct LinearPart;

impl Content for LinearPart {
    fn write(&self, _: &mut Digester) {}
}

impl Projection for LinearPart {
    type Output = Mat3;
    const NAME: &'static str = "weber_penn.linear_part";

    fn compute(&self, slots: &mut SlotReader<'_>) -> Mat3 {
        slots.read::<Placement>().matrix3
    }
}

/// Compiles some branches into what they are and what grows on them.
pub(super) struct SurveyedBranchesRule;

impl Rule for SurveyedBranchesRule {
    type Component = SurveyedBranches;
    type Data = Survey;
    const NAME: &'static str = "weber_penn.surveyed_branches";

    fn init(&self, of: &SurveyedBranches, cx: &mut Context<'_>) -> Result<Survey, RuleError> {
        let mut survey = Survey::default();
        for seed in of.seeds.iter() {
            let stems = cx.ingredient::<Shared<Stems>>(Branch { seed: *seed })?;
            with_growth(stems, cx, &mut survey)?;
            if seed.level == 0 && !stems.stems.is_empty() && cx.project(HasRoots) {
                let roots = Roots { stems: stems.clone() };
                survey.roots.push(cx.ingredient::<Shared<Stems>>(roots)?.clone());
            }
        }
        Ok(survey)
    }
}

/// Adds stems and what grows on them.
fn with_growth(
    stems: &Shared<Stems>,
    cx: &mut Context<'_>,
    survey: &mut Survey,
) -> Result<(), RuleError> {
    if !stems.stems.is_empty() {
        survey.stems.push(stems.clone());
        survey.extend(cx.ingredient::<Survey>(SurveyedGrowth { stems: stems.clone() })?);
    }
    Ok(())
}

/// Compiles stems into what grows on them.
pub(super) struct SurveyedGrowthRule;

impl Rule for SurveyedGrowthRule {
    type Component = SurveyedGrowth;
    type Data = Survey;
    const NAME: &'static str = "weber_penn.surveyed_growth";

    fn init(&self, on: &SurveyedGrowth, cx: &mut Context<'_>) -> Result<Survey, RuleError> {
        let mut survey = Survey::default();
        let stems = on.stems.clone();
        let level = stems.stems.first().map_or(0, |first| u32::from(first.seed.level));
        let is_last = level + 1 >= cx.read::<CrownSlot>().levels;
        if is_last || cx.project(HasLeaves { level: level as u8 }) {
            let tally = cx.ingredient::<Shared<LeafTally>>(Leaves { stems: stems.clone() })?;
            survey.leaves.push(tally.clone());
        }
        if is_last {
            return Ok(survey);
        }
        match cx.ingredient::<Offspring>(Children { stems })? {
            Offspring::None => {}
            Offspring::Branches(seeds) => branches(seeds, cx, &mut survey)?,
            Offspring::Twigs(seeds) => {
                let stems = cx.ingredient::<Shared<Stems>>(Twigs { seeds: seeds.clone() })?;
                with_growth(stems, cx, &mut survey)?;
            }
        }
        Ok(survey)
    }
}

/// Counts and measures leaves, and draws none.
pub(super) struct LeafTallyRule;

impl Rule for LeafTallyRule {
    type Component = Leaves;
    type Data = Shared<LeafTally>;
    const NAME: &'static str = "weber_penn.leaf_tally";

    fn init(&self, on: &Leaves, cx: &mut Context<'_>) -> Result<Shared<LeafTally>, RuleError> {
        let crown = cx.read::<CrownSlot>();
        let params = cx.read::<LeavesSlot>();
        let detail = cx.read::<DetailSlot>();
        let target = cx.read::<LeafTargetSlot>();
        let level = on.stems.stems.first().map_or(0, |stem| stem.seed.level);
        let params = params.on_level(level, crown.levels).thinned(detail.leaves);
        let mut charge = |leaves: usize| cx.reserve_parts(leaves as u64);
        let leaves = leaves(&on.stems, &crown, &params, &target, &mut charge)?;
        Ok(Shared::new(LeafTally::of(&leaves)))
    }
}
