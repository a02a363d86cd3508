//! What a plan is pieced together from: the interface through which rules offer it.

use sapwood_geom::{Pieces, Shared};

/// What a rule offers of its data whose mesh is made of pieces that can be welded.
///
/// Welding knows vertices by what they are and not by where they lie; only who made the pieces
/// can tell.
pub trait Pieced {
    /// The pieces, in the frame of the plan's mesh. They stand for the one mesh that the plan
    /// draws; nothing where it draws none.
    fn pieces(&self) -> Option<&Shared<Pieces>>;
}
