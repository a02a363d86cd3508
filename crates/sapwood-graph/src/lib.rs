//! The render graph: what compiled components look like, and how traversals go over it.
//!
//! A plan's fragment is a flat array of closed render nodes; where children belong there stand
//! *deferred* nodes, whose links a [`Supply`] fills. This crate knows nothing of components,
//! rules or caching: it walks whatever a `Supply` hands out, notes a [`Want`] where a link is
//! unfilled, and asks a [`Provide`] to fill wants between walks.

mod aspects;
mod camera;
mod cross_fade;
mod facing;
mod fading;
mod figures;
mod fragment;
mod handlers;
mod impostor;
mod interfaces;
mod kind;
mod label;
mod light;
mod limits;
mod material;
mod parts;
mod pieces;
mod rig;
mod solids;
mod supply;
mod traversals;
mod walk;
mod wind;

pub use aspects::Aspects;
pub use camera::{Camera, Lens};
pub use cross_fade::{CrossFade, DrawnPart};
pub use facing::{Eye, Facing};
pub use fading::{DrawRange, Fading, Falloff, Stretch, even_order, n_drawn};
pub use figures::grouped;
pub use fragment::{Fragment, FragmentBuilder, RenderNode, Run, Shown};
pub use handlers::{Fallbacks, Handlers};
pub use impostor::Impostor;
pub use interfaces::{Interfaces, Offers};
pub use kind::{Kind, Named};
pub use label::{Anchor, Label};
pub use light::{Light, LightShape};
pub use limits::{Limiter, LimitsAbove, Vantage};
pub use material::{Alpha, Material, MaterialImages};
pub use parts::{Part, Parts};
pub use pieces::Pieced;
pub use rig::{Joint, Levels, Rig, Swing};
pub use solids::Solids;
pub use supply::{
    Diagnostic, EnvId, Interrupted, PlanRef, Provide, SiteId, Supplied, Supply, Want,
};
pub use traversals::{
    AlongRay, Beyond, Body, CameraRow, CountMemo, Counts, DrawList, DrawRow, Fate, Finding,
    Follows, Hit, LabelRow, LightRow, LineRow, Merge, Moved, Occurrence, PickOptions, PickedPart,
    PickedSides, PiecesReport, Poses, Prune, PruneHandlers, PruneLimits, Pruning, Remaining,
    Report, Severity, Standing, Struck, TooManyRows, TooManyTriangles, WeldPieces, count,
    diagnostics, draw_list, dump, fragment_bound, outline, pick, pick_compiled, prune,
    prune_compiled, prune_each, prune_interest, verify,
};
#[cfg(feature = "union")]
pub use traversals::{WeldReport, WeldUnion, WeldedUnion};
pub use walk::{
    Approach, At, Everything, Inside, Interest, Order, Path, Under, discover, traverse, walk,
};
pub use wind::Wind;
