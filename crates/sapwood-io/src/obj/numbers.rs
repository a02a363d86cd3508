//! Numbers as text: the shortest that reads back as the very same number.

/// Appends a finite number, after a space.
pub(super) fn float(text: &mut Vec<u8>, number: f32) {
    let mut buffer = zmij::Buffer::new();
    let digits = buffer.format_finite(number);
    text.push(b' ');
    // Whole numbers need no fraction.
    text.extend_from_slice(digits.strip_suffix(".0").unwrap_or(digits).as_bytes());
}

/// Appends a whole number.
pub(super) fn whole(text: &mut Vec<u8>, number: u64) {
    text.extend_from_slice(itoa::Buffer::new().format(number).as_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_reads_back_as_itself() {
        let check = |number: f32| {
            let mut text = Vec::new();
            float(&mut text, number);
            let text = String::from_utf8(text).unwrap();
            let back: f32 = text.trim_start().parse().unwrap();
            assert_eq!(back.to_bits(), number.to_bits(), "{text}");
        };
        for number in [0.0, -0.0, 1.0, 0.1, -12.5, 1e-7, 16_777_216.0, f32::MAX, f32::MIN_POSITIVE]
        {
            check(number);
        }
        // All bit patterns, with gaps; a prime step meets every exponent and many mantissas.
        for bits in (0..=u32::MAX).step_by(40_009) {
            let number = f32::from_bits(bits);
            if number.is_finite() {
                check(number);
            }
        }
    }

    #[test]
    fn numbers_are_short() {
        let mut text = Vec::new();
        for number in [1.0, -0.5, 0.1, 20.0] {
            float(&mut text, number);
        }
        whole(&mut text, 12_345);
        assert_eq!(text, b" 1 -0.5 0.1 2012345");
    }
}
