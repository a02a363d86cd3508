//! Skeletons as SVG: every polyline seen from the front, as thick as its stem, and texts.
//!
//! The view is along -z: world x to the right, y up, drawn to scale with a ruler in metres.
//! Depth, colour and surfaces are left to pictures.

mod labels;
mod map;

use std::fmt::Write as _;
use std::path::Path;

use sapwood_geom::Polyline;
use sapwood_geom::glam::{Affine3, Vec2};

use sapwood_graph::{DrawList, Kind, LineRow};

use crate::{Error, ErrorKind, FileSet};
use labels::Text;

pub use map::{svg_map, write_svg_map};

/// Height of the picture in pixels, at the size that a viewer shows it first.
const PIXELS: f32 = 1000.0;
/// The thinnest stroke, in those pixels.
const THINNEST: f32 = 0.7;

/// The polylines and lines of text of `list` as an SVG text, seen from the front.
///
/// The same list gives the same text. A list with neither gives an empty picture.
///
/// # Errors
/// When a point or a radius is not finite, or a text has no size.
pub fn svg(list: &DrawList) -> Result<String, Error> {
    let (mut strokes, mut texts) = (Vec::new(), Vec::new());
    for occurrence in &list.occurrences {
        let body = &list.bodies[occurrence.body as usize];
        for row in &body.lines {
            flatten(body.kind, &(occurrence.world * row.local), row, &mut strokes)?;
        }
        for row in &body.labels {
            let text = Text::of(&row.label, &(occurrence.world * row.local));
            texts.push(text.map_err(|reason| unwritable(body.kind, reason))?);
        }
    }
    let frame = Frame::around(&strokes, texts.iter().flat_map(Text::corners));
    let (mut outlines, mut threads) = (String::new(), String::new());
    for stroke in &strokes {
        let drawn = stroke.simplified(frame.thinnest);
        if drawn.iter().all(|(_, radius)| *radius <= frame.thinnest) {
            frame.path(&mut threads, drawn.iter().map(|(point, _)| *point), false);
        } else {
            frame.path(&mut outlines, outline(&drawn, frame.thinnest), true);
        }
    }
    let mut written = String::new();
    texts.iter().for_each(|text| text.draw(&frame, &mut written));
    Ok(frame.document(&outlines, &threads, &written))
}

/// Writes what [`svg`] gives to the file at `path`, whole or not at all.
///
/// # Errors
/// Those of [`svg`] and of [`write_atomically`](crate::write_atomically).
pub fn write_svg(path: impl AsRef<Path>, list: &DrawList) -> Result<(), Error> {
    let mut files = FileSet::new();
    files.add_svg(path, list)?;
    files.commit()
}

/// SVG.
impl FileSet {
    /// Adds what [`write_svg`] writes.
    ///
    /// # Errors
    /// Those of [`write_svg`].
    pub fn add_svg(&mut self, path: impl AsRef<Path>, list: &DrawList) -> Result<(), Error> {
        let path = path.as_ref();
        let text = svg(list).map_err(|error| error.in_file(&path.display().to_string()))?;
        self.write(path, |out| out.write_all(text.as_bytes()))
    }
}

fn unwritable(kind: Kind, reason: String) -> Error {
    Error::new(ErrorKind::Unwritable { component: kind.name().to_owned(), reason })
}

/// A polyline in the plane of the picture, in metres, y up.
struct Stroke(Vec<(Vec2, f32)>);

fn flatten(
    kind: Kind,
    place: &Affine3,
    row: &LineRow,
    strokes: &mut Vec<Stroke>,
) -> Result<(), Error> {
    // A stem stretched unevenly has no one radius; it keeps its volume.
    let stretch = libm::cbrtf(place.matrix3.determinant().abs());
    for line in row.drawn().iter() {
        let stroke = flatten_line(line, place, stretch).ok_or_else(|| {
            unwritable(kind, "a point or a radius of its lines is not finite".to_owned())
        })?;
        if !stroke.0.is_empty() {
            strokes.push(stroke);
        }
    }
    Ok(())
}

