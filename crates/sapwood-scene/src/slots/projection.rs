//! Projections: small values computed from slots, of which only the result counts as read.
//!
//! A component that needs to know whether it stands inside an envelope, or in which square of a
//! grid, reads a projection: it is compiled again when the answer changes, not whenever it is
//! moved.

use std::any::TypeId;
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use sapwood_geom::{Content, Digest, Digester};

use super::{SlotKey, SlotReader};

/// A small value computed from slots.
///
/// The projection's own content holds its arguments: two projections of one type with equal
/// content must compute the same.
pub trait Projection: Content + Send + Sync + 'static {
    /// The type of the result.
    type Output: Content;
    /// The projection's name in dumps and diagnostics.
    const NAME: &'static str;

    /// Computes the value; a pure function of the projection and of what it reads. A panic fails
    /// the component that asked.
    fn compute(&self, slots: &mut SlotReader<'_>) -> Self::Output;
}

/// What stands for the result of a projection that panicked.
pub(crate) const PANICKED: Digest = Digest::from_bits(0x70616e69_636b6564);

/// A projection, its type forgotten.
pub(crate) trait AnyProjection: Send + Sync {
    /// The digest of the result, or of a panic.
    fn compute_digest(&self, slots: &mut SlotReader<'_>) -> Digest;
}

impl<P: Projection> AnyProjection for P {
    fn compute_digest(&self, slots: &mut SlotReader<'_>) -> Digest {
        let result = catch_unwind(AssertUnwindSafe(|| Digest::of(&self.compute(slots))));
        result.unwrap_or(PANICKED)
    }
}

/// A projection that was read: what it is, how to ask again, and the slots it asked.
#[derive(Clone)]
pub(crate) struct ProjectionKey {
    id: TypeId,
    pub(crate) name: &'static str,
    arguments: Digest,
    pub(crate) projection: Arc<dyn AnyProjection>,
    pub(crate) slots: Arc<[SlotKey]>,
}

impl ProjectionKey {
    pub(crate) fn new<P: Projection>(projection: P, slots: Arc<[SlotKey]>) -> Self {
        Self {
            id: TypeId::of::<P>(),
            name: P::NAME,
            arguments: Digest::of(&projection),
            projection: Arc::new(projection),
            slots,
        }
    }
}

impl PartialEq for ProjectionKey {
    fn eq(&self, other: &Self) -> bool {
        self.id == other.id && self.arguments == other.arguments && self.slots == other.slots
    }
}

impl Content for ProjectionKey {
    fn write(&self, digester: &mut Digester) {
        digester.add(self.name).add(&self.arguments);
    }
}

impl fmt::Debug for ProjectionKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}
