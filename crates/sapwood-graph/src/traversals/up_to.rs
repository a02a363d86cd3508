//! The interest of walks that write a text of limited length.

use std::cell::Cell;

use crate::{Approach, Interest};

/// The interest in everything until enough was written.
#[derive(Default)]
pub(super) struct UpTo {
    is_full: Cell<bool>,
}

impl UpTo {
    pub(super) fn is_full(&self) -> bool {
        self.is_full.get()
    }

    /// Notes that enough was written.
    pub(super) fn fill(&self) {
        self.is_full.set(true);
    }
}

impl Interest for UpTo {
    type State = ();

    fn start(&self) {}

    fn enter(&self, (): &(), _: &Approach<'_>) -> Option<()> {
        (!self.is_full()).then_some(())
    }
}