fn flatten_line(line: &Polyline, place: &Affine3, stretch: f32) -> Option<Stroke> {
    let radii = line.radii.iter().copied().chain(std::iter::repeat(0.0));
    let points = line.points.iter().zip(radii).map(|(point, radius)| {
        let (point, radius) = (place.transform_point3(*point), radius * stretch);
        (point.is_finite() && radius.is_finite()).then(|| (point.truncate(), radius.max(0.0)))
    });
    points.collect::<Option<Vec<_>>>().map(Stroke)
}

impl Stroke {
    /// The stroke without points that lie within `step` of the one before; the ends stay.
    fn simplified(&self, step: f32) -> Vec<(Vec2, f32)> {
        let mut kept: Vec<(Vec2, f32)> = Vec::with_capacity(self.0.len());
        for (i, point) in self.0.iter().enumerate() {
            let near = kept.last().is_some_and(|last| last.0.distance(point.0) < step);
            if near && i + 1 == self.0.len() && kept.len() > 1 {
                kept.pop();
            }
            if !near || i + 1 == self.0.len() {
                kept.push(*point);
            }
        }
        kept
    }
}

/// The outline of a tapering stroke: up its left side and down its right.
fn outline(points: &[(Vec2, f32)], thinnest: f32) -> impl Iterator<Item = Vec2> {
    let sides: Vec<(Vec2, Vec2)> = (0..points.len())
        .map(|i| {
            let before = points[i.saturating_sub(1)].0;
            let after = points[(i + 1).min(points.len() - 1)].0;
            // A stem seen end on has no direction in the picture; it is drawn level.
            let along = (after - before).normalize_or(Vec2::Y);
            let aside = along.perp() * points[i].1.max(thinnest);
            (points[i].0 + aside, points[i].0 - aside)
        })
        .collect();
    let left: Vec<Vec2> = sides.iter().map(|side| side.0).collect();
    let right: Vec<Vec2> = sides.iter().rev().map(|side| side.1).collect();
    left.into_iter().chain(right)
}

/// What of the world the picture shows, and in which steps its numbers go.
struct Frame {
    min: Vec2,
    max: Vec2,
    /// The height where the ruler stands: the ground, or the lowest point above it.
    foot: f32,
    /// Units of the picture in one metre; a power of ten.
    per_metre: f32,
    /// Half the thinnest stroke, in metres.
    thinnest: f32,
}

impl Frame {
    fn around(strokes: &[Stroke], corners: impl Iterator<Item = Vec2>) -> Self {
        let (mut min, mut max) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        let mut foot = f32::INFINITY;
        for (point, radius) in strokes.iter().flat_map(|stroke| &stroke.0) {
            min = min.min(*point - *radius);
            max = max.max(*point + *radius);
            foot = foot.min(point.y);
        }
        for corner in corners {
            min = min.min(corner);
            max = max.max(corner);
        }
        if foot == f32::INFINITY {
            foot = min.y;
        }
        if !(min.cmple(max).all()) {
            (min, max, foot) = (Vec2::ZERO, Vec2::ONE, 0.0);
        }
        let extent = (max - min).max_element().max(1e-3);
        // Room on the left for the ruler.
        min -= Vec2::new(0.12, 0.04) * extent;
        max += 0.04 * extent;
        Self::showing([min, max], extent, if max.y > 0.0 { foot.max(0.0) } else { foot })
    }

    /// What lies between two corners, margins included; `extent` is without them.
    fn showing([min, max]: [Vec2; 2], extent: f32, foot: f32) -> Self {
        // At least 5,000 units across, and none larger than a metre.
        let mut per_metre = 1.0;
        while extent * per_metre < 5000.0 && per_metre < 1e6 {
            per_metre *= 10.0;
        }
        Self {
            min,
            max,
            foot,
            per_metre,
            thinnest: 0.5 * THINNEST * (max.y - min.y).max(max.x - min.x) / PIXELS,
        }
    }

    /// A point in the whole units of the picture, y down.
    fn units(&self, point: Vec2) -> (i64, i64) {
        let scaled = Vec2::new(point.x - self.min.x, self.max.y - point.y) * self.per_metre;
        (scaled.x.round() as i64, scaled.y.round() as i64)
    }

