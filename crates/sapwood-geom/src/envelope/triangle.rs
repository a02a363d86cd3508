//! One triangle, as a point in space sees it.

use glam::DVec3;

/// Three corners, counter-clockwise seen from outside.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle(pub(super) [DVec3; 3]);

impl Triangle {
    /// A vector along the normal, as long as the triangle is large.
    pub(super) fn area_vector(&self) -> DVec3 {
        let [a, b, c] = self.0;
        (b - a).cross(c - a) * 0.5
    }

    pub(super) fn middle(&self) -> DVec3 {
        let [a, b, c] = self.0;
        (a + b + c) / 3.0
    }

    /// How much of the view from `eye` the triangle covers, in steradians; above 0 where it is
    /// seen from inside (A. Van Oosterom, J. Strackee: "The solid angle of a plane triangle",
    /// 1983). 0 from its own corners.
    pub(super) fn solid_angle(&self, eye: DVec3) -> f64 {
        let [a, b, c] = self.0.map(|corner| corner - eye);
        let lengths = [a, b, c].map(DVec3::length);
        let [la, lb, lc] = lengths;
        let volume = a.dot(b.cross(c));
        let rest = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
        if volume == 0.0 { 0.0 } else { 2.0 * libm::atan2(volume, rest) }
    }

    /// The square of the distance from `from` (C. Ericson: "Real-Time Collision Detection", 2005,
    /// section 5.1.5).
    pub(super) fn distance_squared(&self, from: DVec3) -> f64 {
        let [a, b, c] = self.0;
        let normal = (b - a).cross(c - a);
        let edges = [(a, b), (b, c), (c, a)];
        let is_over = edges.iter().all(|(p, q)| (*q - *p).cross(from - *p).dot(normal) >= 0.0);
        if is_over && normal != DVec3::ZERO {
            let height = (from - a).dot(normal);
            return height * height / normal.length_squared();
        }
        let to_edge = |(p, q): (DVec3, DVec3)| {
            let along = q - p;
            let t = (from - p).dot(along) / along.length_squared();
            let t = if t.is_finite() { t.clamp(0.0, 1.0) } else { 0.0 };
            (p + along * t).distance_squared(from)
        };
        edges.into_iter().map(to_edge).fold(f64::INFINITY, f64::min)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    const CORNER: Triangle = Triangle([DVec3::X, DVec3::Y, DVec3::Z]);

    #[test]
    fn an_octant_covers_an_eighth_of_the_view() {
        assert!((CORNER.solid_angle(DVec3::ZERO) - PI / 2.0).abs() < 1e-12);
        assert!((CORNER.solid_angle(DVec3::ONE * 1e6)).abs() < 1e-9);
        assert!(CORNER.solid_angle(DVec3::ONE) < 0.0);
        assert_eq!(CORNER.solid_angle(DVec3::X), 0.0);
        let flat = Triangle([DVec3::X, DVec3::X, DVec3::Y]);
        assert_eq!(flat.solid_angle(DVec3::Z), 0.0);
    }

    #[test]
    fn distances_are_to_the_face_an_edge_or_a_corner() {
        let distance = |x, y, z| CORNER.distance_squared(DVec3::new(x, y, z)).sqrt();
        assert!((distance(1.0, 1.0, 1.0) - 2.0 / 3.0f64.sqrt()).abs() < 1e-12);
        assert!((distance(1.0, 1.0, -1.0) - 1.5f64.sqrt()).abs() < 1e-12);
        assert!((distance(3.0, 0.0, 0.0) - 2.0).abs() < 1e-12);
        let flat = Triangle([DVec3::ZERO; 3]);
        assert_eq!(flat.distance_squared(DVec3::X), 1.0);
    }
}
