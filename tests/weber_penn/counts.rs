//! Mean numbers of stems and leaves over many seeds, counted in the scene.

use sapwood::rules::weber_penn::Seed;
use sapwood::scene::Scene;

use super::trees::*;

/// Mean stems of each level, then leaves, over 32 seeds, agree with the formulas within 5 %.
fn check(name: &str, expected: &[f64]) {
    let mut tree = planted_in(Scene::new(), &built_in(name), 0);
    let mut sums = vec![0; expected.len()];
    for seed in 0..32 {
        tree.scene.edit(tree.tree, |tree| tree.seed = Seed::Explicit(seed)).unwrap();
        let parts = tree.parts();
        let n: Vec<usize> = parts.stems.iter().map(Vec::len).chain([parts.leaves.len()]).collect();
        let counts = tree.scene.count(tree.view).unwrap();
        assert_eq!(counts.parts_of("leaf") as usize, parts.leaves.len());
        assert_eq!(counts.parts_of("stem") as usize, n[..n.len() - 1].iter().sum::<usize>());
        assert_eq!(n.len(), expected.len());
        sums.iter_mut().zip(n).for_each(|(sum, n)| *sum += n);
    }
    for (sum, expected) in sums.iter().zip(expected) {
        let mean = *sum as f64 / 32.0;
        assert!((mean / expected - 1.0).abs() < 0.05, "{name}: {mean} for {expected}");
    }
}

#[test]
fn aspens_have_the_papers_numbers_of_stems_and_leaves() {
    check("quaking_aspen", &[1.0, 50.0, 1_200.0, 22_500.0]);
}

#[test]
fn black_tupelos_have_the_papers_numbers_of_stems_and_leaves() {
    check("black_tupelo", &[1.0, 50.0, 1_001.0, 9_011.0, 40_550.0]);
}
