//! Maps as SVG: what is drawn, seen from above, north (-z) up, in metres of the world.
//!
//! The picture's own coordinates are the world's x and z. Meshes are areas in their material's
//! colour: flat ones as they are, others by their convex outline. Lines are as thick as they are,
//! lights and cameras are symbols with their names, texts that stand upright are laid down, and there
//! are a scale bar and an arrow to the north. What of a tree is drawn is up to the rules.

use std::fmt::Write as _;
use std::path::Path;

use sapwood_geom::glam::{Affine3, Mat3, Vec2, Vec3};
use sapwood_geom::{FixedSet, Mesh, convex_hull, fixed_state};
use sapwood_graph::{Alpha, Anchor, DrawList, Kind, Label, LightShape, Material};

use super::labels::{Text, encoded, rounded};
use super::{Frame, Stroke, flatten, outline, round_length, unwritable};
use crate::{Error, FileSet};

/// The size of a symbol's half and of its letters, relative to what the map shows.
const SYMBOL: f32 = 0.012;
/// How large a map is of which everything lies at one point, in metres.
const SMALLEST: f32 = 1.0;

/// What `list` draws as a map in SVG, seen from above.
///
/// The same list gives the same text. A list that draws nothing gives an empty map.
///
/// # Errors
/// When something is not finite, or a text has no size.
pub fn svg_map(list: &DrawList) -> Result<String, Error> {
    let list = &list.as_drawn();
    let mut map = Map::default();
    for occurrence in &list.occurrences {
        let body = &list.bodies[occurrence.body as usize];
        let world = above() * occurrence.world;
        for row in &body.rows {
            let places = row.instances.as_ref().map_or(&[Affine3::IDENTITY][..], |all| all);
            let places = places.iter().map(|place| world * row.local * *place);
            map.area(body.kind, &row.mesh, &row.material, places)?;
        }
        for row in &body.lines {
            flatten(body.kind, &(world * row.local), row, &mut map.strokes)?;
        }
        for row in &body.labels {
            map.labels.push((body.kind, row.label.clone(), laid_down(world * row.local)));
        }
        for row in &body.lights {
            if row.light.shape != LightShape::Directional {
                map.symbol(body.kind, Sign::Light, &row.light.name, world * row.local)?;
            }
        }
        for row in &body.cameras {
            map.symbol(body.kind, Sign::Camera, &row.camera.name, world * row.local)?;
        }
    }
    map.document()
}

/// Writes what [`svg_map`] gives to the file at `path`, whole or not at all.
///
/// # Errors
/// Those of [`svg_map`] and of [`write_atomically`](crate::write_atomically).
pub fn write_svg_map(path: impl AsRef<Path>, list: &DrawList) -> Result<(), Error> {
    let mut files = FileSet::new();
    files.add_svg_map(path, list)?;
    files.commit()
}

/// Maps.
impl FileSet {
    /// Adds what [`write_svg_map`] writes.
    ///
    /// # Errors
    /// Those of [`write_svg_map`].
    pub fn add_svg_map(&mut self, path: impl AsRef<Path>, list: &DrawList) -> Result<(), Error> {
        let path = path.as_ref();
        let text = svg_map(list).map_err(|error| error.in_file(&path.display().to_string()))?;
        self.write(path, |out| out.write_all(text.as_bytes()))
    }
}

/// Turns the world so that what is seen from the front was seen from above: x to the right, -z up.
fn above() -> Affine3 {
    Affine3::from_mat3(Mat3::from_cols(Vec3::X, Vec3::Z, Vec3::NEG_Y))
}

/// Where a text stands; one that is seen from its edge is laid down to be read.
fn laid_down(place: Affine3) -> Affine3 {
    let [along, up] = [place.matrix3.x_axis, place.matrix3.y_axis];
    let is_seen =
        along.truncate().perp_dot(up.truncate()).abs() > 1e-3 * along.length() * up.length();
    if is_seen {
        return place;
    }
    let flat = Mat3::from_diagonal(Vec3::new(along.length(), up.length(), 1.0));
    Affine3::from_mat3_translation(flat, place.translation)
}

/// What stands for something without an extent.
#[derive(Clone, Copy)]
enum Sign {
    /// A star.
    Light,
    /// An arrow in the direction of view.
    Camera,
}

/// What is on a map, in the plane of the picture, in metres, y up.
#[derive(Default)]
struct Map {
    areas: Vec<Area>,
    strokes: Vec<Stroke>,
    labels: Vec<(Kind, Label, Affine3)>,
    symbols: Vec<Symbol>,
}

struct Area {
    borders: Vec<Vec<Vec2>>,
    color: [f32; 3],
    coverage: f32,
}

