//! `--view map` and `--view text`: a tree told of as a whole instead of being drawn.

use std::io::Write;

use sapwood::io::FileSet;
use sapwood::scene::Scene;

use super::output::{self, Format, ListFormat};
use super::{size, title};
use crate::arguments::{Detail, GrowArguments, View};
use crate::failure::Failure;
use crate::tree;
use crate::watch::Watch;

/// Tells of a tree in files, or a text on `out` where there are none.
pub(super) fn run(
    arguments: &GrowArguments,
    watch: &Watch,
    out: &mut dyn Write,
) -> Result<(), Failure> {
    let outcome = told(arguments, watch);
    watch.done();
    out.write_all(outcome?.as_bytes())?;
    Ok(())
}

/// What is said on standard output.
fn told(arguments: &GrowArguments, watch: &Watch) -> Result<String, Failure> {
    check(arguments)?;
    let (individual, of) = (arguments.individual.individual(), &arguments.tree);
    let species = tree::species(of)?;
    let mut scene = Scene::new();
    let root = tree::planted(&mut scene, &species, individual, of)?;
    let is_map = arguments.view == View::Map;
    let rules = if is_map { sapwood::map_rules() } else { sapwood::text_rules() };
    let (view, _) = tree::compiled(&mut scene, root, &rules, of, watch)?;
    let text = if is_map {
        sapwood::io::svg_map(&scene.draw_list(view, usize::MAX)?)?
    } else {
        scene.outline(view, usize::MAX)?
    };
    if arguments.output.is_empty() {
        return Ok(text);
    }
    let follower = watch.clone();
    let mut files = FileSet::watched(move |path, bytes| follower.written(path, bytes));
    for output in &arguments.output {
        files.write(output.path(), |file| file.write_all(text.as_bytes()))?;
    }
    let name = if species.name.is_empty() { of.species.clone() } else { species.name };
    let mut said = format!("{}\n", title(&name, individual, arguments));
    for (path, bytes) in files.written() {
        said.push_str(&format!("{}: {}\n", path.display(), size(bytes)));
    }
    watch.check()?;
    files.commit()?;
    Ok(said)
}

/// Refuses files of other sorts, and what is said of what is not drawn.
fn check(arguments: &GrowArguments) -> Result<(), Failure> {
    let (name, format, ending) = match arguments.view {
        View::Map => ("map", Format::List(ListFormat::Svg), ".svg"),
        _ => ("text", Format::Text, ".txt"),
    };
    if let Some(output) = arguments.output.iter().find(|output| output.format() != format) {
        return Err(Failure::usage(format!(
            "{}: --view {name} is not written to such files (accepted: names that end in {ending}, \
             or --view full)",
            output.path().display()
        )));
    }
    if arguments.view == View::Map && arguments.output.is_empty() {
        return Err(Failure::usage(
            "--view map: there is no file to draw it to (accepted: with -o FILE.svg)".to_owned(),
        ));
    }
    let in_vain = [
        (arguments.tree.detail != Detail::Full, "--detail"),
        (!arguments.cut.is_empty(), "--cut"),
        (arguments.weld.is_some(), "--weld"),
        (arguments.range.is_some(), "--range"),
        (arguments.billboard.is_some(), "--billboard"),
        (arguments.wind.wind.is_some(), "--wind"),
        (arguments.json, "--json"),
        (arguments.turntable.turntable.is_some(), "--turntable"),
    ];
    let in_vain = in_vain.into_iter().find(|(is_given, _)| *is_given).map(|(_, option)| option);
    if let Some(option) = in_vain.or(arguments.picture.given()) {
        return Err(Failure::usage(format!(
            "{option}: does nothing for --view {name} (accepted: with --view full)"
        )));
    }
    output::refuse_clashes(&arguments.output, None)
}
