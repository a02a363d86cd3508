//! Words of files in messages: cut short, and which accepted name was probably meant.

/// The candidate spelt most like `word`, if any is near enough to be a slip of the pen.
///
/// Nearness is the Damerau-Levenshtein distance, without regard to case; a third of the letters
/// may be wrong. Among equals the first candidate wins.
pub(crate) fn nearest<'a>(
    word: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<&'a str> {
    // A name far longer than any candidate cannot be near one; it is not compared.
    const LONGEST: usize = 64;
    if word.len() > LONGEST {
        return None;
    }
    let word = word.to_lowercase();
    candidates
        .into_iter()
        .map(|candidate| {
            let distance = strsim::damerau_levenshtein(&word, &candidate.to_lowercase());
            (distance, candidate)
        })
        .filter(|(distance, candidate)| {
            let letters = word.chars().count().max(candidate.chars().count());
            *distance <= (letters / 3).max(1)
        })
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}

/// `text` on one line, cut off after `longest` characters.
pub(crate) fn shortened_to(longest: usize, text: &str) -> String {
    let mut short = String::new();
    for (i, word) in text.split_whitespace().enumerate() {
        short.extend((i > 0).then_some(' '));
        short.extend(word.chars().take(longest + 1));
        if short.chars().count() > longest {
            return short.chars().take(longest).chain("...".chars()).collect();
        }
    }
    short
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_are_recognised_and_strangers_are_not() {
        let keys = ["curve", "curve_res", "curve_back", "taper"];
        assert_eq!(nearest("curve_rez", keys), Some("curve_res"));
        assert_eq!(nearest("Tapre", keys), Some("taper"));
        assert_eq!(nearest("colour_of_bark", keys), None);
        assert_eq!(nearest(&"curve".repeat(1000), keys), None);
    }
}
