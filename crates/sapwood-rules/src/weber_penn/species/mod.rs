//! A species as its file says it: every parameter in the file's own units.
//!
//! Angles are degrees here and nowhere else, lengths metres, the rest fractions or counts. What
//! values are accepted stands in the table of keys; what growth reads is made from a species by
//! [`Crown`](crate::weber_penn::Crown), [`Level`](crate::weber_penn::Level) and their like.

mod accepted;
mod choices;
mod keys;
mod value;

use sapwood_images::{BarkKind, LeafOutline};

pub use accepted::Accepted;
pub use choices::{CrownShape, Dialect, LeafShape, LeafTarget, Origin, Target, Variation};
pub use keys::{Fault, Key, key, keys};
pub use value::{Value, WrittenEnvelope, WrittenImage, WrittenMesh};

/// The parameters of one species, in degrees and metres.
///
/// The default has the values that Arbaro fills in for missing parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Species {
    /// The name for people.
    pub name: String,
    /// Where the numbers are from.
    pub origin: Origin,
    /// Keys that the source does not give.
    pub defaulted: Vec<String>,
    /// Free remarks.
    pub notes: Vec<String>,
    /// Which reading of the model to grow by; `None` takes the origin's own.
    pub dialect: Option<Dialect>,
    /// How `X ± V` is drawn.
    pub variation: Variation,
    /// What stems turn toward, in the world.
    pub attraction_target: Target,
    /// Shape: the outline of the crown.
    pub shape: CrownShape,
    /// BaseSize: the branchless share at the foot of the tree.
    pub base_size: f32,
    /// Scale: the size of the tree in metres.
    pub scale: f32,
    /// ScaleV: variation of the size in metres.
    pub scale_v: f32,
    /// ZScale: listed in the paper, never used; kept.
    pub z_scale: f32,
    /// ZScaleV: listed in the paper, never used; kept.
    pub z_scale_v: f32,
    /// Levels: how many levels of stems.
    pub levels: u32,
    /// Ratio: trunk radius per trunk length.
    pub ratio: f32,
    /// RatioPower: how fast radius falls with relative length.
    pub ratio_power: f32,
    /// Lobes: peaks round the trunk's cross-section.
    pub lobes: u32,
    /// LobeDepth: amplitude of the lobes, as a fraction of the radius.
    pub lobe_depth: f32,
    /// Flare: how much the trunk's foot widens, as a fraction of the radius.
    pub flare: f32,
    /// AttractionUp: upward (+) or drooping (-) tendency of levels 2 and deeper.
    pub attraction_up: f32,
    /// Smooth (Arbaro): 0 to 1, mesh points and normals.
    pub smooth: Option<f32>,
    /// What the trunk alone has.
    pub trunk: TrunkSpec,
    /// The roots, which the paper knows nothing of.
    pub roots: RootsSpec,
    /// The bark.
    pub bark: BarkSpec,
    /// The leaves.
    pub leaves: LeavesSpec,
    /// The pruning envelope.
    pub pruning: PruningSpec,
    /// The parameters of levels 0 to 3; deeper levels take the last.
    pub level: [LevelSpec; 4],
    /// tree-gen's parameters that have no equal in the paper.
    pub ext: Option<TreeGenExt>,
}

impl Species {
    /// The dialect to grow by: the one written down, or else the origin's own.
    pub fn effective_dialect(&self) -> Dialect {
        self.dialect.unwrap_or(self.origin.into())
    }

    /// The index of the parameter set that leaves take their angles from.
    pub fn leaf_level(&self) -> usize {
        self.levels.min(3) as usize
    }
}

