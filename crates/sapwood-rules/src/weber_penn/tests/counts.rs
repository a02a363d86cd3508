//! Mean numbers of stems and leaves over many seeds.

use super::*;

fn means(species: &Species) -> Vec<f64> {
    let mut sums = vec![0; species.levels as usize + 1];
    for seed in 0..32 {
        let tree = tree(species, seed);
        let leaves = std::iter::once(tree.leaves.len());
        let counts = tree.levels.iter().map(|stems| stems.stems.len()).chain(leaves);
        sums.iter_mut().zip(counts).for_each(|(sum, count)| *sum += count);
    }
    sums.into_iter().map(|sum| sum as f64 / 32.0).collect()
}

fn check(species: &Species, expected: &[f64]) {
    let means = means(species);
    assert_eq!(means.len(), expected.len());
    for (mean, expected) in means.iter().zip(expected) {
        assert!((mean / expected - 1.0).abs() < 0.05, "{means:?}");
    }
}

#[test]
fn an_aspen_has_the_papers_numbers_of_stems_and_leaves() {
    check(&species::aspen(), &[1.0, 50.0, 1_200.0, 22_500.0]);
}

#[test]
fn a_black_tupelo_has_the_papers_numbers_of_stems_and_leaves() {
    check(&species::tupelo(), &[1.0, 50.0, 1_001.0, 9_011.0, 40_550.0]);
}
