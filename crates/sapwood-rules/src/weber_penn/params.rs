//! What growth reads, made from a species: radians, and split so that an edit reaches no more
//! than it must.
//!
//! One value for the whole tree, one per level, one for the leaves and one for the trunk's surface.
//! A parameter of the leaves changes [`LeafParams`](super::LeafParams) alone; one of level n
//! changes the [`Level`] n alone, and the leaves if they take their angles from there.

use glam::{Affine3, Vec3};
use sapwood_geom::{Envelope, content};

use super::growth::flare_factor;
use super::{CrownShape, Dialect, LevelDetail, PruningSpec, Species, Target, Variation};

/// What holds for the whole tree.
#[derive(Clone, Debug, PartialEq)]
pub struct Crown {
    /// Which reading of the model to grow by.
    pub dialect: Dialect,
    /// How `X ± V` is drawn.
    pub variation: Variation,
    /// Shape.
    pub shape: CrownShape,
    /// BaseSize, a fraction.
    pub base_size: f32,
    /// Scale in metres.
    pub scale: f32,
    /// ScaleV in metres.
    pub scale_v: f32,
    /// ZScale; kept, nothing reads it.
    pub z_scale: f32,
    /// ZScaleV; kept, nothing reads it.
    pub z_scale_v: f32,
    /// Levels of stems; leaves come after the last.
    pub levels: u32,
    /// Ratio of the trunk's radius to its length.
    pub ratio: f32,
    /// RatioPower.
    pub ratio_power: f32,
    /// AttractionUp.
    pub attraction_up: f32,
    /// What stems turn toward, in the world; growth takes the target in tree space.
    pub target: Target,
    /// tree-gen's tropism vector, present in its dialect only; replaces AttractionUp.
    pub tropism: Option<[f32; 3]>,
    /// The species' own envelope; also shape 8.
    pub pruning: PruningParams,
}

content!(Crown {
    dialect,
    variation,
    shape,
    base_size,
    scale,
    scale_v,
    z_scale,
    z_scale_v,
    levels,
    ratio,
    ratio_power,
    attraction_up,
    target,
    tropism,
    pruning,
});

impl Crown {
    /// The tree-wide values of a species.
    pub fn new(species: &Species) -> Self {
        let dialect = species.effective_dialect();
        let ext = species.ext.as_ref().filter(|_| dialect == Dialect::TreeGen);
        Self {
            dialect,
            variation: species.variation,
            shape: species.shape,
            base_size: species.base_size,
            scale: species.scale,
            scale_v: species.scale_v,
            z_scale: species.z_scale,
            z_scale_v: species.z_scale_v,
            levels: species.levels,
            ratio: species.ratio,
            ratio_power: species.ratio_power,
            attraction_up: species.attraction_up,
            target: species.attraction_target,
            tropism: ext.and_then(|ext| ext.tropism),
            pruning: PruningParams::new(&species.pruning),
        }
    }
}

/// How a species is pruned by itself; lengths are fractions of the tree's size.
#[derive(Clone, Debug, PartialEq)]
pub struct PruningParams {
    /// PruneRatio: 0 off, 1 fully inside.
    pub ratio: f32,
    /// PruneWidth: its greatest radius.
    pub width: f32,
    /// PruneWidthPeak: the height of its widest place.
    pub width_peak: f32,
    /// PrunePowerLow.
    pub power_low: f32,
    /// PrunePowerHigh.
    pub power_high: f32,
    /// What holds the tree instead of the solid that these numbers describe; in tree space.
    pub envelope: Option<Envelope>,
}

content!(PruningParams { ratio, width, width_peak, power_low, power_high, envelope });

impl PruningParams {
    fn new(spec: &PruningSpec) -> Self {
        let &PruningSpec { ratio, width, width_peak, power_low, power_high, .. } = spec;
        let envelope = spec.envelope.as_ref().map(|written| {
            // From the tree's frame, y up, to its space, z up.
            let upright = Affine3::from_cols(Vec3::X, Vec3::Z, Vec3::NEG_Y, Vec3::ZERO);
            Envelope::placed(upright, written.envelope.clone())
        });
        Self { ratio, width, width_peak, power_low, power_high, envelope }
    }

