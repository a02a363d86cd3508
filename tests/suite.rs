//! The test suite: one binary, one module for each area.

#![allow(clippy::unwrap_used, reason = "what should be there and is not fails the test")]

mod architecture;
mod core;
mod picture;
mod tutorial;
mod weber_penn;
