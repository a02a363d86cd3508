//! How trees are pruned: a stem ends where its middle leaves the envelope, and everything that
//! grows beyond that place goes with it.
//!
//! A stem that begins outside keeps its foot if it enters the envelope later; one that is never
//! inside goes. Leaves are kept or dropped whole, by their middle.

use std::sync::Arc;

use glam::{Affine3, Vec3};
use sapwood_geom::{Envelope, Shared, Side, Sphere};
use sapwood_graph::{At, Beyond, Fate, Handlers, PruneHandlers, Pruning, Standing};

use super::{Leaf, Segment, Stem, Stems};

/// Places on a segment that are asked whether they are inside.
const STEPS: u32 = 16;
/// Halvings of a step that find where a stem leaves.
const HALVINGS: u32 = 16;
/// Segments on either side of a cut that are cut by its plane.
const NEAR: f32 = 2.5;

/// The handlers that prune trees stem by stem.
pub fn prune_handlers() -> PruneHandlers {
    Handlers::new().on_plan::<Shared<Stems>>(prune_stems).on_parts::<Leaf>(prune_leaves)
}

/// Stems with the places where they end.
#[derive(Clone)]
struct Ends {
    stems: Shared<Stems>,
    /// For each stem the offset in metres at which it ends: infinite where it is whole, below 0
    /// where nothing is left of it.
    ends: Arc<[f32]>,
}

const GONE: f32 = -1.0;

impl Ends {
    /// Whether the place on one of these stems from which something grows is still there.
    fn carries(&self, point: Vec3, offset: f32) -> bool {
        // Children do not say on which of several clones they grow; their foot lies on its middle.
        let away = |stem: &usize| self.stems.center_at(*stem, offset).distance_squared(point);
        let stems = (0..self.stems.stems.len()).filter(|stem| {
            let segments = self.stems.segments_of(*stem);
            let reaches = |segment: &Segment| {
                let slack = 1e-3 * segment.length;
                segment.offset - slack <= offset
                    && offset <= segment.offset + segment.length + slack
            };
            segments.iter().any(reaches)
        });
        let nearest = stems.min_by(|a, b| away(a).total_cmp(&away(b)));
        nearest.is_none_or(|stem| offset <= self.ends[stem])
    }
}

fn prune_stems(pruning: &mut Pruning, stems: &Shared<Stems>, at: &At<'_, Standing>) {
    let above = pruning.noted_above::<Ends>(at).cloned();
    let is_inside = at.state().side() == Side::Inside;
    let here = Here { envelope: pruning.envelope(), world: *at.world(), is_inside };
    let mut ends: Vec<f32> = Vec::with_capacity(stems.stems.len());
    let mut entered: Vec<f32> = Vec::with_capacity(stems.stems.len());
    for (index, stem) in stems.stems.iter().enumerate() {
        let start = stem.start as f32 * stem.segment_length();
        let (is_carried, was_inside) = match stem.clone_of {
            // The end of a segment, up to rounding.
            Some(origin) => {
                let origin = origin as usize;
                let slack = 1e-3 * stem.segment_length();
                (start - slack <= ends[origin], entered[origin] <= start)
            }
            None => {
                let (foot, offset) = (stem.seed.frame.origin, stem.seed.offset);
                (above.as_ref().is_none_or(|above| above.carries(foot, offset)), false)
            }
        };
        let [enters, leaves] =
            if is_carried { here.way_of(stems, index, was_inside) } else { [f32::INFINITY, GONE] };
        entered.push(enters);
        ends.push(leaves);
    }
    if ends.iter().all(|end| *end < 0.0) {
        pruning.drop_all(at);
        return;
    }
    let fate = |(stem, end): (usize, &f32)| match *end {
        f32::INFINITY => Fate::Whole,
        end if end < 0.0 => Fate::Gone,
        end => Fate::Cut(Arc::new(StemCut::new(stems, stem, end))),
    };
    pruning.decide::<Stem>(at, ends.iter().enumerate().map(fate).collect());
    pruning.note(at, Ends { stems: stems.clone(), ends: ends.into() });
}

