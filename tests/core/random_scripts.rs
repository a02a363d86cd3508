//! Random scripts: after any edits, what was kept and compiled again equals what a cold start
//! gives.
//!
//! Each script makes a random graph, opens two views under different rules, and does at least
//! fifty random operations on it. In between it traverses: whole, culled by a box, and under a
//! path. Every result is compared with a reference that walks the scripts' own book of the
//! graph without any cache, bounds and dumps also with a scene built anew from that book.
//!
//! The test runs 1,000 scripts. To run more, for instance 10,000:
//! `SAPWOOD_SCRIPTS=10000 cargo test -p sapwood-tests random_scripts`.
//! To run one of them, say number 17: `SAPWOOD_SCRIPT=17`.

mod compare;
mod dice;
mod frame;
mod here;
mod kinds;
mod mirror;
mod reference;
mod script;
mod values;
mod what;
mod wires;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Once;

use sapwood::scene::PlantedFault;

use script::Script;

/// Runs the script with this seed; where it fails, tells what was wrong and what was done.
fn run(seed: u64, fault: Option<PlantedFault>) -> Result<(), String> {
    let mut script = Script::new(seed, fault);
    let outcome = catch_unwind(AssertUnwindSafe(|| {
        // Large graphs take long to look at.
        let percent = if script.mirror.nodes.len() > 300 { 15 } else { 40 };
        for _ in 0..50 + script.dice.below(20) {
            script.operate(true);
            if script.dice.chance(percent) {
                script.traverse();
            }
        }
        script.check_all();
    }));
    outcome.map_err(|panic| {
        let why = panic.downcast_ref::<String>().map(String::as_str);
        let why = why.or(panic.downcast_ref::<&str>().copied()).unwrap_or("a panic");
        format!("script {seed}: {why}\n{}", script.log.join("\n"))
    })
}

/// Keeps the panics that the scripts make on purpose out of the output.
fn be_quiet() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let before = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            let is_meant = panic.payload_as_str().is_some_and(|why| why.ends_with("on purpose"));
            if !is_meant {
                before(panic);
            }
        }));
    });
}

fn number(variable: &str) -> Option<u64> {
    std::env::var(variable).ok()?.parse().ok()
}

#[test]
fn incremental_equals_from_scratch() {
    be_quiet();
    if let Some(seed) = number("SAPWOOD_SCRIPT") {
        return run(seed, None).unwrap_or_else(|why| panic!("{why}"));
    }
    for seed in 0..number("SAPWOOD_SCRIPTS").unwrap_or(1000) {
        run(seed, None).unwrap_or_else(|why| panic!("{why}"));
    }
}

/// Within how many scripts a fault in the compiler must be caught.
const ENOUGH: u64 = 500;

fn check_caught(fault: PlantedFault) {
    be_quiet();
    let caught = (0..ENOUGH).find(|seed| run(*seed, Some(fault)).is_err());
    let seed = caught.unwrap_or_else(|| panic!("{ENOUGH} scripts do not notice {fault:?}"));
    println!("{fault:?} is caught by script {seed}");
    run(seed, None).expect("without the fault the same script passes");
}

#[test]
fn a_dropped_mark_is_caught() {
    check_caught(PlantedFault::DroppedMark);
}

#[test]
fn a_dropped_read_is_caught() {
    check_caught(PlantedFault::DroppedRead);
}

#[test]
fn a_dropped_read_of_an_ingredient_is_caught() {
    check_caught(PlantedFault::DroppedIngredient);
}

#[test]
fn a_wrong_early_stop_is_caught() {
    check_caught(PlantedFault::EarlyStop);
}

#[test]
fn a_forgotten_force_is_caught() {
    check_caught(PlantedFault::ForgottenForce);
}

#[test]
fn a_driven_component_that_is_not_outdated_is_caught() {
    check_caught(PlantedFault::KeptDriven);
}

#[test]
fn an_asker_that_is_not_marked_is_caught() {
    check_caught(PlantedFault::UnmarkedAsker);
}
