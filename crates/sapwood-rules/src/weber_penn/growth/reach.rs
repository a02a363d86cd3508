//! How far a tree may reach, foreseen from its parameters: a bound of whatever any seed grows.
//!
//! No point of a stem is further from the stem's base than the way along it, nor a child's point
//! further from its own base; so the reach of a level is a multiple of the length of its stems,
//! found from the last level upwards. The trunk is looked at more closely, piece by piece: how
//! far it may lean there by then, and how long branches may be there. What pruning or attraction
//! do changes directions or shortens stems, and so nothing here.

use std::f32::consts::{FRAC_PI_2, PI};

use glam::{Vec2, Vec3};
use sapwood_geom::{Aabb, Bound, Content, Digester, Sphere};

use super::attraction::TROPISM;
use super::children::{TREE_GEN_THINNEST, lost_length};
use super::curve::helix_radius;
use super::leaves::relative_size;
use super::roots::root_reach;
use super::shape_ratio::shape_ratio;
use super::trunks::scale_limit;
use super::variation::greatest_deviation;
use crate::weber_penn::{Crown, CrownShape, Dialect, LeafParams, Level, RootParams, TrunkForm};

/// How many pieces the trunk is looked at in.
const PIECES: u32 = 32;

/// Growth adds up in single precision, and so does what is here.
const SLACK: f32 = 1.001;

/// A bound of every tree that any seed grows from these parameters, in tree space (z up, the
/// foot at the origin): stems with their surfaces, splits and all, roots and leaves; every trunk
/// of several. Nothing where no finite bound holds.
///
/// `leaves` are those that are drawn: [thinned](LeafParams::thinned), where they are.
pub fn foreseen(
    crown: &Crown,
    levels: [&Level; 4],
    form: &TrunkForm,
    leaves: &LeafParams,
    roots: &RootParams,
) -> Option<Bound> {
    let trunk = levels[0];
    if crown.levels == 0 || trunk.branches <= 0 {
        return Some(Bound::EMPTY);
    }
    let deviation = greatest_deviation(crown.variation);
    let length = longest(trunk, deviation) * scale_limit(crown);
    let aside = if trunk.branches > 1 { trunk.branch_dist.abs() } else { 0.0 };
    let reach = Reach::new(crown, levels, form, leaves, false).with_roots(roots, crown, trunk);
    let bound = reach.bound(Vec3::ZERO, length)?;
    let Bound { aabb, sphere } = bound;
    let around = Vec2::splat(aside).extend(0.0);
    Some(Bound {
        aabb: Aabb { min: aabb.min - around, max: aabb.max + around },
        sphere: Sphere { radius: sphere.radius + aside, ..sphere },
    })
}

/// How far a trunk and everything on it may reach from the trunk's foot: all but `margin` as
/// multiples of the trunk's length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Reach {
    /// Away from the vertical axis through the foot.
    side: f32,
    up: f32,
    /// Below the foot.
    down: f32,
    /// The height of the middle of a sphere around everything, and its radius.
    middle: f32,
    radius: f32,
    /// In metres, in every direction: leaves.
    margin: f32,
}

impl Content for Reach {
    fn write(&self, digester: &mut Digester) {
        let Self { side, up, down, middle, radius, margin } = self;
        digester.add(side).add(up).add(down).add(middle).add(radius).add(margin);
    }
}

impl Reach {
    /// `topped`: trunks may be shortened by an envelope, which moves what grows on them down.
    pub(crate) fn new(
        crown: &Crown,
        levels: [&Level; 4],
        form: &TrunkForm,
        leaves: &LeafParams,
        topped: bool,
    ) -> Self {
        let topped = topped || crown.pruning.holds_trunks();
        let pieces: Vec<Piece> = Trunk::new(crown, levels, form, topped).pieces().collect();
        let (mut side, mut up, mut down) = (0.0f32, 0.0f32, 0.0f32);
        for piece in &pieces {
            side = side.max(piece.side + piece.around);
            up = up.max(piece.top + piece.around.max(piece.over));
            down = down.max(piece.beyond.max(piece.over) - piece.bottom);
        }
        // On a grid, so that what is rounded up later stays around the same middle.
        let middle = (8.0 * (up - down)).round() / 16.0;
        let radius = pieces.iter().map(|piece| {
            let height = (piece.top - middle).abs().max((piece.bottom - middle).abs());
            Vec2::new(piece.side, height).length() + piece.around
        });
        let radius = radius.fold(0.0, f32::max);
        let margin = leaf_reach(leaves) * relative_size(scale_limit(crown), crown);
        // However short they are, tree-gen's stems are so thick.
        let thick = match crown.dialect {
            Dialect::TreeGen => TREE_GEN_THINNEST * widest(crown, levels),
            Dialect::Paper | Dialect::Arbaro => 0.0,
        };
        Self { side, up, down, middle, radius, margin: margin + thick }
    }

