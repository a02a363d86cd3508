//! Projections: small values computed from slots, of which only the result counts as read.
//!
//! A component that needs to know whether it stands inside an envelope, or in which square of a
//! grid, reads a projection: it is compiled again when the answer changes, not whenever it is
//! moved.

use std::any::{Any, TypeId};
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
    type Output: Content + Clone + Send + Sync + 'static;
    /// The projection's name in dumps and diagnostics.
    const NAME: &'static str;
    /// Whether an earlier result may stand although computing it anew would give another one.
    const REMEMBERS: bool = false;

    /// Computes the value; a pure function of the projection and of what it reads. A panic fails
    /// the component that asked.
    fn compute(&self, slots: &mut SlotReader<'_>) -> Self::Output;

    /// Whether the result found last at the same place still stands; asked only of projections
    /// that remember. This is where a threshold gets its hysteresis, and the one way in which
    /// what is compiled depends on what was there before: where nothing is remembered, after
    /// eviction say, the result is computed anew.
    fn stands(&self, earlier: &Self::Output, slots: &mut SlotReader<'_>) -> bool {
        let _ = (earlier, slots);
        false
    }
}

/// A result that a projection may let stand.
pub(crate) type Memory = Arc<dyn Any + Send + Sync>;

/// What stands for the result of a projection that panicked.
pub(crate) const PANICKED: Digest = Digest::from_bits(0x70616e69_636b6564);

/// A projection, its type forgotten.
pub(crate) trait AnyProjection: Send + Sync {
    /// The digest of the result, or of a panic.
    fn compute_digest(&self, slots: &mut SlotReader<'_>) -> Digest;
    /// Whether an earlier result still stands; a panic lets nothing stand.
    fn lets_stand(&self, earlier: &Memory, slots: &mut SlotReader<'_>) -> bool;
}

impl<P: Projection> AnyProjection for P {
    fn compute_digest(&self, slots: &mut SlotReader<'_>) -> Digest {
        let result = catch_unwind(AssertUnwindSafe(|| Digest::of(&self.compute(slots))));
        result.unwrap_or(PANICKED)
    }

    fn lets_stand(&self, earlier: &Memory, slots: &mut SlotReader<'_>) -> bool {
        let Some(earlier) = earlier.downcast_ref() else { return false };
        catch_unwind(AssertUnwindSafe(|| self.stands(earlier, slots))).unwrap_or(false)
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
    /// The key of a projection that has read nothing yet.
    pub(crate) fn new<P: Projection>(projection: Arc<P>) -> Self {
        Self {
            id: TypeId::of::<P>(),
            name: P::NAME,
            arguments: Digest::of(&*projection),
            projection,
            slots: Arc::default(),
        }
    }

    /// The key with the slots that it was found to read.
    pub(crate) fn reading(self, slots: Arc<[SlotKey]>) -> Self {
        Self { slots, ..self }
    }
}

impl ProjectionKey {
    /// Whether both are the same projection with the same arguments, whatever slots they read.
    pub(crate) fn is_same_question(&self, other: &Self) -> bool {
        self.id == other.id && self.arguments == other.arguments
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
