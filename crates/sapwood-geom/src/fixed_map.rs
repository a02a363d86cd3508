//! Hash containers with fixed seeds.
//!
//! Look-ups only: the order of a hash container must never reach a result, so whoever iterates
//! one sorts first.

use ahash::RandomState;

/// A hash map whose hasher is seeded the same in every run.
#[allow(clippy::disallowed_types)]
pub type FixedMap<K, V> = std::collections::HashMap<K, V, RandomState>;

/// A hash set whose hasher is seeded the same in every run.
#[allow(clippy::disallowed_types)]
pub type FixedSet<K> = std::collections::HashSet<K, RandomState>;

/// The hash state behind [`FixedMap`] and [`FixedSet`]: fixed seeds, the same on every machine.
pub fn fixed_state() -> RandomState {
    RandomState::with_seeds(
        0x243f_6a88_85a3_08d3,
        0x1319_8a2e_0370_7344,
        0xa409_3822_299f_31d0,
        0x082e_fa98_ec4e_6c89,
    )
}
