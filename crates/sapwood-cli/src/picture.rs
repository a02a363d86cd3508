//! Pictures: what is asked of them and how they are taken; and `sapwood picture`, which takes them
//! of files.

mod arguments;
mod cameras;
mod order;
mod take;
mod target;

use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;

use sapwood::geom::Aabb;
use sapwood::graph::grouped;
use sapwood::io::{FileSet, ReadLimits};
use sapwood::scene::{Scene, ViewId};
use serde::Serialize;

pub(crate) use arguments::{PictureArguments, PictureFile, TurntableArguments, place};
pub(crate) use order::{Extent, Order};
pub(crate) use take::{Toll, TollDocument, Track, style, take};
pub(crate) use target::{check_targets, names};

use crate::arguments::PictureCommand;
use crate::failure::Failure;
use crate::grow::size;
use crate::watch::Watch;

/// Components that cannot be compiled and are told of; more would drown the first.
const MAX_DIAGNOSTICS: usize = 10;

/// How much of a file is read. A small file may unfold to a lot; pixels take 128 MiB at most here,
/// instances 96 MiB, and what stands in the way of the rest is how long the file is. The help tells
/// these numbers.
fn limits() -> ReadLimits {
    ReadLimits {
        nodes: 1 << 17,
        shown: 1 << 18,
        instances: 1 << 21,
        pixels: 1 << 25,
        ..ReadLimits::default()
    }
}

/// What was drawn.
struct Drawn {
    n_triangles: u64,
    aabb: Aabb,
    warnings: Vec<String>,
    /// The files, each with its bytes.
    files: Vec<(String, u64)>,
    toll: Toll,
    seconds: f64,
}

/// What was drawn, for scripts. The keys are a promise: they stay.
#[derive(Debug, Serialize)]
struct Document<'a> {
    file: String,
    warnings: &'a [String],
    triangles: u64,
    bounds: Bounds,
    outputs: Vec<Written<'a>>,
    seconds: f64,
    picture: TollDocument,
}

#[derive(Debug, Serialize)]
struct Bounds {
    min: [f32; 3],
    max: [f32; 3],
}

#[derive(Debug, Serialize)]
struct Written<'a> {
    path: &'a str,
    bytes: u64,
}

/// Draws a file; what is at fault is found in this order: arguments, outputs, the file, pictures.
pub(crate) fn run(
    arguments: &PictureCommand,
    watch: &Watch,
    out: &mut dyn Write,
) -> Result<(), Failure> {
    let outcome = drawn(arguments, watch).map_err(Failure::of_model);
    watch.done();
    let drawn = outcome?;
    if arguments.json {
        writeln!(out, "{}", json(arguments, &drawn))?;
        return Ok(());
    }
    for warning in &drawn.warnings {
        writeln!(out, "{}: warning: {warning}", arguments.file.display())?;
    }
    let (triangles, extent) = (grouped(drawn.n_triangles), drawn.aabb.size());
    let [x, y, z] = extent.to_array();
    writeln!(
        out,
        "{}: {triangles} triangles, {x:.2} x {y:.2} x {z:.2} m",
        arguments.file.display()
    )?;
    for (path, bytes) in &drawn.files {
        writeln!(out, "{path}: {}", size(*bytes))?;
    }
    writeln!(out, "{}", told(&drawn.toll))?;
    Ok(())
}

fn json(arguments: &PictureCommand, drawn: &Drawn) -> String {
    let outputs = drawn.files.iter().map(|(path, bytes)| Written { path, bytes: *bytes });
    let document = Document {
        file: arguments.file.display().to_string(),
        warnings: &drawn.warnings,
        triangles: drawn.n_triangles,
        bounds: Bounds { min: drawn.aabb.min.to_array(), max: drawn.aabb.max.to_array() },
        outputs: outputs.collect(),
        seconds: drawn.seconds,
        picture: (&drawn.toll).into(),
    };
    serde_json::to_string(&document).expect("texts and finite numbers are JSON")
}

fn drawn(arguments: &PictureCommand, watch: &Watch) -> Result<Drawn, Failure> {
    let start = Instant::now();
    let turns = arguments.turntable.turntable;
    let mut order = Order::new(&arguments.picture, turns, None)?;
    let itself: Vec<_> = arguments.file.canonicalize().into_iter().collect();
    check_not_read(arguments, turns, &itself)?;
    let output = &arguments.output.0;
    check_targets(names(output, turns))?;
    let model = sapwood::io::read_gltf(&arguments.file, &limits())?;
    check_not_read(arguments, turns, &model.files)?;
    watch.check()?;
    if let Some(wanted) = &arguments.camera {
        order = order.through(cameras::camera(&model, wanted)?);
    }
    let mut scene = Scene::new();
    let root = model.add_to(&mut scene);
    let warnings = model.warnings;
    let view = scene.open_view(root, &sapwood::standard_rules())?;
    watch.follow(scene.cancel_token(view)?);
    let (aabb, n_triangles) = compiled(&mut scene, view)?;
    style(&mut scene, view, &order)?;
    let mut extent = Extent::of_box(aabb, aabb.min.y);
    if order.is_turned() {
        extent = extent.tightened(&scene.draw_list(view, usize::MAX)?);
    }

    let follower = watch.clone();
    let mut files = FileSet::watched(move |path, bytes| follower.written(path, bytes));
    let track = Track { watch, n_before: 0, n_pictures: order.n_pictures() };
    let mut targets = names(output, turns);
    let toll = take(&mut scene, view, &order, &extent, &track, |_, image| {
        if let Some(path) = targets.next() {
            files.add_png(path, &image)?;
        }
        watch.check()
    })?;
    let written = files.written().map(|(path, bytes)| (path.display().to_string(), bytes));
    let written = written.collect();
    files.commit()?;
    let seconds = start.elapsed().as_secs_f64();
    Ok(Drawn { n_triangles, aabb, warnings, files: written, toll, seconds })
}

/// Refuses to write a picture to the file that is drawn, or to one that it refers to; the paths in
/// `read` are canonical.
fn check_not_read(
    arguments: &PictureCommand,
    turns: Option<u32>,
    read: &[PathBuf],
) -> Result<(), Failure> {
    for path in names(&arguments.output.0, turns) {
        let Ok(real) = path.canonicalize() else { continue };
        let path = path.display();
        let line = match read.iter().position(|read| *read == real) {
            None => continue,
            Some(0) => format!("{path} is the file that is drawn; name another one"),
            Some(_) => format!("{path} is read for the file that is drawn; name another one"),
        };
        return Err(Failure::usage(line));
    }
    Ok(())
}

/// Compiles everything; how large it is and how many triangles there are.
fn compiled(scene: &mut Scene, view: ViewId) -> Result<(Aabb, u64), Failure> {
    let bounds = scene.bounds(view)?;
    let found = scene.diagnostics(view, MAX_DIAGNOSTICS)?;
    if !found.is_empty() {
        return Err(Failure::diagnostics(&found));
    }
    let list = scene.draw_list(view, usize::MAX)?;
    Ok((bounds.aabb, list.n_vertices_and_triangles().1))
}

/// What pictures took, in words.
pub(crate) fn told(toll: &Toll) -> String {
    let (n, [width, height]) = (toll.n_pictures, toll.size);
    let s = if n == 1 { "" } else { "s" };
    let (rays, seconds) = (grouped(toll.n_rays()), toll.time.as_secs_f64());
    format!(
        "{n} picture{s} of {width}x{height} with {} samples: {rays} rays in {seconds:.1} s",
        toll.samples
    )
}
