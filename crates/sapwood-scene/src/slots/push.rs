//! How a push stands against the pushes above and below it.

use sapwood_geom::{Content, Digester};

use super::{Held, Slot, SlotKey};

/// How a push stands against what is inherited.
///
/// It is resolved where it stands: whoever is below sees one value, whatever the pushes above
/// it were. Forcing [`Placement`](crate::Placement) changes what is read of it, not where
/// things are drawn: that is up to transforms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum PushMode {
    /// Holds below, unless what is inherited was forced.
    #[default]
    Normal,
    /// Holds below against every push further down that does not protect itself. What was
    /// forced further up holds against this one too.
    Force,
    /// Holds below, even if what is inherited was forced; nothing is forced from here on.
    Protect,
    /// Leaves what is inherited as it is: a push that is turned off.
    Inherit,
}

impl Content for PushMode {
    fn write(&self, digester: &mut Digester) {
        digester.add(&(*self as u8));
    }
}

/// What stands for the forced values that may stand against a push of `slot`.
pub(crate) fn forced_against(slot: SlotKey) -> SlotKey {
    if slot.descends() { SlotKey::of::<ForcedDescending>() } else { SlotKey::of::<Forced>() }
}

/// Stands for all values that are forced at a place together, those that descend left out:
/// whatever pushes something reads them, for they may stand against it.
pub(crate) enum Forced {}

impl Slot for Forced {
    type Value = ();
    type Rate = Held;
    const NAME: &'static str = "forced";

    fn default() {}
}

/// Stands for all forced values together that descend. They are another at each child, which
/// concerns only pushes of slots that descend too.
pub(crate) enum ForcedDescending {}

impl Slot for ForcedDescending {
    type Value = ();
    type Rate = Held;
    const NAME: &'static str = "forced_descending";
    const DESCENDS: bool = true;

    fn default() {}

    fn descend((): &(), _: u64) {}
}
