//! The outlines that leaves can have, as tables: half outlines, hulls, veins.
//!
//! Places are measured across in half widths from the midrib, -1 to 1, and along from the base
//! at 0 to the tip at 1.

use sapwood_geom::{Content, Digester};

/// Where a leaf ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum LeafOutline {
    /// Nowhere: the image is covered all over, for meshes that have the outline themselves.
    Whole,
    /// Nearly round with a short tip and fine teeth, as on aspens.
    Orbicular,
    /// A triangle with a broad base and teeth, as on poplars and birches.
    Deltoid,
    /// A heart with teeth, as on limes.
    Cordate,
    /// Egg-shaped with fine teeth, as on apples.
    #[default]
    Ovate,
    /// Widest at the middle, with a smooth margin, as on tupelos.
    Elliptic,
    /// Long and widest below the middle, as on willows and bamboos.
    Lanceolate,
    /// Deep lobes on both sides, as on oaks.
    Oak,
    /// Five pointed lobes, as on maples.
    Maple,
    /// Three rounded lobes, as on sassafras.
    Trilobed,
    /// Seven long fingers, as on Japanese maples.
    Palmate,
    /// Three leaflets.
    Leaflets,
    /// One flat blunt needle, as on firs.
    Needle,
    /// A bundle of thin needles, as on pines.
    Needles,
    /// A long blade with lines along, as on palm fronds.
    Blade,
}

/// How the right half of an outline is written down.
pub(super) struct Half {
    /// From the base to the tip.
    pub(super) points: &'static [[f32; 2]],
    /// Whether the outline is a smooth curve through the points.
    pub(super) is_smooth: bool,
    /// How many teeth a side has, and how deep they are against the leaf's length.
    pub(super) teeth: (u32, f32),
}

/// How veins run.
pub(super) enum Veins {
    /// So many pairs of side veins off a midrib, each rising by such a share of the leaf.
    Pinnate { pairs: u32, rise: f32 },
    /// Main veins from one place to others on the right half, the left mirrored.
    Palmate { foot: [f32; 2], tips: &'static [[f32; 2]] },
    /// Lines along, so many on a half.
    Parallel { n: u32 },
}

impl LeafOutline {
    /// All outlines with their names.
    pub const NAMES: [(&'static str, Self); 15] = [
        ("whole", Self::Whole),
        ("orbicular", Self::Orbicular),
        ("deltoid", Self::Deltoid),
        ("cordate", Self::Cordate),
        ("ovate", Self::Ovate),
        ("elliptic", Self::Elliptic),
        ("lanceolate", Self::Lanceolate),
        ("oak", Self::Oak),
        ("maple", Self::Maple),
        ("trilobed", Self::Trilobed),
        ("palmate", Self::Palmate),
        ("leaflets", Self::Leaflets),
        ("needle", Self::Needle),
        ("needles", Self::Needles),
        ("blade", Self::Blade),
    ];

    /// The right half of a convex polygon around the outline, from the base up: how far from the
    /// midrib, -1 to 1 being the image's width, and how far along, base 0 and tip 1.
    ///
    /// A mesh of this shape shows the whole leaf; its left half mirrors the right.
    pub fn hull(self) -> &'static [[f32; 2]] {
        match self {
            Self::Whole => &[[1.0, 0.0], [1.0, 1.0]],
            Self::Orbicular => &[[0.72, 0.0], [1.0, 0.5], [0.4, 1.0]],
            Self::Deltoid | Self::Cordate => &[[0.85, 0.0], [1.0, 0.3], [0.25, 1.0]],
            Self::Ovate => &[[0.6, 0.0], [1.0, 0.45], [0.25, 1.0]],
            Self::Elliptic => &[[0.4, 0.0], [1.0, 0.5], [0.4, 1.0]],
            Self::Lanceolate => &[[0.5, 0.0], [1.0, 0.36], [0.2, 1.0]],
            Self::Oak => &[[0.5, 0.0], [1.0, 0.5], [0.45, 1.0]],
            Self::Maple => &[[0.7, 0.0], [1.0, 0.5], [0.15, 1.0]],
            Self::Trilobed => &[[0.3, 0.0], [1.0, 0.6], [0.25, 1.0]],
            Self::Palmate => &[[0.65, 0.0], [1.0, 0.3], [0.96, 0.79], [0.12, 1.0]],
            Self::Leaflets => &[[0.45, 0.0], [1.0, 0.42], [0.35, 1.0]],
            Self::Needle => &[[0.8, 0.0], [1.0, 1.0]],
            Self::Needles => &[[0.4, 0.0], [1.0, 1.0]],
            Self::Blade => &[[0.36, 0.0], [1.0, 0.3], [0.72, 0.7], [0.02, 1.0]],
        }
    }

