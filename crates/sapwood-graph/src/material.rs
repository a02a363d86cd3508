//! What a surface looks like.

use sapwood_geom::{Content, Digester, Image, Shared, content};

/// A surface's look in the metallic-roughness model of glTF.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// The name that exported files carry.
    pub name: String,
    /// Linear red, green, blue and coverage, each in 0..=1.
    pub base_color: [f32; 4],
    /// 0 for everything but bare metal.
    pub metallic: f32,
    /// 0 is a mirror, 1 is chalk.
    pub roughness: f32,
    /// Linear red, green and blue that the surface gives off by itself.
    pub emissive: [f32; 3],
    /// The share of the light scattered below the surface that leaves on its other side, as
    /// through a leaf: 0 for solid things, 0.5 for paper.
    pub translucency: f32,
    /// What coverage means.
    pub alpha: Alpha,
    /// Whether the back of a triangle is drawn too.
    pub double_sided: bool,
    /// Images that vary the values above over the surface.
    pub images: MaterialImages,
}

/// What a material's coverage means.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Alpha {
    /// Nothing: the surface is opaque.
    #[default]
    Opaque,
    /// The surface is there where coverage reaches this value, and not there elsewhere.
    Mask(f32),
    /// The surface lets through what it does not cover.
    Blend,
}

/// The images of a material. Each is multiplied with the value it varies, repeats beyond
/// texture coordinates 0..=1, and is read by the mesh's only set of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MaterialImages {
    /// Colour, sRGB-encoded, and coverage.
    pub base_color: Option<Shared<Image>>,
    /// Roughness in green, metallic in blue; plain numbers.
    pub metallic_roughness: Option<Shared<Image>>,
    /// Normals in the surface's tangent frame; plain numbers, 128 for zero.
    pub normal: Option<Shared<Image>>,
    /// Colour, sRGB-encoded.
    pub emissive: Option<Shared<Image>>,
}

impl Material {
    /// A rough, opaque, non-metallic material of one colour, seen from the front.
    pub fn matte(name: &str, red: f32, green: f32, blue: f32) -> Self {
        Self {
            name: name.to_owned(),
            base_color: [red, green, blue, 1.0],
            metallic: 0.0,
            roughness: 1.0,
            emissive: [0.0; 3],
            translucency: 0.0,
            alpha: Alpha::Opaque,
            double_sided: false,
            images: MaterialImages::default(),
        }
    }
}

impl Material {
    /// What is wrong with the material, in words, or nothing: values in their ranges, images
    /// whole.
    pub fn fault(&self) -> Option<String> {
        let is_share = |value: &f32| (0.0..=1.0).contains(value);
        if !self.base_color.iter().all(is_share) {
            return Some(format!("colour {:?}; each number in 0..=1", self.base_color));
        }
        let Self { metallic, roughness, emissive, .. } = self;
        if !(is_share(metallic) && is_share(roughness)) {
            return Some(format!("metallic {metallic} and roughness {roughness}; both in 0..=1"));
        }
        if !emissive.iter().all(|value| value.is_finite() && *value >= 0.0) {
            return Some(format!("gives off {emissive:?}; finite and not negative"));
        }
        if !is_share(&self.translucency) {
            return Some(format!("translucency {}; in 0..=1", self.translucency));
        }
        match self.alpha {
            Alpha::Mask(least) if !is_share(&least) => {
                return Some(format!("is there from a coverage of {least} on; in 0..=1"));
            }
            Alpha::Opaque | Alpha::Mask(_) | Alpha::Blend => {}
        }
        let MaterialImages { base_color, metallic_roughness, normal, emissive } = &self.images;
        let images = [base_color, metallic_roughness, normal, emissive];
        images.into_iter().flatten().find_map(|image| image.fault())
    }
}

content!(Material {
    name,
    base_color,
    metallic,
    roughness,
    emissive,
    translucency,
    alpha,
    double_sided,
    images
});

content!(MaterialImages { base_color, metallic_roughness, normal, emissive });

impl Content for Alpha {
    fn write(&self, digester: &mut Digester) {
        match self {
            Self::Opaque => digester.add(&0u8),
            Self::Mask(least) => digester.add(&1u8).add(least),
            Self::Blend => digester.add(&2u8),
        };
    }
}
