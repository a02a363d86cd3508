//! Where along a stem, and how far round it, children and leaves grow (Weber and Penn 1995,
//! section 4.3; even placement after Arbaro).

use std::f32::consts::{PI, TAU};

use sapwood_geom::Purpose;

use super::shape_ratio::conical;
use super::stem::{Segment, Stem, Stems};
use super::variation::{Diffusion, Draws};
use crate::weber_penn::{Dialect, Variation};

/// Even places along a stem: outside its parent, above its bare base, in equal slots on each
/// segment.
pub(crate) struct Places {
    // Per metre of an unsplit stem.
    density: f32,
    start: f32,
    grouping: Grouping,
    counts: Diffusion,
    jitter: Draws,
    // Where the whorls of the segment at hand end, counted from its first child.
    whorls: Vec<usize>,
    sizes: Diffusion,
    // The whorl or the pair of the last place, and its jitter.
    last: (usize, f32),
}

/// How places stand along a segment.
#[derive(Clone, Copy)]
pub(crate) enum Grouping {
    /// Each in a slot of its own; slots shrink toward the segment's foot by this factor.
    Single(f32),
    /// tree-gen's: every second one moves toward the one before it by this share of a slot.
    Pairs(f32),
    /// tree-gen's: so many at one height, on average.
    Whorls(f32),
}

impl Grouping {
    /// By tree-gen's branch_dist where there is one, else by nBranchDist.
    pub(crate) fn new(tree_gen: Option<f32>, branch_dist: f32) -> Self {
        match tree_gen {
            Some(dist) if dist > 1.0 => Self::Whorls(dist + 1.0),
            Some(dist) if dist > 0.0 => Self::Pairs(dist),
            _ => Self::Single(branch_dist),
        }
    }
}

impl Places {
    /// `count` places on `stem`, were it never split.
    pub(crate) fn new(stem: &Stem, count: f32, grouping: Grouping, purpose: Purpose) -> Self {
        let start = stem.length_base.max(stem.seed.parent_radius);
        let free = stem.seed.length - start;
        // Jitter is no `X ± V`, so the variation of the species does not reach it.
        let mut jitter = Draws::new(stem.seed.path, purpose, Variation::Uniform);
        let density = if free > 0.0 && count > 0.0 { count / free } else { 0.0 };
        let trunk = stem.seed.level == 0 && stem.clone_of.is_none();
        let error = if trunk || density == 0.0 { 0.0 } else { jitter.between(-0.5, 0.5) };
        Self {
            density,
            start,
            grouping,
            counts: Diffusion::new(error),
            jitter,
            whorls: Vec::new(),
            sizes: Diffusion::new(0.0),
            last: (0, 0.0),
        }
    }

    /// How many grow on the next segment, and the slots that they grow in; `share` is the share of
    /// what an unsplit stem would carry there.
    pub(crate) fn on(&mut self, segment: &Segment, share: f32) -> (usize, Slots) {
        let foot = segment.offset.max(self.start);
        let free = segment.offset + segment.length - foot;
        if free <= 0.0 || self.density == 0.0 {
            return (0, Slots { foot, slot: 0.0 });
        }
        let amount = self.density * free * share;
        self.last = (usize::MAX, 0.0);
        let Grouping::Whorls(size) = self.grouping else {
            let count = self.counts.whole(amount);
            let dist = if let Grouping::Single(dist) = self.grouping { dist } else { 1.0 };
            return (count, Slots { foot, slot: free / count.max(1) as f32 * dist });
        };
        let n_whorls = self.counts.whole(amount / size);
        self.whorls.clear();
        let mut count = 0;
        for _ in 0..n_whorls {
            count += self.sizes.whole(size);
            self.whorls.push(count);
        }
        (count, Slots { foot, slot: free / n_whorls.max(1) as f32 })
    }

    /// The offset in metres of the `i`th in these slots, and the step round the parent that leads
    /// to it. Call it in the order of `i`.
    ///
    /// It stands in the middle of its slot, moved by up to a quarter; pairs and whorls are moved
    /// together.
    pub(crate) fn at(&mut self, slots: Slots, i: usize) -> (f32, Step) {
        let (slot, moved, step) = match self.grouping {
            Grouping::Single(_) => (i, self.jitter.between(0.25, 0.75), Step::Next),
            Grouping::Pairs(dist) => {
                let moved = self.moved(i / 2);
                (i, if i % 2 == 1 { moved - dist } else { moved }, Step::Next)
            }
            Grouping::Whorls(_) => {
                let whorl = self.whorls.partition_point(|&end| end <= i);
                let start = if whorl == 0 { 0 } else { self.whorls[whorl - 1] };
                let share = (i - start) as f32 / (self.whorls[whorl] - start) as f32;
                (whorl, self.moved(whorl), Step::InWhorl { share })
            }
        };
        (slots.foot + slots.slot * (slot as f32 + moved), step)
    }

    /// Where in its slot a pair or a whorl stands.
    fn moved(&mut self, group: usize) -> f32 {
        if self.last.0 != group {
            self.last = (group, self.jitter.between(0.25, 0.75));
        }
        self.last.1
    }
}

/// The step round the parent from one child to the next.
#[derive(Clone, Copy)]
pub(crate) enum Step {
    /// By nRotate.
    Next,
    /// To this share of a circle from the whorl's first; whorls turn by nRotate.
    InWhorl {
        /// 0 for the first.
        share: f32,
    },
}

/// Equal parts of a segment, in metres.
#[derive(Clone, Copy)]
pub(crate) struct Slots {
    foot: f32,
    slot: f32,
}

/// The turn about the parent from one child to the next.
#[derive(Clone, Copy, Default)]
pub(crate) struct Turn {
    // The cumulative angle of helical placement.
    angle: f32,
    // Whether the last one of alternating placement was on the first side.
    first_side: bool,
}

