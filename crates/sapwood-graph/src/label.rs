//! Lines of text.

use sapwood_geom::glam::Vec3;
use sapwood_geom::{Aabb, Bound, Content, Digester, content};

use crate::Named;

/// A line of text in the plane z = 0 of its frame, read from +z: the base line runs along +x,
/// letters stand along +y.
///
/// Which letters there are, and what they look like, is the business of whoever draws.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// What is written.
    pub text: String,
    /// Metres from the base line to the top of a capital letter.
    pub height: f32,
    /// Linear red, green, blue and coverage, each in 0..=1.
    pub color: [f32; 4],
    /// Which end of the line stands at the origin.
    pub anchor: Anchor,
}

content!(Label { text, height, color, anchor });

/// Which end of a line of text stands at the origin.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Anchor {
    /// The beginning.
    #[default]
    Start,
    /// The middle.
    Middle,
    /// The end.
    End,
}

impl Named for Label {
    const NAME: &'static str = "label";
}

impl Label {
    /// How wide a letter is taken to be, relative to the height of a capital: few are wider
    /// in a proportional face.
    const LETTER_WIDTH: f32 = 1.0;
    /// How far letters reach below the base line, relative to the height of a capital.
    const DESCENT: f32 = 0.35;

    /// Black text whose line begins at the origin.
    pub fn new(text: &str, height: f32) -> Self {
        Self { text: text.to_owned(), height, color: [0.0, 0.0, 0.0, 1.0], anchor: Anchor::Start }
    }

    /// A box that holds the text in any usual face, at a capital's height for each letter.
    pub fn bound(&self) -> Bound {
        let n_letters = self.text.chars().count();
        if n_letters == 0 {
            return Bound::EMPTY;
        }
        let width = n_letters as f32 * self.height * Self::LETTER_WIDTH;
        let left = match self.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => -0.5 * width,
            Anchor::End => -width,
        };
        let min = Vec3::new(left, -self.height * Self::DESCENT, 0.0);
        Bound::of_box(Aabb { min, max: Vec3::new(left + width, self.height, 0.0) })
    }

    /// What is wrong with the label's numbers, in words, or nothing.
    pub fn fault(&self) -> Option<String> {
        let Self { height, color, .. } = self;
        if !(height.is_finite() && *height > 0.0) {
            return Some(format!("letters {height} m high; they must be above 0"));
        }
        let is_channel = |channel: &f32| (0.0..=1.0).contains(channel);
        (!color.iter().all(is_channel)).then(|| format!("colour {color:?}; each in 0..=1"))
    }
}

impl Content for Anchor {
    fn write(&self, digester: &mut Digester) {
        digester.add(&(*self as u8));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_anchor_moves_the_line() {
        let label = |anchor| Label { anchor, ..Label::new("four", 2.0) };
        let left = |anchor| label(anchor).bound().aabb.min.x;
        assert_eq!([Anchor::Start, Anchor::Middle, Anchor::End].map(left), [0.0, -4.0, -8.0]);
        assert!(Label::new("", 1.0).bound().is_empty());
    }
}
