//! `sapwood grow`: a scene with one tree, compiled, summed up and written to files.

mod billboard;
mod held;
mod json;
mod output;
mod summary;
#[cfg(test)]
mod tests;
mod told;
mod weld;
mod wind;

use std::io::Write;
use std::time::{Duration, Instant};

use sapwood::geom::Aabb;
use sapwood::geom::glam::{Affine3, Vec3};
use sapwood::graph::{DrawList, Eye, Prune, WeldedUnion, Wind};
use sapwood::io::{FileSet, Shape, Swayed};
use sapwood::rules::weber_penn::{SwaySlot, prune_handlers};
use sapwood::scene::{Attribute, Handle, RuleSet, Scene, Style, ViewError, ViewId, Viewer};
use tracing::{Level, info};

use crate::arguments::{Detail, GrowArguments, Individual, View, Weld};
use crate::failure::Failure;
use crate::picture::{self, Extent, Order, Toll, Track};
use crate::tree;
use crate::watch::Watch;

pub(crate) use billboard::Light;
pub(crate) use output::Output;
use output::{Drawn, Format, ListFormat};
pub(crate) use summary::size;
use summary::{Census, Phase, Summary};
pub(crate) use wind::WindArguments;

/// Grows a tree; what is at fault is found in this order: arguments, species, compiling, files.
pub(crate) fn run(
    arguments: &GrowArguments,
    watch: &Watch,
    out: &mut dyn Write,
) -> Result<(), Failure> {
    if matches!(arguments.view, View::Map | View::Text) {
        return told::run(arguments, watch, out);
    }
    let outcome = grown(arguments, watch);
    watch.done();
    let summary = outcome?;
    if arguments.json {
        writeln!(out, "{}", json::json(&summary, arguments))?;
    } else {
        write!(out, "{summary}")?;
    }
    Ok(())
}