impl Turn {
    /// So far round the parent before the first child.
    pub(crate) fn starting_at(angle: f32) -> Self {
        Self { angle, ..Self::default() }
    }

    /// The angle of the next child about the parent's z.
    pub(crate) fn next(
        &mut self,
        step: Step,
        rotate: f32,
        rotate_v: f32,
        draws: &mut Draws,
    ) -> f32 {
        if let Step::InWhorl { share } = step {
            if share == 0.0 {
                self.advance(rotate);
            }
            return self.angle + TAU * share + draws.around(0.0, rotate_v);
        }
        if rotate >= 0.0 {
            self.advance(draws.around(rotate, rotate_v));
            self.angle
        } else {
            self.first_side = !self.first_side;
            let angle = draws.around(PI + rotate, rotate_v);
            if self.first_side { angle } else { -angle }
        }
    }

    fn advance(&mut self, by: f32) {
        self.angle += by;
        if !(0.0..TAU).contains(&self.angle) {
            self.angle -= TAU * (self.angle / TAU).floor();
        }
    }

    /// Half a turn on, or on the other side: where a clone begins.
    fn opposite(self) -> Self {
        Self { angle: self.angle + PI, first_side: !self.first_side }
    }
}

/// The turns of stems and their clones: a clone goes on where its origin was, half a turn on.
pub(crate) struct Turns {
    // After each segment; empty where no stem has clones.
    after: Vec<Turn>,
}

impl Turns {
    pub(crate) fn new(stems: &Stems) -> Self {
        let cloned = stems.stems.iter().any(|stem| stem.clone_of.is_some());
        Self {
            after: if cloned { vec![Turn::default(); stems.segments.len()] } else { Vec::new() },
        }
    }

    /// The turn before the first child of `stem`.
    pub(crate) fn start(&self, stems: &Stems, stem: &Stem) -> Turn {
        let Some(origin) = stem.clone_of else { return Turn::default() };
        let origin = &stems.stems[origin as usize];
        let last_common = origin.first_segment + (stem.start - 1 - origin.start);
        self.after[last_common as usize].opposite()
    }

    /// Notes the turn after the last child on a segment.
    pub(crate) fn note(&mut self, segment: usize, turn: Turn) {
        if let Some(after) = self.after.get_mut(segment) {
            *after = turn;
        }
    }
}

/// The angle between a parent and what grows on it at `offset` metres.
///
/// A negative variation is not random: it is added in full at the bottom of the parent and
/// taken away toward the top (the paper prints ± there). tree-gen varies the sum by a tenth.
pub(crate) fn down_angle(
    down_angle: f32,
    down_angle_v: f32,
    parent: &Stem,
    offset: f32,
    dialect: Dialect,
    draws: &mut Draws,
) -> f32 {
    if down_angle_v >= 0.0 {
        return draws.around(down_angle, down_angle_v);
    }
    let r = height_ratio(parent, offset);
    let angle = down_angle + down_angle_v * (1.0 - 2.0 * conical(r, dialect));
    match dialect {
        Dialect::TreeGen => draws.around(angle, 0.1 * angle),
        Dialect::Paper | Dialect::Arbaro => angle,
    }
}

/// 1 at the lowest place on `parent` where something grows, 0 at its tip.
pub(crate) fn height_ratio(parent: &Stem, offset: f32) -> f32 {
    let span = parent.seed.length - parent.length_base;
    if span > 0.0 { ((parent.seed.length - offset) / span).clamp(0.0, 1.0) } else { 0.0 }
}

/// The angle about local y of the `i`th of `count` in a fan: an odd count has one in the middle,
/// the others lie in steps of `opening / count` to both sides in turn.
pub(crate) fn fan_angle(
    i: usize,
    count: usize,
    opening: f32,
    opening_v: f32,
    draws: &mut Draws,
) -> f32 {
    let (steps, middle) =
        if count % 2 == 1 { (i.div_ceil(2) as f32, i == 0) } else { ((i / 2) as f32 + 0.5, false) };
    if middle {
        return 0.0;
    }
    let side = if i % 2 == 1 { 1.0 } else { -1.0 };
    let angle = steps * (opening / count as f32);
    side * angle + draws.around(0.0, opening_v / count as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sapwood_geom::StreamPath;

    fn draws() -> Draws {
        Draws::new(StreamPath::new(1), Purpose("test"), Variation::Uniform)
    }

    #[test]
    fn helical_turns_add_up_and_alternating_ones_do_not() {
        let mut turn = Turn::default();
        let angles: Vec<f32> = (0..4)
            .map(|_| turn.next(Step::Next, 140f32.to_radians(), 0.0, &mut draws()).to_degrees())
            .collect();
        for (angle, expected) in angles.iter().zip([140.0, 280.0, 60.0, 200.0]) {
            assert!((angle - expected).abs() < 1e-3, "{angles:?}");
        }
        let mut turn = Turn::default();
        for expected in [60.0, -60.0, 60.0] {
            let angle = turn.next(Step::Next, -120f32.to_radians(), 0.0, &mut draws()).to_degrees();
            assert!((angle - expected).abs() < 1e-3);
        }
    }

    #[test]
    fn fans_open_evenly_about_the_tip() {
        let fan = |count: usize| -> Vec<f32> {
            let mut angles: Vec<f32> =
                (0..count).map(|i| fan_angle(i, count, 120.0, 0.0, &mut draws())).collect();
            angles.sort_by(f32::total_cmp);
            angles
        };
        assert_eq!(fan(1), [0.0]);
        assert_eq!(fan(3), [-40.0, 0.0, 40.0]);
        assert_eq!(fan(4), [-45.0, -15.0, 15.0, 45.0]);
    }
}