struct Symbol {
    sign: Sign,
    kind: Kind,
    name: String,
    at: Vec2,
    /// Where it looks, if that can be seen from above.
    toward: Option<Vec2>,
}

impl Map {
    fn area(
        &mut self,
        kind: Kind,
        mesh: &Mesh,
        material: &Material,
        places: impl Iterator<Item = Affine3>,
    ) -> Result<(), Error> {
        if let Some(why) = mesh.unsound() {
            return Err(unwritable(kind, why));
        }
        let mut outlines = Outlines { mesh, last: None };
        let mut borders = Vec::new();
        for place in places {
            if !place.is_finite() {
                return Err(unwritable(kind, "the place of a mesh is not finite".to_owned()));
            }
            outlines.add(&place, &mut borders);
        }
        if !borders.iter().flatten().all(|point| point.is_finite()) {
            return Err(unwritable(
                kind,
                "a corner of a mesh is not finite where it stands".into(),
            ));
        }
        let [red, green, blue, coverage] = material.base_color;
        // What an image shows is not looked at.
        let has_image = material.images.base_color.is_some();
        let color = if has_image { [0.4; 3] } else { [red, green, blue] };
        let coverage = if material.alpha == Alpha::Blend { coverage } else { 1.0 };
        self.areas.push(Area { borders, color, coverage });
        Ok(())
    }

    fn symbol(&mut self, kind: Kind, sign: Sign, name: &str, place: Affine3) -> Result<(), Error> {
        if !place.is_finite() {
            return Err(unwritable(kind, "its place is not finite".to_owned()));
        }
        let toward = place.transform_vector3(Vec3::NEG_Z);
        let seen = toward.truncate();
        let toward = (seen.length() > 0.05 * toward.length()).then(|| seen.normalize_or(Vec2::Y));
        let (name, at) = (name.to_owned(), place.translation.truncate());
        self.symbols.push(Symbol { sign, kind, name, at, toward });
        Ok(())
    }

    /// All points that the map must show, but for texts.
    fn points(&self) -> impl Iterator<Item = Vec2> + '_ {
        let areas = self.areas.iter().flat_map(|area| area.borders.iter().flatten().copied());
        let strokes = self.strokes.iter().flat_map(|stroke| &stroke.0);
        let ends = strokes.flat_map(|(point, radius)| [*point - *radius, *point + *radius]);
        areas.chain(ends).chain(self.symbols.iter().map(|symbol| symbol.at))
    }

    fn document(mut self) -> Result<String, Error> {
        let mut bounds = Bounds::around(self.points());
        let letters = SYMBOL * bounds.extent();
        for Symbol { kind, name, at, .. } in self.symbols.iter().filter(|s| !s.name.is_empty()) {
            let label = Label { anchor: Anchor::Middle, ..Label::new(name, letters) };
            let below = (*at - 2.5 * letters * Vec2::Y).extend(0.0);
            self.labels.push((*kind, label, Affine3::from_translation(below)));
        }
        let mut texts = Vec::with_capacity(self.labels.len());
        for (kind, label, place) in &self.labels {
            texts.push(Text::of(label, place).map_err(|reason| unwritable(*kind, reason))?);
        }
        bounds = Bounds::around(self.points().chain(texts.iter().flat_map(Text::corners)));
        let frame = bounds.frame();

        let mut drawing = String::new();
        self.areas.iter().for_each(|area| area.draw(&frame, &mut drawing));
        self.draw_strokes(&frame, &mut drawing);
        self.symbols.iter().for_each(|symbol| symbol.draw(letters, &frame, &mut drawing));
        texts.iter().for_each(|text| text.draw(&frame, &mut drawing));
        frame.scale_bar(&mut drawing);
        frame.north_arrow(&mut drawing);
        Ok(frame.map(&drawing))
    }

    fn draw_strokes(&self, frame: &Frame, drawing: &mut String) {
        let (mut outlines, mut threads) = (String::new(), String::new());
        for stroke in &self.strokes {
            let drawn = stroke.simplified(frame.thinnest);
            if drawn.iter().all(|(_, radius)| *radius <= frame.thinnest) {
                frame.path(&mut threads, drawn.iter().map(|(point, _)| *point), false);
            } else {
                frame.path(&mut outlines, outline(&drawn, frame.thinnest), true);
            }
        }
        frame.strokes(&outlines, &threads, drawing);
    }
}

/// The outlines of one mesh at many places.
struct Outlines<'a> {
    mesh: &'a Mesh,
    /// The direction of view at the place before, in the mesh's frame, and the vertices that the
    /// outline had there.
    last: Option<(Vec3, Vec<u32>)>,
}

