//! The render graph: what compiled components look like, and how traversals go over it.
//!
//! A plan's fragment is a flat array of closed render nodes; where children belong there stand
//! *deferred* nodes, whose links a [`Supply`] fills. This crate knows nothing of components,
//! rules or caching: it walks whatever a `Supply` hands out, notes a [`Want`] where a link is
//! unfilled, and asks a [`Provide`] to fill wants between walks.

mod fragment;
mod handlers;
mod kind;
mod material;
mod parts;
mod supply;
mod traversals;
mod walk;

pub use fragment::{Fragment, FragmentBuilder, RenderNode, Run};
pub use handlers::Handlers;
pub use kind::{Kind, Named};
pub use material::Material;
pub use parts::{Part, Parts};
pub use supply::{
    Diagnostic, EnvId, Interrupted, PlanRef, Provide, SiteId, Supplied, Supply, Want,
};
pub use traversals::{
    Body, CountMemo, Counts, DrawList, DrawRow, LineRow, Occurrence, TooManyRows, count,
    diagnostics, draw_list, dump, fragment_bound,
};
pub use walk::{
    Approach, At, Everything, Inside, Interest, Order, Path, Under, discover, traverse, walk,
};
