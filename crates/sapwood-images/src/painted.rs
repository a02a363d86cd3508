//! Materials that are painted with images, and an attribute that gives one to what is below it.

use sapwood_geom::{Content, Digester, content};
use sapwood_graph::{Material, Named};
use sapwood_scene::{Children, Component};

use crate::{BarkImage, LeafImage, NoiseImage, RampImage};

/// A material whose images come from an image component: compiled to a shared
/// [`Material`], `Arc<Material>`, for whoever asks for it as an ingredient.
///
/// The images are multiplied with the material's values, as all images of materials are: its
/// colour should be white unless it is to tint them. An image that the paint does not have stays
/// the material's own.
#[derive(Clone, Debug, PartialEq)]
pub struct PaintedMaterial {
    /// Everything but the images.
    pub material: Material,
    /// Where the images come from.
    pub paint: Paint,
}

content!(PaintedMaterial { material, paint });

impl Named for PaintedMaterial {
    const NAME: &'static str = "painted_material";
}

impl Component for PaintedMaterial {}

/// Where a material's images come from: one of the image components. Whoever has another kind of
/// image asks for it in a rule of their own.
#[derive(Clone, Debug, PartialEq)]
pub enum Paint {
    /// Colours by noise.
    Noise(NoiseImage),
    /// Colours by a ramp.
    Ramp(RampImage),
    /// Colours and normals of bark.
    Bark(BarkImage),
    /// Colours and coverage of a leaf; what coverage means is the material's matter.
    Leaf(LeafImage),
}

impl Content for Paint {
    fn write(&self, digester: &mut Digester) {
        match self {
            Self::Noise(noise) => digester.add(&0u8).add(noise),
            Self::Ramp(ramp) => digester.add(&1u8).add(ramp),
            Self::Bark(bark) => digester.add(&2u8).add(bark),
            Self::Leaf(leaf) => digester.add(&3u8).add(leaf),
        };
    }
}

/// Paints everything below that has no material of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Painted(pub PaintedMaterial);

impl Painted {
    /// Paints with these images, white and matte else.
    pub fn with(paint: Paint) -> Self {
        let material = Material::matte("painted", 1.0, 1.0, 1.0);
        Self(PaintedMaterial { material, paint })
    }
}

impl Content for Painted {
    fn write(&self, digester: &mut Digester) {
        self.0.write(digester);
    }
}

impl Named for Painted {
    const NAME: &'static str = "painted";
}

impl Component for Painted {
    const CHILDREN: Children = Children::One;
}
