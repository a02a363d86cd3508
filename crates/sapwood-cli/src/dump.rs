//! `sapwood dump`: a compiled tree taken apart, as text.

use std::io::Write;

use sapwood::scene::Scene;

use crate::arguments::DumpArguments;
use crate::failure::Failure;
use crate::tree;
use crate::watch::Watch;

/// Writes four lists: components, plans, sites and render nodes.
pub(crate) fn run(
    arguments: &DumpArguments,
    watch: &Watch,
    out: &mut dyn Write,
) -> Result<(), Failure> {
    let text = text(arguments, watch);
    watch.done();
    Ok(out.write_all(text?.as_bytes())?)
}

fn text(arguments: &DumpArguments, watch: &Watch) -> Result<String, Failure> {
    let DumpArguments { individual, tree: of, max_lines } = arguments;
    let species = tree::species(of)?;
    let mut scene = Scene::new();
    let root = tree::planted(&mut scene, &species, individual.individual(), of)?;
    let (view, _) = tree::compiled(&mut scene, root, &tree::rules(of), of, watch)?;
    let mut text = scene.explain(view, *max_lines)?;
    text.push_str("render graph\n");
    for line in scene.dump(view, *max_lines)?.lines() {
        text.push_str("  ");
        text.push_str(line);
        text.push('\n');
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use clap::Parser as _;

    use super::*;
    use crate::arguments::{Arguments, Command};

    fn dumped(line: &str) -> String {
        let line = ["sapwood", "dump"].into_iter().chain(line.split_whitespace());
        let Command::Dump(arguments) = Arguments::try_parse_from(line).unwrap().command else {
            panic!("another command")
        };
        text(&arguments, &Watch::default()).unwrap()
    }

    #[test]
    fn a_tree_is_taken_apart() {
        let text = dumped("wheat --levels 1 --seed 3 --max-lines 200");
        for line in [
            "semantic graph\n  attribute NodeId(1v1), edited at",
            "\nplans\n  p1 view, 1 link\n  p2 attribute NodeId(1v1) by attribute",
            "by weber_penn.branch",
            "; reads weber_penn.crown",
            "material (if forced) 00000000",
            "\nsites\n  s1 of p1; ",
            "\nrender graph\n  attribute\n",
        ] {
            assert!(text.contains(line), "{line} is missing in\n{text}");
        }
        assert_eq!(text, dumped("wheat --levels 1 --seed 3 --max-lines 200"), "the same each time");
    }

    #[test]
    fn each_list_keeps_to_its_limit() {
        let text = dumped("wheat --max-lines 1");
        assert_eq!(text.matches("lines more").count(), 4, "{text}");
        assert!(text.lines().count() <= 12, "{text}");
    }
}
