//! Values as files can hold them, and how the fields of a species turn into them and back.

use std::fmt;

use sapwood_geom::Envelope;
use sapwood_images::{BarkKind, LeafOutline};

use crate::weber_penn::{LeafMesh, OwnLeafImage};

use super::choices::{CrownShape, Dialect, LeafShape, LeafTarget, Origin, Target, Variation};

/// A value as files can hold it.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A number.
    Number(f32),
    /// A whole number.
    Whole(i64),
    /// Text.
    Text(String),
    /// A list of texts.
    Texts(Vec<String>),
    /// A list of numbers; as a target, a direction.
    Numbers(Vec<f32>),
    /// A point, written `{ point = [x, y, z] }`.
    Point([f32; 3]),
    /// A shape in words, and what they stand for.
    Envelope(WrittenEnvelope),
    /// The mesh of a leaf, by the file that it is from.
    LeafMesh(WrittenMesh),
    /// The image of a leaf, by the file that it is from.
    LeafImage(WrittenImage),
}

/// An envelope as a file words it; reading the words, and files that they name, is left to
/// others.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenEnvelope {
    /// The words.
    pub text: String,
    /// What they stand for, in the frame of the tree: metres from its foot, y up.
    pub envelope: Envelope,
}

/// A leaf's mesh, and the file that it is from; reading that is left to others.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenMesh {
    /// The path of the file, as a species file names it; empty for one that is from no file.
    pub path: String,
    /// What it holds.
    pub mesh: LeafMesh,
}

/// A leaf's image, and the file that it is from; reading that is left to others.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenImage {
    /// The path of the file, as a species file names it; empty for one that is from no file.
    pub path: String,
    /// What it holds.
    pub image: OwnLeafImage,
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number}"),
            Self::Whole(number) => write!(f, "{number}"),
            Self::Text(text) => write!(f, "{text:?}"),
            Self::Texts(texts) => write!(f, "{texts:?}"),
            Self::Numbers(numbers) => write!(f, "{numbers:?}"),
            Self::Point(point) => write!(f, "{{ point = {point:?} }}"),
            Self::Envelope(written) => write!(f, "{:?}", written.text),
            Self::LeafMesh(written) => write!(f, "{:?}", written.path),
            Self::LeafImage(written) => write!(f, "{:?}", written.path),
        }
    }
}

pub(super) fn number(value: &Value) -> Option<f32> {
    match value {
        Value::Number(x) => Some(*x),
        Value::Whole(x) => Some(*x as f32),
        _ => None,
    }
}

pub(super) fn whole(value: &Value) -> Option<i64> {
    match value {
        Value::Whole(x) => Some(*x),
        // The cast saturates; what it cannot hold lies outside every range of the table.
        Value::Number(x) if x.is_finite() && x.trunc() == *x => Some(*x as i64),
        _ => None,
    }
}

fn vector(numbers: &[f32]) -> Option<glam::Vec3> {
    let array: [f32; 3] = numbers.try_into().ok()?;
    array.iter().all(|x| x.is_finite()).then_some(array.into())
}

fn direction(value: &Value) -> Option<glam::Vec3> {
    let Value::Numbers(numbers) = value else { return None };
    // A square that underflows or overflows leaves no direction to turn to.
    vector(numbers).filter(|v| v.length_squared() > 0.0 && v.length_squared().is_finite())
}

/// A field of a species that a key can read and write.
pub(super) trait Field: Sized {
    fn to_value(&self) -> Option<Value>;
    fn from_value(value: &Value) -> Option<Self>;
}

impl Field for f32 {
    fn to_value(&self) -> Option<Value> {
        Some(Value::Number(*self))
    }
    fn from_value(value: &Value) -> Option<Self> {
        number(value)
    }
}

macro_rules! whole_field {
    ($($t:ty),*) => {$(
        impl Field for $t {
            fn to_value(&self) -> Option<Value> {
                Some(Value::Whole(i64::from(*self)))
            }
            fn from_value(value: &Value) -> Option<Self> {
                whole(value)?.try_into().ok()
            }
        }
    )*};
}
whole_field!(i32, u32);

impl Field for String {
    fn to_value(&self) -> Option<Value> {
        Some(Value::Text(self.clone()))
    }
    fn from_value(value: &Value) -> Option<Self> {
        match value {
            Value::Text(text) => Some(text.clone()),
            _ => None,
        }
    }
}