    /// The same with roots that reach so far from the foot, compared with the trunk's length.
    pub(crate) fn with_roots(self, params: &RootParams, crown: &Crown, trunk: &Level) -> Self {
        let spread = greatest_deviation(crown.variation) * trunk.radius_scale_v.abs();
        let thickness = crown.ratio * (trunk.radius_scale + spread).max(0.0);
        let far = root_reach(params, crown, thickness);
        Self {
            side: self.side.max(far),
            up: self.up.max(far),
            down: self.down.max(far),
            radius: self.radius.max(far + self.middle.abs()),
            ..self
        }
    }

    /// The same with leaves that reach so many times as far.
    pub(crate) fn with_leaves_grown(self, times: f32) -> Self {
        Self { margin: self.margin * times, ..self }
    }

    /// The same or a little more: in steps of a sixteenth of the trunk's length, and for the leaves
    /// of a sixteenth of `size` metres.
    pub(crate) fn rounded_up(self, size: f32) -> Self {
        let rounded = |x: f32| (16.0 * x).ceil() / 16.0;
        let margin = if size > 0.0 { rounded(self.margin / size) * size } else { self.margin };
        Self {
            side: rounded(self.side),
            up: rounded(self.up),
            down: rounded(self.down),
            middle: self.middle,
            radius: rounded(self.radius),
            margin,
        }
    }

    /// How far everything may reach whichever way stems turn, as in the wind: `up` is as far as
    /// the way along them. A helix may reach `aside` of the trunk's length further.
    pub(crate) fn any_way(self, aside: f32) -> Self {
        let radius = self.up + aside;
        Self { side: radius, up: radius, down: radius, middle: 0.0, radius, ..self }
    }

    /// The bound around a trunk of at most this length in metres, whose foot is here; nothing
    /// where it is not finite.
    pub(crate) fn bound(&self, foot: Vec3, length: f32) -> Option<Bound> {
        let reach = |x: f32| SLACK * (x * length + self.margin);
        let side = reach(self.side);
        let aabb = Aabb {
            min: foot - Vec3::new(side, side, reach(self.down)),
            max: foot + Vec3::new(side, side, reach(self.up)),
        };
        let center = foot + Vec3::Z * (self.middle * length);
        let bound = Bound { aabb, sphere: Sphere { center, radius: reach(self.radius) } };
        let is_finite = aabb.min.is_finite() && aabb.max.is_finite();
        (is_finite && bound.sphere.radius.is_finite()).then_some(bound)
    }
}

/// A piece of the trunk with all that grows there, relative to the trunk's length: everything is
/// within `around` of a point at most `side` from the axis, between `bottom` and `top`.
struct Piece {
    side: f32,
    bottom: f32,
    top: f32,
    /// The greater of how far children reach and how thick the trunk is.
    around: f32,
    /// How far children reach.
    beyond: f32,
    /// How far the trunk's surface reaches up and down from its centre line.
    over: f32,
}

/// What the pieces of a trunk are found from.
struct Trunk<'a> {
    crown: &'a Crown,
    level: &'a Level,
    child: &'a Level,
    form: &'a TrunkForm,
    has_children: bool,
    deviation: f32,
    /// The bare share of the trunk, at the least and at the most.
    bare: [f32; 2],
    /// The reach of a child relative to the child's length.
    child_reach: f32,
    /// How much thicker than they begin stems on the trunk and above may become, all together.
    widening: f32,
    /// By how much a child's place may lie off its segment.
    astray: f32,
    /// Whether the trunk may be shorter than foreseen.
    topped: bool,
}

