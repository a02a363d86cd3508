//! Trees as scenes: what runs after which edit, seeds, targets, looks, every built-in species,
//! and snapshots. The formulas themselves are tested beside the generator.

mod by_level;
mod compiles;
mod counts;
mod cutting;
mod extremes;
mod fading;
mod foreseen;
mod impostor;
mod looks;
mod own_leaves;
mod pruning;
mod roots;
mod seeds;
mod snapshots;
mod solid_wood;
mod species;
mod species_files;
mod styles;
mod targets;
mod threads;
mod trees;
mod views;
mod welding;
mod wind;
mod wood;
