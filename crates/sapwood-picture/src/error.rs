//! Why there is no picture.

use std::fmt;

use sapwood_graph::Interrupted;

/// Why there is no picture.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum PictureError {
    /// An option is out of its range.
    Option {
        /// Its name: `samples`.
        name: &'static str,
        /// What it is.
        value: String,
        /// What it may be, in words.
        accepted: &'static str,
    },
    /// An option of an impostor is out of its range.
    Impostor {
        /// Its name: `sides`.
        name: &'static str,
        /// What it is.
        value: u32,
        /// What it may be, in words.
        accepted: &'static str,
    },
    /// The camera cannot look: what is wrong, in words.
    Camera(String),
    /// There is nothing to point the camera at.
    Empty,
    /// Compiling was cancelled or a budget ran out.
    Interrupted(Interrupted),
}

impl fmt::Display for PictureError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Option { name, value, accepted } => {
                write!(f, "{name} of a picture: {value} (accepted: {accepted})")
            }
            Self::Impostor { name, value, accepted } => {
                write!(f, "{name} of an impostor: {value} (accepted: {accepted})")
            }
            Self::Camera(fault) => write!(f, "the camera cannot look: {fault}"),
            Self::Empty => f.write_str("there is nothing to see: the scene has no extent"),
            Self::Interrupted(why) => why.fmt(f),
        }
    }
}

impl std::error::Error for PictureError {}

impl From<Interrupted> for PictureError {
    fn from(why: Interrupted) -> Self {
        Self::Interrupted(why)
    }
}
