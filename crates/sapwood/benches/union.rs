//! The wood of every built-in species as one closed surface: time, triangles, what had to be
//! mended, and whether the surface is what it should be.
//!
//! *tips*: of the stems more than 2 mm thick, how many have their tip farther than 1 mm from the
//! surface, and how many inside of another stem, where no surface is. *volume*: of the union,
//! against that of a million random points of which each is looked for in every single stem. *afloat*:
//! components that hold nothing of any trunk. Names of species after `--` take these alone; a number
//! is the seed, else 1.

use std::time::Instant;

use rustix::time::{ClockId, clock_gettime};
use sapwood::geom::{Mesh, Solid};
use sapwood::graph::{Everything, Order, WeldReport, WeldUnion, WeldedUnion};
use sapwood::rules::weber_penn::{Seed, Tree};
use sapwood::scene::Scene;

use wood::Wood;

#[path = "../../../tests/weber_penn/wood.rs"]
mod wood;

const N_POINTS: u32 = 1_000_000;

fn main() {
    let wanted: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let seed = wanted.iter().find_map(|word| word.parse().ok()).unwrap_or(1);
    let names: Vec<&String> = wanted.iter().filter(|word| word.parse::<u64>().is_err()).collect();
    println!(
        "| species | stems | triangles of stems | triangles | wall s | CPU s | faults mended | \
         tips lost, covered, all | volume m3 | off | components | afloat |"
    );
    for name in sapwood::io::built_in_names() {
        if names.is_empty() || names.iter().any(|wanted| **wanted == *name) {
            println!("| `{name}` | {} |", row(name, seed));
        }
    }
}

fn cpu_seconds() -> f64 {
    let now = clock_gettime(ClockId::ProcessCPUTime);
    now.tv_sec as f64 + now.tv_nsec as f64 * 1e-9
}

fn row(name: &str, seed: u64) -> String {
    let species = sapwood::io::find_species(name).expect("the species is built in");
    let mut scene = Scene::new();
    let family = scene.add(species.attribute());
    let tree = Tree { seed: Seed::Explicit(seed) };
    scene.add_to(family, tree).expect("an attribute has no other child");
    let view = scene.open_view(family, &sapwood::standard_rules()).expect("the family is there");
    let list = scene.draw_list(view, usize::MAX).expect("nobody interrupts");

    let (start, cpu) = (Instant::now(), cpu_seconds());
    let mut weld = WeldUnion::new();
    let walked = scene.traverse(view, Order::Pre, &Everything, &mut |at| weld.meet(at));
    walked.expect("nobody interrupts");
    let joined = weld.join(&list, u64::MAX, &|_| true);
    let (seconds, cpu) = (start.elapsed().as_secs_f64(), cpu_seconds() - cpu);
    let WeldedUnion { list, union, report } = match joined {
        Ok(joined) => joined,
        Err(error) => return format!("after {seconds:.1} s: {error}"),
    };
    let WeldReport { n_solids, n_triangles_before, n_triangles, mended, checked, .. } = report;
    assert!(checked.is_sound(), "{checked}");

    let wood = Wood::of(&mut scene, view);
    let occurrence = &list.occurrences[0];
    let mut surface = Mesh::default();
    for row in &list.bodies[occurrence.body as usize].rows {
        surface.append(&row.mesh, &row.local);
    }
    let surface = Solid::of_mesh(&surface);
    let again = surface.check();
    assert!(again.is_sound(), "{again}");
    let (lost, n_covered) = wood.lost_tips(&surface, 1e-3);
    let afloat = wood.afloat(&union);
    let volume = wood.volume(N_POINTS);
    let n_uncovered = wood.n_uncovered();
    if n_uncovered > 0 {
        eprintln!("{name}: {n_uncovered} corners lie in no box");
    }
    format!(
        "{n_solids} | {n_triangles_before} | {n_triangles} | {seconds:.1} | {cpu:.1} | {} | \
         {}, {n_covered}, {} | {volume:.5} | {:+.2} % | {} | {}",
        mended.faults,
        lost.len(),
        wood.tips.len(),
        100.0 * (checked.volume / volume - 1.0),
        checked.components,
        afloat.len(),
    )
}
