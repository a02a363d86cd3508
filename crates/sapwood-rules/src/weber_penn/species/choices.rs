//! The closed choices of a species file: origins, dialects, shapes and targets, with their names.
//!
//! What a choice does stands with the formula that reads it; outlines of leaves are elsewhere.

use std::borrow::Cow;

use glam::Vec3;
use sapwood_geom::{Content, Digester};

/// Where a species' numbers were published.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Origin {
    /// Weber and Penn 1995, appendix.
    #[default]
    Paper,
    /// The species files of Arbaro.
    Arbaro,
    /// The species files of tree-gen.
    TreeGen,
    /// Nowhere else: species of the library's own, written for the paper's reading.
    Sapwood,
}

/// Which reading of the model a species is grown by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Dialect {
    /// The paper with its slips corrected.
    #[default]
    Paper,
    /// Arbaro's shape 0, its vertical attraction, and 0Scale applied to the surface alone.
    Arbaro,
    /// tree-gen's splits, lengths, leaf counts and extra keys; `docs/architecture.md` lists them.
    TreeGen,
}

/// How `X ± V` is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Variation {
    /// Evenly in [X - V, X + V].
    #[default]
    Uniform,
    /// From a normal distribution of the same variance, truncated at three deviations.
    Normal,
}

/// The outline of the crown, Weber and Penn's Shape 0 to 8.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CrownShape {
    /// 0: longest branches at the bottom.
    #[default]
    Conical,
    /// 1: longest branches halfway.
    Spherical,
    /// 2: round above, flat below.
    Hemispherical,
    /// 3: all branches alike.
    Cylindrical,
    /// 4: half as long at the top.
    TaperedCylindrical,
    /// 5: nothing at top and bottom, longest at 0.7 from the top.
    Flame,
    /// 6: longest branches at the top.
    InverseConical,
    /// 7: a flame that starts at one half.
    TendFlame,
    /// 8: the pruning envelope's profile.
    Envelope,
}

impl CrownShape {
    /// All shapes in the paper's order.
    pub const ALL: [Self; 9] = [
        Self::Conical,
        Self::Spherical,
        Self::Hemispherical,
        Self::Cylindrical,
        Self::TaperedCylindrical,
        Self::Flame,
        Self::InverseConical,
        Self::TendFlame,
        Self::Envelope,
    ];

    /// The shape with the paper's number 0 to 8.
    pub fn from_index(index: i64) -> Option<Self> {
        usize::try_from(index).ok().and_then(|i| Self::ALL.get(i).copied())
    }

    /// The paper's number.
    pub fn index(self) -> u8 {
        self as u8
    }
}

/// The outline of a leaf, one unit long and at most as wide before scaling: elliptic leaves are
/// half as wide, linear ones an eighth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum LeafShape {
    /// An oval, drawn as a hexagon.
    #[default]
    Oval,
    /// A rhombus.
    Diamond,
    /// A triangle.
    Triangle,
    /// A narrow strip, needle-like.
    Linear,
    /// A heart.
    Heart,
    /// A maple leaf of three lobes.
    Maple3,
    /// A maple leaf of five lobes.
    Maple5,
    /// Five leaflets from one point.
    Palmate,
    /// An oak leaf of three lobes.
    Oak3,
    /// Three leaflets from one point.
    Leaflets3,
    /// An ellipse.
    Elliptic,
    /// A square.
    Square,
    /// A folded strip, as on palm fronds.
    Palm,
    /// A ball.
    Sphere,
    /// A disc with this many outline points, at least 3.
    Disc(u32),
}

impl LeafShape {
    /// The canonical names; [`LeafShape::Disc`] is written `disc:K`.
    pub const NAMES: [(&'static str, Self); 14] = [
        ("oval", Self::Oval),
        ("diamond", Self::Diamond),
        ("triangle", Self::Triangle),
        ("linear", Self::Linear),
        ("heart", Self::Heart),
        ("maple3", Self::Maple3),
        ("maple5", Self::Maple5),
        ("palmate", Self::Palmate),
        ("oak3", Self::Oak3),
        ("leaflets3", Self::Leaflets3),
        ("elliptic", Self::Elliptic),
        ("square", Self::Square),
        ("palm", Self::Palm),
        ("sphere", Self::Sphere),
    ];

    /// The shape of this name: canonical names, `disc`, `disc:K` of K outline points (3 to 1000),
    /// Arbaro's `discK` of K triangles (1 to 998), tree-gen's `tree_gen:k`, and in species of
    /// the paper its list index 0 to 5.
    pub fn from_name(name: &str, origin: Origin) -> Option<Self> {
        if let Some((_, shape)) = Self::NAMES.iter().find(|(known, _)| *known == name) {
            return Some(*shape);
        }
        if let Some(index) = name.strip_prefix("tree_gen:") {
            return Self::from_tree_gen(index.parse().ok()?);
        }
        if let Some(points) = name.strip_prefix("disc") {
            if points.is_empty() {
                return Some(Self::Oval);
            }
            let points = match points.strip_prefix(':') {
                Some(points) => points.parse().ok()?,
                // A fan of triangles has two outline points more.
                None => points.parse::<u32>().ok()?.checked_add(2)?,
            };
            return (3..=1000).contains(&points).then_some(Self::Disc(points));
        }
        match (name, origin) {
            ("0", _) => Some(Self::Oval),
            ("1", Origin::Paper) => Some(Self::Triangle),
            ("2", Origin::Paper) => Some(Self::Oak3),
            ("3", Origin::Paper) => Some(Self::Maple3),
            ("4", Origin::Paper) => Some(Self::Maple5),
            ("5", Origin::Paper) => Some(Self::Leaflets3),
            _ => None,
        }
    }

    fn from_tree_gen(index: u32) -> Option<Self> {
        Some(match index {
            0 | 1 => Self::Oval,
            2 => Self::Linear,
            3 => Self::Heart,
            4 => Self::Maple5,
            5 => Self::Palmate,
            6 | 7 => Self::Oak3,
            8 => Self::Elliptic,
            9 => Self::Square,
            10 => Self::Triangle,
            _ => return None,
        })
    }

    /// The canonical name, which [`from_name`](Self::from_name) reads back.
    pub fn name(self) -> Cow<'static, str> {
        if let Self::Disc(points) = self {
            return Cow::Owned(format!("disc:{points}"));
        }
        let (name, _) = Self::NAMES
            .iter()
            .find(|(_, shape)| *shape == self)
            .expect("every shape but the disc stands in the list of names");
        Cow::Borrowed(name)
    }
}

