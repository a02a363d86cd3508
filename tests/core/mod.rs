//! The core: scenes, slots, rules, sharing and what runs after an edit.

mod built_ins;
mod deep;
mod edits;
mod errors;
mod events;
mod explain;
mod images;
mod ingredients;
mod kinds;
mod moving;
pub(crate) mod picking;
mod projections;
mod pruning;
mod random_scripts;
mod sharing;
mod taken_back;
mod threads;
mod unruly;
mod verify;
mod views;
mod walks;
mod wide;
