//! The built-in components, each with its rule.

mod attribute;
mod group;
mod held_geometry;
mod switch;
mod transform;

pub use attribute::Attribute;
pub use group::Group;
pub use held_geometry::HeldGeometry;
pub use switch::Switch;
pub use transform::Transform;

use crate::RuleSet;

/// The rules of the built-in components; the layer that every rule set lies over.
pub fn built_in_rules() -> RuleSet {
    RuleSet::new()
        .with(group::GroupRule)
        .with(transform::TransformRule)
        .with(switch::SwitchRule)
        .with(attribute::AttributeRule)
        .with(held_geometry::HeldGeometryRule)
}
