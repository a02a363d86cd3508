//! Sweeping rings along a curve into the surface of a tube: frames without twist, normals that
//! follow the taper, texture coordinates that close around and keep their proportions along.
//!
//! What the curve is and how thick it is where, the caller decides; here rings become triangles.

mod fork;
mod forked;
mod piece;
#[cfg(test)]
mod tests;
mod write;

use glam::{Vec2, Vec3};

pub use self::fork::Fork;
pub use self::piece::{RingPlane, Swept};
pub use self::write::{Forking, Written};
use crate::Section;

/// A cross-section of a tube: where its middle is and how thick the tube is there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring {
    /// The middle, in metres.
    pub center: Vec3,
    /// The radius in metres; a ring of next to no radius is a point.
    pub radius: f32,
}

/// How an end of a tube is shut; an end whose radius is next to nothing is a point anyway.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Cap {
    /// Not at all.
    #[default]
    Open,
    /// With a flat disc.
    Flat,
    /// With half a sphere of the ring's radius, beyond the last ring.
    Round,
}

/// The ring that a tube starts with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweepStart {
    /// Direction of the section's first point, made square to the tangent.
    pub x: Vec3,
    /// Unit normal of the first ring's plane; none takes the direction to the second ring.
    pub tangent: Option<Vec3>,
    /// Texture coordinate `u` of the section's first point.
    pub u: f32,
    /// Texture coordinate `v` of the first ring.
    pub v: f32,
}

impl SweepStart {
    /// A start of its own, whose section's first point lies toward `x`.
    pub fn toward(x: Vec3) -> Self {
        Self { x, tangent: None, u: 0.0, v: 0.0 }
    }
}

/// How a tube is made of its rings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweepOptions {
    /// The first ring's frame.
    pub start: SweepStart,
    /// How the texture goes around the tube.
    ///
    /// Along the tube it repeats as often as keeps its proportions, so more often where the same
    /// number of repeats goes round a thinner tube; `v` falls from the base to the tip, so that the image stands upright.
    pub around: Around,
    /// How the first ring is shut; a round cap there is drawn flat.
    pub base: Cap,
    /// How the last ring is shut.
    pub tip: Cap,
}

impl Default for SweepOptions {
    fn default() -> Self {
        let start = SweepStart::toward(Vec3::X);
        Self { start, around: Around::Repeats(1), base: Cap::Open, tip: Cap::Flat }
    }
}

/// How a texture goes around a tube. Either way it closes without a seam, if it tiles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Around {
    /// So many times, at least once, however thick the tube is.
    Repeats(u32),
    /// As much of it as the way around is long, the texture being so many metres wide: half of
    /// that to the far side, and the same mirrored back. For tubes so thin that a whole texture
    /// would be squeezed; it keeps its size where the tube tapers.
    Mirrored {
        /// The texture's width in metres.
        width: f32,
    },
}

impl Around {
    /// How many widths of the texture the way around a ring of this radius is long.
    fn widths(self, radius: f32) -> f32 {
        match self {
            Self::Repeats(n) => n.max(1) as f32,
            Self::Mirrored { width } => std::f32::consts::TAU * radius / width.max(1e-6),
        }
    }
}

/// A ring with all that its vertices share.
#[derive(Clone, Copy, Debug)]
struct Laid {
    center: Vec3,
    radius: f32,
    /// Metres below which `f32` cannot tell points here apart.
    blur: f32,
    /// Whether the ring is drawn as a point.
    is_point: bool,
    /// Unit vector and distance to the next ring.
    onward: Vec3,
    length: f32,
    tangent: Vec3,
    x: Vec3,
    v: f32,
    /// Normal of the stretch to the next ring, in the plane of outward (x) and tangent (y).
    slope: Vec2,
}

impl Laid {
    /// Whether triangles of the ring would be degenerate beside a stretch of this length.
    fn is_thin(&self, length: f32) -> bool {
        self.radius <= self.blur.max(4e-5 * length).max(1e-6)
    }
}

/// Turns rings into triangles; holds the working memory, so that sweeping many tubes with one of
/// these allocates nothing but the mesh.
///
/// A tube is laid first (frames, number of triangles) and written then, so that a caller can
/// refuse it in between.
#[derive(Clone, Debug)]
pub struct Sweep {
    laid: Vec<Laid>,
    /// For each ring given, its row in `laid`.
    rows: Vec<u32>,
    around: Around,
    u: f32,
    base: Cap,
    tip: Cap,
}

impl Default for Sweep {
    fn default() -> Self {
        let SweepOptions { start, around, base, tip } = SweepOptions::default();
        Self { laid: Vec::new(), rows: Vec::new(), around, u: start.u, base, tip }
    }
}