    fn length(&self, metres: f32) -> i64 {
        (metres * self.per_metre).round().max(1.0) as i64
    }

    /// Adds a path in relative steps between rounded points, so that rounding does not add up.
    fn path(&self, text: &mut String, points: impl Iterator<Item = Vec2>, closed: bool) {
        let mut last: Option<(i64, i64)> = None;
        let mut n_steps = 0;
        for point in points {
            let (x, y) = self.units(point);
            match last {
                None => write_pair(text, "M", x, y),
                Some(last) if last == (x, y) => continue,
                Some((last_x, last_y)) => {
                    let letter = if n_steps == 0 { "l" } else { " " };
                    write_pair(text, letter, x - last_x, y - last_y);
                    n_steps += 1;
                }
            }
            last = Some((x, y));
        }
        if n_steps == 0 {
            // A dot: a path of length zero shows by its round caps.
            text.push_str("h0");
        } else if closed {
            text.push('z');
        }
        text.push('\n');
    }

    fn document(&self, outlines: &str, threads: &str, written: &str) -> String {
        let size = self.max - self.min;
        let (width, height) = (self.length(size.x), self.length(size.y));
        let [wide, high] = self.pixels();
        let mut text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{wide}\" height=\"{high}\" \
             viewBox=\"0 0 {width} {height}\">\n\
             <desc>Seen from the front; one unit is {unit} m.</desc>\n\
             <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
            unit = 1.0 / self.per_metre,
        );
        self.strokes(outlines, threads, &mut text);
        text.push_str(written);
        self.ruler(&mut text);
        text.push_str("</svg>\n");
        text
    }

    /// Width and height in pixels, at the size that a viewer shows first.
    fn pixels(&self) -> [i64; 2] {
        let size = self.max - self.min;
        (size * (PIXELS / size.max_element())).to_array().map(|pixels| pixels.round() as i64)
    }

    /// Adds paths of strokes that were written before.
    fn strokes(&self, outlines: &str, threads: &str, text: &mut String) {
        if !threads.is_empty() {
            let thick = self.length(2.0 * self.thinnest);
            let _ = writeln!(
                text,
                "<path fill=\"none\" stroke=\"#7a6248\" stroke-width=\"{thick}\" \
                 stroke-linecap=\"round\" d=\"{}\"/>",
                threads.trim_end()
            );
        }
        if !outlines.is_empty() {
            // Stems that meet or fold over themselves stay filled.
            let _ = writeln!(
                text,
                "<path fill=\"#4a3626\" fill-rule=\"nonzero\" d=\"{}\"/>",
                outlines.trim_end()
            );
        }
    }

    /// An upright scale bar with its length in metres, standing on the ground.
    fn ruler(&self, text: &mut String) {
        let size = self.max - self.min;
        let metres = round_length(0.5 * size.y);
        let (x, y) = self.units(Vec2::new(self.min.x + 0.04 * size.x, self.foot));
        let tick = self.length(0.01 * size.max_element());
        let tall = self.length(metres);
        let thick = self.length(2.0 * self.thinnest);
        let font = self.length(0.022 * size.max_element());
        let _ = writeln!(
            text,
            "<path fill=\"none\" stroke=\"#555\" stroke-width=\"{thick}\" \
             d=\"M{} {y}h{}m-{tick} 0v-{tall}m-{tick} 0h{}\"/>",
            x - tick,
            2 * tick,
            2 * tick,
        );
        let _ = writeln!(
            text,
            "<text x=\"{}\" y=\"{}\" font-family=\"DejaVu Sans, Arial, sans-serif\" \
             font-size=\"{font}\" fill=\"#555\">{metres} m</text>",
            x - tick,
            y - tall - font / 2,
        );
    }
}

/// The largest 1, 2 or 5 times a power of ten that is at most `limit`; at least a tenth of a
/// millimetre.
fn round_length(limit: f32) -> f32 {
    let lengths = (0..36).map(|step| [1.0, 2.0, 5.0][step % 3] * POWERS_OF_TEN[step / 3] / 1e4);
    lengths.take_while(|length| *length <= limit).last().unwrap_or(1e-4)
}