macro_rules! written_field {
    ($($t:ty => $variant:ident),*) => {$(
        impl Field for $t {
            fn to_value(&self) -> Option<Value> {
                Some(Value::$variant(self.clone()))
            }
            fn from_value(value: &Value) -> Option<Self> {
                match value {
                    Value::$variant(written) => Some(written.clone()),
                    _ => None,
                }
            }
        }
    )*};
}
written_field!(
    WrittenEnvelope => Envelope,
    WrittenMesh => LeafMesh,
    WrittenImage => LeafImage
);

impl Field for Vec<String> {
    fn to_value(&self) -> Option<Value> {
        Some(Value::Texts(self.clone()))
    }
    fn from_value(value: &Value) -> Option<Self> {
        match value {
            Value::Texts(texts) => Some(texts.clone()),
            _ => None,
        }
    }
}

impl<const N: usize> Field for [f32; N] {
    fn to_value(&self) -> Option<Value> {
        Some(Value::Numbers(self.to_vec()))
    }
    fn from_value(value: &Value) -> Option<Self> {
        match value {
            Value::Numbers(numbers) => numbers.as_slice().try_into().ok(),
            _ => None,
        }
    }
}

impl<T: Field> Field for Option<T> {
    fn to_value(&self) -> Option<Value> {
        self.as_ref().and_then(Field::to_value)
    }
    fn from_value(value: &Value) -> Option<Self> {
        T::from_value(value).map(Some)
    }
}

macro_rules! name_field {
    ($($t:ty),*) => {$(
        impl Field for $t {
            fn to_value(&self) -> Option<Value> {
                Some(Value::Text(self.name().into()))
            }
            fn from_value(value: &Value) -> Option<Self> {
                match value {
                    Value::Text(name) => Self::from_name(name),
                    _ => None,
                }
            }
        }
    )*};
}
name_field!(Origin, Dialect, Variation);

macro_rules! image_field {
    ($($t:ty),*) => {$(
        impl Field for $t {
            fn to_value(&self) -> Option<Value> {
                let (name, _) = Self::NAMES.iter().find(|(_, known)| known == self)?;
                Some(Value::Text((*name).into()))
            }
            fn from_value(value: &Value) -> Option<Self> {
                let Value::Text(text) = value else { return None };
                Self::NAMES.iter().find(|(name, _)| name == text).map(|(_, known)| *known)
            }
        }
    )*};
}
image_field!(BarkKind, LeafOutline);

impl Field for CrownShape {
    fn to_value(&self) -> Option<Value> {
        Some(Value::Whole(i64::from(self.index())))
    }
    fn from_value(value: &Value) -> Option<Self> {
        Self::from_index(whole(value)?)
    }
}

impl Field for LeafShape {
    fn to_value(&self) -> Option<Value> {
        Some(Value::Text(self.name().into_owned()))
    }
    // Names that depend on the origin have been made canonical by `Key::set`.
    fn from_value(value: &Value) -> Option<Self> {
        match value {
            Value::Text(name) => Self::from_name(name, Origin::Paper),
            _ => None,
        }
    }
}

impl Field for Target {
    fn to_value(&self) -> Option<Value> {
        Some(match self {
            Self::Up => Value::Text("up".into()),
            Self::Direction(v) => Value::Numbers(v.to_array().to_vec()),
            Self::Point(v) => Value::Point(v.to_array()),
        })
    }
    fn from_value(value: &Value) -> Option<Self> {
        match value {
            Value::Text(name) if name == "up" => Some(Self::Up),
            Value::Point(point) => vector(point).map(Self::Point),
            _ => direction(value).map(Self::Direction),
        }
    }
}

impl Field for LeafTarget {
    fn to_value(&self) -> Option<Value> {
        Some(match self {
            Self::Outward => Value::Text("outward".into()),
            Self::Scattered => Value::Text("scattered".into()),
            Self::Direction(v) => Value::Numbers(v.to_array().to_vec()),
            Self::Point(v) => Value::Point(v.to_array()),
        })
    }
    fn from_value(value: &Value) -> Option<Self> {
        match value {
            Value::Text(name) if name == "outward" => Some(Self::Outward),
            Value::Text(name) if name == "scattered" => Some(Self::Scattered),
            Value::Point(point) => vector(point).map(Self::Point),
            _ => direction(value).map(Self::Direction),
        }
    }
}
