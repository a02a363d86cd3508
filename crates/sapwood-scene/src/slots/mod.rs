//! Slots: typed values that components inherit from above, and how they are read.

mod built_in;
mod environment;
mod places;
mod projection;
mod push;
mod reader;
mod scope;
mod slot;

pub use built_in::{
    ChildPath, Choice, EnvelopeSlot, MaterialSlot, Placement, Style, StyleSlot, SwitchedOn, Time,
    Viewer, Viewpoint, WindSlot,
};
pub(crate) use environment::{Above, Environments, ForcedSlots, LinkFacts};
pub use places::{Cell, DistanceBand, SideOfBox};
pub use projection::Projection;
pub(crate) use projection::{Memory, PANICKED, ProjectionKey};
pub use push::PushMode;
pub(crate) use push::{Forced, ForcedDescending, forced_against};
pub use reader::SlotReader;
pub(crate) use scope::{LinkPushes, NO_SCOPE, Pushed, Scope};
pub use slot::{Held, Moving, Rate, Slot};
pub(crate) use slot::{SlotKey, SlotValue};
