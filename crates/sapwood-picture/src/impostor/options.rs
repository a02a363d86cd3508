//! How impostors are made.

use std::f32::consts::TAU;

use sapwood_geom::glam::Vec3;

use crate::{Background, PictureError, PictureOptions, Sky, Sun};

/// How impostors are made.
#[derive(Clone, Debug, PartialEq)]
pub struct ImpostorOptions {
    /// From how many sides at level height, a multiple of 4 up to 64; the first lies at +z, the
    /// next ones go on towards +x.
    pub sides: u32,
    /// From how many sides halfway up, 0 to 64, at [`STEEPNESS`](Self::STEEPNESS).
    pub upper_sides: u32,
    /// Whether there is one from above.
    pub from_above: bool,
    /// Rows of pixels of the image from each side, 8 to 1024.
    pub rows: u32,
    /// Rays through each pixel.
    pub samples: u32,
    /// The light that images are taken in.
    pub light: ImpostorLight,
}

/// The light that images are taken in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ImpostorLight {
    /// This light and that of lights in the view, which images then show whatever light falls on
    /// the boards: they shine by themselves. Looks right under that light, and where the impostor
    /// stands as it was made.
    Baked {
        /// The sun.
        sun: Option<Sun>,
        /// The sky.
        sky: Sky,
    },
    /// White light from all sides alike, [`Sky::even`], and no other: images show the surfaces' own
    /// colours, and the shade that they throw on each other. In that light a board looks as what it
    /// stands for does. It is lit by whatever light there is, as boards are: in a light of another
    /// colour it has that colour, and under a sun it is as bright as its slope to the sun has it,
    /// and has no side in the shade.
    Even,
}

impl ImpostorLight {
    pub(super) fn is_baked(&self) -> bool {
        matches!(self, Self::Baked { .. })
    }

    /// Pictures in this light.
    pub(super) fn picture_options(&self) -> PictureOptions {
        let (sun, sky) = match *self {
            Self::Baked { sun, sky } => (sun, sky),
            Self::Even => (None, Sky::even([1.0; 3])),
        };
        PictureOptions { sun, sky, lights: self.is_baked(), ..PictureOptions::default() }
    }
}

impl Default for ImpostorOptions {
    /// From 16 sides at level height, 8 halfway up and from above, 128 rows each, in the light of
    /// [`PictureOptions`]' default.
    fn default() -> Self {
        let PictureOptions { sun, sky, .. } = PictureOptions::default();
        Self {
            sides: 16,
            upper_sides: 8,
            from_above: true,
            rows: 128,
            samples: 16,
            light: ImpostorLight::Baked { sun, sky },
        }
    }
}

impl ImpostorOptions {
    /// How far up the upper sides lie, in radians.
    pub const STEEPNESS: f32 = 0.8;

    /// The first option that is out of its range; what pictures are asked for is checked by those.
    pub(super) fn check(&self) -> Result<(), PictureError> {
        let wrong = |name, value, accepted| Err(PictureError::Impostor { name, value, accepted });
        if !self.sides.is_multiple_of(4) || !(4..=64).contains(&self.sides) {
            return wrong("sides", self.sides, "a multiple of 4, 4 to 64");
        }
        if self.upper_sides > 64 {
            return wrong("upper sides", self.upper_sides, "0 to 64");
        }
        if !(8..=1024).contains(&self.rows) {
            return wrong("rows", self.rows, "8 to 1024");
        }
        Ok(())
    }

    /// Pictures of this size.
    pub(super) fn picture_options(&self, size: [u32; 2]) -> PictureOptions {
        PictureOptions {
            size,
            samples: self.samples,
            background: Background::Transparent,
            ..self.light.picture_options()
        }
    }

    /// How many boards are drawn where nobody tells the eye: two crossed ones, seen from both
    /// sides, which come first.
    pub(super) const CROSSED: u32 = 4;

    /// The directions that it is seen from, with unit length.
    pub(super) fn directions(&self) -> Vec<Vec3> {
        let at = |number: u32, of: u32, steepness: f32| {
            let (sine, cosine) = libm::sincosf(TAU * number as f32 / of as f32);
            let (up, along) = libm::sincosf(steepness);
            Vec3::new(sine * along, up, cosine * along).normalize()
        };
        // Every quarter first.
        let quarter = self.sides / Self::CROSSED;
        let crossed = (0..Self::CROSSED).map(|turn| turn * quarter);
        let others = (0..self.sides).filter(|side| side % quarter != 0);
        let level = crossed.chain(others).map(|side| at(side, self.sides, 0.0));
        let upper = (0..self.upper_sides).map(|side| at(side, self.upper_sides, Self::STEEPNESS));
        level.chain(upper).chain(self.from_above.then_some(Vec3::Y)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_crossed_boards_come_first() {
        let options = ImpostorOptions::default();
        let directions = options.directions();
        assert_eq!(directions.len(), 25);
        let crossed = [Vec3::Z, Vec3::X, Vec3::NEG_Z, Vec3::NEG_X];
        for (direction, expected) in directions.iter().zip(crossed) {
            assert!(direction.distance(expected) < 1e-6, "{direction}");
        }
        assert!(directions.iter().all(|direction| direction.is_normalized()));
        let apart = directions
            .iter()
            .enumerate()
            .flat_map(|(i, a)| directions[..i].iter().map(move |b| a.distance(*b)));
        assert!(apart.fold(2.0, f32::min) > 0.3);
        let few = ImpostorOptions { sides: 4, upper_sides: 0, from_above: false, ..options };
        assert_eq!(few.directions().len(), 4);
    }

    #[test]
    fn what_is_out_of_range_is_named() {
        let fault = |options: ImpostorOptions| options.check().unwrap_err().to_string();
        let default = ImpostorOptions::default;
        assert!(fault(ImpostorOptions { sides: 6, ..default() }).contains("a multiple of 4"));
        assert!(fault(ImpostorOptions { upper_sides: 65, ..default() }).contains("upper sides"));
        assert!(fault(ImpostorOptions { rows: 7, ..default() }).contains("8 to 1024"));
    }
}
