//! From the table of an outline to polygons, and from polygons to coverage.

use glam::Vec2;

use super::LeafOutline;

/// The polygons of a leaf: across -1 to 1, along 0 to 1. `width` is the image's width against its
/// length, so that teeth stand square to the margin.
pub(super) fn polygons(outline: LeafOutline, width: f32) -> Vec<Vec<Vec2>> {
    if outline == LeafOutline::Needles {
        return needles();
    }
    let half = outline.half();
    let points: Vec<Vec2> = half.points.iter().copied().map(Vec2::from_array).collect();
    let mut right = if half.is_smooth { smoothed(&points) } else { points };
    // The tip of a sharp half may be left to its mirror image.
    if outline == LeafOutline::Palmate {
        right.push(Vec2::Y);
    }
    let (n, depth) = half.teeth;
    if n > 0 {
        right = toothed(&right, n, depth, width);
    }
    let left = right.iter().rev().map(|p| Vec2::new(-p.x, p.y)).collect::<Vec<_>>();
    right.extend(left);
    vec![right]
}

/// Three thin needles from one sheath.
fn needles() -> Vec<Vec<Vec2>> {
    let needle = |foot: f32, tip: Vec2| {
        let across = Vec2::new(0.22, 0.0);
        let foot = Vec2::new(foot, 0.0);
        let middle = foot + (tip - foot) * 0.8;
        vec![foot - across, foot + across, middle + across, tip, middle - across]
    };
    vec![
        needle(-0.16, Vec2::new(-0.7, 0.96)),
        needle(0.0, Vec2::new(0.06, 1.0)),
        needle(0.16, Vec2::new(0.72, 0.93)),
    ]
}

/// The curve of Catmull and Rom through the points, eight steps to each stretch.
fn smoothed(points: &[Vec2]) -> Vec<Vec2> {
    let at = |i: isize| points[i.clamp(0, points.len() as isize - 1) as usize];
    let mut curve = Vec::with_capacity(8 * points.len());
    for i in 0..points.len() as isize - 1 {
        let [a, b, c, d] = [at(i - 1), at(i), at(i + 1), at(i + 2)];
        for step in 0..8 {
            let t = step as f32 / 8.0;
            let linear = (c - a) * t;
            let square = (a * 2.0 - b * 5.0 + c * 4.0 - d) * (t * t);
            let cube = (b * 3.0 - a - c * 3.0 + d) * (t * t * t);
            let p = (b * 2.0 + linear + square + cube) * 0.5;
            curve.push(Vec2::new(p.x.clamp(0.0, 1.0), p.y.clamp(0.0, 1.0)));
        }
    }
    curve.extend(points.last());
    curve
}

/// The margin with `n` teeth that lean toward the tip.
fn toothed(curve: &[Vec2], n: u32, depth: f32, width: f32) -> Vec<Vec2> {
    // Measured where both axes are alike: in lengths of the leaf.
    let stretch = Vec2::new(0.5 * width, 1.0);
    let length: f32 = curve.windows(2).map(|ends| ((ends[1] - ends[0]) * stretch).length()).sum();
    let mut teeth = Vec::with_capacity(3 * curve.len() + 2 * n as usize);
    let mut walked = 0.0;
    let depth = depth * width.min(1.0);
    for ends in curve.windows(2) {
        let along = (ends[1] - ends[0]) * stretch;
        let step = along.length();
        let out = Vec2::new(along.y, -along.x) / step.max(1e-9);
        let (first, last) = (walked / length, (walked + step) / length);
        // None at the very base and tip.
        let fade = (8.0 * first.min(1.0 - first)).clamp(0.0, 1.0);
        let raised = |share: f32, height: f32| {
            let t = (share - first) / (last - first).max(1e-9);
            ends[0] + (ends[1] - ends[0]) * t + out * (height * depth * fade) / stretch
        };
        teeth.push(raised(first, (first * n as f32).fract()));
        let (mut tooth, end) = ((first * n as f32).floor() + 1.0, last * n as f32);
        while tooth < end {
            let share = tooth / n as f32;
            teeth.extend([raised(share, 1.0), raised(share, 0.0)]);
            tooth += 1.0;
        }
        walked += step;
    }
    teeth.extend(curve.last());
    teeth
}

/// Rows of samples to a row of pixels.
const SUBROWS: usize = 4;

/// How far each pixel is covered by any of the polygons, 0 to 255; the tip is up.
pub(super) fn coverage(polygons: &[Vec<Vec2>], [width, height]: [u32; 2]) -> Vec<u8> {
    let (w, h) = (width as usize, height as usize);
    let mut covered = vec![0.0f32; w * h];
    let mut crossings: Vec<f32> = Vec::new();
    let mut line = vec![0.0f32; w];
    for subrow in 0..h * SUBROWS {
        let along = 1.0 - (subrow as f32 + 0.5) / (h * SUBROWS) as f32;
        line.fill(0.0);
        for polygon in polygons {
            crossings.clear();
            let next = polygon.iter().cycle().skip(1);
            for (a, b) in polygon.iter().zip(next) {
                if (a.y <= along) != (b.y <= along) {
                    let x = a.x + (b.x - a.x) * (along - a.y) / (b.y - a.y);
                    crossings.push((x * 0.5 + 0.5) * width as f32);
                }
            }
            crossings.sort_unstable_by(f32::total_cmp);
            for span in crossings.chunks_exact(2) {
                fill(&mut line, span[0], span[1]);
            }
        }
        let row = &mut covered[subrow / SUBROWS * w..][..w];
        row.iter_mut().zip(&line).for_each(|(sum, part)| *sum += part.min(1.0));
    }
    let scale = 255.0 / SUBROWS as f32;
    covered.iter().map(|sum| (sum * scale + 0.5) as u8).collect()
}

/// Adds a stretch of a line to the pixels that it covers, wholly or in part.
fn fill(line: &mut [f32], from: f32, to: f32) {
    let (from, to) = (from.clamp(0.0, line.len() as f32), to.clamp(0.0, line.len() as f32));
    let (first, last) = (from as usize, (to.ceil() as usize).min(line.len()));
    for (i, part) in line.iter_mut().enumerate().take(last).skip(first) {
        *part += (to.min(i as f32 + 1.0) - from.max(i as f32)).max(0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_are_covered_by_as_much_as_lies_in_them() {
        let square = [[-0.5, 0.25], [0.25, 0.25], [0.25, 0.75], [-0.5, 0.75]];
        let square = vec![square.map(Vec2::from_array).to_vec()];
        let covered = coverage(&square, [4, 2]);
        assert_eq!(covered, [0, 128, 64, 0, 0, 128, 64, 0]);
    }

    #[test]
    fn teeth_stand_out_of_the_margin_and_nowhere_else() {
        let plain = polygons(LeafOutline::Elliptic, 1.0);
        let curve = smoothed(
            &LeafOutline::Elliptic
                .half()
                .points
                .iter()
                .map(|p| Vec2::from_array(*p))
                .collect::<Vec<_>>(),
        );
        let toothed = toothed(&curve, 12, 0.02, 1.0);
        let area = |points: &[Vec2]| {
            let pairs = points.windows(2);
            pairs.map(|ends| ends[0].perp_dot(ends[1])).sum::<f32>() * 0.5
        };
        let n_tips = toothed.windows(2).filter(|two| {
            let step = (two[1] - two[0]) * Vec2::new(0.5, 1.0);
            step.length() > 0.015 && step.x < -0.005
        });
        assert!(n_tips.count() >= 8);
        assert!(area(&toothed) > area(&curve) && area(&curve) > 0.0 && !plain.is_empty());
    }
}
