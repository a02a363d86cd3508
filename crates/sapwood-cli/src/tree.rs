//! The tree that a command is about: read, planted in a scene, and compiled.

mod counting;

use sapwood::geom::Bound;
use sapwood::io::Shape;
use sapwood::rules::weber_penn::{
    self, DetailSlot, FadingParams, FadingSlot, PruneRatioSlot, Seed, Species, Tree, WrittenImage,
    WrittenMesh,
};
use sapwood::scene::{
    Action, Attribute, Budget, EnvelopeSlot, Handle, RuleSet, Scene, Transform, ViewId,
};
use tracing::debug;

use crate::arguments::{Detail, Individual, TreeArguments};
use crate::failure::Failure;
use crate::watch::Watch;

/// Edge length in metres of the cells that make a position a seed.
const CELL: f32 = 0.1;
/// Components that cannot be compiled and are told of; more would drown the first.
const MAX_DIAGNOSTICS: usize = 10;

/// The species that the arguments ask for.
pub(crate) fn species(arguments: &TreeArguments) -> Result<Species, Failure> {
    let mut species = sapwood::io::find_species(&arguments.species)?;
    dress(&mut species, arguments)?;
    Ok(thinned(limited(species, arguments.levels)?, arguments.quality))
}

/// Gives leaves the mesh and the image that the arguments name.
fn dress(species: &mut Species, arguments: &TreeArguments) -> Result<(), Failure> {
    let leaves = &mut species.leaves;
    if let Some(path) = &arguments.leaf_mesh {
        let mesh = sapwood::io::read_leaf_mesh(path)?;
        leaves.mesh = Some(WrittenMesh { path: path.display().to_string(), mesh });
        // What the species says of an image is meant for its own leaves.
        leaves.image = None;
    }
    if let Some(path) = &arguments.leaf_image {
        let image = sapwood::io::read_leaf_image(path)?;
        leaves.image = Some(WrittenImage { path: path.display().to_string(), image });
        if let Some(fault) = leaves.image_fault() {
            return Err(Failure::usage(format!("--leaf-image {}: {fault}", path.display())));
        }
    }
    // An image on a mesh of somebody's own says nothing of proportions.
    let is_reshaped =
        arguments.leaf_mesh.is_some() || arguments.leaf_image.is_some() && leaves.mesh.is_none();
    if is_reshaped && leaves.has_own_proportions() {
        leaves.scale_x = 1.0;
    }
    Ok(())
}

/// The rules that the arguments ask for.
pub(crate) fn rules(arguments: &TreeArguments) -> RuleSet {
    match arguments.detail {
        Detail::Full | Detail::Draft => sapwood::standard_rules(),
        Detail::Segments => sapwood::segment_rules(),
        Detail::Skeleton => sapwood::skeleton_rules(),
    }
}

/// Places the species and a tree of it in the scene, inside of what the arguments hold it by.
pub(crate) fn planted(
    scene: &mut Scene,
    species: &Species,
    individual: Individual,
    arguments: &TreeArguments,
) -> Result<Handle<Attribute>, Failure> {
    let mut attribute = species.attribute();
    if let Some(envelope) = Shape::all(&arguments.prune, None)? {
        attribute.set::<EnvelopeSlot>(Some(envelope));
        attribute.set::<PruneRatioSlot>(arguments.prune_ratio.unwrap_or(1.0));
    }
    // Branches with fewer leaves before them fade the sooner; fans have all of theirs.
    let drawn = match arguments.detail {
        Detail::Draft => weber_penn::Detail::draft().leaves,
        Detail::Full | Detail::Segments | Detail::Skeleton => 1.0,
    };
    let is_fan = species.leaves.count < 0;
    let quality = if is_fan { 1.0 } else { species.leaves.quality * drawn };
    let fading = FadingParams { quality, ..FadingParams::default() };
    attribute.set::<FadingSlot>(fading);
    let root = scene.add(attribute);
    match individual {
        Individual::Seed(seed) => {
            scene.add_to(root, Tree { seed: Seed::Explicit(seed) })?;
        }
        Individual::At([x, y, z]) => {
            let place = scene.add_to(root, Transform::translation(x, y, z))?;
            scene.add_to(place, Tree { seed: Seed::Position { cell: CELL } })?;
        }
    }
    Ok(root)
}

/// Opens a view and compiles all of it; tells its bound, or why it is not complete.
pub(crate) fn compiled(
    scene: &mut Scene,
    root: Handle<Attribute>,
    rules: &RuleSet,
    arguments: &TreeArguments,
    watch: &Watch,
) -> Result<(ViewId, Bound), Failure> {
    let view = scene.open_view(root, rules)?;
    let triangles = arguments.max_triangles;
    scene.set_budget(view, Budget { triangles, ..Budget::default() })?;
    if arguments.detail == Detail::Draft {
        scene.set_held::<DetailSlot>(view, weber_penn::Detail::draft())?;
    }
    watch.follow(scene.cancel_token(view)?);
    // Should this end early, the scene tells why.
    let _ = counting::compile_watched(scene.supply(view)?, watch);
    let bounds = scene.bounds(view)?;
    tell_log(scene);
    let found = scene.diagnostics(view, MAX_DIAGNOSTICS)?;
    if found.is_empty() { Ok((view, bounds)) } else { Err(Failure::diagnostics(&found)) }
}

/// The species with no more than `levels` levels of stems.
fn limited(mut species: Species, levels: Option<u32>) -> Result<Species, Failure> {
    if let Some(levels) = levels {
        if !(1..=species.levels).contains(&levels) {
            return Err(Failure::usage(format!(
                "--levels {levels}: {} has {} levels of stems (accepted: 1 to {})",
                species.name, species.levels, species.levels
            )));
        }
        species.levels = levels;
    }
    Ok(species)
}

/// The species with a share of its leaves, which are larger, but for those in fans.
fn thinned(mut species: Species, quality: f32) -> Species {
    species.leaves.quality *= quality;
    species
}

/// Tells what was compiled and what was used again, one line for each rule.
fn tell_log(scene: &mut Scene) {
    let mut rows: Vec<(&'static str, Action, u64)> = Vec::new();
    for event in scene.take_log() {
        match rows.iter_mut().find(|row| (row.0, row.1) == (event.rule, event.action)) {
            Some(row) => row.2 += 1,
            None => rows.push((event.rule, event.action, 1)),
        }
    }
    for (rule, action, times) in rows {
        debug!(rule, ?action, times);
    }
}
