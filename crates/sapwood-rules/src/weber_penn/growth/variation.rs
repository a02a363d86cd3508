//! `X ± V`: draws from a stem's own streams, one stream per purpose.
//!
//! A stream is opened at its first draw, and a variation of 0 draws nothing; since every feature
//! has a stream of its own, neither disturbs another feature's numbers.

use sapwood_geom::{Purpose, Stream, StreamPath};

use crate::weber_penn::Variation;

/// The draws of one feature of one stem.
pub(crate) struct Draws {
    path: StreamPath,
    purpose: Purpose,
    variation: Variation,
    stream: Option<Stream>,
}

impl Draws {
    pub(crate) fn new(path: StreamPath, purpose: Purpose, variation: Variation) -> Self {
        Self { path, purpose, variation, stream: None }
    }

    fn stream(&mut self) -> &mut Stream {
        self.stream.get_or_insert_with(|| Stream::new(self.path, self.purpose))
    }

    /// `mean ± spread`; the sign of `spread` does not matter.
    pub(crate) fn around(&mut self, mean: f32, spread: f32) -> f32 {
        if spread == 0.0 {
            return mean;
        }
        match self.variation {
            Variation::Uniform => self.stream().around(mean, spread),
            Variation::Normal => self.stream().normal_around(mean, spread.abs()),
        }
    }

    /// Evenly distributed in [low, high), whatever the variation of the species.
    pub(crate) fn between(&mut self, low: f32, high: f32) -> f32 {
        self.stream().between(low, high)
    }

    /// +1 or -1.
    pub(crate) fn sign(&mut self) -> f32 {
        self.stream().sign()
    }

    /// A whole number from 0 to `most`, each equally likely.
    pub(crate) fn up_to(&mut self, most: u32) -> u32 {
        let steps = (f64::from(most) + 1.0) * f64::from(self.stream().unit());
        (steps as u32).min(most)
    }
}

/// How far from the mean a draw may lie, relative to its spread.
pub(crate) fn greatest_deviation(variation: Variation) -> f32 {
    match variation {
        Variation::Uniform => 1.0,
        Variation::Normal => 3.0f32.sqrt(),
    }
}

/// Rounds real amounts to whole ones so that the sums agree (error diffusion).
///
/// The error is kept per stem: it starts evenly distributed in [-0.5, 0.5), which makes the mean
/// over stems exact without any stem depending on another.
pub(crate) struct Diffusion {
    error: f32,
}

impl Diffusion {
    /// Starts at `error`.
    pub(crate) fn new(error: f32) -> Self {
        Self { error }
    }

    /// The whole number for `amount`, rounded to the nearest.
    pub(crate) fn whole(&mut self, amount: f32) -> usize {
        let effective = (amount + self.error + 0.5).floor().max(0.0);
        self.error -= effective - amount;
        effective as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn draws(seed: u64, variation: Variation) -> Draws {
        Draws::new(StreamPath::new(seed), Purpose("test"), variation)
    }

    #[test]
    fn both_variations_keep_mean_and_limits() {
        for (variation, limit) in [(Variation::Uniform, 1.0), (Variation::Normal, 3.0f32.sqrt())] {
            let mut draws = draws(1, variation);
            let values: Vec<f32> = (0..20_000).map(|_| draws.around(5.0, -2.0)).collect();
            let mean = values.iter().sum::<f32>() / values.len() as f32;
            let widest = values.iter().map(|x| (x - 5.0).abs()).fold(0.0, f32::max);
            assert!((mean - 5.0).abs() < 0.03, "{mean}");
            assert!(widest <= 2.0 * limit + 1e-4 && widest > 1.9 * limit, "{widest}");
        }
    }

    #[test]
    fn no_variation_draws_nothing() {
        let (mut a, mut b) = (draws(1, Variation::Uniform), draws(1, Variation::Uniform));
        assert_eq!(a.around(3.0, 0.0), 3.0);
        assert_eq!(a.between(0.0, 1.0), b.between(0.0, 1.0));
    }

    #[test]
    fn diffusion_keeps_sums() {
        for start in [-0.5, 0.0, 0.49] {
            let mut diffusion = Diffusion::new(start);
            let sum: usize = (0..100).map(|_| diffusion.whole(0.37)).sum();
            assert!((sum as f32 - 37.0).abs() <= 1.0);
        }
        let mut whole = Diffusion::new(-0.5);
        assert!((0..10).all(|_| whole.whole(2.0) == 2));
    }

    #[test]
    fn counts_up_to_a_limit_are_equally_likely() {
        let mut draws = draws(3, Variation::Normal);
        let mut seen = [0; 4];
        (0..4000).for_each(|_| seen[draws.up_to(3) as usize] += 1);
        assert!(seen.iter().all(|n| (900..1100).contains(n)), "{seen:?}");
    }
}
