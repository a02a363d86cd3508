//! The core: scenes, slots, rules, sharing and what runs after an edit.

mod errors;
mod kinds;
mod random_scripts;
mod sharing;
mod wide;