fn grown(arguments: &GrowArguments, watch: &Watch) -> Result<Summary, Failure> {
    let order = check_outputs(arguments)?;
    let cut = Shape::all(&arguments.cut, None)?.map(Prune::to);
    let mut steps = Steps::default();
    let (individual, of) = (arguments.individual.individual(), &arguments.tree);
    let species = steps.time("read", || tree::species(of))?;

    let mut scene = Scene::new();
    scene.set_logging(tracing::enabled!(Level::DEBUG));
    let mut root = tree::planted(&mut scene, &species, individual, of)?;
    if arguments.wind.wind.is_some() {
        scene.push::<SwaySlot>(root, arguments.wind.sway())?;
    }
    // What stands for the whole tree does not fade itself.
    let fades_at = arguments.range.filter(|_| arguments.billboard.is_none());
    let rules = match (arguments.weld, fades_at) {
        (None | Some(Weld::Union), None) => tree::rules(of),
        (Some(Weld::Stem), None) => sapwood::segment_rules(),
        (_, Some(_)) => sapwood::fading_rules(),
    };
    let rules = arguments.wind.rules(rules);
    let (mut view, bounds) =
        steps.time("compile", || tree::compiled(&mut scene, root, &rules, of, watch))?;
    let census = Census::of(&mut scene, view, species.levels)?;
    let components = scene.count(view)?.components;
    let foot = match individual {
        Individual::At(place) => Vec3::from(place),
        Individual::Seed(_) => Vec3::ZERO,
    };
    if let Some(light) = arguments.billboard {
        let boards = steps.time("billboard", || {
            billboard::stand_in(&mut scene, view, light, order.as_ref(), watch)
        });
        (scene, root) = boards?;
        (view, _) = tree::compiled(&mut scene, root, &rules, of, watch)?;
    }
    if let Some(range) = arguments.range {
        scene.set_moving::<Viewer>(view, Some(Eye::new(foot + Vec3::Z * range)))?;
    }
    let mut list = steps.time("draw list", || drawn(&mut scene, view, cut.as_ref()))?;
    let mut bounds = bounds.aabb;
    let moment = arguments.wind.moment(&list);
    if moment.is_some() {
        // The view's own have room for more wind.
        bounds = aabb(&list);
    }
    if cut.is_some() {
        bounds = aabb(&list);
        if bounds.is_empty() {
            return Err(nothing_left(arguments));
        }
    }
    let mut welded = None;
    match arguments.weld {
        None => {}
        Some(Weld::Stem) => {
            list = steps.time("weld", || weld::stems(&mut scene, view, &list, cut.as_ref()))?;
        }
        Some(Weld::Union) => {
            let max = of.max_triangles;
            let join = || weld::union(&mut scene, view, &list, cut.as_ref(), max, watch);
            let WeldedUnion { list: joined, union, report } = steps.time("weld", join)?;
            list = joined;
            welded = Some((union, report));
        }
    }
    let has_surfaces = arguments.tree.detail != Detail::Skeleton;
    let surfaces = has_surfaces.then(|| list.n_vertices_and_triangles());

    // Everything is compiled before the first file is written.
    let wants_svg = arguments.output.iter().any(|o| o.format() == Format::List(ListFormat::Svg));
    let mut lines = None;
    // Of a tree that fades, the lines are drawn that are left.
    if has_surfaces && wants_svg && arguments.range.is_none() {
        let rules = sapwood::skeleton_rules();
        lines = Some(steps.time("compile skeleton", || {
            let (view, _) = tree::compiled(&mut scene, root, &rules, of, watch)?;
            Ok::<_, Failure>(drawn(&mut scene, view, cut.as_ref())?)
        })?);
    }
    let follower = watch.clone();
    let mut files = FileSet::watched(move |path, bytes| follower.written(path, bytes));
    let name = if species.name.is_empty() { of.species.clone() } else { species.name };
    files.note("species", &name);
    match individual {
        Individual::Seed(seed) => files.note("seed", &seed.to_string()),
        Individual::At([x, y, z]) => files.note("at", &format!("{x},{y},{z}")),
    }
    let lines = lines.as_ref().unwrap_or(&list);
    let solid = welded.as_ref().map(|(union, _)| &union.solid);
    let still = moment.as_ref().unwrap_or(&list);
    let animation = arguments.wind.animation();
    let animation = animation.as_ref();
    let to_write = Drawn { list: &list, still, animation, lines, solid };
    let swayed = write_lists(arguments, &mut files, &to_write, watch, &mut steps)?;
    let mut toll = None;
    if let Some(order) = &order {
        let mut held;
        // A skeleton is drawn along what grew, welded or not.
        let is_welded = arguments.weld.is_some() && order.style != Some(Style::Skeleton);
        let grown = if cut.is_some() || is_welded || moment.is_some() {
            held = held::held(still)?;
            let (scene, root) = (&mut held.0, held.1);
            let view = scene.open_view(root, &rules)?;
            watch.follow(scene.cancel_token(view)?);
            Grown { scene, root, rules: &rules, view }
        } else {
            Grown { scene: &mut scene, root, rules: &rules, view }
        };
        let order = &order.clone().at_range(arguments.range, foot);
        // At rest, so that all moments are seen from the same place.
        let mut extent = Extent::of_box(bounds, foot.y);
        if order.is_turned() {
            extent = extent.tightened(&list);
        }
        toll =
            Some(write_pictures(arguments, order, grown, &extent, &mut files, watch, &mut steps)?);
    }
    watch.check()?;
    files.commit()?;

    let title = title(&name, individual, arguments);
    let phases = steps.0;
    Ok(Summary {
        species: name,
        title,
        census,
        components,
        surfaces,
        welded: welded.map(|(_, report)| report),
        swayed,
        bounds,
        phases,
        notes: arguments.output.iter().filter_map(Output::note).collect(),
        picture: toll,
    })
}

