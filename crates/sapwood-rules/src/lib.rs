//! Rule sets: components as plain data, generators that need no scene, and the rules that
//! compile the one with the other.

#[cfg(feature = "weber_penn")]
pub mod weber_penn;
