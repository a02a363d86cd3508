//! Roots: stems of their own below the trunks, which nothing grows on and no wind moves.

use sapwood_geom::{Content, Digester, Shared};
use sapwood_graph::Named;
use sapwood_scene::{Context, Projection, Rule, RuleError, SlotReader};

use super::super::slots::{CrownSlot, RootsSlot};
use super::super::{Roots, Stem, StemSurface, Stems, Target, grow, roots};
use super::pruning::fitted;
use super::structure::{add_stem_parts, charging};

/// Compiles the roots of trunks into their stems.
pub(super) struct RootsRule;

impl Rule for RootsRule {
    type Component = Roots;
    type Data = Shared<Stems>;
    const NAME: &'static str = "weber_penn.roots";

    fn init(&self, of: &Roots, cx: &mut Context<'_>) -> Result<Shared<Stems>, RuleError> {
        let params = cx.read::<RootsSlot>();
        let crown = cx.read::<CrownSlot>();
        let seeds = roots(&of.stems, &crown, &params, &mut charging(cx))?;
        let fitted = fitted(cx, &seeds, &crown, &params.level, &Target::Up, true)?;
        let seeds = fitted.as_ref().unwrap_or(&seeds);
        let stems = grow(seeds, &crown, &params.level, &Target::Up, &mut charging(cx))?;
        // They follow from these alone.
        let mut digester = Digester::new();
        digester.add(Roots::NAME).add(Stem::NAME).add(&of.stems).add(&*crown).add(&*params);
        digester.add(&fitted);
        let stems = Shared::with_digest(digester.finish(), stems);
        add_stem_parts(&stems, cx);
        if !stems.stems.is_empty() {
            cx.emit(StemSurface { stems: stems.clone() });
        }
        Ok(stems)
    }
}

/// Emits the roots of a branch that is a trunk, where trunks have some.
pub(super) fn emit_roots(stems: &Shared<Stems>, cx: &mut Context<'_>) {
    let is_trunk = stems.stems.first().is_some_and(|first| first.seed.level == 0);
    if is_trunk && cx.project(HasRoots) {
        cx.emit(Roots { stems: stems.clone() });
    }
}

/// Whether trunks have roots; what they are like is not the trunks' business.
pub(super) struct HasRoots;

impl Content for HasRoots {
    fn write(&self, _: &mut Digester) {}
}

impl Projection for HasRoots {
    type Output = bool;
    const NAME: &'static str = "weber_penn.has_roots";

    fn compute(&self, slots: &mut SlotReader<'_>) -> bool {
        slots.read::<RootsSlot>().count > 0
    }
}
