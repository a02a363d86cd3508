//! How much a pruning may make, and whether it shall go on.

use std::cell::Cell;

use crate::{Interrupted, Kind};

/// Steps between two questions whether to go on.
const STEPS: u32 = 1024;

/// What a pruning has to keep to.
#[derive(Clone, Copy)]
pub struct PruneLimits<'a> {
    /// Rows that the draw list may have.
    pub rows: usize,
    /// Triangles that whatever is cut may have afterwards, all together; what is cut to stand in
    /// for that ([`Remaining::solids`](super::Remaining::solids)) may have as many for itself.
    pub triangles: u64,
    /// Asked now and then; ends the work where it answers no.
    pub goes_on: &'a dyn Fn() -> bool,
}

impl PruneLimits<'_> {
    /// No limits.
    pub const NONE: Self = Self { rows: usize::MAX, triangles: u64::MAX, goes_on: &|| true };
}

/// Counts what is cut, and apart from that what is cut to stand in for it: of a mesh that is drawn
/// and a solid in its place only one is there in the end.
pub(super) struct Meters<'a> {
    pub(super) drawn: Meter<'a>,
    pub(super) stand_ins: Meter<'a>,
}

impl<'a> Meters<'a> {
    pub(super) fn new(limits: &'a PruneLimits<'a>) -> Self {
        Self { drawn: Meter::new(limits), stand_ins: Meter::new(limits) }
    }

    /// Whether the work was ended, at a component of this kind.
    pub(super) fn outcome(&self, kind: Kind) -> Result<(), Interrupted> {
        self.drawn.outcome(kind)?;
        self.stand_ins.outcome(kind)
    }
}

/// Counts what is cut.
pub(super) struct Meter<'a> {
    limits: &'a PruneLimits<'a>,
    n_made: Cell<u64>,
    n_steps: Cell<u32>,
    is_cancelled: Cell<bool>,
}

impl<'a> Meter<'a> {
    pub(super) fn new(limits: &'a PruneLimits<'a>) -> Self {
        let (n_made, n_steps) = (Cell::new(0), Cell::new(0));
        Self { limits, n_made, n_steps, is_cancelled: Cell::new(false) }
    }

    /// Notes that so many triangles were made, or so many at most.
    pub(super) fn made(&self, n: usize) {
        self.n_made.set(self.n_made.get() + n as u64);
    }

    /// Notes a step; tells whether there may be another one.
    pub(super) fn goes_on(&self) -> bool {
        let n = self.n_steps.get();
        self.n_steps.set((n + 1) % STEPS);
        if n == 0 && !self.is_cancelled.get() && !(self.limits.goes_on)() {
            self.is_cancelled.set(true);
        }
        !self.is_cancelled.get() && self.n_made.get() <= self.limits.triangles
    }

    /// Whether the work was ended, at a component of this kind.
    fn outcome(&self, kind: Kind) -> Result<(), Interrupted> {
        if self.goes_on() {
            return Ok(());
        }
        if self.is_cancelled.get() {
            return Err(Interrupted::Cancelled);
        }
        let (what, limit) = ("triangles", self.limits.triangles);
        Err(Interrupted::Exhausted { what, limit, component: kind.name() })
    }
}
