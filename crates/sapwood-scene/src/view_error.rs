//! Why a view yields nothing.

use std::fmt;

use sapwood_graph::{Interrupted, TooManyRows};

/// Why a traversal of a view yields nothing.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ViewError {
    /// The view was closed, or belongs to another scene.
    Closed,
    /// Compiling was cancelled, or a budget ran out.
    Interrupted(Interrupted),
    /// The draw list would have more rows than allowed.
    TooManyRows(TooManyRows),
}

impl fmt::Display for ViewError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Closed => f.write_str("the view is closed"),
            Self::Interrupted(why) => why.fmt(f),
            Self::TooManyRows(why) => why.fmt(f),
        }
    }
}

impl std::error::Error for ViewError {}

impl From<Interrupted> for ViewError {
    fn from(why: Interrupted) -> Self {
        Self::Interrupted(why)
    }
}

impl From<TooManyRows> for ViewError {
    fn from(why: TooManyRows) -> Self {
        Self::TooManyRows(why)
    }
}