    /// Whether trunks may be shortened.
    pub(crate) fn holds_trunks(&self) -> bool {
        self.ratio > 0.0 && self.envelope.is_some()
    }
}

/// What the trunk's surface reads, and the rule that keeps children inside the trunk's radius.
#[derive(Clone, Debug, PartialEq)]
pub struct TrunkForm {
    /// Flare.
    pub flare: f32,
    /// Lobes.
    pub lobes: u32,
    /// LobeDepth, a fraction of the radius.
    pub lobe_depth: f32,
    /// The factor on the radius at the end: Arbaro's 0Scale; 1 in other dialects, which have it
    /// in the base radius.
    pub scale: f32,
    /// Arbaro's 0ScaleV, the roughness of its trunk mesh; 0 in other dialects.
    pub scale_v: f32,
}

content!(TrunkForm { flare, lobes, lobe_depth, scale, scale_v });

impl TrunkForm {
    /// The form of a species' trunk.
    pub fn new(species: &Species) -> Self {
        let at_the_end = species.effective_dialect() == Dialect::Arbaro;
        Self {
            flare: species.flare,
            lobes: species.lobes,
            lobe_depth: species.lobe_depth,
            scale: if at_the_end { species.trunk.scale } else { 1.0 },
            scale_v: if at_the_end { species.trunk.scale_v } else { 0.0 },
        }
    }

    /// The factor on the trunk's radius at `z` (0 foot, 1 tip), averaged over the lobes.
    pub fn factor(&self, z: f32) -> f32 {
        self.scale * flare_factor(self.flare, z)
    }

    /// The factor on the radius toward `angle` about local z from local x.
    pub fn lobe_factor(&self, angle: f32) -> f32 {
        if self.lobes == 0 {
            return 1.0;
        }
        1.0 + self.lobe_depth * libm::sinf(self.lobes as f32 * angle)
    }
}

/// The parameters of one level of stems, angles in radians.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// nDownAngle.
    pub down_angle: f32,
    /// nDownAngleV; negative: varied along the parent.
    pub down_angle_v: f32,
    /// nRotate; negative: alternate sides.
    pub rotate: f32,
    /// nRotateV.
    pub rotate_v: f32,
    /// nBranches; negative: a fan at the parent's tip.
    pub branches: i32,
    /// nBranchDist; for the trunks a radius in metres.
    pub branch_dist: f32,
    /// nLength.
    pub length: f32,
    /// nLengthV.
    pub length_v: f32,
    /// nTaper.
    pub taper: f32,
    /// nSegSplits.
    pub seg_splits: f32,
    /// nSplitAngle; negative in tree-gen's dialect: planar split.
    pub split_angle: f32,
    /// nSplitAngleV.
    pub split_angle_v: f32,
    /// nCurveRes, at least 1.
    pub curve_res: u32,
    /// nCurve.
    pub curve: f32,
    /// nCurveBack.
    pub curve_back: f32,
    /// nCurveV; negative: a helix.
    pub curve_v: f32,
    /// 0BaseSplits; 0 beyond the trunk.
    pub base_splits: i32,
    /// The factor on the base radius: 0Scale of the trunk (1 in Arbaro's dialect), tree-gen's
    /// radius factor, else 1.
    pub radius_scale: f32,
    /// Its variation: 0ScaleV of the trunk, else 0.
    pub radius_scale_v: f32,
    /// tree-gen's branchless share of a stem of this level; 0 elsewhere, where the trunk's is
    /// BaseSize.
    pub base_size: f32,
    /// tree-gen's sideways bend; 0 elsewhere.
    pub bend_v: f32,
    /// tree-gen's branch_dist, in its dialect only: 0 alternate, 1 opposite, above 1 whorls of one
    /// more.
    pub grouping: Option<f32>,
}

content!(Level {
    down_angle,
    down_angle_v,
    rotate,
    rotate_v,
    branches,
    branch_dist,
    length,
    length_v,
    taper,
    seg_splits,
    split_angle,
    split_angle_v,
    curve_res,
    curve,
    curve_back,
    curve_v,
    base_splits,
    radius_scale,
    radius_scale_v,
    base_size,
    bend_v,
    grouping,
});

