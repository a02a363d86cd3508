//! Lines of text in a drawing: laid into the picture as their planes are seen from the front.

use std::fmt::Write as _;

use sapwood_geom::glam::{Affine3, Vec2};
use sapwood_graph::{Anchor, Label};

use super::Frame;

/// The height of a capital letter relative to the size of the font, in most faces.
const CAPITAL: f32 = 0.72;

/// A line of text in the plane of the picture.
pub(super) struct Text<'a> {
    label: &'a Label,
    /// From the text's plane to the plane of the picture: origin, and what becomes of a metre
    /// along the line and of one up the letters.
    origin: Vec2,
    along: Vec2,
    up: Vec2,
    /// How long those two are in space, not foreshortened by the view.
    lengths: [f64; 2],
}

impl<'a> Text<'a> {
    /// A text put somewhere; the error says what cannot be drawn.
    pub(super) fn of(label: &'a Label, place: &Affine3) -> Result<Self, String> {
        if let Some(fault) = label.fault() {
            return Err(format!("text '{}' has {fault}", label.text));
        }
        if !place.is_finite() {
            return Err(format!("the place of text '{}' is not finite", label.text));
        }
        let [along, up] = [place.matrix3.x_axis, place.matrix3.y_axis];
        Ok(Self {
            label,
            origin: place.translation.truncate(),
            along: along.truncate(),
            up: up.truncate(),
            lengths: [along, up].map(|axis| axis.as_dvec3().length()),
        })
    }

    /// The corners of a box that holds the text.
    pub(super) fn corners(&self) -> impl Iterator<Item = Vec2> {
        let bound = self.label.bound().aabb;
        let (min, max) = (bound.min, bound.max);
        let corners = [(min.x, min.y), (max.x, min.y), (min.x, max.y), (max.x, max.y)];
        let n = if bound.is_empty() { 0 } else { corners.len() };
        let place = |(x, y): (f32, f32)| self.origin + self.along * x + self.up * y;
        corners.map(place).into_iter().take(n)
    }

    /// Adds the text to a drawing. Seen from its edge it is not there, from behind it is mirrored.
    pub(super) fn draw(&self, frame: &Frame, drawing: &mut String) {
        let Self { label, along, up, .. } = self;
        let ([along, up], [wide, high]) = ([along, up].map(|axis| axis.as_dvec2()), self.lengths);
        // Relative to the text itself, which may be small and seen well.
        let is_seen = along.perp_dot(up).abs() > 1e-6 * wide * high;
        if label.text.is_empty() || !is_seen {
            return;
        }
        let (x, y) = frame.units(self.origin);
        // The scale is the font's, so that four decimals are enough for the matrix.
        let size = frame.length((f64::from(label.height / CAPITAL) * high) as f32);
        let matrix = [along.x, -along.y, -up.x, up.y];
        let [a, b, c, d] = matrix.map(|number| rounded((number / high) as f32));
        let anchor = match label.anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let [red, green, blue, alpha] = label.color;
        let [red, green, blue] = [red, green, blue].map(encoded);
        let alpha = rounded(alpha.clamp(0.0, 1.0));
        // Writing to a text cannot fail.
        let _ = write!(
            drawing,
            "<text transform=\"matrix({a} {b} {c} {d} {x} {y})\" text-anchor=\"{anchor}\" \
             font-family=\"DejaVu Sans, Arial, sans-serif\" font-size=\"{size}\" \
             fill=\"#{red:02x}{green:02x}{blue:02x}\" fill-opacity=\"{alpha}\" \
             xml:space=\"preserve\">"
        );
        drawing.extend(label.text.chars().map(Escaped).map(|c| c.to_string()));
        drawing.push_str("</text>\n");
    }
}

/// A number with four decimals at most.
pub(super) fn rounded(number: f32) -> f32 {
    let rounded = (number * 1e4).round() / 1e4;
    // Not -0.
    if rounded == 0.0 { 0.0 } else { rounded }
}

