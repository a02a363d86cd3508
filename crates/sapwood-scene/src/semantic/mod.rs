//! The semantic graph: what is there, as plain data.
//!
//! Components of any registered kind stand in a directed graph without cycles. Groups and
//! attributes are components too, of built-in kinds. Nothing here knows of rules or plans; an
//! edit leaves a new revision and marks the way up to the roots.

mod component;
mod cycle;
mod edges;
mod edit_error;
mod fields;
mod graph;
mod mark;
mod storage;
mod values;

pub use component::{Children, Component, Handle, NodeId};
pub use edit_error::EditError;
pub(crate) use graph::Graph;
pub(crate) use storage::{AnyComponent, ComponentRow, Storage};
pub use values::Question;