/// What a view draws, or what a cut leaves of it.
fn drawn(scene: &mut Scene, view: ViewId, cut: Option<&Prune>) -> Result<DrawList, ViewError> {
    match cut {
        None => scene.draw_list(view, usize::MAX),
        Some(cut) => scene.prune(view, cut, &prune_handlers(), usize::MAX),
    }
}

/// The box around everything that a list draws.
fn aabb(list: &DrawList) -> Aabb {
    let once = [Affine3::IDENTITY];
    let rows = list.placed_rows().flat_map(|(world, row)| {
        let instances = row.instances.as_ref().map_or(&once[..], |instances| instances);
        instances.iter().map(move |at| row.mesh.bound().transformed(&(world * *at)).aabb)
    });
    let lines = list.placed_lines().flat_map(|(world, row)| {
        row.lines.iter().map(move |line| line.transformed(&world).bound().aabb)
    });
    // A cut has no plans to ask for their bounds, and little is left of what had them.
    rows.chain(lines).fold(Aabb::EMPTY, Aabb::union)
}

fn nothing_left(arguments: &GrowArguments) -> Failure {
    let shapes: Vec<_> = arguments.cut.iter().map(ToString::to_string).collect();
    Failure::usage(format!(
        "--cut {}: nothing of the tree is left (accepted: shapes that a trunk stands or reaches \
         in); nothing was written",
        shapes.join(" --cut ")
    ))
}

/// Adds all files that hold what is drawn, and tells how many joints of them move.
fn write_lists(
    arguments: &GrowArguments,
    files: &mut FileSet,
    drawn: &Drawn<'_>,
    watch: &Watch,
    steps: &mut Steps,
) -> Result<Option<Swayed>, Failure> {
    let mut swayed = None;
    for output in &arguments.output {
        let Format::List(format) = output.format() else { continue };
        watch.check()?;
        let start = Instant::now();
        let (bytes, moved) = format.write(output.path(), files, drawn)?;
        swayed = swayed.or(moved);
        steps.note(output.path().display().to_string(), start.elapsed(), Some(bytes));
    }
    Ok(swayed)
}

/// A tree in a scene, and the view that it was compiled for.
struct Grown<'a> {
    scene: &'a mut Scene,
    root: Handle<Attribute>,
    rules: &'a RuleSet,
    view: ViewId,
}

/// Takes the pictures and adds each to all the files that are to hold it.
fn write_pictures(
    arguments: &GrowArguments,
    order: &Order,
    grown: Grown<'_>,
    extent: &Extent,
    files: &mut FileSet,
    watch: &Watch,
    steps: &mut Steps,
) -> Result<Toll, Failure> {
    let Grown { scene, root, rules, mut view } = grown;
    let of = &arguments.tree;
    if order.style.is_some() {
        // What other files hold has the style that it had.
        (view, _) = tree::compiled(scene, root, rules, of, watch)?;
        picture::style(scene, view, order)?;
    }
    let turns = arguments.turntable.turntable;
    let outputs = arguments.output.iter().filter(|output| output.format() == Format::Png);
    let mut written: Vec<_> = outputs.map(|output| (output, Duration::ZERO, 0)).collect();
    let track = Track { watch, n_before: 0, n_pictures: order.n_pictures() };
    let toll = picture::take(scene, view, order, extent, &track, |number, image| {
        for (output, time, bytes) in &mut written {
            let start = Instant::now();
            let name = picture::names(output.path(), turns).nth(number as usize);
            files.add_png(name.unwrap_or_default(), &image)?;
            *bytes += files.written().last().map_or(0, |(_, bytes)| bytes);
            *time += start.elapsed();
        }
        watch.check()
    })?;
    steps.note("pictures".to_owned(), toll.time, None);
    for (output, time, bytes) in written {
        steps.note(output.path().display().to_string(), time, Some(bytes));
    }
    Ok(toll)
}

