//! The rules that compile images. What they make is their data, for whoever asks for it as an
//! ingredient; none of them draws anything.
//!
//! Pixels are made when somebody looks at them for the first time: a scene that is measured,
//! counted or drawn as lines never makes any. Until then an image is its description, which has
//! been found right.

use std::sync::{Arc, LazyLock};

use sapwood_geom::{Content, Digest, Image, Shared};
use sapwood_graph::{Material, MaterialImages, Named};
use sapwood_scene::{Context, MaterialSlot, Rule, RuleError, RuleSet};

use crate::{BarkImage, LeafImage, NoiseImage, Over, Paint, Painted, PaintedMaterial, RampImage};

/// The rules for all images.
pub fn rules() -> RuleSet {
    RuleSet::new()
        // patterns
        .with(NoiseRule)
        .with(RampRule)
        // parts of trees
        .with(BarkRule)
        .with(LeafRule)
        // what they are for
        .with(PaintedMaterialRule)
        .with(PaintedRule)
}

/// Fails with what is wrong with a component, and stops where the caller asked to.
fn begin(fault: Option<String>, cx: &mut Context<'_>) -> Result<(), RuleError> {
    cx.checkpoint()?;
    fault.map_or(Ok(()), |fault| Err(RuleError::Failed(fault)))
}

/// One of the images that a component describes: the component's kind, and which of its images,
/// tell it from all others.
fn later<C: Named + Content>(
    described: &C,
    which: &'static str,
    make: impl FnOnce() -> Shared<Image> + Send + Sync + 'static,
) -> Shared<Image> {
    Shared::later(Digest::of(&(C::NAME, (which, described))), make)
}

struct NoiseRule;

impl Rule for NoiseRule {
    type Component = NoiseImage;
    type Data = Shared<Image>;
    const NAME: &'static str = "images.noise";

    fn init(&self, noise: &NoiseImage, cx: &mut Context<'_>) -> Result<Shared<Image>, RuleError> {
        begin(noise.fault(), cx)?;
        let described = noise.clone();
        Ok(later(noise, "color", move || described.image()))
    }
}

struct RampRule;

impl Rule for RampRule {
    type Component = RampImage;
    type Data = Shared<Image>;
    const NAME: &'static str = "images.ramp";

    fn init(&self, ramp: &RampImage, cx: &mut Context<'_>) -> Result<Shared<Image>, RuleError> {
        begin(ramp.fault(), cx)?;
        match &ramp.over {
            // Ramps over the same noise share it, whatever colours it was given.
            Over::Noise(noise) => {
                let grey = cx.ingredient::<Shared<Image>>(noise.grey())?.clone();
                let described = RampImage { over: Over::Noise(noise.grey()), ..ramp.clone() };
                let over = described.clone();
                Ok(later(&described, "color", move || over.image_over(&grey)))
            }
            Over::Across(_) | Over::Down(_) => {
                let described = ramp.clone();
                Ok(later(ramp, "color", move || described.image()))
            }
        }
    }
}

struct BarkRule;

impl Rule for BarkRule {
    type Component = BarkImage;
    type Data = MaterialImages;
    const NAME: &'static str = "images.bark";

    fn init(&self, bark: &BarkImage, cx: &mut Context<'_>) -> Result<MaterialImages, RuleError> {
        begin(bark.fault(), cx)?;
        // Colours and normals are made together, whichever is looked at first.
        let described = bark.clone();
        let made = Arc::new(LazyLock::new(move || described.images()));
        let normals = Arc::clone(&made);
        let missing = "bark has colours and normals";
        Ok(MaterialImages {
            base_color: Some(later(bark, "color", move || made.base_color.clone().expect(missing))),
            normal: Some(later(bark, "normal", move || normals.normal.clone().expect(missing))),
            ..MaterialImages::default()
        })
    }
}

struct LeafRule;

impl Rule for LeafRule {
    type Component = LeafImage;
    type Data = MaterialImages;
    const NAME: &'static str = "images.leaf";

    fn init(&self, leaf: &LeafImage, cx: &mut Context<'_>) -> Result<MaterialImages, RuleError> {
        begin(leaf.fault(), cx)?;
        let described = leaf.clone();
        let make = move || described.images().base_color.expect("leaves have a colour");
        Ok(MaterialImages {
            base_color: Some(later(leaf, "color", make)),
            ..MaterialImages::default()
        })
    }
}

struct PaintedMaterialRule;

impl Rule for PaintedMaterialRule {
    type Component = PaintedMaterial;
    type Data = Arc<Material>;
    const NAME: &'static str = "images.painted_material";

    fn init(
        &self,
        painted: &PaintedMaterial,
        cx: &mut Context<'_>,
    ) -> Result<Arc<Material>, RuleError> {
        begin(painted.material.fault(), cx)?;
        let only = |image: &Shared<Image>| MaterialImages {
            base_color: Some(image.clone()),
            ..MaterialImages::default()
        };
        let images = match &painted.paint {
            Paint::Noise(noise) => only(cx.ingredient(noise.clone())?),
            Paint::Ramp(ramp) => only(cx.ingredient(ramp.clone())?),
            Paint::Bark(bark) => cx.ingredient::<MaterialImages>(bark.clone())?.clone(),
            Paint::Leaf(leaf) => cx.ingredient::<MaterialImages>(leaf.clone())?.clone(),
        };
        let mut material = painted.material.clone();
        let own = material.images;
        material.images = MaterialImages {
            base_color: images.base_color.or(own.base_color),
            metallic_roughness: images.metallic_roughness.or(own.metallic_roughness),
            normal: images.normal.or(own.normal),
            emissive: images.emissive.or(own.emissive),
        };
        Ok(Arc::new(material))
    }
}

struct PaintedRule;

impl Rule for PaintedRule {
    type Component = Painted;
    type Data = ();
    const NAME: &'static str = "images.painted";

    fn init(&self, painted: &Painted, cx: &mut Context<'_>) -> Result<(), RuleError> {
        let material = cx.ingredient::<Arc<Material>>(painted.0.clone())?;
        cx.push::<MaterialSlot>(Material::clone(material), |cx| cx.children());
        Ok(())
    }
}