    pub(super) fn half(self) -> Half {
        let smooth = |points, teeth| Half { points, is_smooth: true, teeth };
        let sharp = |points| Half { points, is_smooth: false, teeth: (0, 0.0) };
        match self {
            Self::Whole => sharp(&[[1.0, 0.0], [1.0, 1.0]]),
            Self::Orbicular => smooth(&ORBICULAR, (20, 0.016)),
            Self::Deltoid => smooth(&DELTOID, (15, 0.024)),
            Self::Cordate => smooth(&CORDATE, (18, 0.02)),
            Self::Ovate => smooth(&OVATE, (22, 0.014)),
            Self::Elliptic => smooth(&ELLIPTIC, (0, 0.0)),
            Self::Lanceolate => smooth(&LANCEOLATE, (0, 0.0)),
            Self::Oak => smooth(&OAK, (0, 0.0)),
            Self::Maple => sharp(&MAPLE),
            Self::Trilobed => smooth(&TRILOBED, (0, 0.0)),
            Self::Palmate => sharp(&PALMATE),
            Self::Leaflets => smooth(&LEAFLETS, (0, 0.0)),
            Self::Needle => smooth(&NEEDLE, (0, 0.0)),
            Self::Needles => sharp(&[]),
            Self::Blade => smooth(&BLADE, (0, 0.0)),
        }
    }

