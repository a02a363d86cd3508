//! The rules that compile trees.
//!
//! [`full`] makes surfaces and leaves. Over it lie, from the same stems, [`skeleton`], which draws lines
//! instead, [`segments`], which draws each segment by itself, and [`fading`], which draws less of
//! everything from afar.

mod fading;
mod geometry;
mod pruning;
mod segments;
mod skeleton;
mod structure;

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
        // geometry: what it looks like
        .with(geometry::StemSurfaceRule)
        .with(geometry::LeavesRule::default())
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
/// [`Viewer`](sapwood_scene::Viewer), as [`FadingSlot`](super::FadingSlot) says; stems are shared with
/// [`full`]. Polygons give way to lines, which have no material, and those of leaves to triangles.
pub fn fading() -> RuleSet {
    RuleSet::new()
        .with(fading::FadingSurfaceRule)
        .with(fading::FadingLeavesRule::default())
        .over(&full())
}