impl Default for Species {
    fn default() -> Self {
        let level = |down_angle, rotate, branches, length, curve_res| LevelSpec {
            down_angle,
            rotate,
            branches,
            length,
            curve_res,
            ..LevelSpec::default()
        };
        Self {
            name: String::new(),
            origin: Origin::Paper,
            defaulted: Vec::new(),
            notes: Vec::new(),
            dialect: None,
            variation: Variation::Uniform,
            attraction_target: Target::Up,
            shape: CrownShape::Conical,
            base_size: 0.25,
            scale: 10.0,
            scale_v: 0.0,
            z_scale: 1.0,
            z_scale_v: 0.0,
            levels: 3,
            ratio: 0.05,
            ratio_power: 1.0,
            lobes: 0,
            lobe_depth: 0.0,
            flare: 0.5,
            attraction_up: 0.0,
            smooth: None,
            trunk: TrunkSpec::default(),
            roots: RootsSpec::default(),
            bark: BarkSpec::default(),
            leaves: LeavesSpec::default(),
            pruning: PruningSpec::default(),
            level: [
                LevelSpec { branch_dist: 0.0, ..level(0.0, 0.0, 1, 1.0, 3) },
                level(30.0, 120.0, 10, 0.5, 3),
                level(30.0, 120.0, 5, 0.5, 1),
                level(30.0, 120.0, 5, 0.5, 1),
            ],
            ext: None,
        }
    }
}

/// What the trunk alone has: 0Scale, 0ScaleV and 0BaseSplits.
#[derive(Clone, Debug, PartialEq)]
pub struct TrunkSpec {
    /// 0Scale: extra factor on the trunk's radius.
    pub scale: f32,
    /// 0ScaleV: its variation.
    pub scale_v: f32,
    /// 0BaseSplits: clones at the end of the trunk's first segment; negative (tree-gen): a
    /// random number up to that many.
    pub base_splits: i32,
}

impl Default for TrunkSpec {
    fn default() -> Self {
        Self { scale: 1.0, scale_v: 0.0, base_splits: 0 }
    }
}

/// The roots of a species, in degrees and fractions: stems that grow from the foot of each trunk.
#[derive(Clone, Debug, PartialEq)]
pub struct RootsSpec {
    /// How many each trunk has; 0: none.
    pub count: u32,
    /// Their length relative to the trunk's.
    pub length: f32,
    /// Its variation.
    pub length_v: f32,
    /// Their radius at the foot relative to the trunk's.
    pub radius: f32,
    /// The angle between them and the trunk: more than 90 leads down.
    pub down_angle: f32,
    /// Its variation.
    pub down_angle_v: f32,
    /// How far each may stand beside where even spacing has it.
    pub rotate_v: f32,
    /// As nTaper.
    pub taper: f32,
    /// As nSegSplits.
    pub seg_splits: f32,
    /// As nSplitAngle, of which the angle that a root makes with the vertical is taken away.
    pub split_angle: f32,
    /// As nSplitAngleV.
    pub split_angle_v: f32,
    /// As nCurveRes.
    pub curve_res: u32,
    /// As nCurve; positive: down.
    pub curve: f32,
    /// As nCurveV; negative: a helix.
    pub curve_v: f32,
}

impl Default for RootsSpec {
    fn default() -> Self {
        Self {
            count: 0,
            length: 0.3,
            length_v: 0.1,
            radius: 0.45,
            down_angle: 85.0,
            down_angle_v: 8.0,
            rotate_v: 15.0,
            taper: 1.0,
            seg_splits: 0.0,
            split_angle: 130.0,
            split_angle_v: 10.0,
            curve_res: 8,
            curve: 35.0,
            curve_v: 60.0,
        }
    }
}

/// The bark of a species; what is not given follows from the rest.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BarkSpec {
    /// How it is structured.
    pub kind: Option<BarkKind>,
    /// The linear colour of what lies outermost.
    pub color: Option<[f32; 3]>,
    /// The linear colour of furrows, marks and rings.
    pub deep_color: Option<[f32; 3]>,
    /// How deep the relief is, in metres.
    pub depth: Option<f32>,
    /// The width in metres of one repeat of the images.
    pub width: Option<f32>,
    /// The linear colour of the last level of stems.
    pub twig_color: Option<[f32; 3]>,
}

