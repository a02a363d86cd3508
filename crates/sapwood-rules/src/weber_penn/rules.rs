//! The rules that compile trees.
//!
//! [`full`] makes surfaces and leaves. Over it lie, from the same stems, [`skeleton`], which draws
//! lines instead, [`segments`], which draws each segment by itself, [`fading`], which draws less of
//! everything from afar, [`swaying`], which has what these two draw sway in the wind, and [`map`]
//! and [`text`], which tell of trees as a whole.

mod fading;
mod geometry;
mod leaves;
mod map;
mod pruning;
mod roots;
mod segments;
mod skeleton;
mod structure;
mod survey;
mod swaying;
mod text;

use sapwood_scene::RuleSet;

/// Trees with all their geometry; their materials are painted with images, whose rules must lie
/// below ([`sapwood_images::rules`]).
pub fn full() -> RuleSet {
    RuleSet::new()
        // structure: what grows where
        .with(structure::TreeRule)
        .with(structure::BranchRule)
        .with(structure::ChildrenRule)
        .with(structure::TwigsRule)
        .with(roots::RootsRule)
        .with(leaves::LeavesRule)
        // geometry: what it looks like
        .with(geometry::StemSurfaceRule)
        .with(geometry::LeafModelRule)
        .with(geometry::LeafSurfaceRule)
}

/// Trees as polylines with radii; stems are shared with [`full`].
pub fn skeleton() -> RuleSet {
    RuleSet::new().with(skeleton::StemLinesRule).with(skeleton::NoLeavesRule).over(&full())
}

/// Trees whose stems are separate segments, with gaps and overlaps where they bend, to be welded
/// ([`WeldPieces`](sapwood_graph::WeldPieces)); stems and leaves are shared with [`full`].
pub fn segments() -> RuleSet {
    RuleSet::new().with(segments::SegmentsRule).over(&full())
}

/// Trees of which less is drawn the further away they are from the view's
/// [`Viewer`](sapwood_scene::Viewer), as [`FadingSlot`](super::FadingSlot) says; stems are shared
/// with [`full`]. Polygons give way to lines of the bark's material, and those of leaves to
/// triangles.
pub fn fading() -> RuleSet {
    RuleSet::new().with(fading::FadingSurfaceRule).with(fading::FadingLeavesRule).over(&full())
}

/// A layer over [`full`] or [`fading`] by which trees sway in the view's wind
/// ([`WindSlot`](sapwood_scene::WindSlot)) as time goes by, as [`SwaySlot`](super::SwaySlot) says:
/// what is drawn stands at rest, with joints that [`Poses`](sapwood_graph::Poses) move. Lines do
/// not sway.
pub fn swaying() -> RuleSet {
    RuleSet::new()
        .with(swaying::SwayingTreeRule)
        .with(swaying::SwayingBranchRule)
        .with(swaying::SwayingChildrenRule)
        .with(swaying::SwayingTwigsRule)
}

/// What [`map`] and [`text`] have in common.
fn survey() -> RuleSet {
    RuleSet::new()
        .with(survey::SurveyedTreeRule)
        .with(survey::SurveyedBranchesRule)
        .with(survey::SurveyedGrowthRule)
        .with(survey::LeafTallyRule)
        .over(&full())
}

/// Trees as on a map, flat on the ground: the disc and the outline of the crown that grew, the
/// trunk, and a label with name and height; stems are shared with [`full`].
pub fn map() -> RuleSet {
    RuleSet::new().with(map::TreeMapRule).over(&survey())
}

/// Trees as lines of text: size, crown, stems by level, the longest branches and leaves; stems are
/// shared with [`full`].
pub fn text() -> RuleSet {
    RuleSet::new().with(text::TreeTextRule).over(&survey())
}