/// A linear channel as sRGB has it.
pub(super) fn encoded(linear: f32) -> u8 {
    let linear = linear.clamp(0.0, 1.0);
    let encoded = if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * libm::powf(linear, 1.0 / 2.4) - 0.055
    };
    (encoded * 255.0).round() as u8
}

/// A character as XML text has it; what XML cannot hold becomes the replacement character.
struct Escaped(char);

impl std::fmt::Display for Escaped {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.0 {
            '&' => f.write_str("&amp;"),
            '<' => f.write_str("&lt;"),
            '>' => f.write_str("&gt;"),
            '\u{fffe}' | '\u{ffff}' => f.write_char('\u{fffd}'),
            c if c.is_control() && !matches!(c, '\t' | '\n' | '\r') => f.write_char('\u{fffd}'),
            c => f.write_char(c),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::svg;
    use super::*;
    use sapwood_geom::glam::Vec3;
    use sapwood_graph::{Body, DrawList, Kind, LabelRow, Named, Occurrence};

    struct Sign;

    impl Named for Sign {
        const NAME: &'static str = "sign";
    }

    fn list(label: Label, world: Affine3) -> DrawList {
        let labels = vec![LabelRow { local: Affine3::IDENTITY, label }];
        DrawList {
            bodies: vec![Body { labels, ..Body::new(Kind::of::<Sign>()) }],
            occurrences: vec![Occurrence { body: 0, world }],
        }
    }

    #[test]
    fn a_text_is_laid_into_the_picture() {
        let label = Label {
            color: [1.0, 0.25, 0.0, 0.5],
            anchor: Anchor::Middle,
            ..Label::new("a < b & \u{1}", 0.72)
        };
        let text = svg(&list(label, Affine3::from_scale(Vec3::new(2.0, 1.0, 1.0)))).unwrap();
        let line = text.lines().find(|line| line.contains("a &lt; b &amp; \u{fffd}")).unwrap();
        assert!(line.starts_with("<text transform=\"matrix(2 0 0 1 "), "{line}");
        assert!(line.contains("text-anchor=\"middle\""), "{line}");
        assert!(line.contains("fill=\"#ff8900\" fill-opacity=\"0.5\""), "{line}");
        assert!(line.contains("font-size=\"1000\""), "{line}");
    }

    #[test]
    fn from_the_edge_nothing_is_seen() {
        let turned = Affine3::from_rotation_y(std::f32::consts::FRAC_PI_2);
        let text = svg(&list(Label::new("flat", 1.0), turned)).unwrap();
        assert!(!text.contains("flat"), "{text}");
        svg(&list(Label::new("", 1.0), Affine3::IDENTITY)).unwrap();
    }

    #[test]
    fn a_text_that_is_scaled_down_does_not_vanish() {
        let drawn = |height: f32, scale: f32| {
            let world = Affine3::from_scale(Vec3::splat(scale));
            let text = svg(&list(Label::new("hello", height), world)).unwrap();
            let line = text.lines().find(|line| line.contains("hello")).map(str::to_owned);
            line.unwrap_or_else(|| panic!("scale {scale}: {text}"))
        };
        let plain = drawn(0.45, 1.0);
        assert!(plain.starts_with("<text transform=\"matrix(1 0 0 1 "), "{plain}");
        for (height, scale) in [(500.0, 0.0009), (4.5e15, 1e-16), (4.5e-7, 1e6)] {
            let size = |line: &str| {
                let (_, rest) = line.split_once("font-size=\"").unwrap();
                rest.split_once('"').unwrap().0.parse::<f32>().unwrap()
            };
            let line = drawn(height, scale);
            assert!(line.starts_with("<text transform=\"matrix(1 0 0 1 "), "{line}");
            assert!((size(&line) - size(&plain)).abs() <= 1.0, "{line}");
        }
    }

    #[test]
    fn what_has_no_size_is_refused() {
        let error = svg(&list(Label::new("none", 0.0), Affine3::IDENTITY)).unwrap_err();
        assert!(error.to_string().contains("component 'sign'"), "{error}");
        let nowhere = Affine3::from_translation(Vec3::NAN);
        svg(&list(Label::new("lost", 1.0), nowhere)).unwrap_err();
    }
}
