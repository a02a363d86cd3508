//! What is solid about a plan: the interface through which rules offer it.

use sapwood_geom::Mesh;

/// What a rule offers of its data whose meshes are the surface of solids: the solids, each a
/// closed mesh of its own. Solids may overlap each other.
///
/// A union of solids needs more than the meshes that are drawn: where a branch begins inside its
/// trunk, those are open.
pub trait Solids {
    /// The solids, in the frame of the plan's meshes. They stand for all meshes of the plan. Where
    /// those show parts ([`Shown`](crate::Shown)), there is one for each part, in their order: empty
    /// where the part is none, so that what is cut away of a part is cut away of its solid.
    fn solids(&self) -> Vec<Mesh>;
}