    pub(super) fn veins(self) -> Veins {
        match self {
            Self::Whole => Veins::Pinnate { pairs: 6, rise: 0.2 },
            Self::Orbicular => Veins::Pinnate { pairs: 5, rise: 0.24 },
            Self::Deltoid | Self::Cordate => Veins::Pinnate { pairs: 6, rise: 0.24 },
            Self::Ovate | Self::Elliptic => Veins::Pinnate { pairs: 8, rise: 0.17 },
            Self::Lanceolate => Veins::Pinnate { pairs: 14, rise: 0.1 },
            Self::Oak => Veins::Pinnate { pairs: 5, rise: 0.16 },
            Self::Maple => Veins::Palmate { foot: [0.0, 0.1], tips: &MAPLE_TIPS },
            Self::Trilobed => Veins::Palmate { foot: [0.0, 0.16], tips: &TRILOBED_TIPS },
            Self::Palmate => Veins::Palmate { foot: PALM, tips: &PALMATE_TIPS },
            Self::Leaflets => Veins::Palmate { foot: [0.0, 0.24], tips: &LEAFLETS_TIPS },
            Self::Needle | Self::Needles => Veins::Parallel { n: 1 },
            Self::Blade => Veins::Parallel { n: 5 },
        }
    }
}

impl Content for LeafOutline {
    fn write(&self, digester: &mut Digester) {
        (*self as u8).write(digester);
    }
}

const ORBICULAR: [[f32; 2]; 9] = [
    [0.0, 0.01],
    [0.34, 0.015],
    [0.64, 0.1],
    [0.82, 0.26],
    [0.88, 0.45],
    [0.74, 0.65],
    [0.44, 0.83],
    [0.13, 0.94],
    [0.0, 1.0],
];
const DELTOID: [[f32; 2]; 8] = [
    [0.0, 0.03],
    [0.42, 0.02],
    [0.78, 0.08],
    [0.9, 0.24],
    [0.68, 0.5],
    [0.36, 0.76],
    [0.11, 0.93],
    [0.0, 1.0],
];
const CORDATE: [[f32; 2]; 9] = [
    [0.0, 0.13],
    [0.18, 0.04],
    [0.46, 0.015],
    [0.76, 0.1],
    [0.9, 0.29],
    [0.68, 0.56],
    [0.34, 0.8],
    [0.1, 0.94],
    [0.0, 1.0],
];
const OVATE: [[f32; 2]; 8] = [
    [0.0, 0.0],
    [0.28, 0.02],
    [0.62, 0.14],
    [0.83, 0.36],
    [0.7, 0.6],
    [0.4, 0.82],
    [0.13, 0.95],
    [0.0, 1.0],
];
const ELLIPTIC: [[f32; 2]; 7] =
    [[0.0, 0.0], [0.28, 0.06], [0.62, 0.23], [0.82, 0.5], [0.62, 0.76], [0.26, 0.93], [0.0, 1.0]];
const LANCEOLATE: [[f32; 2]; 8] = [
    [0.0, 0.0],
    [0.3, 0.04],
    [0.66, 0.18],
    [0.85, 0.36],
    [0.63, 0.62],
    [0.32, 0.83],
    [0.1, 0.95],
    [0.0, 1.0],
];
const OAK: [[f32; 2]; 24] = [
    [0.0, 0.0],
    [0.05, 0.03],
    [0.09, 0.12],
    [0.28, 0.12],
    [0.5, 0.13],
    [0.6, 0.19],
    [0.46, 0.24],
    [0.36, 0.26],
    [0.31, 0.3],
    [0.38, 0.35],
    [0.62, 0.37],
    [0.86, 0.42],
    [0.89, 0.5],
    [0.7, 0.54],
    [0.44, 0.52],
    [0.34, 0.56],
    [0.4, 0.62],
    [0.58, 0.67],
    [0.64, 0.75],
    [0.46, 0.79],
    [0.32, 0.77],
    [0.28, 0.85],
    [0.14, 0.96],
    [0.0, 1.0],
];
const MAPLE: [[f32; 2]; 18] = [
    [0.0, 0.1],
    [0.1, 0.07],
    [0.3, 0.085],
    [0.4, 0.05],
    [0.6, 0.04],
    [0.5, 0.14],
    [0.36, 0.25],
    [0.56, 0.29],
    [0.72, 0.37],
    [0.95, 0.5],
    [0.78, 0.52],
    [0.6, 0.59],
    [0.3, 0.53],
    [0.26, 0.6],
    [0.38, 0.74],
    [0.22, 0.77],
    [0.14, 0.88],
    [0.0, 1.0],
];
const MAPLE_TIPS: [[f32; 2]; 3] = [[0.6, 0.04], [0.95, 0.5], [0.0, 1.0]];
const TRILOBED: [[f32; 2]; 14] = [
    [0.0, 0.0],
    [0.08, 0.06],
    [0.2, 0.2],
    [0.42, 0.33],
    [0.72, 0.45],
    [0.9, 0.58],
    [0.84, 0.67],
    [0.6, 0.64],
    [0.38, 0.58],
    [0.36, 0.66],
    [0.44, 0.78],
    [0.38, 0.9],
    [0.16, 0.98],
    [0.0, 1.0],
];
const TRILOBED_TIPS: [[f32; 2]; 2] = [[0.9, 0.62], [0.0, 1.0]];
/// Where the fingers meet.
const PALM: [f32; 2] = [0.0, 0.28];
const PALMATE: [[f32; 2]; 15] = [
    [0.0, 0.2],
    [0.12, 0.21],
    [0.28, 0.13],
    [0.56, 0.08],
    [0.42, 0.19],
    [0.24, 0.27],
    [0.54, 0.25],
    [0.94, 0.31],
    [0.58, 0.37],
    [0.26, 0.36],
    [0.58, 0.5],
    [0.86, 0.77],
    [0.42, 0.61],
    [0.16, 0.44],
    [0.19, 0.7],
];
const PALMATE_TIPS: [[f32; 2]; 4] = [[0.56, 0.08], [0.94, 0.31], [0.86, 0.77], [0.0, 1.0]];
const LEAFLETS: [[f32; 2]; 15] = [
    [0.0, 0.0],
    [0.03, 0.03],
    [0.03, 0.2],
    [0.26, 0.12],
    [0.6, 0.17],
    [0.84, 0.3],
    [0.92, 0.44],
    [0.6, 0.44],
    [0.25, 0.34],
    [0.05, 0.25],
    [0.05, 0.36],
    [0.3, 0.5],
    [0.38, 0.7],
    [0.2, 0.9],
    [0.0, 1.0],
];
const LEAFLETS_TIPS: [[f32; 2]; 2] = [[0.92, 0.44], [0.0, 1.0]];
const NEEDLE: [[f32; 2]; 6] =
    [[0.3, 0.0], [0.7, 0.06], [0.8, 0.3], [0.78, 0.8], [0.5, 0.97], [0.0, 1.0]];
const BLADE: [[f32; 2]; 8] = [
    [0.0, 0.0],
    [0.3, 0.01],
    [0.6, 0.12],
    [0.9, 0.3],
    [0.8, 0.5],
    [0.64, 0.69],
    [0.26, 0.88],
    [0.0, 1.0],
];
