//! The rules that compile images. None of them draws anything: what they make is their data.

use sapwood_geom::{Image, Shared};
use sapwood_graph::MaterialImages;
use sapwood_scene::{Context, Rule, RuleError, RuleSet};

use crate::{BarkImage, LeafImage, NoiseImage};

/// The rules for all images.
pub fn rules() -> RuleSet {
    RuleSet::new()
        // patterns
        .with(NoiseRule)
        // parts of trees
        .with(BarkRule)
        .with(LeafRule)
}

/// Fails with what is wrong with a component, and stops where the caller asked to.
fn begin(fault: Option<String>, cx: &mut Context<'_>) -> Result<(), RuleError> {
    cx.checkpoint()?;
    fault.map_or(Ok(()), |fault| Err(RuleError::Failed(fault)))
}

struct NoiseRule;

impl Rule for NoiseRule {
    type Component = NoiseImage;
    type Data = Shared<Image>;
    const NAME: &'static str = "images.noise";

    fn init(&self, noise: &NoiseImage, cx: &mut Context<'_>) -> Result<Shared<Image>, RuleError> {
        begin(noise.fault(), cx)?;
        Ok(noise.image())
    }
}

struct BarkRule;

impl Rule for BarkRule {
    type Component = BarkImage;
    type Data = MaterialImages;
    const NAME: &'static str = "images.bark";

    fn init(&self, bark: &BarkImage, cx: &mut Context<'_>) -> Result<MaterialImages, RuleError> {
        begin(bark.fault(), cx)?;
        Ok(bark.images())
    }
}

struct LeafRule;

impl Rule for LeafRule {
    type Component = LeafImage;
    type Data = MaterialImages;
    const NAME: &'static str = "images.leaf";

    fn init(&self, leaf: &LeafImage, cx: &mut Context<'_>) -> Result<MaterialImages, RuleError> {
        begin(leaf.fault(), cx)?;
        Ok(leaf.images())
    }
}
