//! What a picture is to look like, whatever the scene.

use sapwood_geom::glam::Vec3;

use crate::PictureError;

/// What a picture is to look like.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureOptions {
    /// Pixels in a row, and rows; each at least 1, and no more than 2^26 together.
    pub size: [u32; 2],
    /// Rays through each pixel, 1 to 4096; powers of two are spread best.
    pub samples: u32,
    /// Another number, another pattern of rays.
    pub seed: u64,
    /// The sun.
    pub sun: Option<Sun>,
    /// The dome of the sky, which gives light from all sides.
    pub sky: Sky,
    /// Whether lights that stand in the scene shine.
    pub lights: bool,
    /// A plane without end below everything.
    pub ground: Option<Ground>,
    /// What is seen where nothing is.
    pub background: Background,
    /// How often light is mirrored on its way, 0 to 16.
    pub most_reflections: u32,
    /// What all light is multiplied by.
    pub exposure: f32,
    /// The colour of lines that have no material, linear.
    pub line_color: [f32; 3],
    /// How many pixels wide lines are at least.
    pub line_width: f32,
}

impl Default for PictureOptions {
    /// 1024 x 1024 pixels with 4 samples, a sun from the upper left, a clear sky, the
    /// scene's lights, no ground.
    fn default() -> Self {
        Self {
            size: [1024, 1024],
            samples: 4,
            seed: 0,
            sun: Some(Sun::default()),
            sky: Sky::default(),
            lights: true,
            ground: None,
            background: Background::Sky,
            most_reflections: 4,
            exposure: 1.0,
            line_color: [0.05, 0.04, 0.03],
            line_width: 1.0,
        }
    }
}

/// A sun: light from one direction, with soft shadows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// Where it stands; need not have unit length.
    pub toward: Vec3,
    /// The angle in radians between its middle and its rim; the larger, the softer its shadows.
    pub radius: f32,
    /// Linear red, green and blue of what falls on a surface square to it.
    pub color: [f32; 3],
}

impl Default for Sun {
    /// Warm light from the upper left in front.
    fn default() -> Self {
        Self { toward: Vec3::new(-0.55, 0.75, 0.6), radius: 0.02, color: [3.3, 3.05, 2.7] }
    }
}

/// The dome of the sky. Colours are linear, and what an eye would see.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    /// Straight above.
    pub zenith: [f32; 3],
    /// All around.
    pub horizon: [f32; 3],
    /// Straight below.
    pub nadir: [f32; 3],
    /// How many metres away something may be and still keep the sky's light away.
    pub occlusion_distance: f32,
    /// What share of the sky's light comes by way of whatever keeps it away, before that colours
    /// it.
    pub bounce: f32,
}

impl Default for Sky {
    /// A clear day.
    fn default() -> Self {
        Self {
            zenith: [0.42, 0.56, 0.82],
            horizon: [0.86, 0.90, 0.95],
            nadir: [0.42, 0.40, 0.36],
            occlusion_distance: 20.0,
            bounce: 0.35,
        }
    }
}

/// A plane without end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ground {
    /// Its height in metres, y up.
    pub height: f32,
    /// Its colour, linear.
    pub color: [f32; 3],
}

impl Default for Ground {
    /// Dry grass at height 0.
    fn default() -> Self {
        Self { height: 0.0, color: [0.26, 0.25, 0.17] }
    }
}

/// What is seen where nothing is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Background {
    /// The sky.
    #[default]
    Sky,
    /// One colour, linear.
    Color([f32; 3]),
    /// Nothing: the picture's coverage is 0 there.
    Transparent,
}

/// Pixels of the largest picture.
const MOST_PIXELS: u64 = 1 << 26;

impl PictureOptions {
    /// The first option that is out of its range.
    ///
    /// # Errors
    /// When there is one.
    pub fn check(&self) -> Result<(), PictureError> {
        let Self { size: [width, height], samples, ref sky, .. } = *self;
        let n = u64::from(width) * u64::from(height);
        let wrong = |name, value, accepted| Err(PictureError::Option { name, value, accepted });
        if n == 0 || n > MOST_PIXELS {
            let accepted = "at least 1x1, and up to 67108864 pixels together";
            return wrong("size", format!("{width}x{height}"), accepted);
        }
        if !(1..=4096).contains(&samples) {
            return wrong("samples", samples.to_string(), "1 to 4096");
        }
        if self.most_reflections > 16 {
            return wrong("reflections", self.most_reflections.to_string(), "0 to 16");
        }
        let is_amount = |value: f32| value.is_finite() && value >= 0.0;
        let no_negatives = "finite and not negative";
        for (name, value) in [
            ("exposure", self.exposure),
            ("line width", self.line_width),
            ("occlusion distance of the sky", sky.occlusion_distance),
            ("bounce of the sky", sky.bounce),
        ] {
            if !is_amount(value) {
                return wrong(name, value.to_string(), no_negatives);
            }
        }
        let mut colors = vec![
            ("zenith of the sky", sky.zenith),
            ("horizon of the sky", sky.horizon),
            ("nadir of the sky", sky.nadir),
            ("colour of lines", self.line_color),
        ];
        if let Some(Ground { height, color }) = self.ground {
            colors.push(("colour of the ground", color));
            if !height.is_finite() {
                return wrong("height of the ground", height.to_string(), "finite");
            }
        }
        if let Background::Color(color) = self.background {
            colors.push(("colour of the background", color));
        }
        if let Some(Sun { toward, radius, color }) = self.sun {
            colors.push(("colour of the sun", color));
            if toward.try_normalize().is_none() {
                return wrong("direction of the sun", toward.to_string(), "finite and not zero");
            }
            if !(0.0..=1.0).contains(&radius) {
                return wrong("radius of the sun", radius.to_string(), "0 to 1 radian");
            }
        }
        for (name, color) in colors {
            if !color.into_iter().all(is_amount) {
                return wrong(name, format!("{color:?}"), no_negatives);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_out_of_range_is_named() {
        type Change = fn(&mut PictureOptions);
        let cases: [(Change, &str); 9] = [
            (|o| o.size = [0, 5], "size of a picture: 0x5 (accepted: at least 1x1"),
            (|o| o.size = [1 << 14, 1 << 13], "size of a picture: 16384x8192"),
            (|o| o.samples = 0, "samples of a picture: 0 (accepted: 1 to 4096)"),
            (|o| o.most_reflections = 99, "reflections of a picture: 99"),
            (|o| o.exposure = f32::NAN, "exposure of a picture: NaN"),
            (|o| o.sun.as_mut().unwrap().toward = Vec3::ZERO, "direction of the sun"),
            (|o| o.sun.as_mut().unwrap().color[1] = -1.0, "colour of the sun"),
            (|o| o.ground = Some(Ground { height: f32::INFINITY, ..Ground::default() }), "height"),
            (|o| o.background = Background::Color([f32::NAN; 3]), "colour of the background"),
        ];
        for (change, text) in cases {
            let mut options = PictureOptions::default();
            assert_eq!(options.check(), Ok(()));
            change(&mut options);
            let error = options.check().unwrap_err().to_string();
            assert!(error.starts_with(text), "{error}");
        }
    }
}