/// Metres that `f32` cannot tell apart, for each metre from the origin.
const BLUR: f32 = 2e-6;

/// Rings of half a sphere between its rim and its pole: sine and cosine of 30 and 60 degrees.
const DOME: [(f32, f32); 2] = [(0.5, 0.866_025_4), (0.866_025_4, 0.5)];

impl Sweep {
    /// Working memory for tubes of so many rings; for longer ones it grows.
    pub fn with_room(n_rings: usize) -> Self {
        let (laid, rows) = (Vec::with_capacity(n_rings), Vec::with_capacity(n_rings));
        Self { laid, rows, ..Self::default() }
    }

    /// Lays a tube through `rings` and returns the number of triangles it has for `section`.
    ///
    /// Rings turn from one to the next without twist, first toward the stretch between them, then
    /// into the next ring's plane, which lies between the planes square to the two stretches
    /// that it joins, nearer to the shorter one's. A ring that coincides with the one before is
    /// left out. Points are rings below 1e-6 m, or so thin against their distance from the origin
    /// or from the next ring that `f32` could not tell their vertices apart.
    pub fn lay(&mut self, section: &Section, rings: &[Ring], options: &SweepOptions) -> usize {
        self.around = options.around;
        self.u = options.start.u;
        self.base = options.base;
        self.tip = options.tip;
        self.laid.clear();
        self.rows.clear();
        let before_all = options.start.tangent.unwrap_or(Vec3::Z);
        for ring in rings {
            self.keep(ring, before_all);
            self.rows.push(self.laid.len() as u32 - 1);
        }
        if self.tip == Cap::Round {
            self.dome();
        }
        self.turn(&options.start);
        self.n_triangles(section.n_sides() as usize)
    }

    /// The frame of ring number `ring` of those last laid, to start a tube that continues there;
    /// nothing if there is no such ring.
    pub fn start_at(&self, ring: usize) -> Option<SweepStart> {
        let laid = self.laid.get(*self.rows.get(ring)? as usize)?;
        Some(SweepStart { x: laid.x, tangent: Some(laid.tangent), u: self.u, v: laid.v })
    }

    /// The stretches of the tube last laid, in the order in which their triangles are written: how
    /// many each has for `section`, discs at the tube's ends with the nearest, and the rings at
    /// its own ends. None where nothing is written.
    ///
    /// `narrow` tells of each ring at which walls part by how many triangles the stretch behind it
    /// has less: [`Fork::n_narrow`].
    pub fn stretches(
        &self,
        section: &Section,
        narrow: &[(usize, usize)],
    ) -> impl Iterator<Item = (usize, [Ring; 2])> {
        let sides = section.n_sides() as usize;
        let last = self.laid.len().saturating_sub(2);
        let n = if self.n_triangles(sides) == 0 { 0 } else { last + 1 };
        (0..n).map(move |i| {
            let ends = [self.laid[i], self.laid[i + 1]];
            let walls = 2 - ends.iter().filter(|laid| laid.is_point).count();
            let has_base = i == 0 && self.base != Cap::Open && !ends[0].is_point;
            let has_tip = i == last && self.tip != Cap::Open && !ends[1].is_point;
            let discs = usize::from(has_base) + usize::from(has_tip);
            let ring = |laid: Laid| Ring { center: laid.center, radius: laid.radius };
            let is_here = |ring: usize| self.rows.get(ring).is_some_and(|row| *row as usize == i);
            let parting = narrow.iter().filter(|(ring, _)| is_here(*ring));
            let n_missing: usize = parting.map(|(_, n)| n).sum();
            ((walls + discs) * sides - n_missing, ends.map(ring))
        })
    }

    /// Keeps a ring unless it coincides with the one kept last, and works out the stretch
    /// between the two; where they share their middle, the direction before goes on.
    fn keep(&mut self, ring: &Ring, before_all: Vec3) {
        let Ring { center, radius } = *ring;
        let radius = radius.max(0.0);
        let blur = BLUR * center.abs().max_element();
        let mut onward = before_all;
        let mut slope = Vec2::X;
        let before = self.laid.len().checked_sub(2).map(|row| self.laid[row].onward);
        if let Some(last) = self.laid.last_mut() {
            let (step, rise) = (center - last.center, radius - last.radius);
            let length_squared = step.length_squared();
            let apart = length_squared + rise * rise;
            let same = 1e-5 * radius.max(last.radius) + blur;
            if apart <= same * same {
                return;
            }
            last.length = length_squared.sqrt();
            last.onward = if length_squared > (blur * blur).max(1e-12 * rise * rise) {
                step * (1.0 / last.length)
            } else {
                before.unwrap_or(before_all)
            };
            last.slope = Vec2::new(last.length, -rise) * (1.0 / apart.sqrt());
            (onward, slope) = (last.onward, last.slope);
        }
        self.laid.push(Laid {
            center,
            radius,
            blur,
            is_point: false,
            onward,
            length: 0.0,
            tangent: onward,
            x: Vec3::ZERO,
            v: 0.0,
            slope,
        });
    }

