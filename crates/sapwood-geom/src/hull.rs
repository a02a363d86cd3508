//! Outlines of points in a plane: their convex hull, and the smallest circle around them.

use glam::Vec2;

/// A circle in a plane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Circle {
    /// Its middle.
    pub center: Vec2,
    /// Its radius; 0 for a single point.
    pub radius: f32,
}

/// The corners of the smallest convex polygon around all points, counter-clockwise (x to the right,
/// y up), from the leftmost one on; no three of them lie on a line.
///
/// Fewer than three where all points lie on a line, none where there are none. Points that are not
/// finite are left out.
pub fn convex_hull(points: impl IntoIterator<Item = Vec2>) -> Vec<Vec2> {
    let mut sorted: Vec<Vec2> = points.into_iter().filter(|point| point.is_finite()).collect();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    sorted.dedup();
    if sorted.len() < 3 {
        return sorted;
    }
    let mut hull: Vec<Vec2> = Vec::new();
    // The lower side from left to right, then the upper one from right to left.
    for point in &sorted {
        push_turning_left(&mut hull, 0, *point);
    }
    let first = hull.len() - 1;
    for point in sorted.iter().rev().skip(1) {
        push_turning_left(&mut hull, first, *point);
    }
    hull.pop();
    hull
}

/// Adds a point, and takes back those after `first` at which the outline would not turn left.
fn push_turning_left(hull: &mut Vec<Vec2>, first: usize, point: Vec2) {
    while let [.., a, b] = hull[first..]
        && turn(a, b, point) <= 0.0
    {
        hull.pop();
    }
    hull.push(point);
}

/// Above 0 where the way from `a` over `b` to `c` turns left; exact but for coordinates of very
/// different size.
fn turn(a: Vec2, b: Vec2, c: Vec2) -> f64 {
    let [a, b, c] = [a, b, c].map(|point| point.as_dvec2());
    (b - a).perp_dot(c - a)
}

/// The smallest circle around all points, widened so that no rounding leaves one outside; nothing
/// where there are none.
///
/// Costs the hull, and up to the cube of its corners.
pub fn smallest_circle(points: impl IntoIterator<Item = Vec2>) -> Option<Circle> {
    let corners = convex_hull(points);
    let mut circle = Circle { center: *corners.first()?, radius: 0.0 };
    // A point outside of the circle around those before it lies on the border of the next one.
    for (i, a) in corners.iter().enumerate() {
        if circle.contains(*a) {
            continue;
        }
        circle = Circle { center: *a, radius: 0.0 };
        for (j, b) in corners[..i].iter().enumerate() {
            if circle.contains(*b) {
                continue;
            }
            circle = Circle::across(*a, *b);
            for c in &corners[..j] {
                if !circle.contains(*c) {
                    circle = Circle::through(*a, *b, *c).unwrap_or(circle);
                }
            }
        }
    }
    let distances = corners.iter().map(|corner| corner.distance(circle.center));
    Some(Circle { radius: distances.fold(0.0, f32::max), ..circle })
}

impl Circle {
    /// Whether a point lies inside, or outside by less than a rounding.
    fn contains(&self, point: Vec2) -> bool {
        point.distance(self.center) <= self.radius * (1.0 + 1e-6)
    }

    /// With the way between two points as its diameter.
    fn across(a: Vec2, b: Vec2) -> Self {
        Self { center: 0.5 * (a + b), radius: 0.5 * a.distance(b) }
    }

    /// Through three points, unless they lie on a line.
    fn through(a: Vec2, b: Vec2, c: Vec2) -> Option<Self> {
        let [ab, ac] = [b - a, c - a].map(|way| way.as_dvec2());
        let twice_area = 2.0 * ab.perp_dot(ac);
        let offset =
            (ab.length_squared() * ac.perp() - ac.length_squared() * ab.perp()) / -twice_area;
        let circle = Self { center: a + offset.as_vec2(), radius: offset.length() as f32 };
        (twice_area != 0.0 && circle.center.is_finite()).then_some(circle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Purpose, Stream, StreamPath};

    fn hull(points: &[(f32, f32)]) -> Vec<(f32, f32)> {
        let points = points.iter().map(|(x, y)| Vec2::new(*x, *y));
        convex_hull(points).into_iter().map(|point| (point.x, point.y)).collect()
    }

    fn cloud(seed: u64, n: usize) -> Vec<Vec2> {
        let mut dice = Stream::new(StreamPath::new(seed), Purpose("hull"));
        (0..n).map(|_| Vec2::new(dice.unit() * 7.0, dice.unit() * 3.0)).collect()
    }

    #[test]
    fn corners_are_those_of_the_outline() {
        let square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        assert_eq!(hull(&square), square);
        // Points inside, on an edge, and twice.
        let more = [square.as_slice(), &[(0.5, 0.5), (0.5, 0.0), (1.0, 1.0)]].concat();
        assert_eq!(hull(&more), square);
        assert_eq!(hull(&[(2.0, 2.0), (0.0, 0.0), (1.0, 1.0)]), [(0.0, 0.0), (2.0, 2.0)]);
        assert_eq!(hull(&[(3.0, 1.0), (3.0, 1.0)]), [(3.0, 1.0)]);
        assert_eq!(hull(&[(f32::NAN, 1.0)]), []);
    }

    #[test]
    fn no_point_is_left_outside() {
        for seed in 0..20 {
            let points = cloud(seed, 200);
            let hull = convex_hull(points.iter().copied());
            let circle = smallest_circle(points.iter().copied()).unwrap();
            let edges = hull.iter().zip(hull.iter().cycle().skip(1));
            for (a, b) in edges {
                assert!(points.iter().all(|point| turn(*a, *b, *point) >= 0.0), "seed {seed}");
            }
            assert!(points.iter().all(|p| p.distance(circle.center) <= circle.radius * 1.000_01));
            // Held by two points across from each other, or by three: nothing smaller would do.
            let is_held = |p: &&Vec2| p.distance(circle.center) >= circle.radius * 0.999_9;
            let holders: Vec<Vec2> = hull.iter().filter(is_held).copied().collect();
            let inside = convex_hull(holders.iter().copied().chain([circle.center]));
            let is_corner = inside.contains(&circle.center) && inside.len() > 2;
            let is_smallest = match &holders[..] {
                [a, b] => a.distance(*b) >= 1.999 * circle.radius,
                holders => holders.len() > 2 && !is_corner,
            };
            assert!(is_smallest, "seed {seed}");
        }
    }

    #[test]
    fn circles_around_few_points() {
        let circle = |points: &[(f32, f32)]| {
            let circle = smallest_circle(points.iter().map(|(x, y)| Vec2::new(*x, *y)))?;
            Some((circle.center.x, circle.center.y, circle.radius))
        };
        assert_eq!(circle(&[]), None);
        assert_eq!(circle(&[(1.0, 2.0)]), Some((1.0, 2.0, 0.0)));
        assert_eq!(circle(&[(0.0, 0.0), (4.0, 0.0), (2.0, 1.0)]), Some((2.0, 0.0, 2.0)));
        let (x, y, radius) = circle(&[(-1.0, 0.0), (1.0, 0.0), (0.0, 3.0)]).unwrap();
        assert!(x.abs() < 1e-6 && (y - 4.0 / 3.0).abs() < 1e-6, "{x} {y}");
        assert!((radius - 5.0 / 3.0).abs() < 1e-6, "{radius}");
    }
}
