//! What becomes of parts, where somebody knows better than the triangles do.

use std::sync::Arc;

use sapwood_geom::glam::{Affine3, Vec3};

use crate::{Kind, Part};

/// What remains of a part.
#[derive(Clone)]
pub enum Fate {
    /// All of it, also what lies outside of the envelope.
    Whole,
    /// Nothing.
    Gone,
    /// What is not beyond a cut; the open end is closed by a flat cap.
    Cut(Arc<dyn Beyond>),
}

/// On which side of a cut through a part points lie.
pub trait Beyond: Send + Sync {
    /// How far beyond the cut a point lies, in metres; 0 at the cut, below 0 in what remains.
    /// Linear near the cut, so that the cut is flat. Points are in the frame of the plan that
    /// has the part.
    fn beyond(&self, point: Vec3) -> f32;
}

impl std::fmt::Debug for Fate {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Whole => "Whole",
            Self::Gone => "Gone",
            Self::Cut(_) => "Cut",
        })
    }
}

/// The fates of a plan's parts of one kind.
pub(super) struct Fates {
    pub(super) kind: Kind,
    pub(super) rows: Vec<Fate>,
    /// From the plan's frame to the root's.
    pub(super) world: Affine3,
}

impl Fates {
    pub(super) fn new<P: Part>(rows: Vec<Fate>, world: Affine3) -> Self {
        Self { kind: Kind::of::<P>(), rows, world }
    }

    /// What becomes of a row; what nobody knows of stays whole.
    pub(super) fn of(&self, row: Option<u32>) -> &Fate {
        row.and_then(|row| self.rows.get(row as usize)).unwrap_or(&Fate::Whole)
    }
}
