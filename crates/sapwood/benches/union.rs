//! The wood of every built-in species as one closed surface: time, triangles, what had to be
//! mended, and whether the surface is what it should be.
//!
//! *tips*: of the stems more than 2 mm thick, how many have their tip farther than 1 mm from the
//! surface, and how many inside of another stem, where no surface is. *volume*: of the union,
//! against that of a million random points of which each is looked for in every single stem.
//! *afloat*: components that hold nothing of any trunk. *farthest*: by how much mending moved the
//! surface at most. Names of species after `--` take these alone; a number is the seed, else 1.
//!
//! With the word `edit`, how long it takes to join a tree again after a wall beside it has come so
//! near that a branch is shortened, with what was joined before kept.

use std::time::Instant;

use rustix::time::{ClockId, clock_gettime};
use sapwood::geom::glam::Vec3;
use sapwood::geom::{Envelope, Mesh, Solid};
use sapwood::graph::{Everything, Order, WeldReport, WeldUnion, WeldedUnion};
use sapwood::rules::weber_penn::{Seed, Tree};
use sapwood::scene::{Attribute, EnvelopeSlot, Handle, Scene, ViewId};

use wood::Wood;

#[path = "../../../tests/weber_penn/wood.rs"]
mod wood;

const N_POINTS: u32 = 1_000_000;

fn main() {
    let wanted: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let seed = wanted.iter().find_map(|word| word.parse().ok()).unwrap_or(1);
    let is_edited = wanted.iter().any(|word| word == "edit");
    let is_name = |word: &&String| word.parse::<u64>().is_err() && *word != "edit";
    let names: Vec<&String> = wanted.iter().filter(is_name).collect();
    println!(
        "{}",
        if is_edited {
            "| species | groups | cold CPU s | groups of the edit | edit CPU s | share |"
        } else {
            "| species | stems | triangles of stems | triangles | wall s | CPU s | faults mended | \
             farthest mm | tips lost, covered, all | volume m3 | off | components | afloat |"
        }
    );
    let row = if is_edited { edit_row } else { row };
    for name in sapwood::io::built_in_names() {
        if names.is_empty() || names.iter().any(|wanted| **wanted == *name) {
            println!("| `{name}` | {} |", row(name, seed));
        }
    }
}

/// Welds a view again, and tells the CPU time that this took.
fn welded(scene: &mut Scene, view: ViewId, weld: &mut WeldUnion) -> (WeldedUnion, f64) {
    let list = scene.draw_list(view, usize::MAX).expect("nobody interrupts");
    let cpu = cpu_seconds();
    let walked = scene.traverse(view, Order::Pre, &Everything, &mut |at| weld.meet(at));
    walked.expect("nobody interrupts");
    let welded = weld.join(&list, u64::MAX, &|_| true).expect("species become solids");
    (welded, cpu_seconds() - cpu)
}

/// A tree below its species, and a view of it.
fn planted(name: &str, seed: u64) -> (Scene, Handle<Attribute>, ViewId) {
    let species = sapwood::io::find_species(name).expect("the species is built in");
    let mut scene = Scene::new();
    let family = scene.add(species.attribute());
    let tree = Tree { seed: Seed::Explicit(seed) };
    scene.add_to(family, tree).expect("an attribute has no other child");
    let view = scene.open_view(family, &sapwood::standard_rules()).expect("the family is there");
    (scene, family, view)
}

fn edit_row(name: &str, seed: u64) -> String {
    let (mut scene, family, view) = planted(name, seed);
    let mut at = scene.bounds(view).expect("nobody interrupts").aabb.max.x;
    let mut weld = WeldUnion::new();
    let (first, cold) = welded(&mut scene, view, &mut weld);
    loop {
        at -= 0.01;
        let wall = Some(Envelope::half_space(Vec3::X, at));
        let held = scene.edit(family, |attribute| attribute.set::<EnvelopeSlot>(wall));
        held.expect("the family is there");
        let (again, warm) = welded(&mut scene, view, &mut weld);
        let (all, n) = (first.report.work.n_joined, again.report.work.n_joined);
        if n > 0 {
            return format!("{all} | {cold:.2} | {n} | {warm:.2} | {:.2}", warm / cold);
        }
    }
}

fn cpu_seconds() -> f64 {
    let now = clock_gettime(ClockId::ProcessCPUTime);
    now.tv_sec as f64 + now.tv_nsec as f64 * 1e-9
}

fn row(name: &str, seed: u64) -> String {
    let (mut scene, _, view) = planted(name, seed);
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
        "{n_solids} | {n_triangles_before} | {n_triangles} | {seconds:.1} | {cpu:.1} | {} | {:.3} | \
         {}, {n_covered}, {} | {volume:.5} | {:+.2} % | {} | {}",
        mended.faults,
        1e3 * union.strayed.iter().copied().fold(0.0, f32::max),
        lost.len(),
        wood.tips.len(),
        100.0 * (checked.volume / volume - 1.0),
        checked.components,
        afloat.len(),
    )
}
