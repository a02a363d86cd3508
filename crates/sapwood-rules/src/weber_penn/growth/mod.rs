//! Growth: pure functions from parameters and a parent's facts to stems, segments and leaves.
//!
//! [`trunks`] seeds the trunks, [`grow`] makes stems of seeds, [`children`] seeds the next level on
//! them, [`roots`] those below, and [`leaves`] ends on the last. [`fit`] tells how long stems may
//! be under an envelope, [`foreseen`] how far a whole tree may reach. Everything is in tree space.

mod attraction;
mod children;
mod curve;
mod fit;
mod frame;
mod grow;
mod leaf_turns;
mod leaves;
mod placement;
mod reach;
mod roots;
mod shape_ratio;
mod split;
mod stem;
mod taper;
mod trunks;
mod variation;

pub(super) use attraction::is_attracted;
pub use children::children;
pub(super) use children::children_on;
#[cfg(test)]
pub(super) use children::n_children;
pub(super) use curve::helix_radius;
pub(super) use fit::fit_standing;
pub use fit::{Limit, fit};
pub use frame::Frame;
pub use grow::grow;
pub(super) use leaves::leaves_at;
pub use leaves::{LeafPlaces, leaf_places, leaves};
pub(super) use reach::Reach;
pub use reach::foreseen;
pub use roots::roots;
pub use stem::{Leaf, Segment, Stem, StemSeed, Stems};
pub(super) use taper::flare_factor;
pub use trunks::trunks;
