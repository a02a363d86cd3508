//! The built-in traversals, one file each.

mod bounds;
mod count;
mod diagnostics;
mod draw_list;
mod dump;
mod merge;
mod outline;
mod pick;
mod poses;
mod prune;
mod rigged;
#[cfg(feature = "simplify")]
mod simplify;
mod smooth;
mod up_to;
mod verify;
#[cfg(feature = "union")]
mod weld;
mod weld_pieces;

pub use bounds::fragment_bound;
pub use count::{CountMemo, Counts, count};
pub use diagnostics::diagnostics;
pub use draw_list::{
    Body, CameraRow, DrawList, DrawRow, Follows, LabelRow, LightRow, LineRow, Occurrence,
    TooManyRows, draw_list,
};
pub use dump::dump;
pub use merge::{Merge, TooManyTriangles};
pub use outline::outline;
pub use pick::{AlongRay, Hit, PickOptions, PickedPart, PickedSides, Struck, pick, pick_compiled};
pub use poses::{Moved, Poses};
pub use prune::{
    Beyond, Fate, Prune, PruneHandlers, PruneLimits, Pruning, Remaining, Standing, prune,
    prune_compiled, prune_each, prune_interest,
};
pub use verify::{Finding, Report, Severity, verify};
#[cfg(feature = "union")]
pub use weld::{WeldReport, WeldUnion, WeldedUnion};
pub use weld_pieces::{PiecesReport, WeldPieces};
