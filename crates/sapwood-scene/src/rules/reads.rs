//! What a rule read: the key under which its plan is found again.

use std::cmp::Ordering;
use std::fmt;
use std::sync::Arc;

use sapwood_geom::{Content, Digest, Digester};
use smallvec::SmallVec;

use crate::slots::{Memory, ProjectionKey, SlotKey, SlotReader, SlotValue};

/// Something that was read.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum ReadKey {
    Slot(SlotKey),
    /// The value of a slot where it is forced, else nothing.
    Forced(SlotKey),
    Projection(Arc<ProjectionKey>),
}

/// Something that was read, and what it was.
#[derive(Clone)]
pub(crate) struct Read {
    pub(crate) key: ReadKey,
    pub(crate) value: Digest,
    /// The result itself, of projections that remember.
    pub(crate) memory: Option<Memory>,
}

/// What is remembered leaves its digest.
impl PartialEq for Read {
    fn eq(&self, other: &Self) -> bool {
        self.key == other.key && self.value == other.value
    }
}

impl fmt::Debug for Read {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}: {:?}", self.key, self.value)
    }
}

/// What a component read when it was compiled last at a place, as far as projections remember
/// it.
#[derive(Clone, Default)]
pub(crate) struct Memories(SmallVec<[Read; 1]>);

impl Memories {
    pub(crate) fn of(reads: &[Read]) -> Self {
        Self(reads.iter().filter(|read| read.memory.is_some()).cloned().collect())
    }

    /// What a projection found at its place last, if that still stands.
    pub(crate) fn standing(
        &self,
        key: &ProjectionKey,
        slots: &mut SlotReader<'_>,
    ) -> Option<&Read> {
        let read = self.0.iter().find(|read| match &read.key {
            ReadKey::Projection(known) => known.is_same_question(key),
            ReadKey::Slot(_) | ReadKey::Forced(_) => false,
        })?;
        key.projection.lets_stand(read.memory.as_ref()?, slots).then_some(read)
    }
}

impl ReadKey {
    pub(crate) fn name(&self) -> &'static str {
        match self {
            Self::Slot(slot) | Self::Forced(slot) => slot.name(),
            Self::Projection(projection) => projection.name,
        }
    }

    /// An order by name, in a way that is quick to compare.
    pub(crate) fn order(&self, other: &Self) -> Ordering {
        match (self, other) {
            (Self::Slot(a) | Self::Forced(a), Self::Slot(b) | Self::Forced(b)) if a != b => {
                a.cmp(b)
            }
            (Self::Projection(_), Self::Slot(_) | Self::Forced(_)) => Ordering::Less,
            (Self::Slot(_) | Self::Forced(_), Self::Projection(_)) => Ordering::Greater,
            (a, b) => a.name().cmp(b.name()),
        }
    }

    /// What reading it again gives in another environment; nothing where a projection asks for
    /// other slots there, for then its result is not the same read.
    pub(crate) fn read_again(
        &self,
        slots: &mut SlotReader<'_>,
        memories: &Memories,
    ) -> Option<Digest> {
        match self {
            Self::Slot(slot) => Some(slots.value(*slot).digest),
            Self::Forced(slot) => Some(forced_digest(slots.forced_value(*slot).as_ref())),
            Self::Projection(key) => {
                let mut reader = slots.fork();
                let standing = memories.standing(key, &mut reader).map(|read| read.value);
                let digest = standing.unwrap_or_else(|| key.projection.compute_digest(&mut reader));
                (reader.slots.as_slice() == &*key.slots).then_some(digest)
            }
        }
    }

    /// Whether both ask the same.
    pub(crate) fn asks_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Slot(a), Self::Slot(b)) | (Self::Forced(a), Self::Forced(b)) => a == b,
            (Self::Projection(a), Self::Projection(b)) => a == b,
            _ => false,
        }
    }
}

impl Content for ReadKey {
    fn write(&self, digester: &mut Digester) {
        match self {
            Self::Slot(slot) if slot.served().is_some() => digester.add(&3u8).add(slot.name()),
            Self::Slot(slot) => digester.add(&0u8).add(slot.name()),
            Self::Projection(key) => digester.add(&1u8).add(&**key),
            Self::Forced(slot) => digester.add(&2u8).add(slot.name()),
        };
    }
}

/// What counts as read of a slot that is forced, or is not.
pub(crate) fn forced_digest(value: Option<&SlotValue>) -> Digest {
    value.map_or(Digest::from_bits(0), |value| value.digest)
}
