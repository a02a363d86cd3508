//! Seeds as arguments: a number, or one that nobody has chosen.

use std::hash::{BuildHasher as _, RandomState};

use crate::accepted::whole;

/// The seed that the words stand for; `random` stands for another one in every run, of few enough
/// digits to be typed again.
pub(crate) fn seed(text: &str) -> Result<u64, String> {
    if text == "random" {
        // The standard library's hash keys are the system's random bits.
        return Ok(RandomState::new().hash_one("seed") >> 32);
    }
    whole(text, 0..=u64::MAX).map_err(|told| format!("{told}, or random"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_are_numbers_or_drawn() {
        assert_eq!(seed("18446744073709551615"), Ok(u64::MAX));
        assert!(seed("Random").unwrap_err().ends_with(", or random"));
        let drawn: Vec<u64> = (0..20).map(|_| seed("random").unwrap()).collect();
        assert!(drawn.iter().all(|seed| *seed <= u64::from(u32::MAX)));
        assert!(drawn.iter().any(|seed| *seed != drawn[0]));
    }
}