/// What stems turn toward; vectors are in the world in a species, in tree space when growing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Target {
    /// Along the tree's own z axis, by the formula of the dialect.
    #[default]
    Up,
    /// Along a direction of any positive length.
    Direction(Vec3),
    /// Toward a point in metres.
    Point(Vec3),
}

/// What leaves turn their upper side toward; vectors as in [`Target`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum LeafTarget {
    /// Away from the tree's axis and up, by the amount of LeafBend.
    #[default]
    Outward,
    /// Along a direction of any positive length.
    Direction(Vec3),
    /// Toward a point in metres, such as the sun.
    Point(Vec3),
    /// No preferred side: each leaf is rolled about its own length by a random angle.
    Scattered,
}

macro_rules! named {
    ($t:ident { $($variant:ident => $name:literal),* $(,)? }) => {
        impl $t {
            /// The names in species files.
            pub const NAMES: &'static [&'static str] = &[$($name),*];

            /// The choice of this name.
            pub fn from_name(name: &str) -> Option<Self> {
                match name { $($name => Some(Self::$variant),)* _ => None }
            }

            /// Its name in species files.
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => $name),* }
            }
        }

        impl Content for $t {
            fn write(&self, digester: &mut Digester) {
                (*self as u8).write(digester);
            }
        }
    };
}
named!(Origin {
    Paper => "paper",
    Arbaro => "arbaro",
    TreeGen => "tree_gen",
    Sapwood => "sapwood",
});
named!(Dialect { Paper => "paper", Arbaro => "arbaro", TreeGen => "tree_gen" });
named!(Variation { Uniform => "uniform", Normal => "normal" });

impl From<Origin> for Dialect {
    fn from(origin: Origin) -> Self {
        match origin {
            Origin::Paper | Origin::Sapwood => Self::Paper,
            Origin::Arbaro => Self::Arbaro,
            Origin::TreeGen => Self::TreeGen,
        }
    }
}

impl Content for CrownShape {
    fn write(&self, digester: &mut Digester) {
        self.index().write(digester);
    }
}

impl Content for LeafShape {
    fn write(&self, digester: &mut Digester) {
        self.name().as_ref().write(digester);
    }
}

impl Content for Target {
    fn write(&self, digester: &mut Digester) {
        match self {
            Self::Up => 0u8.write(digester),
            Self::Direction(v) => (1u8, *v).write(digester),
            Self::Point(v) => (2u8, *v).write(digester),
        }
    }
}

impl Content for LeafTarget {
    fn write(&self, digester: &mut Digester) {
        match self {
            Self::Outward => 0u8.write(digester),
            Self::Direction(v) => (1u8, *v).write(digester),
            Self::Point(v) => (2u8, *v).write(digester),
            Self::Scattered => 3u8.write(digester),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leaf_shape_names_read_back() {
        let discs = [LeafShape::Disc(3), LeafShape::Disc(8)];
        for shape in LeafShape::NAMES.iter().map(|(_, shape)| *shape).chain(discs) {
            assert_eq!(LeafShape::from_name(&shape.name(), Origin::TreeGen), Some(shape));
        }
    }

    #[test]
    fn leaf_shapes_are_read_by_their_foreign_names() {
        let read = LeafShape::from_name;
        assert_eq!(read("0", Origin::Arbaro), Some(LeafShape::Oval));
        assert_eq!(read("disc", Origin::Arbaro), Some(LeafShape::Oval));
        assert_eq!(read("disc5", Origin::Arbaro), Some(LeafShape::Disc(7)));
        assert_eq!(read("disc:5", Origin::Arbaro), Some(LeafShape::Disc(5)));
        assert_eq!(read("disc0", Origin::Arbaro), None);
        assert_eq!(read("disc:2", Origin::Arbaro), None);
        assert_eq!(read("3", Origin::Paper), Some(LeafShape::Maple3));
        assert_eq!(read("3", Origin::Arbaro), None);
        assert_eq!(read("tree_gen:7", Origin::TreeGen), Some(LeafShape::Oak3));
        assert_eq!(read("tree_gen:11", Origin::TreeGen), None);
    }

    #[test]
    fn crown_shapes_have_the_papers_numbers() {
        for (i, shape) in CrownShape::ALL.into_iter().enumerate() {
            assert_eq!(usize::from(shape.index()), i);
            assert_eq!(CrownShape::from_index(i as i64), Some(shape));
        }
        assert_eq!(CrownShape::from_index(9), None);
        assert_eq!(CrownShape::from_index(-1), None);
    }
}
