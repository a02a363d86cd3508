//! What a surface looks like.

use sapwood_geom::{Content, Digester};

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
    /// Whether the back of a triangle is drawn too.
    pub double_sided: bool,
}

impl Material {
    /// A rough, opaque, non-metallic material of one colour, seen from the front.
    pub fn matte(name: &str, red: f32, green: f32, blue: f32) -> Self {
        Self {
            name: name.to_owned(),
            base_color: [red, green, blue, 1.0],
            metallic: 0.0,
            roughness: 1.0,
            double_sided: false,
        }
    }
}

impl Content for Material {
    fn write(&self, digester: &mut Digester) {
        let Self { name, base_color, metallic, roughness, double_sided } = self;
        digester.add(name).add(base_color).add(metallic).add(roughness).add(double_sided);
    }
}
