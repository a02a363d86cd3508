//! `--weld`: the wood of what was grown, welded before it is written.

use sapwood::graph::{DrawList, Everything, Order, WeldPieces};
use sapwood::scene::{Scene, ViewId};

use crate::arguments::{Detail, GrowArguments};
use crate::failure::Failure;

/// Refuses to weld what has no surface.
pub(super) fn check(arguments: &GrowArguments) -> Result<(), Failure> {
    if arguments.weld.is_none() || arguments.tree.detail != Detail::Skeleton {
        return Ok(());
    }
    Err(Failure::usage(
        "--weld: surfaces are welded, and --detail skeleton makes none (accepted: --detail full, \
         --detail draft)"
            .to_owned(),
    ))
}

/// The list with each stem's segments welded to one mesh. The view must have been compiled by
/// the rules that draw segments.
pub(super) fn stems(scene: &mut Scene, view: ViewId, list: &DrawList) -> Result<DrawList, Failure> {
    let mut weld = WeldPieces::new();
    scene.traverse(view, Order::Pre, &Everything, &mut |at| weld.meet(at))?;
    Ok(weld.welded(list).0)
}
