//! The built-in components, each with its rule.

mod attribute;
mod billboard;
mod graph_nodes;
mod group;
mod held_geometry;
mod held_impostor;
mod held_instances;
mod kit;
mod level_of_detail;
mod rotor;
mod selector;
mod switch;
mod transform;

pub use attribute::Attribute;
pub use billboard::Billboard;
pub use group::Group;
pub use held_geometry::HeldGeometry;
pub use held_impostor::HeldImpostor;
pub use held_instances::HeldInstances;
pub use kit::{Kit, KitRule, KitTemplate};
pub use level_of_detail::LevelOfDetail;
pub use rotor::Rotor;
pub use selector::Selector;
pub use switch::Switch;
pub use transform::Transform;

use sapwood_graph::Kind;

use crate::RuleSet;

/// The rules of the built-in components; the layer that every rule set lies over.
pub fn built_in_rules() -> RuleSet {
    RuleSet::new()
        // Structure.
        .with(group::GroupRule)
        .with(selector::SelectorRule)
        .with(level_of_detail::LevelOfDetailRule)
        // Attributes.
        .with(attribute::AttributeRule)
        .with(transform::TransformRule)
        .with(switch::SwitchRule)
        .with(rotor::RotorRule)
        .with(billboard::BillboardRule)
        // What is there to see.
        .with(held_geometry::HeldGeometryRule)
        .with(held_instances::HeldInstancesRule)
        .with(held_impostor::HeldImpostorRule)
        .with(graph_nodes::LightRule)
        .with(graph_nodes::CameraRule)
        .with(graph_nodes::LabelRule)
}

/// The kinds that say something of what they hold, and are little by themselves.
pub(crate) fn kinds_of_attributes() -> [Kind; 7] {
    [
        Kind::of::<Attribute>(),
        Kind::of::<Transform>(),
        Kind::of::<Switch>(),
        Kind::of::<Selector>(),
        Kind::of::<LevelOfDetail>(),
        Kind::of::<Rotor>(),
        Kind::of::<Billboard>(),
    ]
}
