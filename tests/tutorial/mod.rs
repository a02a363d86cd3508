//! The tutorial of `docs/writing-rules.md`: its code, a file for each step.

#![allow(dead_code, unreachable_pub, reason = "the tutorial's code is written as a crate's own")]

mod building_code;
mod detail;
mod document;
mod flight;
mod inspection;
mod rule_set;
mod rules;
mod staircase;
mod timber;
