//! How large an image may be.

/// The most pixels along an image's edge.
pub const LARGEST_IMAGE: u32 = 4096;

/// What is wrong with a number of pixels along an edge, in words, or nothing.
pub(crate) fn fault(field: &str, pixels: u32) -> Option<String> {
    let is_fine = (1..=LARGEST_IMAGE).contains(&pixels);
    (!is_fine).then(|| {
        format!("{field} is {pixels}; accepted: a whole number of pixels from 1 to {LARGEST_IMAGE}")
    })
}

/// What is wrong with a number, in words, or nothing where it lies in a range.
pub(crate) fn number_fault(field: &str, value: f32, min: f32, max: f32) -> Option<String> {
    (!(min..=max).contains(&value))
        .then(|| format!("{field} is {value}; accepted: a number at least {min} and at most {max}"))
}

/// As [`fault`], of an image's width and height.
pub(crate) fn fault_of_both([width, height]: [u32; 2]) -> Option<String> {
    fault("width", width).or_else(|| fault("height", height))
}