impl Level {
    /// The parameters of level `n`; levels beyond 3 take those of 3.
    pub fn new(species: &Species, n: usize) -> Self {
        let n = n.min(3);
        let spec = &species.level[n];
        let dialect = species.effective_dialect();
        let (trunk, arbaro) = (n == 0, dialect == Dialect::Arbaro);
        let ext = species.ext.as_ref().filter(|_| dialect == Dialect::TreeGen);
        let per_level = |values: Option<[f32; 4]>, absent| values.map_or(absent, |v| v[n]);
        let scale = if trunk && !arbaro { species.trunk.scale } else { 1.0 };
        Self {
            down_angle: spec.down_angle.to_radians(),
            down_angle_v: spec.down_angle_v.to_radians(),
            rotate: spec.rotate.to_radians(),
            rotate_v: spec.rotate_v.to_radians(),
            branches: spec.branches,
            branch_dist: spec.branch_dist,
            length: spec.length,
            length_v: spec.length_v,
            taper: spec.taper,
            seg_splits: spec.seg_splits,
            split_angle: spec.split_angle.to_radians(),
            split_angle_v: spec.split_angle_v.to_radians(),
            curve_res: spec.curve_res.max(1),
            curve: spec.curve.to_radians(),
            curve_back: spec.curve_back.to_radians(),
            curve_v: spec.curve_v.to_radians(),
            base_splits: if trunk { species.trunk.base_splits } else { 0 },
            radius_scale: scale * per_level(ext.and_then(|ext| ext.radius_mod), 1.0),
            radius_scale_v: if trunk && !arbaro { species.trunk.scale_v } else { 0.0 },
            base_size: if trunk { 0.0 } else { per_level(ext.and_then(|e| e.base_size), 0.0) },
            bend_v: per_level(ext.and_then(|ext| ext.bend_v), 0.0).to_radians(),
            grouping: grouping(species, n),
        }
    }

    /// Levels 0 to 3 of a species.
    pub fn all(species: &Species) -> [Self; 4] {
        std::array::from_fn(|n| Self::new(species, n))
    }
}

impl LevelDetail {
    /// What a species asks for on levels 0 to 3.
    pub fn all(species: &Species) -> [Self; 4] {
        species.level.each_ref().map(|level| Self { sides: level.sides, segments: level.segments })
    }
}

/// The roots of a species, angles in radians.
#[derive(Clone, Debug, PartialEq)]
pub struct RootParams {
    /// How many each trunk has.
    pub count: u32,
    /// Their length relative to the trunk's.
    pub length: f32,
    /// Its variation.
    pub length_v: f32,
    /// Their base radius relative to the trunk's, before flare.
    pub radius: f32,
    /// The angle between them and the trunk: more than a right angle leads down.
    pub down_angle: f32,
    /// Its variation.
    pub down_angle_v: f32,
    /// How far each is turned about the trunk from where even spacing has it.
    pub rotate_v: f32,
    /// How they grow: taper, splits and curvature; a positive curve leads down.
    pub level: Level,
}

content!(RootParams { count, length, length_v, radius, down_angle, down_angle_v, rotate_v, level });

impl RootParams {
    /// The roots of a species.
    pub fn new(species: &Species) -> Self {
        let roots = &species.roots;
        let plain = Level::new(&Species::default(), 1);
        Self {
            count: roots.count,
            length: roots.length,
            length_v: roots.length_v,
            radius: roots.radius,
            down_angle: roots.down_angle.to_radians(),
            down_angle_v: roots.down_angle_v.to_radians(),
            rotate_v: roots.rotate_v.to_radians(),
            level: Level {
                taper: roots.taper,
                seg_splits: roots.seg_splits,
                split_angle: roots.split_angle.to_radians(),
                split_angle_v: roots.split_angle_v.to_radians(),
                curve_res: roots.curve_res.max(1),
                curve: roots.curve.to_radians(),
                curve_v: roots.curve_v.to_radians(),
                ..plain
            },
        }
    }
}

/// How what grows on level `n - 1` is grouped, where a species of tree-gen's dialect says so.
pub(super) fn grouping(species: &Species, n: usize) -> Option<f32> {
    let ext = species.ext.as_ref().filter(|_| species.effective_dialect() == Dialect::TreeGen);
    ext.and_then(|ext| ext.branch_dist).map(|dist| dist[n.min(3)])
}
