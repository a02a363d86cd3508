//! `--weld`: the wood of what was grown, each stem welded from its segments or all joined to one.

use sapwood::geom::UnionError;
use sapwood::graph::{
    At, DrawList, Everything, Order, Prune, Remaining, Standing, WeldPieces, WeldUnion, WeldedUnion,
};
use sapwood::rules::weber_penn::prune_handlers;
use sapwood::scene::{Scene, ViewId};

use crate::arguments::{Detail, GrowArguments, Weld};
use crate::failure::Failure;
use crate::watch::Watch;

/// Refuses to weld what has no surface, and files of one solid where nothing makes that.
pub(super) fn check(arguments: &GrowArguments) -> Result<(), Failure> {
    let mut outputs = arguments.output.iter();
    if arguments.weld != Some(Weld::Union)
        && let Some(output) = outputs.find(|output| output.needs_solid())
    {
        return Err(Failure::usage(format!(
            "{}: STL files hold one solid, and only --weld union makes that of the wood \
             (accepted: with --weld union, or another ending)",
            output.path().display()
        )));
    }
    match (arguments.weld, arguments.tree.detail) {
        (None, _) | (_, Detail::Full | Detail::Draft) | (Some(Weld::Stem), Detail::Segments) => {
            Ok(())
        }
        (Some(_), Detail::Skeleton) => Err(Failure::usage(
            "--weld: surfaces are welded, and --detail skeleton makes none (accepted: --detail \
             full, --detail draft)"
                .to_owned(),
        )),
        (Some(Weld::Union), Detail::Segments) => Err(Failure::usage(
            "--weld union: the segments of --detail segments are open tubes, which enclose nothing that \
             could be joined (accepted: --detail full, --detail draft; --weld stem)"
                .to_owned(),
        )),
    }
}

/// The list with each stem's segments welded to one mesh, and cut then, if there is a cut: the list
/// must be cut too. The view must have been compiled by the rules that draw segments.
pub(super) fn stems(
    scene: &mut Scene,
    view: ViewId,
    list: &DrawList,
    cut: Option<&Prune>,
) -> Result<DrawList, Failure> {
    let mut weld = WeldPieces::new();
    match cut {
        None => scene.traverse(view, Order::Pre, &Everything, &mut |at| weld.meet(at))?,
        Some(cut) => {
            let visit = &mut |remaining: &Remaining<'_>, at: &At<'_, Standing>| {
                weld.meet_remaining(remaining, at);
            };
            scene.traverse_pruned(view, cut, &prune_handlers(), visit)?;
        }
    }
    Ok(weld.welded(list).0)
}

/// The list with one closed surface in the place of all stems; of what a cut leaves, if there is
/// one: the list must be cut then.
pub(super) fn union(
    scene: &mut Scene,
    view: ViewId,
    list: &DrawList,
    cut: Option<&Prune>,
    max_triangles: u64,
    watch: &Watch,
) -> Result<WeldedUnion, Failure> {
    let mut weld = WeldUnion::new();
    match cut {
        None => scene.traverse(view, Order::Pre, &Everything, &mut |at| weld.meet(at))?,
        Some(cut) => {
            let visit = &mut |remaining: &Remaining<'_>, at: &At<'_, Standing>| {
                weld.meet_remaining(remaining, at);
            };
            scene.traverse_pruned(view, cut, &prune_handlers(), visit)?;
        }
    }
    let n_solids = weld.n_solids();
    if n_solids == 0 {
        return Err(Failure::input("--weld union: nothing that was grown is solid".to_owned()));
    }
    let goes_on = |step| watch.welded(step, n_solids).is_continue();
    weld.join(list, max_triangles, &goes_on).map_err(|error| match error {
        UnionError::Interrupted => Failure::interrupted(),
        UnionError::TooManyTriangles { .. } => Failure::too_many(error.to_string()),
        _ => Failure::input(error.to_string()),
    })
}
