//! How something stands towards a region.

use crate::{Content, Digester};

/// How something stands towards a region.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    /// Wholly inside.
    Inside,
    /// Neither wholly inside nor wholly outside.
    Crossing,
    /// Wholly outside.
    Outside,
}

impl Side {
    /// The side towards everything that is not in the region.
    pub fn flipped(self) -> Self {
        match self {
            Self::Inside => Self::Outside,
            Self::Crossing => Self::Crossing,
            Self::Outside => Self::Inside,
        }
    }
}

impl Content for Side {
    fn write(&self, digester: &mut Digester) {
        digester.add(&(*self as u8));
    }
}
