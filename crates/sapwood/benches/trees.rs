//! Whole trees beyond one cold compile: growth alone, a second core, a forest of few individuals,
//! files, and memory.
//!
//! Each case is repeated, the cases that are compared by turns, and the least is printed:
//! whatever else the machine does can only add to it.
//! `cargo bench -p sapwood --bench trees [growth|cores|forest|file|memory]`.

mod clock;
mod grove;

use std::convert::Infallible;
use std::process::Command;
use std::time::Duration;

use clock::Moment;
use grove::{bounds, cores, planted, pool, species};
use sapwood::geom::StreamPath;
use sapwood::graph::DrawList;
use sapwood::rules::weber_penn::{
    Crown, Detail, LeafParams, Level, Seed, Stems, Tree, TrunkForm, children, grow, leaves,
    surface, trunks,
};
use sapwood::scene::{Group, Scene, Transform};

/// How often each case is repeated.
const REPEATED: usize = 15;
/// Trees of the forest, and how many of them are different.
const FOREST: usize = 10_000;
const INDIVIDUALS: usize = 16;
/// The argument by which the program asks itself for the memory of one tree, in a process of its
/// own.
const MEMORY_OF: &str = "memory-of";

fn main() {
    let wanted: Vec<String> =
        std::env::args().skip(1).filter(|arg| !arg.starts_with('-')).collect();
    if let [ask, name] = wanted.as_slice()
        && ask == MEMORY_OF
    {
        pool(1).install(|| memory_of(name));
        return;
    }
    let is_wanted = |name: &str| wanted.is_empty() || wanted.iter().any(|word| word == name);
    if is_wanted("growth") {
        let names = ["quaking_aspen", "black_tupelo", "weeping_willow"];
        pool(1).install(|| names.into_iter().for_each(growth));
    }
    if is_wanted("cores") {
        ["quaking_aspen", "black_tupelo"].into_iter().for_each(cores);
    }
    if is_wanted("forest") {
        pool(1).install(forest);
    }
    if is_wanted("file") {
        pool(1).install(|| ["quaking_aspen", "black_tupelo"].into_iter().for_each(file));
    }
    if is_wanted("memory") {
        ["quaking_aspen", "black_tupelo", "weeping_willow"].into_iter().for_each(memory);
    }
}

fn free(_: usize) -> Result<(), Infallible> {
    Ok(())
}

/// Stems, leaves and triangles by themselves, without a scene.
fn growth(name: &str) {
    let species = species(name);
    let (crown, levels) = (Crown::new(&species), Level::all(&species));
    let (form, params) = (TrunkForm::new(&species), LeafParams::new(&species));
    let skeleton = || {
        let mut grown: Vec<Stems> = Vec::new();
        for n in 0..species.levels as usize {
            let level = &levels[n.min(3)];
            let Ok(seeds) = match grown.last() {
                None => trunks(&crown, level, StreamPath::new(1), &mut free),
                Some(parents) => {
                    let form = (n == 1).then_some(&form);
                    children(parents, &crown, form, level, &mut free)
                }
            };
            let Ok(stems) = grow(&seeds, &crown, level, &species.attraction_target, &mut free);
            grown.push(stems);
        }
        grown
    };
    let grown = skeleton();
    let n_stems: usize = grown.iter().map(|stems| stems.stems.len()).sum();
    let last = grown.last().expect("every species has a trunk");
    let leafy = || leaves(last, &crown, &params, &params.target, &mut free).unwrap_or_default();
    let n_leaves = leafy().len();
    // As wide as a tree seen from nearby: branches of five to eight sides.
    let detail = Detail { sides: 1.3, ..Detail::default() };
    let is_five_to_eight = |stems: &Stems| {
        stems
            .stems
            .iter()
            .all(|stem| (5..=8).contains(&detail.n_sides(stem.seed.level, stem.seed.radius)))
    };
    let branches: Vec<&Stems> = grown.iter().filter(|stems| is_five_to_eight(stems)).collect();
    let barked = || -> usize {
        let meshes = branches.iter().map(|stems| surface(stems, &form, &detail, 0.5, free));
        meshes.map(|mesh| mesh.map_or(0, |mesh| mesh.n_triangles())).sum()
    };
    let n_triangles = barked();

    let [stems, leaves, triangles] =
        least([&mut || drop(skeleton()), &mut || drop(leafy()), &mut || {
            assert_eq!(barked(), n_triangles)
        }]);
    let rate = |n: usize, time: Duration| n as f64 / 1e6 / time.as_secs_f64();
    println!("{name}, growth alone, millions per second of CPU time");
    println!("  {n_stems:>7} stems     {:>6.2}", rate(n_stems, stems));
    println!("  {n_leaves:>7} leaves    {:>6.2}", rate(n_leaves, leaves));
    println!("  {n_triangles:>7} triangles {:>6.1}, 5 to 8 sides", rate(n_triangles, triangles));
}