/// The leaves of a species.
#[derive(Clone, Debug, PartialEq)]
pub struct LeavesSpec {
    /// Leaves: the most leaves on one stem of the last level; negative: a fan at its tip.
    pub count: i32,
    /// LeafShape: the outline.
    pub shape: LeafShape,
    /// A mesh instead of the shape.
    pub mesh: Option<WrittenMesh>,
    /// An image instead of a painted one. One of which parts are cut out is shown on a card in its
    /// own proportions, any other on the shape; on a mesh by its texture coordinates.
    pub image: Option<WrittenImage>,
    /// LeafScale: length in metres.
    pub scale: f32,
    /// LeafScaleX: width per length; of meshes and cards a factor on their own width.
    pub scale_x: f32,
    /// LeafBend: 0 to 1, how far leaves turn outward and up.
    pub bend: f32,
    /// LeafStemLen (Arbaro): the undrawn petiole, as a fraction of the leaf's length.
    pub stem_len: f32,
    /// LeafDistrib (Arbaro): the shape by which leaf counts vary along the parent stem.
    pub distrib: CrownShape,
    /// LeafQuality (Arbaro; the paper's quality): 0 to 1, fewer but larger leaves; fans stay.
    pub quality: f32,
    /// How strongly leaves turn toward a direction or a point: 0 not at all, 1 fully.
    pub attraction: f32,
    /// What leaves turn toward, in the world.
    pub target: LeafTarget,
    /// Where their images end; not given: as suits the shape.
    pub outline: Option<LeafOutline>,
    /// The linear colour between their veins.
    pub color: Option<[f32; 3]>,
    /// The linear colour of their veins.
    pub vein_color: Option<[f32; 3]>,
    /// The share of the light scattered in them that leaves on the other side.
    pub translucency: Option<f32>,
    /// 0 to 1: how far their normals follow the crown instead of each leaf, for a soft look.
    pub roundness: f32,
}

impl Default for LeavesSpec {
    fn default() -> Self {
        Self {
            count: 0,
            shape: LeafShape::Oval,
            mesh: None,
            image: None,
            scale: 0.2,
            scale_x: 0.5,
            bend: 0.3,
            stem_len: 0.5,
            distrib: CrownShape::TaperedCylindrical,
            quality: 1.0,
            attraction: 0.0,
            target: LeafTarget::Outward,
            outline: None,
            color: None,
            vein_color: None,
            translucency: None,
            roundness: 0.0,
        }
    }
}

impl LeavesSpec {
    /// Whether they have proportions of their own, which a `scale_x` of 1 keeps: those of a mesh,
    /// or of an image that is cut out.
    pub fn has_own_proportions(&self) -> bool {
        self.mesh.is_some() || self.image.as_ref().is_some_and(|own| own.image.is_cut_out())
    }

    /// Why the image cannot be shown, in words, if it cannot.
    pub fn image_fault(&self) -> Option<&'static str> {
        let is_bare = self.mesh.as_ref().is_some_and(|own| !own.mesh.has_uvs());
        (is_bare && self.image.is_some()).then_some(
            "the leaf's mesh has no texture coordinates to lay the image by (accepted: without a \
             mesh, or with one that has them)",
        )
    }
}

/// The pruning envelope of a species; lengths are fractions of the tree's size.
#[derive(Clone, Debug, PartialEq)]
pub struct PruningSpec {
    /// PruneRatio: 0 off, 1 fully inside the envelope.
    pub ratio: f32,
    /// PruneWidth: the envelope's radius where it is widest.
    pub width: f32,
    /// PruneWidthPeak: the height of its widest place, from its bottom.
    pub width_peak: f32,
    /// PrunePowerLow: curvature below the peak.
    pub power_low: f32,
    /// PrunePowerHigh: curvature above the peak.
    pub power_high: f32,
    /// Another shape instead of the paper's solid of revolution; it holds trunks too.
    pub envelope: Option<WrittenEnvelope>,
}