impl Outlines<'_> {
    fn add(&mut self, place: &Affine3, borders: &mut Vec<Vec<Vec2>>) {
        if self.mesh.positions.is_empty() {
            return;
        }
        let seen =
            |vertex: u32| place.transform_point3(self.mesh.positions[vertex as usize]).truncate();
        if let Some(loops) = flat_borders(self.mesh, place) {
            borders.extend(loops.iter().map(|border| border.iter().map(|v| seen(*v)).collect()));
            return;
        }
        let view = place.matrix3.inverse() * Vec3::Z;
        let view = view.normalize_or_zero();
        // Seen from the same side the same vertices lie on the outline, however it is turned.
        if !self.last.as_ref().is_some_and(|(last, _)| view != Vec3::ZERO && *last == view) {
            let vertices = 0..self.mesh.positions.len() as u32;
            let hull = convex_hull(vertices.clone().map(seen));
            let mut corners: FixedSet<[u32; 2]> = FixedSet::with_hasher(fixed_state());
            corners.extend(hull.into_iter().map(bits));
            let on_it = vertices.filter(|vertex| corners.contains(&bits(seen(*vertex))));
            self.last = Some((view, on_it.collect()));
        }
        let on_it = self.last.iter().flat_map(|(_, on_it)| on_it);
        borders.push(convex_hull(on_it.map(|vertex| seen(*vertex))));
    }
}

fn bits(point: Vec2) -> [u32; 2] {
    // As 0 and -0 are the same point.
    (point + Vec2::ZERO).to_array().map(f32::to_bits)
}

/// The borders of a mesh of which every triangle is seen from its front; nothing for others. Edges
/// between two triangles of which each uses vertices of its own count as border.
fn flat_borders(mesh: &Mesh, place: &Affine3) -> Option<Vec<Vec<u32>>> {
    let mut edges: Vec<(u32, u32)> = Vec::with_capacity(mesh.indices.len());
    for triangle in mesh.indices.chunks_exact(3) {
        let corners = [0, 1, 2]
            .map(|i| place.transform_point3(mesh.positions[triangle[i] as usize]).truncate());
        let [a, b, c] = corners;
        if (b - a).perp_dot(c - a) <= 0.0 {
            return None;
        }
        for i in 0..3 {
            edges.push((triangle[i], triangle[(i + 1) % 3]));
        }
    }
    let mut inner: FixedSet<(u32, u32)> = FixedSet::with_hasher(fixed_state());
    inner.extend(edges.iter().map(|(a, b)| (*b, *a)));
    edges.retain(|edge| !inner.contains(edge));
    edges.sort_unstable();
    let mut loops = Vec::new();
    let mut is_used = vec![false; edges.len()];
    for first in 0..edges.len() {
        let mut border = Vec::new();
        let mut edge = first;
        while !is_used[edge] {
            is_used[edge] = true;
            border.push(edges[edge].0);
            let from = edges.partition_point(|(start, _)| *start < edges[edge].1);
            let ways = (from..edges.len()).take_while(|i| edges[*i].0 == edges[edge].1);
            match ways.into_iter().find(|way| !is_used[*way]) {
                Some(way) => edge = way,
                None => break,
            }
        }
        if border.len() > 2 {
            loops.push(border);
        }
    }
    Some(loops)
}

impl Area {
    fn draw(&self, frame: &Frame, drawing: &mut String) {
        let mut path = String::new();
        for border in &self.borders {
            frame.path(&mut path, border.iter().copied(), true);
        }
        if path.is_empty() {
            return;
        }
        let [red, green, blue] = self.color.map(encoded);
        let coverage = rounded(self.coverage.clamp(0.0, 1.0));
        let _ = writeln!(
            drawing,
            "<path fill=\"#{red:02x}{green:02x}{blue:02x}\" fill-opacity=\"{coverage}\" d=\"{}\"/>",
            path.trim_end()
        );
    }
}

impl Symbol {
    fn draw(&self, size: f32, frame: &Frame, drawing: &mut String) {
        let mut path = String::new();
        let mut lines = |offsets: &[Vec2], closed: bool| {
            frame.path(&mut path, offsets.iter().map(|offset| self.at + size * *offset), closed);
        };
        match (self.sign, self.toward) {
            (Sign::Light, _) => {
                for way in [Vec2::X, Vec2::Y, Vec2::new(0.7, 0.7), Vec2::new(0.7, -0.7)] {
                    lines(&[-way, way], false);
                }
            }
            (Sign::Camera, Some(toward)) => {
                let aside = 0.6 * toward.perp();
                lines(&[1.2 * toward, aside - 0.8 * toward, -aside - 0.8 * toward], true);
            }
            (Sign::Camera, None) => {
                let corners = [(-0.7, -0.7), (0.7, -0.7), (0.7, 0.7), (-0.7, 0.7)];
                lines(&corners.map(Vec2::from), true);
            }
        }
        let thick = frame.length(2.0 * frame.thinnest);
        let _ = writeln!(
            drawing,
            "<path fill=\"none\" stroke=\"#a33\" stroke-width=\"{thick}\" d=\"{}\"/>",
            path.trim_end()
        );
    }
}