/// The least CPU times of cases that take turns.
fn least<const N: usize>(mut cases: [&mut dyn FnMut(); N]) -> [Duration; N] {
    let mut least = [Duration::MAX; N];
    for _ in 0..REPEATED {
        for (case, least) in cases.iter_mut().zip(&mut least) {
            let start = Moment::now();
            case();
            *least = start.elapsed().min(*least);
        }
    }
    least
}

/// Many places of few trees, from a new scene to the first bounds.
fn forest() {
    let aspen = species("quaking_aspen");
    let mut build = || {
        let mut scene = Scene::new();
        let family = scene.add(aspen.attribute());
        let forest = scene.add_to(family, Group).expect("the family is empty");
        let trees: Vec<_> =
            (0..INDIVIDUALS as u64).map(|i| scene.add(Tree { seed: Seed::Explicit(i) })).collect();
        for i in 0..FOREST {
            let place = Transform::translation((i / 100) as f32 * 8.0, 0.0, (i % 100) as f32 * 8.0);
            let place = scene.add_to(forest, place).expect("a forest holds places");
            scene.append(place, trees[i % INDIVIDUALS]).expect("the place is empty");
        }
        let view =
            scene.open_view(family, &sapwood::standard_rules()).expect("the family is there");
        drop(bounds((scene, view)));
    };
    let [time] = least([&mut build]);
    println!("{FOREST} aspens of {INDIVIDUALS} individuals: first bounds after {time:.3?}");
}

/// A tree as GLB in memory, beside compiling it.
fn file(name: &str) {
    let species = species(name);
    let (mut scene, view) = planted(&species, 1..=1);
    let list = scene.draw_list(view, usize::MAX).expect("a tree is within the budget");
    // Pixels are made when somebody looks for the first time.
    let n_bytes = glb(&list).len();
    let [cold, file] = least([&mut || drop(bounds(planted(&species, 1..=1))), &mut || {
        assert_eq!(glb(&list).len(), n_bytes)
    }]);
    println!("{name}: compiled in {cold:.3?}, as GLB of {n_bytes} bytes in {file:.3?}");
}

fn glb(list: &DrawList) -> Vec<u8> {
    sapwood::io::glb_bytes(list).expect("a tree can be written")
}

fn memory(name: &str) {
    let program = std::env::current_exe().expect("the program has a file");
    let output = Command::new(program).args([MEMORY_OF, name]).output().expect("it runs again");
    print!("{}", String::from_utf8_lossy(&output.stdout));
}

/// The most memory that compiling a tree takes, against what comes of it.
fn memory_of(name: &str) {
    let species = species(name);
    let before = most_resident();
    let (mut scene, view) = planted(&species, 1..=1);
    scene.bounds(view).expect("a tree is within the budget");
    let after = most_resident();
    let list = scene.draw_list(view, usize::MAX).expect("a tree is within the budget");
    let rows = list.bodies.iter().flat_map(|body| &body.rows);
    let bytes: usize = rows
        .map(|row| match &row.instances {
            Some(places) => size_of_val(places.as_slice()),
            None => {
                let mesh = &row.mesh;
                size_of_val(mesh.positions.as_slice())
                    + size_of_val(mesh.normals.as_slice())
                    + size_of_val(mesh.uvs.as_slice())
                    + size_of_val(mesh.indices.as_slice())
            }
        })
        .sum();
    if let (Some(before), Some(after)) = (before, after) {
        let (most, bytes) = ((after - before) as f64 / 1e6, bytes as f64 / 1e6);
        let ratio = most / bytes;
        println!("{name}: {bytes:.1} MB of meshes and places, at most {most:.1} MB, {ratio:.2}");
    }
}

/// The most bytes of memory that the process has had, where the system tells.
fn most_resident() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.split_whitespace().next()?.parse::<u64>().ok()? * 1024)
}
