//! The semantic graph, slots and rules, and the compiler between them and render graphs.
//!
//! A [`Scene`] holds components in a graph without cycles. A view looks at the scene with a
//! [`RuleSet`]; a traversal of the view compiles each component it reaches into a plan, and
//! remembers it together with what the rule read. After an edit, what read something that has
//! changed is compiled again when a traversal reaches it, and nothing else is.
//!
//! ```
//! use sapwood_scene::{Group, Scene, Transform, built_in_rules};
//!
//! let mut scene = Scene::new();
//! let root = scene.add(Group);
//! let moved = scene.add_to(root, Transform::translation(1.0, 0.0, 0.0))?;
//! let view = scene.open_view(root, &built_in_rules())?;
//! assert_eq!(scene.count(view)?.components_of("transform"), 1);
//! scene.edit(moved, |transform| *transform = Transform::translation(2.0, 0.0, 0.0))?;
//! assert!(scene.bounds(view)?.is_empty());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod built_in;
mod column;
mod compile;
mod log;
mod panic;
#[cfg(feature = "planted-faults")]
mod planted_fault;
mod rules;
mod scene;
mod semantic;
mod slots;
mod view;
mod view_error;

pub use built_in::{
    Attribute, Billboard, Group, HeldGeometry, HeldImpostor, HeldInstances, Kit, KitRule,
    KitTemplate, LevelOfDetail, Rotor, Selector, Switch, Transform, built_in_rules,
};
pub use log::{Action, Event};
#[cfg(feature = "planted-faults")]
pub use planted_fault::PlantedFault;
pub use rules::{Budget, CancelToken, Context, Rule, RuleError, RuleSet, VisitContext};
/// How something stands towards a region: what [`SideOfBox`] tells.
pub use sapwood_geom::Side;
pub use scene::Scene;
pub use semantic::{Children, Component, EditError, Handle, NodeId, Question};
pub use slots::{
    Cell, ChildPath, Choice, DistanceBand, EnvelopeSlot, Held, MaterialSlot, Moving, Placement,
    Projection, PushMode, Rate, SideOfBox, Slot, SlotReader, Style, StyleSlot, SwitchedOn, Time,
    Viewer, Viewpoint, WindSlot,
};
pub use view::ViewId;
pub use view_error::ViewError;