/// The corners of what a map shows.
struct Bounds {
    min: Vec2,
    max: Vec2,
}

impl Bounds {
    fn around(points: impl Iterator<Item = Vec2>) -> Self {
        let all = Self { min: Vec2::INFINITY, max: Vec2::NEG_INFINITY };
        let mut all = points
            .fold(all, |all, point| Self { min: all.min.min(point), max: all.max.max(point) });
        if !all.min.cmple(all.max).all() {
            (all.min, all.max) = (Vec2::ZERO, Vec2::ZERO);
        }
        if all.extent() <= 0.0 {
            all.min -= 0.5 * SMALLEST;
            all.max += 0.5 * SMALLEST;
        }
        all
    }

    fn extent(&self) -> f32 {
        (self.max - self.min).max_element()
    }

    /// With room below for the scale bar, and to the right for the arrow.
    fn frame(&self) -> Frame {
        let extent = self.extent();
        let min = self.min - Vec2::new(0.05, 0.12) * extent;
        let max = self.max + Vec2::new(0.12, 0.05) * extent;
        Frame::showing([min, max], extent, min.y)
    }
}

/// What maps alone have.
impl Frame {
    /// A level scale bar with its length in metres, in the lower left corner.
    fn scale_bar(&self, drawing: &mut String) {
        let size = self.max - self.min;
        let metres = round_length(0.35 * size.x);
        let foot = self.min + Vec2::new(0.05 * size.x, 0.04 * size.max_element());
        let (x, y) = self.units(foot);
        let tick = self.length(0.008 * size.max_element());
        let (wide, thick) = (self.length(metres), self.length(2.0 * self.thinnest));
        let font = self.length(0.022 * size.max_element());
        let _ = writeln!(
            drawing,
            "<path fill=\"none\" stroke=\"#333\" stroke-width=\"{thick}\" \
             d=\"M{x} {top}v{tall}m0-{tick}h{wide}m0-{tick}v{tall}\"/>",
            top = y - tick,
            tall = 2 * tick,
        );
        let _ = writeln!(
            drawing,
            "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\" \
             font-family=\"DejaVu Sans, Arial, sans-serif\" font-size=\"{font}\" \
             fill=\"#333\">{metres} m</text>",
            x + wide / 2,
            y - tick - font / 3,
        );
    }

    /// An arrow to the north, in the upper right corner.
    fn north_arrow(&self, drawing: &mut String) {
        let large = 0.03 * (self.max - self.min).max_element();
        let at = self.max - 1.5 * large;
        let mut path = String::new();
        let arrow = [(0.0, 1.0), (0.5, -1.0), (0.0, -0.6), (-0.5, -1.0)];
        self.path(&mut path, arrow.map(|corner| at + large * Vec2::from(corner)).into_iter(), true);
        let (x, y) = self.units(at - Vec2::new(0.0, 2.2 * large));
        let font = self.length(large);
        let _ = writeln!(
            drawing,
            "<path fill=\"#333\" d=\"{}\"/>\n<text x=\"{x}\" y=\"{y}\" text-anchor=\"middle\" \
             font-family=\"DejaVu Sans, Arial, sans-serif\" font-size=\"{font}\" \
             fill=\"#333\">N</text>",
            path.trim_end(),
        );
    }

    /// The whole map around what is drawn in units of the frame.
    fn map(&self, drawing: &str) -> String {
        let size = self.max - self.min;
        let [wide, high] = self.pixels();
        let [x, y, width, height] = [self.min.x, -self.max.y, size.x, size.y].map(Metres);
        let unit = 1.0 / self.per_metre;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{wide}\" height=\"{high}\" \
             viewBox=\"{x} {y} {width} {height}\">\n\
             <desc>Seen from above, in metres: x to the right, z down, north (-z) up.</desc>\n\
             <rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" fill=\"#fbfaf5\"/>\n\
             <g transform=\"matrix({unit} 0 0 {unit} {x} {y})\">\n{drawing}</g>\n</svg>\n"
        )
    }
}

/// Metres with four decimals at most.
struct Metres(f32);

impl std::fmt::Display for Metres {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let rounded = (f64::from(self.0) * 1e4).round() / 1e4;
        write!(f, "{}", if rounded == 0.0 { 0.0 } else { rounded })
    }
}
