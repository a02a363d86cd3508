//! Reading slots at a place, and noting which were read.

use std::sync::{Arc, Mutex, MutexGuard};

use sapwood_graph::EnvId;
use smallvec::SmallVec;

use super::{Environments, Held, Slot, SlotKey, SlotValue, forced_against};

/// Reads held slots in one environment.
pub struct SlotReader<'a> {
    /// Behind a lock, for rules run side by side.
    environments: &'a Mutex<Environments>,
    env: EnvId,
    /// The slots read so far, sorted.
    pub(crate) slots: SmallVec<[SlotKey; 4]>,
}

impl<'a> SlotReader<'a> {
    pub(crate) fn new(environments: &'a Mutex<Environments>, env: EnvId) -> Self {
        Self { environments, env, slots: SmallVec::new() }
    }

    /// The value of a held slot.
    ///
    /// A slot that moves cannot be read here:
    /// ```compile_fail
    /// # use sapwood_scene::{Moving, Slot, SlotReader};
    /// enum Time {}
    /// impl Slot for Time {
    ///     type Value = f32;
    ///     type Rate = Moving;
    ///     const NAME: &'static str = "time";
    ///     fn default() -> f32 { 0.0 }
    /// }
    /// fn read(slots: &mut SlotReader<'_>) -> f32 {
    ///     *slots.read::<Time>()
    /// }
    /// ```
    pub fn read<S: Slot<Rate = Held>>(&mut self) -> Arc<S::Value> {
        self.value(SlotKey::of::<S>()).typed::<S>()
    }

    pub(crate) fn value(&mut self, slot: SlotKey) -> SlotValue {
        if let Err(place) = self.slots.binary_search(&slot) {
            self.slots.insert(place, slot);
        }
        self.known().value(self.env, slot)
    }

    fn known(&self) -> MutexGuard<'a, Environments> {
        self.environments.lock().unwrap_or_else(|broken| broken.into_inner())
    }

    /// Notes slots as read.
    pub(crate) fn note(&mut self, slots: &[SlotKey]) {
        for slot in slots {
            if let Err(place) = self.slots.binary_search(slot) {
                self.slots.insert(place, *slot);
            }
        }
    }

    /// The value of a slot if it is forced here.
    pub(crate) fn forced_value(&mut self, slot: SlotKey) -> Option<SlotValue> {
        let forced = forced_against(slot);
        if let Err(place) = self.slots.binary_search(&forced) {
            self.slots.insert(place, forced);
        }
        let mut known = self.known();
        let is_forced = known.is_forced(self.env, slot);
        is_forced.then(|| known.value(self.env, slot))
    }

    /// The slots that were read, as plans keep them.
    pub(crate) fn into_slots(self) -> Arc<[SlotKey]> {
        if self.slots.is_empty() { Arc::default() } else { self.slots.as_slice().into() }
    }

    /// A reader at the same place that notes its own slots.
    pub(crate) fn fork(&mut self) -> SlotReader<'_> {
        SlotReader::new(self.environments, self.env)
    }
}