impl<'a> Trunk<'a> {
    fn new(crown: &'a Crown, levels: [&'a Level; 4], form: &'a TrunkForm, topped: bool) -> Self {
        let deviation = greatest_deviation(crown.variation);
        let [level, child, ..] = levels;
        let last = crown.levels.min(256) as usize;
        let at = |n: usize| levels[n.min(3)];
        let mut child_reach = 0.0f32;
        for n in (1..last).rev() {
            let next = (n + 1 < last).then(|| at(n + 1));
            child_reach = stem_reach(crown, at(n), next, child_reach, deviation);
        }
        let spread = deviation * level.length_v.abs();
        let bare =
            [level.length + spread, level.length - spread].map(|longest| match crown.dialect {
                Dialect::TreeGen => crown.base_size.min(1.0),
                _ if longest > 0.0 => (crown.base_size / longest).min(1.0),
                _ => 1.0,
            });
        let has_children = last > 1 && child.branches != 0;
        let astray = astray(level, child);
        let bare = if bare[0] <= bare[1] { bare } else { [bare[1], bare[0]] };
        Self {
            crown,
            level,
            child,
            form,
            has_children,
            deviation,
            bare,
            child_reach,
            widening: widest(crown, levels),
            astray,
            topped,
        }
    }

    fn pieces(&self) -> impl Iterator<Item = Piece> + '_ {
        let helix = 2.0 * helix_radius(self.level.curve_v, 1.0 / self.level.curve_res as f32);
        let (mut side, mut bottom) = (0.0f32, 0.0f32);
        (0..PIECES).map(move |i| {
            let [start, end] = [i, i + 1].map(|i| i as f32 / PIECES as f32);
            let lean = self.greatest_lean(start, end);
            let (before, thick) = (bottom, self.radius(start) * lobes(self.form));
            side += (end - start) * libm::sinf(lean.min(FRAC_PI_2));
            bottom += (end - start) * libm::cosf(lean);
            let beyond = self.children(start, end);
            let tilt = libm::sinf(lean.min(FRAC_PI_2));
            Piece {
                side: side + helix,
                bottom: before.min(bottom) - helix * tilt,
                top: end + helix * tilt,
                around: beyond.max(thick),
                beyond,
                // A helix leans more than its axis does.
                over: if helix > 0.0 { thick } else { thick * tilt },
            }
        })
    }

    /// The greatest angle between the vertical and the trunk between two heights.
    fn greatest_lean(&self, start: f32, end: f32) -> f32 {
        // Between its foot, the end of its first half and its tip it leans more and more, or
        // less and less.
        let half = self.level.curve_res.div_ceil(2) as f32 / self.level.curve_res as f32;
        let lean = self.lean(start).max(self.lean(end));
        lean.max(self.lean(half.clamp(start, end)))
    }

    /// The angle between the vertical and the trunk at `z`, at most.
    ///
    /// Turns about local x add up with their signs; others count in full. Turns about the
    /// vertical change nothing.
    fn lean(&self, z: f32) -> f32 {
        let (crown, level) = (self.crown, self.level);
        let res = level.curve_res as f32;
        // The segment in which z lies, if z is its end.
        let segment = ((z * res).ceil() - 1.0).clamp(0.0, res - 1.0);
        let half = level.curve_res.div_ceil(2) as f32;
        let (curve, curve_back) = if level.curve_back == 0.0 {
            (segment * level.curve / res, 0.0)
        } else {
            let second = (segment - (half - 1.0)).max(0.0);
            let half = 0.5 * res;
            ((segment - second) * level.curve / half, second * level.curve_back / half)
        };
        let bends = level.curve_v.max(0.0) + level.bend_v.abs();
        let mut tilts = segment * self.deviation * bends / res;
        if let Some([x, y, _]) = crown.tropism {
            tilts += segment * TROPISM * Vec2::new(x, y).length();
        }
        let spread = self.deviation * level.down_angle_v.abs();
        // Each segment so far may have split, and every split is undone in time.
        let n_splits = match (level.seg_splits > 0.0, level.base_splits != 0) {
            (true, _) => segment,
            (false, true) => segment.min(1.0),
            (false, false) => 0.0,
        };
        let spread_split = self.deviation * level.split_angle_v.abs();
        let split = n_splits * (level.split_angle + spread_split).max(0.0);
        let (low, high, planar) = match crown.dialect {
            Dialect::TreeGen => {
                // What splits curves in some of its segments only.
                let (low, high) = match n_splits > 0.0 {
                    true => {
                        let [a, b] = [curve, curve_back];
                        (a.min(0.0) + b.min(0.0), a.max(0.0) + b.max(0.0))
                    }
                    false => (curve + curve_back, curve + curve_back),
                };
                let planar = if level.split_angle < 0.0 {
                    0.5 * n_splits * (level.split_angle.abs() + spread_split)
                } else {
                    0.0
                };
                // It turns by half the angle, and then back by less than the whole.
                (low - 0.5 * split, high + 0.5 * split, planar)
            }
            Dialect::Paper | Dialect::Arbaro => {
                (curve + curve_back, curve + curve_back + split, 0.0)
            }
        };
        let low = level.down_angle - spread + low;
        let high = level.down_angle + spread + high;
        (low.abs().max(high.abs()) + tilts + planar).min(PI)
    }

    /// The radius of the trunk's foot by taper alone, at most.
    fn foot(&self) -> f32 {
        let scale = self.level.radius_scale;
        let scale = scale + self.deviation * self.level.radius_scale_v.abs();
        (self.crown.ratio * scale).max(0.0)
    }

    /// The trunk's radius from `z` upwards, without lobes, at most.
    fn radius(&self, z: f32) -> f32 {
        let widened = self.form.factor(z).abs().max(self.form.scale.abs());
        self.foot() * widening(self.level) * widened
    }

    /// How far the children between `start` and `end` may reach from where they grow; they are
    /// as thick as the trunk at most.
    fn children(&self, start: f32, end: f32) -> f32 {
        let is_fan = self.child.branches < 0;
        if !self.has_children || !self.topped && (is_fan && end < 1.0 || end < self.bare[0]) {
            return 0.0;
        }
        let above = |z: f32, bare: f32| {
            if bare < 1.0 { ((1.0 - z) / (1.0 - bare)).clamp(0.0, 1.0) } else { 1.0 }
        };
        let ratio = if is_fan {
            self.widest(0.0, 0.0)
        } else if self.astray > 0.0 || self.topped {
            self.widest(0.0, 1.0)
        } else {
            self.widest(above(end, self.bare[0]), above(start, self.bare[1].min(end)))
        };
        let length = longest(self.child, self.deviation) * ratio;
        let thin = if self.crown.ratio_power >= 0.0 {
            let falloff = libm::powf(length, self.crown.ratio_power);
            self.foot() * falloff * self.child.radius_scale.abs()
        } else {
            f32::INFINITY
        };
        let thick = thin.min(self.radius(start)) * self.widening;
        self.astray + self.child_reach * length + thick
    }

    /// The greatest ShapeRatio between two heights.
    fn widest(&self, low: f32, high: f32) -> f32 {
        let Crown { shape, pruning, dialect, .. } = self.crown;
        let peak = match shape {
            CrownShape::Spherical => 0.5,
            CrownShape::Flame | CrownShape::TendFlame => 0.7,
            CrownShape::Envelope => 1.0 - pruning.width_peak,
            CrownShape::Conical
            | CrownShape::Hemispherical
            | CrownShape::Cylindrical
            | CrownShape::TaperedCylindrical
            | CrownShape::InverseConical => low,
        };
        let at = |r: f32| shape_ratio(*shape, r, pruning, *dialect).max(0.0);
        at(low).max(at(high)).max(at(peak.clamp(low, high)))
    }
}

