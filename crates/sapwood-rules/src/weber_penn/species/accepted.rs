//! Which values a key accepts.

use std::fmt;

use super::choices::{LeafShape, LeafTarget, Origin, Target};
use super::value::{Field, Value, number, whole};

/// The values that a key accepts. The ends of ranges are finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Accepted {
    /// A number from `min` to `max`, either end of which may be left out of the range.
    Number {
        /// The least number.
        min: f32,
        /// Whether `min` itself is too small.
        above_min: bool,
        /// The greatest number.
        max: f32,
        /// Whether `max` itself is too great.
        below_max: bool,
    },
    /// A whole number from `min` to `max`, both accepted.
    Whole {
        /// The least number.
        min: i64,
        /// The greatest number.
        max: i64,
    },
    /// Any text.
    Text,
    /// A list of texts.
    Texts,
    /// One of these names.
    Names(&'static [&'static str]),
    /// A list of this many numbers, each from `min` to `max`.
    Numbers {
        /// How many.
        len: usize,
        /// The least number.
        min: f32,
        /// The greatest number.
        max: f32,
    },
    /// A name of a leaf shape.
    LeafShape,
    /// `"up"`, a direction or a point.
    Target,
    /// `"outward"`, `"scattered"`, a direction or a point.
    LeafTarget,
    /// A shape that holds the tree, in words.
    Envelope,
    /// The path of a file with the mesh of a leaf.
    LeafMesh,
    /// The path of a file with the image of a leaf.
    LeafImage,
}

impl Accepted {
    /// Whether `value` is accepted. `origin` matters for names of leaf shapes only.
    ///
    /// A whole number is accepted as a number, and a number without a fraction as a whole one.
    pub fn accepts(&self, value: &Value, origin: Origin) -> bool {
        match self {
            Self::Number { min, above_min, max, below_max } => number(value).is_some_and(|x| {
                (x > *min || !above_min && x == *min) && (x < *max || !below_max && x == *max)
            }),
            Self::Whole { min, max } => whole(value).is_some_and(|x| (*min..=*max).contains(&x)),
            Self::Text => matches!(value, Value::Text(_)),
            Self::Texts => matches!(value, Value::Texts(_)),
            Self::Names(names) => {
                matches!(value, Value::Text(name) if names.contains(&name.as_str()))
            }
            Self::Numbers { len, min, max } => matches!(value, Value::Numbers(numbers)
                if numbers.len() == *len
                    && numbers.iter().all(|x| min <= x && x <= max)),
            Self::LeafShape => matches!(value, Value::Text(name)
                if LeafShape::from_name(name, origin).is_some()),
            Self::Target => Target::from_value(value).is_some(),
            Self::LeafTarget => LeafTarget::from_value(value).is_some(),
            Self::Envelope => matches!(value, Value::Envelope(_)),
            Self::LeafMesh => matches!(value, Value::LeafMesh(_)),
            Self::LeafImage => matches!(value, Value::LeafImage(_)),
        }
    }
}

impl fmt::Display for Accepted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Number { min, above_min, max, below_max } => {
                let low = if above_min { "above" } else { "at least" };
                let high = if below_max { "below" } else { "at most" };
                write!(f, "a number {low} {min} and {high} {max}")
            }
            Self::Whole { min, max } => write!(f, "a whole number from {min} to {max}"),
            Self::Text => write!(f, "a text"),
            Self::Texts => write!(f, "a list of texts"),
            Self::Names(names) => {
                write!(f, "one of")?;
                names.iter().enumerate().try_for_each(|(i, name)| {
                    write!(f, "{} {name:?}", if i == 0 { "" } else { "," })
                })
            }
            Self::Numbers { len, min, max } => {
                write!(f, "a list of {len} numbers, each from {min} to {max}")
            }
            Self::LeafShape => {
                write!(f, "the name of a leaf shape:")?;
                LeafShape::NAMES.iter().try_for_each(|(name, _)| write!(f, " {name:?},"))?;
                write!(f, " \"disc:K\" (K from 3 to 1000), \"tree_gen:0\" to \"tree_gen:10\"")
            }
            Self::Target => write!(f, "\"up\", a direction [x, y, z] or {{ point = [x, y, z] }}"),
            Self::Envelope => write!(
                f,
                "\"sphere:X,Y,Z,R\", \"box:X0,Y0,Z0,X1,Y1,Z1\", \"half-space:NX,NY,NZ,D\", \
                 \"mesh:FILE.glb\" or \"outside:SHAPE\", in metres from the tree's foot, y up"
            ),
            Self::LeafMesh => write!(f, "the path of a .glb, .gltf or .obj file"),
            Self::LeafImage => write!(f, "the path of a PNG or JPEG file"),
            Self::LeafTarget => write!(
                f,
                "\"outward\", \"scattered\", a direction [x, y, z] or {{ point = [x, y, z] }}"
            ),
        }
    }
}
