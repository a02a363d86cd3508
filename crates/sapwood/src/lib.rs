//! Sapwood, a dynamic scene graph framework: a compiler from meaning to pictures.
//!
//! A semantic graph says *what is there*; rules compile it, on demand, into render graphs that
//! say what it looks like; traversals do all the work on the result. The crates behind this
//! facade are its modules.
//!
//! `docs/writing-rules.md` in the repository builds a rule set from nothing.

pub use sapwood_geom as geom;
pub use sapwood_graph as graph;
pub use sapwood_images as images;
pub use sapwood_io as io;
pub use sapwood_picture as picture;
pub use sapwood_rules as rules;
pub use sapwood_scene as scene;

/// The rule set that compiles everything Sapwood knows to full geometry.
pub fn standard_rules() -> scene::RuleSet {
    rules::weber_penn::full().over(&images::rules()).over(&scene::built_in_rules())
}

/// The rule set that draws trees as lines with radii and everything else as it is.
pub fn skeleton_rules() -> scene::RuleSet {
    rules::weber_penn::skeleton().over(&images::rules()).over(&scene::built_in_rules())
}

/// The rule set that draws each segment of a stem by itself and everything else as it is, for
/// [`WeldPieces`](graph::WeldPieces).
pub fn segment_rules() -> scene::RuleSet {
    rules::weber_penn::segments().over(&images::rules()).over(&scene::built_in_rules())
}

/// The rule set that draws less of trees the further away they are, and everything else as it is.
pub fn fading_rules() -> scene::RuleSet {
    rules::weber_penn::fading().over(&images::rules()).over(&scene::built_in_rules())
}

/// The rule set by which trees sway in the wind of their view; at rest everything is as under
/// [`standard_rules`].
pub fn swaying_rules() -> scene::RuleSet {
    rules::weber_penn::swaying().over(&standard_rules())
}

/// The rule set that draws trees as on a map, flat on the ground with their crowns' outlines, names
/// and heights, and everything else as it is, for [`svg_map`](io::svg_map).
pub fn map_rules() -> scene::RuleSet {
    rules::weber_penn::map().over(&images::rules()).over(&scene::built_in_rules())
}

/// The rule set that tells of trees in lines of text and draws everything else as it is, for
/// [`Scene::outline`](scene::Scene::outline).
pub fn text_rules() -> scene::RuleSet {
    rules::weber_penn::text().over(&images::rules()).over(&scene::built_in_rules())
}

/// The README's example, compiled and run with the documentation tests.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
pub struct Readme;
