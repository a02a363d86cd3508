//! Cutting lines: the pieces of them on one side of a border.

use sapwood_geom::glam::Vec3;
use sapwood_geom::{Envelope, Polyline, Side, Sphere};

use super::cut::Border;

/// Pieces that a straight part of a line is looked at in.
const PIECES: u32 = 16;

/// The pieces of a line that stay; `is_near` tells whether a straight part may cross the border
/// between ends that lie on the same side.
pub(super) fn cut_line(
    line: &Polyline,
    border: &impl Border,
    is_near: impl Fn(Vec3, Vec3) -> bool,
) -> Vec<Polyline> {
    let mut pieces = Vec::new();
    let mut piece = Polyline::default();
    let add = |piece: &mut Polyline, at: usize, part: f32| {
        let next = (at + 1).min(line.points.len() - 1);
        let point = line.points[at].lerp(line.points[next], part);
        if piece.points.last() != Some(&point) {
            piece.points.push(point);
            piece.radii.push(line.radii[at] + (line.radii[next] - line.radii[at]) * part);
        }
    };
    let mut end = |piece: &mut Polyline| {
        let piece = std::mem::take(piece);
        if piece.points.len() > 1 {
            pieces.push(piece);
        }
    };
    for at in 0..line.points.len().saturating_sub(1) {
        let [from, to] = [line.points[at], line.points[at + 1]];
        let n = if is_near(from, to) { PIECES } else { 1 };
        for i in 0..n {
            let parts = [i, i + 1].map(|i| i as f32 / n as f32);
            let ends = parts.map(|part| from.lerp(to, part));
            let kept = ends.map(|end| border.keeps(end));
            if kept[0] {
                add(&mut piece, at, parts[0]);
            }
            if kept[0] != kept[1] {
                let [stays, goes] = if kept[0] { ends } else { [ends[1], ends[0]] };
                let along = border.between(stays, goes);
                let along = if kept[0] { along } else { 1.0 - along };
                add(&mut piece, at, parts[0] + (parts[1] - parts[0]) * along);
            }
            if kept[1] {
                add(&mut piece, at, parts[1]);
            } else {
                end(&mut piece);
            }
        }
    }
    end(&mut piece);
    pieces
}

/// Whether a straight part may cross an envelope's surface.
pub(super) fn is_near(envelope: &Envelope, from: Vec3, to: Vec3) -> bool {
    let around = Sphere { center: (from + to) * 0.5, radius: from.distance(to) * 0.5 };
    envelope.side_of(&around) == Side::Crossing
}

#[cfg(test)]
mod tests {
    use sapwood_geom::glam::Affine3;

    use super::super::cut::Surface;
    use super::*;

    #[test]
    fn a_line_through_a_ball_is_cut_twice() {
        let envelope = Envelope::sphere(Sphere { center: Vec3::ZERO, radius: 1.0 });
        let line = Polyline { points: vec![Vec3::X * -2.0, Vec3::X * 2.0], radii: vec![0.4, 0.0] };
        let cut = |envelope: &Envelope| {
            let surface = Surface { envelope, world: Affine3::IDENTITY, tolerance: 1e-3 };
            cut_line(&line, &surface, |from, to| is_near(envelope, from, to))
        };
        let inside = cut(&envelope);
        let [piece] = &inside[..] else { panic!("{inside:?}") };
        let (first, last) = (piece.points[0].x, piece.points[piece.points.len() - 1].x);
        assert!((first + 1.0).abs() < 1e-5 && (last - 1.0).abs() < 1e-5, "{piece:?}");
        assert!((piece.radii[0] - 0.3).abs() < 1e-5 && piece.fault().is_none());
        let outside = cut(&envelope.complement());
        assert_eq!(outside.len(), 2);
        assert_eq!(outside[1].points.last(), line.points.last());
    }
}
