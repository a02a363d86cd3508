//! Random streams: reproducible numbers from (seed, path of keys, purpose, draw index).
//!
//! There is no shared generator. Whoever needs random numbers opens a stream for one purpose at
//! one place of a path, so that nobody's draws disturb anybody else's. The generator is PCG
//! XSL 128/64 (MCG); numbers are made from its raw bits by the functions below and by nothing
//! else, so that an update of a library cannot change them.

use rand_core::Rng as _;
use rand_pcg::Mcg128Xsl64;

use crate::{Content, Digest, Digester};

/// The place that a stream belongs to: a seed and the keys from where it was set down to here.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct StreamPath(Digest);

impl StreamPath {
    /// The path that starts at the component that set `seed`.
    pub fn new(seed: u64) -> Self {
        Self(Digest::of(&seed))
    }

    /// The path of the child with this key.
    pub fn child(self, key: u64) -> Self {
        Self(Digest::of(&(self.0, key)))
    }
}

impl Content for StreamPath {
    fn write(&self, digester: &mut Digester) {
        self.0.write(digester);
    }
}

/// What a stream's numbers are for; streams of one path differ by purpose.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Purpose(pub &'static str);

/// A reproducible sequence of random numbers.
#[derive(Clone, Debug)]
pub struct Stream(Mcg128Xsl64);

impl Stream {
    /// The stream at `path` for `purpose`.
    pub fn new(path: StreamPath, purpose: Purpose) -> Self {
        Self(Mcg128Xsl64::new(Digest::of(&(path.0, purpose.0)).bits()))
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// A number in [0, 1), with 24 random bits.
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 * (1.0 / (1u32 << 24) as f32)
    }

    /// A number between `low` and `high`; `low` itself when both are equal. One draw.
    pub fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    /// `mean` plus or minus up to `spread`, evenly distributed. One draw.
    pub fn around(&mut self, mean: f32, spread: f32) -> f32 {
        mean + spread * (2.0 * self.unit() - 1.0)
    }

    /// A number from a normal distribution with the variance of [`around`](Self::around)
    /// (standard deviation `spread` / sqrt 3), truncated at three standard deviations.
    ///
    /// Box and Muller's transform; draws outside the limit are drawn again, on average once in
    /// 370 times.
    pub fn normal_around(&mut self, mean: f32, spread: f32) -> f32 {
        let deviation = spread * (1.0 / 3.0f32).sqrt();
        loop {
            let radius = libm::sqrtf(-2.0 * libm::logf(1.0 - self.unit()));
            let z = radius * libm::cosf(std::f32::consts::TAU * self.unit());
            if z.abs() <= 3.0 {
                return mean + deviation * z;
            }
        }
    }

    /// +1 or -1, equally likely. One draw.
    pub fn sign(&mut self) -> f32 {
        if self.bits() >> 63 == 0 { 1.0 } else { -1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stream(seed: u64, purpose: &'static str) -> Stream {
        Stream::new(StreamPath::new(seed).child(3), Purpose(purpose))
    }

    #[test]
    fn streams_differ_by_seed_path_and_purpose() {
        let first = stream(1, "curve").bits();
        assert_eq!(first, stream(1, "curve").bits());
        assert_ne!(first, stream(2, "curve").bits());
        assert_ne!(first, stream(1, "split").bits());
        assert_ne!(first, Stream::new(StreamPath::new(1).child(4), Purpose("curve")).bits());
    }

    #[test]
    fn both_distributions_have_the_same_mean_and_variance() {
        let moments = |draw: &mut dyn FnMut() -> f32| {
            let n = 200_000;
            let draws: Vec<f64> = (0..n).map(|_| f64::from(draw())).collect();
            let mean = draws.iter().sum::<f64>() / f64::from(n);
            let variance = draws.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / f64::from(n);
            (mean, variance)
        };
        let (mut even, mut normal) = (stream(7, "even"), stream(7, "normal"));
        let (even_mean, even_variance) = moments(&mut || even.around(5.0, 2.0));
        let (mean, variance) = moments(&mut || normal.normal_around(5.0, 2.0));
        assert!((even_mean - 5.0).abs() < 0.01 && (mean - 5.0).abs() < 0.01);
        assert!((even_variance - 4.0 / 3.0).abs() < 0.01, "{even_variance}");
        // Truncating at three deviations takes 2.7 % of the variance away.
        assert!((variance / even_variance - 0.973).abs() < 0.01, "{variance}");
    }

    #[test]
    fn normal_draws_stay_within_three_deviations() {
        let mut stream = stream(9, "normal");
        for _ in 0..10_000 {
            let x = stream.normal_around(0.0, 1.0);
            assert!(x.abs() <= 3.0f32.sqrt() + 1e-6);
        }
    }
}