impl Default for PruningSpec {
    fn default() -> Self {
        Self {
            ratio: 0.0,
            width: 0.5,
            width_peak: 0.5,
            power_low: 0.5,
            power_high: 0.5,
            envelope: None,
        }
    }
}

/// The parameters of one level, in degrees and fractions.
#[derive(Clone, Debug, PartialEq)]
pub struct LevelSpec {
    /// nDownAngle: angle between stem and parent.
    pub down_angle: f32,
    /// nDownAngleV: its variation; negative: varied along the parent.
    pub down_angle_v: f32,
    /// nRotate: turn about the parent from one stem to the next; negative: alternate sides.
    pub rotate: f32,
    /// nRotateV: its variation.
    pub rotate_v: f32,
    /// nBranches: the most stems of this level on one parent, or the number of trunks;
    /// negative: a fan at the parent's tip.
    pub branches: i32,
    /// nBranchDist (Arbaro): 1 even spacing, 0 whorls at the segments' feet; for the trunks the
    /// radius in metres over which they scatter.
    pub branch_dist: f32,
    /// nLength: length relative to the parent's, or to the tree's size for the trunk.
    pub length: f32,
    /// nLengthV: its variation.
    pub length_v: f32,
    /// nTaper: 0 cylinder, 1 cone, 2 rounded end, up to 3 string of spheres.
    pub taper: f32,
    /// nSegSplits: clones per segment.
    pub seg_splits: f32,
    /// nSplitAngle: angle between clones; negative (tree-gen): planar split.
    pub split_angle: f32,
    /// nSplitAngleV: its variation.
    pub split_angle_v: f32,
    /// nCurveRes: segments per stem.
    pub curve_res: u32,
    /// nCurve: total bend.
    pub curve: f32,
    /// nCurveBack: bend of the second half; 0: no back curve.
    pub curve_back: f32,
    /// nCurveV: random bend; negative: a helix of that declination.
    pub curve_v: f32,
    /// The most leaves on one stem of the level, besides those that the last level has by
    /// [`LeavesSpec::count`]; negative: a fan at its tip. Means nothing on the last level itself.
    pub leaves: i32,
    /// Sides of the stems' cross-section; not given: by level and thickness.
    pub sides: Option<u32>,
    /// Pieces of the stems' surface from end to end; not given: one for each segment.
    pub segments: Option<u32>,
}

impl Default for LevelSpec {
    fn default() -> Self {
        Self {
            down_angle: 0.0,
            down_angle_v: 0.0,
            rotate: 0.0,
            rotate_v: 0.0,
            branches: 1,
            branch_dist: 1.0,
            length: 1.0,
            length_v: 0.0,
            taper: 1.0,
            seg_splits: 0.0,
            split_angle: 0.0,
            split_angle_v: 0.0,
            curve_res: 1,
            curve: 0.0,
            curve_back: 0.0,
            curve_v: 0.0,
            leaves: 0,
            sides: None,
            segments: None,
        }
    }
}

/// tree-gen's extra parameters; arrays hold one number per level.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TreeGenExt {
    /// The branchless share of each level's stems; the trunk's is [`Species::base_size`].
    pub base_size: Option<[f32; 4]>,
    /// Random sideways bend in degrees.
    pub bend_v: Option<[f32; 4]>,
    /// How what grows on the level before is grouped: 0 alternate, 1 opposite, above 1 whorls of
    /// one more on average; not to be mixed up with nBranchDist.
    pub branch_dist: Option<[f32; 4]>,
    /// A factor on the radius.
    pub radius_mod: Option<[f32; 4]>,
    /// The vector that stems bend toward, instead of AttractionUp; trunks and the first branches
    /// feel its horizontal part alone.
    pub tropism: Option<[f32; 3]>,
    /// The share of leaves replaced by blossoms; kept, no blossoms grow.
    pub blossom_rate: Option<f32>,
    /// The size of a blossom in metres.
    pub blossom_scale: Option<f32>,
    /// The number of the blossom's shape.
    pub blossom_shape: Option<i32>,
}