/// Refuses files that hold what the detail does not make, files that are written twice, and what
/// is said of pictures where there are none. Gives what is asked of the pictures.
fn check_outputs(arguments: &GrowArguments) -> Result<Option<Order>, Failure> {
    let mut outputs = arguments.output.iter();
    if arguments.tree.detail == Detail::Skeleton
        && let Some(output) = outputs.find(|output| output.needs_surfaces())
    {
        return Err(Failure::usage(format!(
            "{}: glTF files hold surfaces, and --detail skeleton makes none; accepted: .obj, \
             .svg, .png, or --detail full",
            output.path().display()
        )));
    }
    if let Some(output) = arguments.output.iter().find(|o| o.format() == Format::Text) {
        return Err(Failure::usage(format!(
            "{}: what is drawn is no text (accepted: with --view text)",
            output.path().display()
        )));
    }
    weld::check(arguments)?;
    billboard::check(arguments, None)?;
    let turns = arguments.turntable.turntable;
    output::refuse_clashes(&arguments.output, turns)?;
    let fades = !matches!(arguments.tree.detail, Detail::Skeleton | Detail::Segments);
    if !fades && arguments.range.is_some() {
        return Err(Failure::usage(
            "--range: skeletons and segments do not fade (accepted: with --detail full or draft)"
                .to_owned(),
        ));
    }
    let pictures = || arguments.output.iter().filter(|output| output.format() == Format::Png);
    if pictures().next().is_none() {
        let in_vain = arguments.picture.given().or(turns.map(|_| "--turntable"));
        wind::check(arguments, None)?;
        return match in_vain {
            None => Ok(None),
            Some(option) => Err(Failure::usage(format!(
                "{option}: there is no picture that it is for (accepted: with -o FILE.png)"
            ))),
        };
    }
    let order = Order::new(&arguments.picture, turns, None)?;
    wind::check(arguments, Some(&order))?;
    billboard::check(arguments, Some(&order))?;
    let has_lines = arguments.tree.detail == Detail::Skeleton;
    if !arguments.cut.is_empty() && (has_lines || order.style == Some(Style::Skeleton)) {
        return Err(Failure::usage(
            "--cut: pictures of what is left show surfaces, and a skeleton has none (accepted: \
             -o FILE.svg, or another style and detail)"
                .to_owned(),
        ));
    }
    picture::check_targets(pictures().flat_map(|output| picture::names(output.path(), turns)))?;
    Ok(Some(order))
}

fn title(name: &str, individual: Individual, arguments: &GrowArguments) -> String {
    let GrowArguments { tree: arguments, range, wind, billboard, .. } = arguments;
    let detail = match arguments.detail {
        Detail::Full => "",
        Detail::Draft => ", draft",
        Detail::Segments => ", segments",
        Detail::Skeleton => ", skeleton",
    };
    let quality = match arguments.quality {
        1.0 => String::new(),
        quality => format!(", quality {quality}"),
    };
    let held = if arguments.prune.is_empty() { "" } else { ", pruned" };
    let mut seen = range.map_or_else(String::new, |range| format!(", from {range} m"));
    if let Some(Wind { speed, gust }) = wind.wind {
        seen = format!(", in a wind of {speed} m/s with gusts of {gust}");
    }
    if billboard.is_some() {
        seen.push_str(", as a billboard");
    }
    match individual {
        Individual::At([x, y, z]) => {
            format!("{name} at {x}, {y}, {z}{detail}{quality}{held}{seen}")
        }
        Individual::Seed(seed) => format!("{name}, seed {seed}{detail}{quality}{held}{seen}"),
    }
}

/// The steps taken so far, with their times.
#[derive(Default)]
struct Steps(Vec<Phase>);

impl Steps {
    fn time<R>(&mut self, name: &str, step: impl FnOnce() -> R) -> R {
        let start = Instant::now();
        let result = step();
        self.note(name.to_owned(), start.elapsed(), None);
        result
    }

    fn note(&mut self, name: String, time: Duration, bytes: Option<u64>) {
        info!(step = name, ?time, bytes);
        self.0.push(Phase { name, time, bytes });
    }
}
