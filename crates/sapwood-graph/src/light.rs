//! Lights.

use sapwood_geom::{Content, Digester, content};

use crate::Named;

/// A light at the origin of its frame, shining down the frame's -z axis as in glTF.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// The name that exported files carry.
    pub name: String,
    /// Linear red, green and blue.
    pub color: [f32; 3],
    /// Lux for a directional light, candela for the others.
    pub intensity: f32,
    /// Where the light comes from and goes to.
    pub shape: LightShape,
}

content!(Light { name, color, intensity, shape });

/// Where a light comes from and goes to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightShape {
    /// From infinitely far away, down the -z axis.
    Directional,
    /// From the origin in all directions.
    Point {
        /// How far the light reaches in metres; without end if there is none.
        range: Option<f32>,
    },
    /// From the origin into a cone about the -z axis.
    Spot {
        /// How far the light reaches in metres; without end if there is none.
        range: Option<f32>,
        /// The angle from the axis in radians up to which the light is full.
        inner: f32,
        /// The angle from the axis in radians beyond which there is none; more than `inner`,
        /// at most a right angle.
        outer: f32,
    },
}

impl Named for Light {
    const NAME: &'static str = "light";
}

impl Light {
    /// What is wrong with the light's numbers, in words, or nothing.
    pub fn fault(&self) -> Option<String> {
        let is_amount = |value: f32| value.is_finite() && value >= 0.0;
        if !self.color.iter().all(|channel| is_amount(*channel)) || !is_amount(self.intensity) {
            return Some(format!(
                "colour {:?} and intensity {} must be finite and not negative",
                self.color, self.intensity
            ));
        }
        let (LightShape::Point { range } | LightShape::Spot { range, .. }) = self.shape else {
            return None;
        };
        if range.is_some_and(|range| !(is_amount(range) && range > 0.0)) {
            return Some(format!("a range of {range:?} m; it must be above 0"));
        }
        match self.shape {
            LightShape::Spot { inner, outer, .. }
                if !(0.0 <= inner && inner < outer && outer <= std::f32::consts::FRAC_PI_2) =>
            {
                Some(format!("cone angles {inner} and {outer}; 0 <= inner < outer <= pi / 2"))
            }
            _ => None,
        }
    }
}

impl Content for LightShape {
    fn write(&self, digester: &mut Digester) {
        match self {
            Self::Directional => digester.add(&0u8),
            Self::Point { range } => digester.add(&1u8).add(range),
            Self::Spot { range, inner, outer } => {
                digester.add(&2u8).add(range).add(inner).add(outer)
            }
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cones_open_outwards() {
        let light = |inner, outer| Light {
            name: String::new(),
            color: [1.0; 3],
            intensity: 1.0,
            shape: LightShape::Spot { range: None, inner, outer },
        };
        assert_eq!(light(0.1, 0.2).fault(), None);
        assert!(light(0.2, 0.2).fault().is_some());
        assert!(light(0.0, 2.0).fault().is_some());
        assert!(light(f32::NAN, 1.0).fault().is_some());
    }
}
