//! What a rule read: the key under which its plan is found again.

use std::sync::Arc;

use sapwood_geom::{Content, Digest, Digester};

use crate::slots::{ProjectionKey, SlotKey, SlotReader};

/// Something that was read.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum ReadKey {
    Slot(SlotKey),
    Projection(Arc<ProjectionKey>),
}

/// Something that was read, and what it was.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Read {
    pub(crate) key: ReadKey,
    pub(crate) value: Digest,
}

impl ReadKey {
    pub(crate) fn name(&self) -> &'static str {
        match self {
            Self::Slot(slot) => slot.name(),
            Self::Projection(projection) => projection.name,
        }
    }

    /// What reading it again gives in another environment; nothing where a projection asks for
    /// other slots there, for then its result is not the same read.
    pub(crate) fn read_again(&self, slots: &mut SlotReader<'_>) -> Option<Digest> {
        match self {
            Self::Slot(slot) => Some(slots.value(*slot).digest),
            Self::Projection(key) => {
                let mut reader = slots.fork();
                let digest = key.projection.compute_digest(&mut reader);
                (reader.slots.as_slice() == &*key.slots).then_some(digest)
            }
        }
    }

    /// Whether both ask the same.
    pub(crate) fn asks_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Slot(a), Self::Slot(b)) => a == b,
            (Self::Projection(a), Self::Projection(b)) => a == b,
            _ => false,
        }
    }
}

impl Content for ReadKey {
    fn write(&self, digester: &mut Digester) {
        match self {
            Self::Slot(slot) => digester.add(&0u8).add(slot.name()),
            Self::Projection(key) => digester.add(&1u8).add(&**key),
        };
    }
}
