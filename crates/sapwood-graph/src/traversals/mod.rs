//! The built-in traversals, one file each.

mod bounds;
mod count;
mod diagnostics;
mod draw_list;
mod dump;
mod pick;

pub use bounds::fragment_bound;
pub use count::{CountMemo, Counts, count};
pub use diagnostics::diagnostics;
pub use draw_list::{
    Body, CameraRow, DrawList, DrawRow, LabelRow, LightRow, LineRow, Occurrence, TooManyRows,
    draw_list,
};
pub use dump::dump;
pub use pick::{AlongRay, Hit, PickOptions, PickedPart, PickedSides, Struck, pick, pick_compiled};