/// The length of a level's stems relative to what they grow on, at most, before any ratio.
fn longest(level: &Level, deviation: f32) -> f32 {
    (level.length + deviation * level.length_v.abs()).max(0.0)
}

/// The reach of a stem beyond the trunk from its base, relative to its length; `next` grows on it,
/// and reaches `next_reach` times its own length.
fn stem_reach(
    crown: &Crown,
    level: &Level,
    next: Option<&Level>,
    next_reach: f32,
    deviation: f32,
) -> f32 {
    let helix = 2.0 * helix_radius(level.curve_v, 1.0 / level.curve_res as f32);
    let Some(next) = next.filter(|next| next.branches != 0) else { return 1.0 + helix };
    let lost = lost_length(crown.dialect);
    let reach = longest(next, deviation) * next_reach;
    // Children grow shorter in proportion to the way from the base: one of the ends counts.
    let (at_base, at_tip) = (reach, 1.0 + (1.0 - lost) * reach);
    let astray = astray(level, next);
    let farthest = if astray > 0.0 {
        1.0 + astray + (1.0 + lost * astray) * reach
    } else if next.branches < 0 {
        at_tip
    } else {
        at_tip.max(at_base)
    };
    helix + farthest
}

/// By how much a child's place may lie off its parent's segment, relative to the parent's length.
fn astray(parent: &Level, child: &Level) -> f32 {
    // Pairs and whorls keep to their segment.
    let dist = child.grouping.filter(|dist| *dist > 0.0).map_or(child.branch_dist, |_| 1.0);
    let off = (dist - 1.0).max(-dist).max(0.0);
    off / parent.curve_res as f32
}

/// How much thicker a stem may become than it begins.
fn widening(level: &Level) -> f32 {
    1.0 + (-level.taper).max(0.0)
}

/// How much thicker than they begin stems beyond the trunk may become, all together.
fn widest(crown: &Crown, levels: [&Level; 4]) -> f32 {
    (1..crown.levels.min(256) as usize).map(|n| widening(levels[n.min(3)])).product()
}

/// How much further lobes reach than the mean radius.
fn lobes(form: &TrunkForm) -> f32 {
    if form.lobes == 0 { 1.0 } else { 1.0 + form.lobe_depth.abs() }
}

/// How far a leaf reaches from the stem that it grows on, in metres.
fn leaf_reach(leaves: &LeafParams) -> f32 {
    if leaves.any_count() == 0 {
        return 0.0;
    }
    let longest = leaves.longest_thinned(1.0);
    let (length, width) = (longest.length().abs(), longest.width().abs());
    let tip = leaves.reach * Vec3::new(width, width, length);
    leaves.stem_len.abs() * length + tip.length()
}