/// A table, for `powi` may round differently from one build to another. Ruler lengths are counted
/// in tenths of millimetres by it, then divided: so they print as short decimals.
const POWERS_OF_TEN: [f32; 12] = [1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11];

/// A command letter and two numbers; a minus sign separates as well as a space.
fn write_pair(text: &mut String, letter: &str, x: i64, y: i64) {
    let first = if letter == " " && x < 0 { "" } else { letter };
    let gap = if y < 0 { "" } else { " " };
    let _ = write!(text, "{first}{x}{gap}{y}");
}

#[cfg(test)]
mod tests {
    use super::*;
    use sapwood_geom::Shared;
    use sapwood_geom::glam::Vec3;
    use sapwood_graph::{Body, Named, Occurrence};

    struct Tree;

    impl Named for Tree {
        const NAME: &'static str = "tree";
    }

    fn list(lines: Vec<Polyline>) -> DrawList {
        let lines = vec![LineRow {
            local: Affine3::IDENTITY,
            lines: Shared::new(lines),
            material: None,
            range: None,
        }];
        DrawList {
            bodies: vec![Body { lines, ..Body::new(Kind::of::<Tree>()) }],
            occurrences: vec![Occurrence { body: 0, world: Affine3::IDENTITY }],
        }
    }

    fn trunk() -> Polyline {
        Polyline { points: vec![Vec3::ZERO, Vec3::Y * 10.0], radii: vec![0.25, 0.0] }
    }

    #[test]
    fn a_tapering_trunk_is_an_outline_in_short_numbers() {
        let text = svg(&list(vec![trunk()])).unwrap();
        assert!(text.contains("one unit is 0.001 m"), "{text}");
        assert!(text.contains("<path fill=\"#4a3626\""), "{text}");
        assert!(text.contains("5 m</text>"), "{text}");
        let again = svg(&list(vec![trunk()])).unwrap();
        assert_eq!(text, again);
    }

    #[test]
    fn up_in_the_world_is_up_in_the_picture() {
        let frame = Frame::around(
            &[Stroke(vec![(Vec2::ZERO, 0.1), (Vec2::Y * 10.0, 0.1)])],
            std::iter::empty(),
        );
        assert!(frame.units(Vec2::Y * 10.0).1 < frame.units(Vec2::ZERO).1);
        assert!(frame.units(Vec2::X).0 > frame.units(Vec2::ZERO).0);
    }

    #[test]
    fn twigs_stay_visible_and_dots_are_drawn() {
        let twig = Polyline { points: vec![Vec3::X, Vec3::X + Vec3::Y], radii: vec![1e-4; 2] };
        let end_on = Polyline { points: vec![Vec3::X, Vec3::X + Vec3::Z], radii: vec![1e-4; 2] };
        let text = svg(&list(vec![trunk(), twig, end_on])).unwrap();
        let threads = text.lines().find(|line| line.contains("stroke=\"#7a6248\"")).unwrap();
        assert!(threads.contains("stroke-width=\"8\""), "{threads}");
        assert!(text.contains("h0"), "{text}");
    }

    #[test]
    fn placement_scales_lines_and_radii() {
        let mut scaled = list(vec![trunk()]);
        scaled.occurrences[0].world = Affine3::from_scale(Vec3::splat(0.1));
        let text = svg(&scaled).unwrap();
        assert!(text.contains("one unit is 0.0001 m"), "{text}");
        assert!(text.contains(">0.5 m</text>"), "{text}");
    }

    #[test]
    fn nothing_gives_an_empty_picture_and_nan_an_error() {
        assert!(svg(&DrawList::default()).unwrap().ends_with("</svg>\n"));
        let mut bad = trunk();
        bad.points[1].x = f32::NAN;
        let error = svg(&list(vec![bad])).unwrap_err();
        assert!(error.to_string().contains("component 'tree'"), "{error}");
        svg(&list(vec![Polyline::default()])).unwrap();
    }

    #[test]
    fn rulers_have_round_lengths() {
        for (limit, length) in [(12.0, 10.0), (7.4, 5.0), (0.31, 0.2), (0.5, 0.5), (1.9, 1.0)] {
            assert_eq!(round_length(limit), length);
        }
    }
}
