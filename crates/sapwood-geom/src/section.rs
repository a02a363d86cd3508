//! Cross-sections of a swept tube: the points around a ring, worked out once and used for every
//! ring of every stem that has as many sides.

use std::borrow::Cow;
use std::sync::OnceLock;

use glam::Vec2;

/// The outline of a tube: a regular polygon, or a polygon around a lobed circle.
///
/// Point 0 lies on the ring's x axis, the others follow counter-clockwise seen from the tube's
/// end; the last point repeats the first exactly, so that a texture can end where it began.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    sides: u32,
    pub(crate) lobed: bool,
    /// Points for radius 1, `sides + 1` of them.
    pub(crate) points: Vec<Vec2>,
    /// Outward normals in the ring's plane: unit vectors on a round section; on a lobed one
    /// `m e_r - m' e_phi`, where `m` is the factor of the radius.
    pub(crate) normals: Vec<Vec2>,
    /// The square of the factor of the radius, what the taper's slope weighs in a normal.
    pub(crate) factors_squared: Vec<f32>,
    /// Normals halfway between a point and the next, `sides` of them.
    pub(crate) middles: Vec<Vec2>,
    /// How far around each point is, 0 to 1.
    pub(crate) around: Vec<f32>,
    /// Vertex numbers of the triangles between a ring and the ring written right after it.
    pub(crate) strip: Vec<u32>,
}

impl Section {
    /// A regular polygon of `sides` sides (at least 3) about a circle of the ring's radius.
    pub fn round(sides: u32) -> Self {
        Self::lobed(sides, 0, 0.0)
    }

    /// As [`round`](Self::round); those of few sides are worked out once and kept.
    pub fn known_round(sides: u32) -> Cow<'static, Self> {
        static KNOWN: [OnceLock<Section>; 64] = [const { OnceLock::new() }; 64];
        match KNOWN.get(sides as usize) {
            Some(known) => Cow::Borrowed(known.get_or_init(|| Self::round(sides))),
            None => Cow::Owned(Self::round(sides)),
        }
    }

    /// A polygon of `sides` sides whose distance from the middle is the ring's radius times
    /// `1 + depth * sin(lobes * angle)`, the angle counted from the ring's x axis.
    ///
    /// Four sides for each lobe meet all its peaks and hollows. The depth is limited to 0.95
    /// either way, so that the outline stays around its middle.
    pub fn lobed(sides: u32, lobes: u32, depth: f32) -> Self {
        let sides = sides.max(3);
        let lobed = lobes > 0 && depth != 0.0;
        let depth = if lobed { depth.clamp(-0.95, 0.95) } else { 0.0 };
        let lobes = lobes as f32;
        let mut section = Self {
            sides,
            lobed,
            points: Vec::with_capacity(sides as usize + 1),
            normals: Vec::with_capacity(sides as usize + 1),
            factors_squared: Vec::with_capacity(sides as usize + 1),
            middles: Vec::with_capacity(sides as usize),
            around: (0..=sides).map(|k| k as f32 / sides as f32).collect(),
            strip: Vec::with_capacity(6 * sides as usize),
        };
        for k in 0..sides {
            let angle = std::f32::consts::TAU * (k as f32 / sides as f32);
            let out = Vec2::new(libm::cosf(angle), libm::sinf(angle));
            let factor = 1.0 + depth * libm::sinf(lobes * angle);
            let change = depth * lobes * libm::cosf(lobes * angle);
            section.points.push(out * factor);
            section.normals.push(out * factor - out.perp() * change);
            section.factors_squared.push(factor * factor);
            let ring = sides + 1;
            section.strip.extend([k, k + 1, k + ring, k + 1, k + 1 + ring, k + ring]);
        }
        section.points.push(section.points[0]);
        section.normals.push(section.normals[0]);
        section.factors_squared.push(section.factors_squared[0]);
        let edges = section.points.windows(2);
        section
            .middles
            .extend(edges.map(|ends| -(ends[1] - ends[0]).perp().normalize_or(-ends[0])));
        section
    }

    /// Number of sides.
    pub fn n_sides(&self) -> u32 {
        self.sides
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_point_repeats_the_first() {
        for section in [Section::round(5), Section::lobed(20, 5, 0.2)] {
            assert_eq!(section.points.first(), section.points.last());
            assert_eq!(section.points.len(), section.n_sides() as usize + 1);
        }
        assert_eq!(Section::round(0).n_sides(), 3);
    }

    #[test]
    fn four_sides_for_each_lobe_meet_peaks_and_hollows() {
        let section = Section::lobed(20, 5, 0.2);
        let lengths: Vec<f32> = section.points.iter().map(|p| p.length()).collect();
        for (found, expected) in lengths.iter().zip([1.0, 1.2, 1.0, 0.8, 1.0, 1.2]) {
            assert!((found - expected).abs() < 1e-5, "{lengths:?}");
        }
    }

    #[test]
    fn normals_point_out_of_the_edges_beside_them() {
        let section = Section::lobed(28, 7, 0.3);
        for k in 0..28 {
            let normal = section.normals[k];
            let before = section.middles[(k + 27) % 28];
            assert!(normal.dot(section.middles[k]) > 0.0 && normal.dot(before) > 0.0, "{k}");
        }
    }
}
