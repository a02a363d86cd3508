//! `sapwood family`: a contact sheet of individuals of one species, all at the same scale.
//!
//! Each individual has a scene of its own and is grown twice: once to learn how large it is, and
//! once for its picture. So no more than one of them is there at a time.

use std::io::Write;
use std::time::Instant;

use sapwood::geom::Aabb;
use sapwood::io::FileSet;
use sapwood::picture::{Paper, Sheet};
use sapwood::rules::weber_penn::Species;
use sapwood::scene::{Scene, ViewId};
use serde::Serialize;

use crate::arguments::{FamilyArguments, Individual, TreeArguments};
use crate::failure::Failure;
use crate::grow::size;
use crate::picture::{self, Extent, Order, Toll, TollDocument, Track};
use crate::tree;
use crate::watch::Watch;

/// Pixels of one picture where nobody says otherwise.
const CELL: [u32; 2] = [256, 320];

/// What was drawn.
struct Family {
    species: String,
    seeds: Vec<u64>,
    size: [u32; 2],
    bytes: u64,
    toll: Toll,
    seconds: f64,
}

/// What was drawn, for scripts. The keys are a promise: they stay.
#[derive(Debug, Serialize)]
struct Document<'a> {
    species: &'a str,
    seeds: &'a [u64],
    path: String,
    width: u32,
    height: u32,
    bytes: u64,
    seconds: f64,
    picture: TollDocument,
}

/// Draws the sheet; what is at fault is found in this order: arguments, file, species, compiling.
pub(crate) fn run(
    arguments: &FamilyArguments,
    watch: &Watch,
    out: &mut dyn Write,
) -> Result<(), Failure> {
    let outcome = drawn(arguments, watch);
    watch.done();
    let family = outcome?;
    let path = arguments.output.0.display().to_string();
    if arguments.json {
        let Family { species, seeds, size: [width, height], bytes, toll, seconds } = &family;
        let document = Document {
            species,
            seeds,
            path,
            width: *width,
            height: *height,
            bytes: *bytes,
            seconds: *seconds,
            picture: toll.into(),
        };
        let text = serde_json::to_string(&document).expect("texts and finite numbers are JSON");
        writeln!(out, "{text}")?;
    } else {
        let [width, height] = family.size;
        writeln!(out, "{}", title(&family.species, &family.seeds))?;
        writeln!(out, "{path}: {width}x{height}, {}", size(family.bytes))?;
        writeln!(out, "{}", picture::told(&family.toll))?;
    }
    Ok(())
}

fn drawn(arguments: &FamilyArguments, watch: &Watch) -> Result<Family, Failure> {
    let start = Instant::now();
    let order = Order::new(&arguments.picture, None, Some(CELL))?;
    let seeds = seeds(arguments)?;
    let of = &arguments.tree;
    let captions: Vec<String> = seeds.iter().map(|seed| format!("seed {seed}")).collect();
    let paper = match order.is_transparent() {
        true => Paper { color: [0; 4], ..Paper::default() },
        false => Paper::default(),
    };
    let new_sheet = |title: &str| {
        Sheet::new(title, &captions, order.size(), paper).ok_or_else(|| {
            let [width, height] = order.size();
            Failure::usage(format!(
                "--count {}: a sheet of pictures of {width}x{height} would be too large (accepted: \
                 up to 67108864 pixels together; a smaller --size leaves room for more)",
                seeds.len()
            ))
        })
    };
    new_sheet("")?;
    picture::check_targets([arguments.output.0.clone()])?;
    let species = tree::species(of)?;
    let name = if species.name.is_empty() { of.species.clone() } else { species.name.clone() };
    let mut sheet = new_sheet(&title(&name, &seeds))?;

    let mut aabb = Aabb::EMPTY;
    for seed in &seeds {
        aabb = aabb.union(grown(&species, *seed, of, watch)?.2);
    }
    let extent = Extent::of_box(aabb, 0.0);
    let mut toll = Toll::default();
    for (number, seed) in (0..).zip(&seeds) {
        let (mut scene, view, _) = grown(&species, *seed, of, watch)?;
        picture::style(&mut scene, view, &order)?;
        let track = Track { watch, n_before: number, n_pictures: arguments.count };
        let one = picture::take(&mut scene, view, &order, &extent, &track, |_, image| {
            sheet.put(number, &image);
            Ok(())
        })?;
        toll = toll.and(&one);
    }
    let follower = watch.clone();
    let mut files = FileSet::watched(move |path, bytes| follower.written(path, bytes));
    files.add_png(&arguments.output.0, sheet.image())?;
    let bytes = files.written().map(|(_, bytes)| bytes).sum();
    watch.check()?;
    files.commit()?;
    let size = [sheet.image().width, sheet.image().height];
    let seconds = start.elapsed().as_secs_f64();
    Ok(Family { species: name, seeds, size, bytes, toll, seconds })
}

/// A tree in a scene of its own, compiled, and how large it is.
fn grown(
    species: &Species,
    seed: u64,
    of: &TreeArguments,
    watch: &Watch,
) -> Result<(Scene, ViewId, Aabb), Failure> {
    watch.check()?;
    let mut scene = Scene::new();
    let root = tree::planted(&mut scene, species, Individual::Seed(seed), of)?;
    let (view, bounds) = tree::compiled(&mut scene, root, &tree::rules(of), of, watch)?;
    Ok((scene, view, bounds.aabb))
}

/// The seeds, one after the other.
fn seeds(arguments: &FamilyArguments) -> Result<Vec<u64>, Failure> {
    let first = arguments.seed.unwrap_or(0);
    let count = u64::from(arguments.count);
    if first.checked_add(count - 1).is_none() {
        return Err(Failure::usage(format!(
            "--seed {first}: there are not as many seeds from there on (accepted: 0 to {})",
            u64::MAX - (count - 1)
        )));
    }
    Ok((0..count).map(|i| first + i).collect())
}

fn title(species: &str, seeds: &[u64]) -> String {
    match seeds {
        [first, .., last] => format!("{species}, seeds {first} to {last}"),
        [only] => format!("{species}, seed {only}"),
        [] => species.to_owned(),
    }
}
