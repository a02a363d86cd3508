//! The wind: what joints sway in.

use sapwood_geom::{Content, Digester};

/// How hard the wind blows, in metres per second: between its speed, and its speed and gusts
/// together. It has no direction; stems sway to all sides.
///
/// Weber and Penn leave the unit open. By ours their amplitudes are those of a light to moderate
/// wind: stems bend by their printed amplitude at 50.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wind {
    /// The steady part; below 0, or no number, is 0.
    pub speed: f32,
    /// How much stronger gusts are; below 0, or no number, is 0.
    pub gust: f32,
}

impl Wind {
    /// A wind of this speed with gusts that are so much stronger.
    pub fn new(speed: f32, gust: f32) -> Self {
        Self { speed, gust }
    }

    /// The shares of the slow and the fast sine in how far a joint turns: the paper's a1 and a2,
    /// as multiples of its a0. At most what `strongest`, a wind without gusts, has together.
    pub fn shares(&self, strongest: f32) -> [f32; 2] {
        let sound = |x: f32| if x.is_finite() { x.max(0.0) } else { 0.0 };
        let slow = sound(self.speed) / 50.0;
        let fast = sound(self.gust) / 50.0 + 0.5 * slow;
        let (sum, most) = (slow + fast, Self::most(strongest));
        if sum > most { [slow, fast].map(|share| share * (most / sum)) } else { [slow, fast] }
    }

    /// Both shares together in a wind without gusts.
    pub(crate) fn most(strongest: f32) -> f32 {
        if strongest > 0.0 { 0.03 * strongest } else { 0.0 }
    }
}

impl Content for Wind {
    fn write(&self, digester: &mut Digester) {
        digester.add(&self.speed).add(&self.gust);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_the_papers() {
        assert_eq!(Wind::new(10.0, 0.0).shares(20.0), [0.2, 0.1]);
        assert_eq!(Wind::new(0.0, 5.0).shares(20.0), [0.0, 0.1]);
        assert_eq!(Wind::new(10.0, 5.0).shares(20.0), [0.2, 0.2]);
        assert_eq!(Wind::default().shares(20.0), [0.0, 0.0]);
    }

    #[test]
    fn stronger_wind_does_no_more_than_the_strongest() {
        let [slow, fast] = Wind::new(40.0, 0.0).shares(20.0);
        assert!((slow - 0.4).abs() < 1e-6 && (fast - 0.2).abs() < 1e-6);
        let [slow, fast] = Wind::new(30.0, 60.0).shares(20.0);
        assert!((slow + fast - 0.6).abs() < 1e-6);
        for wrong in [f32::NAN, f32::INFINITY, -3.0] {
            assert_eq!(Wind::new(wrong, wrong).shares(20.0), [0.0, 0.0]);
            assert_eq!(Wind::new(3.0, 1.0).shares(-wrong.abs()), [0.0, 0.0]);
        }
    }
}
