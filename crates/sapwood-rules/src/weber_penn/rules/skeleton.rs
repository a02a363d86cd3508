//! Trees as polylines with radii.

use sapwood_geom::{Polyline, Shared};
use sapwood_graph::Shown;
use sapwood_scene::{Context, Rule, RuleError};

use super::super::slots::TrunkFormSlot;
use super::super::{Leaves, Stem, StemSurface, Stems};

/// Points that one turn of a helix is drawn with.
const POINTS_PER_TURN: u32 = 10;

/// Compiles stems into their centre lines.
pub(super) struct StemLinesRule;

impl Rule for StemLinesRule {
    type Component = StemSurface;
    type Data = ();
    const NAME: &'static str = "weber_penn.stem_lines";

    fn init(&self, of: &StemSurface, cx: &mut Context<'_>) -> Result<(), RuleError> {
        draw_stem_lines(of, cx);
        Ok(())
    }
}

/// Draws the centre line of each stem.
pub(super) fn draw_stem_lines(of: &StemSurface, cx: &mut Context<'_>) {
    let is_trunk = of.stems.stems.iter().any(|stem| stem.seed.level == 0);
    let form = is_trunk.then(|| cx.read::<TrunkFormSlot>());
    let factor = |z| form.as_ref().map_or(1.0, |form| form.factor(z));
    let lines = (0..of.stems.stems.len()).map(|stem| line(&of.stems, stem, &factor)).collect();
    cx.lines(Shared::new(lines));
    cx.shows(Shown::each::<Stem>());
}

fn line(stems: &Stems, stem: usize, factor: &dyn Fn(f32) -> f32) -> Polyline {
    let row = &stems.stems[stem];
    let per_segment = if row.helix_radius == 0.0 { 1 } else { POINTS_PER_TURN };
    let mut line = Polyline::default();
    let mut add = |segment, z: f32| {
        line.points.push(stems.center_in(stem, segment, z * row.seed.length));
        line.radii.push(row.radius_at(z) * factor(z));
    };
    let segments = stems.segments_of(stem);
    for segment in segments {
        for i in 0..per_segment {
            let part = i as f32 / per_segment as f32;
            add(segment, segment.z_foot + (segment.z_end - segment.z_foot) * part);
        }
    }
    if let Some(last) = segments.last() {
        add(last, last.z_end);
    }
    line
}

/// Draws no leaves.
pub(super) struct NoLeavesRule;

impl Rule for NoLeavesRule {
    type Component = Leaves;
    type Data = ();
    const NAME: &'static str = "weber_penn.no_leaves";

    fn init(&self, _: &Leaves, _: &mut Context<'_>) -> Result<(), RuleError> {
        Ok(())
    }
}