    /// Adds the rings of a round cap.
    fn dome(&mut self) {
        let Some(rim) = self.laid.last().copied() else { return };
        if self.laid.len() < 2 || rim.radius <= 1e-6 {
            return;
        }
        for (sine, cosine) in DOME.into_iter().chain([(1.0, 0.0)]) {
            let center = rim.center + rim.onward * (rim.radius * sine);
            self.keep(&Ring { center, radius: rim.radius * cosine }, rim.onward);
        }
    }

    /// Works out which rings are points, all frames and the texture's way along the tube.
    fn turn(&mut self, start: &SweepStart) {
        let Some(first) = self.laid.first_mut() else { return };
        let mut tangent = start.tangent.unwrap_or(first.onward);
        let mut x = upright(start.x, tangent);
        let mut v = start.v;
        (first.tangent, first.x, first.v) = (tangent, x, v);
        first.is_point = first.is_thin(first.length);
        let mut before = *first;
        let last = self.laid.len() - 1;
        for (i, laid) in self.laid.iter_mut().enumerate().skip(1) {
            let next = if i == last {
                before.onward
            } else {
                // The shorter stretch weighs more: a ring must not reach past its neighbours.
                let halfway = before.onward * laid.length + laid.onward * before.length;
                halfway.normalize_or(laid.onward)
            };
            x = sharpen(carry(carry(x, tangent, before.onward), before.onward, next), next);
            tangent = next;
            v -= match self.around {
                Around::Repeats(n) => {
                    let around = std::f32::consts::PI * (before.radius + laid.radius);
                    before.length * n.max(1) as f32 / around.max(1e-6)
                }
                Around::Mirrored { width } => before.length / width.max(1e-6),
            };
            (laid.tangent, laid.x, laid.v) = (tangent, x, v);
            laid.is_point = laid.is_thin(laid.length.max(before.length));
            before = *laid;
        }
    }

    fn n_triangles(&self, sides: usize) -> usize {
        let stretches = self.laid.windows(2);
        let walls: usize =
            stretches.map(|ends| 2 - ends.iter().filter(|laid| laid.is_point).count()).sum();
        let ends = [(self.base, self.laid.first()), (self.tip, self.laid.last())];
        let discs = ends
            .iter()
            .filter(|(cap, laid)| *cap != Cap::Open && laid.is_some_and(|laid| !laid.is_point));
        if walls == 0 { 0 } else { (walls + discs.count()) * sides }
    }
}

/// `vector`, turned as the shortest turn from unit vector `from` to unit vector `to` does; as it
/// is where they are opposite.
fn carry(vector: Vec3, from: Vec3, to: Vec3) -> Vec3 {
    if from == to {
        return vector;
    }
    // Reflecting first along `from` and then along the middle of both is that turn; `vector` is
    // square to `from`, which leaves the second reflection only.
    let middle = from + to;
    let square = middle.length_squared();
    if square < 1e-8 {
        return vector;
    }
    vector - middle * (2.0 * vector.dot(middle) / square)
}

/// `vector` itself if it is a unit vector square to unit vector `tangent`, so that a tube that
/// continues another starts with the same bits, or else the nearest that is.
fn upright(vector: Vec3, tangent: Vec3) -> Vec3 {
    let lean = vector.dot(tangent).abs().max((vector.length_squared() - 1.0).abs());
    if lean < 4e-6 { vector } else { square(vector, tangent) }
}

/// `vector`, nearly a unit vector and nearly square to unit vector `tangent`, made both; a step
/// of Newton's method does for the small errors of a turn.
fn sharpen(vector: Vec3, tangent: Vec3) -> Vec3 {
    let flat = vector - tangent * vector.dot(tangent);
    let length_squared = flat.length_squared();
    if (length_squared - 1.0).abs() > 1e-3 {
        return square(vector, tangent);
    }
    flat * (1.5 - 0.5 * length_squared)
}

/// The unit vector square to unit vector `tangent` that is nearest to `vector`.
fn square(vector: Vec3, tangent: Vec3) -> Vec3 {
    let flat = vector - tangent * vector.dot(tangent);
    flat.try_normalize().unwrap_or_else(|| tangent.any_orthonormal_vector())
}
