//! Drawing one thing and another at the same place, each in some of the pixels.

use crate::DrawRange;

/// In which of the pixels a thing is drawn, where others are drawn in the rest: those whose number,
/// of a pattern that repeats or by chance, lies from one sixteenth up to another.
///
/// Things that fade into each other have ranges that come to the whole together, so that nothing
/// needs sorting and no pixel shows two of them (dithering; screen-door transparency). As the one
/// gives way to the other, pixels change sides one by one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct CrossFade {
    /// The first sixteenth.
    pub first: u8,
    /// The one behind the last, up to [`STEPS`](Self::STEPS).
    pub end: u8,
}

impl CrossFade {
    /// Into how many steps pixels are divided.
    pub const STEPS: u8 = 16;

    /// Two that come to the whole: the first up to a share from 0 to 1, and the second.
    pub(crate) fn pair(share: f32) -> [Self; 2] {
        let end = (f32::from(Self::STEPS) * share.clamp(0.0, 1.0)).round() as u8;
        [Self { first: 0, end }, Self { first: end, end: Self::STEPS }]
    }

    /// Whether it is drawn in a pixel with a number from 0 to 1.
    pub fn shows(&self, number: f32) -> bool {
        let step = number * f32::from(Self::STEPS);
        (f32::from(self.first)..f32::from(self.end)).contains(&step)
    }

    /// The share of the pixels that it is drawn in.
    pub fn share(&self) -> f32 {
        f32::from(self.end.saturating_sub(self.first)) / f32::from(Self::STEPS)
    }

    /// Whether it is the one to be drawn alone where nothing can be drawn by halves.
    pub fn is_foremost(&self) -> bool {
        let half = Self::STEPS / 2;
        let len = self.end.saturating_sub(self.first);
        len > half || len == half && self.first == 0
    }
}

/// What is drawn of one row, and where.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct DrawnPart {
    /// Which of its triangles, instances or lines.
    pub range: DrawRange,
    /// In which pixels; nothing for all.
    pub cross_fade: Option<CrossFade>,
}

impl DrawnPart {
    /// This part alone.
    pub(crate) fn alone(range: DrawRange) -> DrawnParts {
        [Some(Self { range, cross_fade: None }), None]
    }
}

/// What is drawn of one row: one part, or two that fade into each other.
pub(crate) type DrawnParts = [Option<DrawnPart>; 2];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_are_drawn_in_all_pixels_and_one_is_foremost() {
        for share in [0.0, 0.1, 0.49, 0.5, 0.7, 1.0, f32::NAN] {
            let pair = CrossFade::pair(share);
            assert_eq!(pair[0].share() + pair[1].share(), 1.0);
            assert_eq!(pair.iter().filter(|fade| fade.is_foremost()).count(), 1);
            for number in [0.0, 0.3, 0.5, 0.9999] {
                assert_eq!(pair.iter().filter(|fade| fade.shows(number)).count(), 1);
            }
        }
        assert_eq!(CrossFade::pair(0.3)[0], CrossFade { first: 0, end: 5 });
    }
}
