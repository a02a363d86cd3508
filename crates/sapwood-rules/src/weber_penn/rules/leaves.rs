//! Which stems have leaves, and where these sit; what they look like there is left to others.

use sapwood_geom::{Content, Digester, Shared};
use sapwood_graph::Named;
use sapwood_scene::{Context, Projection, Rule, RuleError, SlotReader, Style, StyleSlot};

use super::super::slots::{CrownSlot, DetailSlot, LeafTargetSlot, LeavesSlot};
use super::super::{
    Children, Crown, Leaf, LeafParams, LeafPlaces, LeafSurface, Leaves, Stems, leaf_places,
};
use super::structure::charging;

/// Compiles leaves into where they sit; what they look like there is left to others.
pub(super) struct LeavesRule;

impl Rule for LeavesRule {
    type Component = Leaves;
    type Data = ();
    const NAME: &'static str = "weber_penn.leaves";

    fn init(&self, on: &Leaves, cx: &mut Context<'_>) -> Result<(), RuleError> {
        let crown = cx.read::<CrownSlot>();
        let below = level_of_leaves(&on.stems, &crown);
        let Some(params) = cx.project(LeavesOfGrowth { below }) else { return Ok(()) };
        let target = cx.read::<LeafTargetSlot>();
        let LeafPlaces { places, stems } =
            leaf_places(&on.stems, &crown, &params, &target, &mut charging(cx))?;
        if places.is_empty() {
            return Ok(());
        }
        // They follow from these alone, so there is no need to read them all for their digest.
        let mut digester = Digester::new();
        digester.add(Leaf::NAME).add(&on.stems).add(&*crown).add(&params).add(&*target);
        let places = Shared::with_digest(digester.finish(), places);
        cx.emit(LeafSurface { stems: on.stems.clone(), places, on: stems.into() });
        Ok(())
    }
}

/// Emits the leaves of stems on which something else grows too, where their level has some.
pub(super) fn emit_leaves_beside(on: &Children, cx: &mut Context<'_>) {
    let level = on.stems.stems.first().map(|first| first.seed.level);
    if level.is_some_and(|level| cx.project(HasLeaves { level })) {
        cx.emit(Leaves { stems: on.stems.clone() });
    }
}

/// Whether stems of a level have leaves though it is not the last; how many is not the stems'
/// business.
pub(super) struct HasLeaves {
    pub(super) level: u8,
}

impl Content for HasLeaves {
    fn write(&self, digester: &mut Digester) {
        digester.add(&self.level);
    }
}

impl Projection for HasLeaves {
    type Output = bool;
    const NAME: &'static str = "weber_penn.has_leaves";

    fn compute(&self, slots: &mut SlotReader<'_>) -> bool {
        slots.read::<LeavesSlot>().on_level(self.level, u32::MAX).count != 0
    }
}

/// The level of the stems that leaves grow on, unless it is the last.
fn level_of_leaves(stems: &Stems, crown: &Crown) -> Option<u8> {
    let level = stems.stems.first()?.seed.level;
    (u32::from(level) + 1 < crown.levels).then_some(level)
}

/// What drawing asks of the leaves on stems of a level, so that leaves elsewhere do not matter.
pub(super) struct LeavesOnLevel {
    pub(super) level: u8,
}

impl Content for LeavesOnLevel {
    fn write(&self, digester: &mut Digester) {
        digester.add(&self.level);
    }
}

impl Projection for LeavesOnLevel {
    type Output = LeafParams;
    const NAME: &'static str = "weber_penn.leaves_on_level";

    fn compute(&self, slots: &mut SlotReader<'_>) -> LeafParams {
        let levels = slots.read::<CrownSlot>().levels;
        let share = slots.read::<DetailSlot>().leaves;
        let leaves = slots.read::<LeavesSlot>().on_level(self.level, levels).thinned(share);
        LeafParams { on_levels: [0; 4], ..leaves }
    }
}

/// What growth asks of the leaves, so that leaves of another size stay where they are; nothing
/// where the style has none drawn.
struct LeavesOfGrowth {
    /// The level of the stems that they grow on, unless it is the last.
    below: Option<u8>,
}

impl Content for LeavesOfGrowth {
    fn write(&self, digester: &mut Digester) {
        digester.add(&self.below);
    }
}

impl Projection for LeavesOfGrowth {
    type Output = Option<LeafParams>;
    const NAME: &'static str = "weber_penn.leaves_of_growth";

    fn compute(&self, slots: &mut SlotReader<'_>) -> Option<LeafParams> {
        if *slots.read::<StyleSlot>() == Style::Skeleton {
            return None;
        }
        // A coarse leaf mesh would lose the shape; fewer, larger leaves keep it.
        let leaves = slots.read::<LeavesSlot>();
        let share = slots.read::<DetailSlot>().leaves;
        let leaves = match self.below {
            Some(level) => leaves.on_level(level, u32::MAX).thinned(share),
            None => leaves.thinned(share),
        };
        Some(leaves.of_growth())
    }
}
