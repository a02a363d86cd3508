//! Tests of whole trees: growing them level by level, as the rules do.

mod counts;
mod dialects;
mod directions;
mod measure;
mod parameters;
mod species;
mod tree_gen;
mod whole;

use std::convert::Infallible;

use sapwood_geom::StreamPath;

use super::*;

/// A whole tree.
struct Tree {
    levels: Vec<Stems>,
    leaves: Vec<Leaf>,
}

fn free(_: usize) -> Result<(), Infallible> {
    Ok(())
}

/// Grows all levels of a species and its leaves, without a limit.
fn tree(species: &Species, seed: u64) -> Tree {
    let Ok(tree) = charged(species, seed, &mut free);
    tree
}

fn charged<E>(
    species: &Species,
    seed: u64,
    charge: &mut impl FnMut(usize) -> Result<(), E>,
) -> Result<Tree, E> {
    let (crown, levels) = (Crown::new(species), Level::all(species));
    let form = TrunkForm::new(species);
    let mut seeds = trunks(&crown, &levels[0], StreamPath::new(seed), charge)?;
    let mut grown = Vec::new();
    for n in 0..species.levels as usize {
        if n > 0 {
            let form = (n == 1).then_some(&form);
            seeds = children(&grown[n - 1], &crown, form, &levels[n.min(3)], charge)?;
        }
        let (level, target) = (&levels[n.min(3)], &species.attraction_target);
        let limit = seeds.first().and_then(|seed| Limit::of_species(&crown, seed.scale_tree));
        if let Some(limit) = limit {
            let shares = fit(&seeds, &crown, level, target, &[limit], charge)?;
            let both = seeds.iter().zip(shares);
            seeds = both.filter_map(|(seed, share)| seed.shortened(share, &crown)).collect();
        }
        grown.push(grow(&seeds, &crown, level, target, charge)?);
    }
    let params = LeafParams::new(species);
    let leaves = match grown.last() {
        Some(last) => leaves(last, &crown, &params, &params.target, charge)?,
        None => Vec::new(),
    };
    Ok(Tree { levels: grown, leaves })
}
