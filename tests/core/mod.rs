//! The core: scenes, slots, rules, sharing and what runs after an edit.

// mod deep;
// mod edits;
// mod errors;
mod kinds;
// mod moving;
mod sharing;
// mod walks;
