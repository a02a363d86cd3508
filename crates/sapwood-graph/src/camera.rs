//! Cameras.

use sapwood_geom::{Content, Digester, content};

use crate::Named;

/// A camera at the origin of its frame, looking down the frame's -z axis with +y up, as in
/// glTF.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// The name that exported files carry.
    pub name: String,
    /// How space is laid onto the picture.
    pub lens: Lens,
    /// The distance in metres before which nothing is seen.
    pub near: f32,
    /// The distance in metres beyond which nothing is seen; a perspective camera may do
    /// without.
    pub far: Option<f32>,
}

content!(Camera { name, lens, near, far });

/// How a camera lays space onto the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lens {
    /// What is farther is smaller.
    Perspective {
        /// The angle in radians between the lower and the upper edge of the picture.
        vertical_angle: f32,
    },
    /// What is farther is as large.
    Orthographic {
        /// Metres between the lower and the upper edge of the picture.
        height: f32,
    },
}

impl Named for Camera {
    const NAME: &'static str = "camera";
}

impl Camera {
    /// What is wrong with the camera's numbers, in words, or nothing.
    pub fn fault(&self) -> Option<String> {
        let is_positive = |value: f32| value.is_finite() && value > 0.0;
        match self.lens {
            Lens::Perspective { vertical_angle }
                if !(is_positive(vertical_angle) && vertical_angle < std::f32::consts::PI) =>
            {
                return Some(format!("a vertical angle of {vertical_angle}; between 0 and pi"));
            }
            Lens::Orthographic { height } if !is_positive(height) => {
                return Some(format!("a picture {height} m high; it must be above 0"));
            }
            Lens::Orthographic { .. } if self.far.is_none() => {
                return Some("an orthographic camera needs a far distance".to_owned());
            }
            Lens::Perspective { .. } | Lens::Orthographic { .. } => {}
        }
        let is_ordered =
            is_positive(self.near) && self.far.is_none_or(|far| far.is_finite() && far > self.near);
        let Self { near, far, .. } = self;
        (!is_ordered).then(|| format!("near {near} and far {far:?} m; 0 < near < far"))
    }
}

impl Content for Lens {
    fn write(&self, digester: &mut Digester) {
        match self {
            Self::Perspective { vertical_angle } => digester.add(&0u8).add(vertical_angle),
            Self::Orthographic { height } => digester.add(&1u8).add(height),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_far_distance_lies_beyond_the_near_one() {
        let camera = |near, far| Camera {
            name: String::new(),
            lens: Lens::Perspective { vertical_angle: 1.0 },
            near,
            far,
        };
        assert_eq!(camera(0.1, None).fault(), None);
        assert_eq!(camera(0.1, Some(10.0)).fault(), None);
        assert!(camera(1.0, Some(0.5)).fault().is_some());
        assert!(camera(0.0, None).fault().is_some());
    }
}