fn prune_leaves(pruning: &mut Pruning, leaves: &[Leaf], at: &At<'_, Standing>) {
    let Some(on) = pruning.noted_above::<Ends>(at).cloned() else { return };
    let is_inside = at.state().side() == Side::Inside;
    let here = Here { envelope: pruning.envelope(), world: *at.world(), is_inside };
    let fate = |leaf: &Leaf| {
        let stem = leaf.stem as usize;
        let end = on.ends.get(stem).copied().unwrap_or(f32::INFINITY);
        let foot = leaf.frame.origin;
        let is_carried = end == f32::INFINITY || offset_of(&on.stems, stem, foot) <= end;
        let middle = foot + leaf.frame.axes.z_axis * (0.5 * leaf.length);
        if is_carried && here.holds(middle) { Fate::Whole } else { Fate::Gone }
    };
    let fates = leaves.iter().map(fate).collect();
    pruning.decide::<Leaf>(at, fates);
}

/// An envelope seen from the frame of stems.
struct Here<'a> {
    envelope: &'a Envelope,
    world: Affine3,
    /// Everything is inside.
    is_inside: bool,
}

impl Here<'_> {
    fn holds(&self, point: Vec3) -> bool {
        self.is_inside || self.envelope.contains(self.world.transform_point3(point))
    }

    /// The offsets at which a stem is inside for the first time, infinite where it never is, and
    /// at which it ends.
    fn way_of(&self, stems: &Stems, stem: usize, was_inside: bool) -> [f32; 2] {
        let segments = stems.segments_of(stem);
        let start = segments.first().map_or(0.0, |segment| segment.offset);
        if self.is_inside {
            return [start, f32::INFINITY];
        }
        let mut entered = if was_inside { start } else { f32::INFINITY };
        let mut before = start;
        for segment in segments {
            let n_steps = match self.side_of(segment, stems.stems[stem].helix_radius) {
                Side::Crossing => STEPS,
                Side::Inside | Side::Outside => 1,
            };
            for step in 0..=n_steps {
                let along = segment.length * step as f32 / n_steps as f32;
                let offset = segment.offset + along;
                let inside = |offset| self.holds(stems.center_in(stem, segment, offset));
                if inside(offset) {
                    entered = entered.min(offset);
                } else if entered.is_finite() {
                    let (mut low, mut high) = (before.max(segment.offset), offset);
                    for _ in 0..HALVINGS {
                        let middle = 0.5 * (low + high);
                        if inside(middle) {
                            low = middle;
                        } else {
                            high = middle;
                        }
                    }
                    return [entered, low];
                }
                before = offset;
            }
        }
        [entered, if entered.is_finite() { f32::INFINITY } else { GONE }]
    }

    fn side_of(&self, segment: &Segment, helix_radius: f32) -> Side {
        let center = (segment.frame.origin + segment.end()) * 0.5;
        let radius = 0.5 * segment.length + 2.0 * helix_radius;
        self.envelope.side_of(&Sphere { center, radius }.transformed(&self.world))
    }
}

/// The offset in metres of the place on a stem that is nearest to a point.
fn offset_of(stems: &Stems, stem: usize, point: Vec3) -> f32 {
    let mut nearest = (f32::INFINITY, 0.0);
    for segment in stems.segments_of(stem) {
        let axis = segment.frame.axes.z_axis;
        let along = (point - segment.frame.origin).dot(axis).clamp(0.0, segment.length);
        let square = (segment.frame.origin + axis * along).distance_squared(point);
        if square < nearest.0 {
            nearest = (square, segment.offset + along);
        }
    }
    nearest.1
}

/// A cut across a stem.
struct StemCut {
    stems: Shared<Stems>,
    stem: usize,
    /// Where, in metres from the stem's base.
    end: f32,
    center: Vec3,
    tangent: Vec3,
}

impl StemCut {
    fn new(stems: &Shared<Stems>, stem: usize, end: f32) -> Self {
        let (center, tangent) = (stems.center_at(stem, end), stems.tangent_at(stem, end));
        Self { stems: stems.clone(), stem, end, center, tangent }
    }
}

impl Beyond for StemCut {
    fn beyond(&self, point: Vec3) -> f32 {
        let away = offset_of(&self.stems, self.stem, point) - self.end;
        // A plane near by, so that the cut is flat; farther away a stem may bend back to it.
        let near = NEAR * self.stems.stems[self.stem].segment_length();
        if away.abs() < near { (point - self.center).dot(self.tangent) } else { away }
    }
}
