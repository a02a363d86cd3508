//! The arguments and their help texts.

use std::path::PathBuf;

use clap::{ArgAction, Args, Parser, Subcommand, ValueEnum};
use sapwood::io::Shape;
use tracing_subscriber::filter::LevelFilter;

use crate::accepted::{accepted, whole};
use crate::grow::{Light, Output, WindArguments};
use crate::picture::{PictureArguments, PictureFile, TurntableArguments, place};
use crate::seed::seed;

const EXIT_CODES: &str = "\
Exit codes:
  0  done
  1  the input is at fault: an unknown species, an error in a file
  2  the arguments are at fault
  3  the output could not be written; an existing file is left as it was
  4  a budget ran out, such as the number of triangles; nothing was written
  130  interrupted, as by Ctrl-C or SIGTERM; nothing was written. A third one does not wait for
       the tidying up: temporary files (.NAME.*.part) may then stay, and outputs may be
       incomplete as a set";

const SPECIES_FILES: &str = "\
Species files are TOML, as `sapwood species show` prints them, or the XML of Arbaro.";

const GROW_EXAMPLES: &str = "\
Examples:
  sapwood grow quaking_aspen -o quaking_aspen.glb
  sapwood grow quaking_aspen --seed random -o aspen.png
  sapwood grow quaking_aspen --leaf-mesh pear.glb -o pears.glb
  sapwood grow black_tupelo --seed 7 -o tupelo.gltf -o tupelo.obj -o tupelo.svg
  sapwood grow my_species.toml --at 12,0,-3.5 --detail skeleton -o lines.svg
  sapwood grow weeping_willow --detail draft --quality 0.5 -o willow.glb
  sapwood grow weeping_willow --levels 2 --json
  sapwood grow black_tupelo --view text
  sapwood grow japanese_maple --view map -o maple.svg
  sapwood grow quaking_aspen --weld stem -o welded.glb
  sapwood grow quaking_aspen --weld union -o solid.obj -o print.stl
  sapwood grow quaking_aspen --range 120 -o far.glb -o far.png
  sapwood grow quaking_aspen --billboard=even -o billboard.glb
  sapwood grow quaking_aspen --wind 5,2 --seconds 6 -o aspen.glb
  sapwood grow palm -o palm.png --size 600x800 --ground --sun 1,0.5,0.3
  sapwood grow apple -o turn.png --turntable 24 --samples 4 --transparent";

const PICTURE_EXAMPLES: &str = "\
Files are refused that hold more than 33,554,432 pixels in all images (such as 32 of 1024x1024),
131,072 nodes or primitives, 262,144 primitives counted at each node that shows them, or
2,097,152 instances; or whose meshes and instances would take more memory than 64 MiB and 32 times
the file's bytes.

Examples:
  sapwood picture tree.glb -o tree.png
  sapwood picture house.gltf --size 1920x1080 --samples 64 --ground -o house.png
  sapwood picture tree.glb --eye 8,1.7,8 --target 0,4,0 --fov 60 -o tree.png
  sapwood picture house.glb --camera garden -o garden.png
  sapwood picture tree.glb --style wire --from 0,0,1 --orthographic -o front.png";

const FAMILY_EXAMPLES: &str = "\
Examples:
  sapwood family quaking_aspen --count 12 -o aspens.png
  sapwood family black_tupelo --count 6 --seed 100 --size 400x600 --ground -o tupelos.png
  sapwood family my_species.toml --count 20 --detail draft --style skeleton -o lines.png";

const DUMP_EXAMPLES: &str = "\
Values are told by the first eight digits of their digests: equal ones are equal.

Examples:
  sapwood dump wheat --levels 1
  sapwood dump my_species.toml --seed 3 --max-lines 1000";

/// Grows scenes from descriptions.
#[derive(Debug, Parser)]
#[command(name = "sapwood", version, after_help = EXIT_CODES, arg_required_else_help = true)]
pub(crate) struct Arguments {
    /// Tell what is going on, on standard error; -vv: what was compiled; -vvv: each component
    #[arg(short, long, global = true, action = ArgAction::Count)]
    pub(crate) verbose: u8,
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Grow a tree, tell how large it is and write it to files
    #[command(after_help = GROW_EXAMPLES)]
    Grow(GrowArguments),
    /// Draw a glTF file, such as one that was grown
    #[command(after_help = PICTURE_EXAMPLES)]
    Picture(PictureCommand),
    /// Draw a contact sheet: individuals of one species at the same scale, each with its seed
    #[command(after_help = FAMILY_EXAMPLES)]
    Family(FamilyArguments),
    /// Take a compiled tree apart, for people who write rules: the components of its scene, the
    /// plans they were compiled to with what was read, the sites with what they are found by, and
    /// the render graph
    #[command(after_help = DUMP_EXAMPLES)]
    Dump(DumpArguments),
    /// Built-in species and species files: list, show, check, convert
    #[command(after_help = SPECIES_FILES)]
    Species(SpeciesArguments),
}

/// Which individual of a species.
#[derive(Args, Debug)]
pub(crate) struct IndividualArguments {
    /// Which individual: another number, another tree; `random` for one that nobody has chosen. It
    /// is told, and stands in .glb, .gltf and .obj files, so that the tree can be grown again
    /// [default: 0]
    #[arg(long, value_name = "N|random", value_parser = seed, allow_negative_numbers = true)]
    pub(crate) seed: Option<u64>,
    /// Stand the tree at this place, in metres, y up; the place also decides which individual
    /// it is
    #[arg(
        long,
        value_name = "X,Y,Z",
        value_parser = place,
        allow_hyphen_values = true,
        conflicts_with = "seed"
    )]
    pub(crate) at: Option<[f32; 3]>,
}

/// Which species, and how much of a tree.
#[derive(Args, Debug)]
pub(crate) struct TreeArguments {
    /// Name of a built-in species (see `sapwood species`), or a species file
    #[arg(value_name = "SPECIES|FILE")]
    pub(crate) species: String,
    /// What to make of stems and leaves
    #[arg(long, value_enum, default_value_t = Detail::Full)]
    pub(crate) detail: Detail,
    /// Grow this share of the leaves, above 0 and at most 1, each larger so that they cover as
    /// much; multiplies the species' own quality, as in the paper; stems do not change, nor do
    /// leaves in fans
    #[arg(
        long,
        value_name = "Q",
        default_value = "1",
        value_parser = quality,
        allow_negative_numbers = true
    )]
    pub(crate) quality: f32,
    /// Grow that many levels of stems only, 1 for the trunk alone; leaves grow on the last
    #[arg(long, value_name = "N", value_parser = levels, allow_negative_numbers = true)]
    pub(crate) levels: Option<u32>,
    /// Grow inside of a shape, in the words of --cut of `sapwood grow`: stems are shortened until
    /// their segments end inside, and what does not fit does not grow. May be given several times;
    /// each holds
    #[arg(long, value_name = "SHAPE", allow_hyphen_values = true)]
    pub(crate) prune: Vec<Shape>,
    /// How firmly --prune holds: 0 not at all, 1 fully, between by the paper's weighted mean
    /// [default: 1]
    #[arg(
        long,
        value_name = "R",
        value_parser = share,
        allow_negative_numbers = true,
        requires = "prune"
    )]
    pub(crate) prune_ratio: Option<f32>,
    /// Draw each leaf as what a .glb, .gltf or .obj file shows: a leaf, a flower, a fruit. The
    /// file's origin is where the stalk ends, +z leads along the leaf, +y is its upper side; it
    /// becomes as long as the leaves of the species and keeps its proportions
    #[arg(long, value_name = "FILE")]
    pub(crate) leaf_mesh: Option<PathBuf>,
    /// Draw leaves with an image, a PNG or JPEG with the tip at its upper edge. If parts of it are
    /// transparent, they are cut out and it keeps its proportions; else it is laid on the leaves'
    /// own shape, or on --leaf-mesh by its texture coordinates
    #[arg(long, value_name = "FILE")]
    pub(crate) leaf_image: Option<PathBuf>,
    /// Stop before there are more triangles than this
    #[arg(
        long,
        value_name = "N",
        default_value_t = 50_000_000,
        hide_default_value = true,
        value_parser = number,
        allow_negative_numbers = true,
        help = "Stop before there are more triangles than this [default: 50 million]"
    )]
    pub(crate) max_triangles: u64,
}

#[derive(Args, Debug)]
pub(crate) struct GrowArguments {
    #[command(flatten)]
    pub(crate) individual: IndividualArguments,
    #[command(flatten)]
    pub(crate) tree: TreeArguments,
    /// Write a file; may be given several times, and all files are written or none: .glb, .gltf
    /// (with a .bin) and .obj (with a .mtl) for surfaces and leaves, .svg for the skeleton or a
    /// map, .png for a picture, .txt for a text; with --weld union also .stl for the wood, in
    /// metres, z up
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Vec<Output>,
    /// What to show of the tree
    #[arg(long, value_enum, default_value_t = View::Full)]
    pub(crate) view: View,
    /// Keep only what is inside of a shape: sphere:X,Y,Z,R, box:X0,Y0,Z0,X1,Y1,Z1,
    /// half-space:NX,NY,NZ,D (the side that the normal leads away from), mesh:FILE.glb or
    /// outside:SHAPE, in metres, y up. Stems end where they leave it, and what grows beyond goes
    /// too. May be given several times; each cuts
    #[arg(long, value_name = "SHAPE", allow_hyphen_values = true)]
    pub(crate) cut: Vec<Shape>,
    /// Weld the wood before it is written; with --cut what is left of it
    #[arg(long, value_enum)]
    pub(crate) weld: Option<Weld>,
    /// Draw what is left of the tree at this distance, in metres, as the paper has trees fade:
    /// fewer leaves and branches, lines for tubes and triangles for leaves. Pictures are taken from
    /// there, through a lens that has all of the tree in view unless --fov is given
    #[arg(
        long,
        value_name = "METRES",
        value_parser = metres,
        allow_negative_numbers = true,
        conflicts_with_all = ["eye", "target", "orthographic", "turntable", "cut", "weld"]
    )]
    pub(crate) range: Option<f32>,
    /// Take images of the tree from 25 sides and draw boards with them instead of it: in files the
    /// one that faces an eye in front of the tree at --range, or else two crossed ones, each seen
    /// from both sides; in pictures the one that faces the eye
    #[arg(
        long,
        value_name = "LIGHT",
        value_enum,
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "baked",
        conflicts_with_all = ["cut", "weld", "wind"]
    )]
    pub(crate) billboard: Option<Light>,
    #[command(flatten)]
    pub(crate) wind: WindArguments,
    /// Tell what was grown as one JSON object instead of a table; the README has its keys
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) picture: PictureArguments,
    #[command(flatten)]
    pub(crate) turntable: TurntableArguments,
}

/// What is shown of a tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum View {
    /// Surfaces and leaves, as finely as --detail says
    Full,
    /// Lines with radii, as --detail skeleton
    Skeleton,
    /// The crown from above, with the tree's name and height; with -o FILE.svg
    Map,
    /// An outline in words, on standard output or with -o FILE.txt
    Text,
}

impl GrowArguments {
    /// The same with the detail that the view has.
    pub(crate) fn with_detail(mut self) -> Self {
        if self.view == View::Skeleton {
            self.tree.detail = Detail::Skeleton;
        }
        self
    }
}

/// How wood is welded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Weld {
    /// The segments of each stem, and of those that split from it, to one mesh
    Stem,
    /// All stems to one closed surface, as 3D printers and physics engines take it; leaves stay
    /// as they are
    Union,
}

#[derive(Args, Debug)]
pub(crate) struct PictureCommand {
    /// The file to draw: .glb, or .gltf with whatever it refers to in its folder
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,
    /// The picture to write, a .png file, whole or not at all
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: PictureFile,
    /// Tell what was drawn as one JSON object; the README has its keys
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) picture: PictureArguments,
    #[command(flatten)]
    pub(crate) turntable: TurntableArguments,
    /// Look through a camera of the file: its name, that of its node, or its number, counted from 0
    /// in the order of nodes
    #[arg(
        long,
        value_name = "NAME|INDEX",
        help_heading = "Pictures",
        allow_negative_numbers = true,
        conflicts_with_all = ["from", "eye", "target", "fov", "orthographic"]
    )]
    pub(crate) camera: Option<String>,
}

#[derive(Args, Debug)]
pub(crate) struct FamilyArguments {
    /// The first individual, or `random`; each of the others has the next number [default: 0]
    #[arg(long, value_name = "N|random", value_parser = seed, allow_negative_numbers = true)]
    pub(crate) seed: Option<u64>,
    #[command(flatten)]
    pub(crate) tree: TreeArguments,
    /// How many individuals to draw
    #[arg(
        short = 'n',
        long,
        value_name = "N",
        default_value = "12",
        value_parser = individuals,
        allow_negative_numbers = true
    )]
    pub(crate) count: u32,
    /// The sheet to write, a .png file, whole or not at all
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: PictureFile,
    /// Tell what was drawn as one JSON object; the README has its keys
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) picture: PictureArguments,
}

#[derive(Args, Debug)]
pub(crate) struct DumpArguments {
    #[command(flatten)]
    pub(crate) individual: IndividualArguments,
    #[command(flatten)]
    pub(crate) tree: TreeArguments,
    /// Write no more than that many lines of each list
    #[arg(long, value_name = "N", default_value_t = 40, value_parser = lines)]
    pub(crate) max_lines: usize,
}

/// What stems are compiled to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Detail {
    /// Surfaces and leaves
    Full,
    /// Fewer sides, rings and leaves, in about a third of the triangles or less
    Draft,
    /// Every segment of a stem by itself, before it is welded to the others; and leaves
    Segments,
    /// Lines with radii
    Skeleton,
}

#[derive(Args, Debug)]
pub(crate) struct SpeciesArguments {
    #[command(subcommand)]
    pub(crate) command: Option<SpeciesCommand>,
}

#[derive(Debug, Subcommand)]
pub(crate) enum SpeciesCommand {
    /// One line for each built-in species
    List,
    /// The text of a species file, to be saved and changed
    Show {
        /// Name of a built-in species, or a species file to check and print in full
        #[arg(value_name = "NAME|FILE")]
        name: String,
    },
    /// Read species files and tell of each what it is, or all that is wrong with it
    Check {
        /// Species files, or names of built-in species
        #[arg(value_name = "FILE", required = true)]
        names: Vec<String>,
    },
    /// Write a species as a TOML file, such as one that Arbaro wrote
    Convert {
        /// A species file, or the name of a built-in species
        #[arg(value_name = "IN")]
        from: String,
        /// The file to write, whole or not at all; its name ends in .toml
        #[arg(value_name = "OUT")]
        to: PathBuf,
    },
}

/// An individual of a species.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Individual {
    /// With this seed, at the origin.
    Seed(u64),
    /// The one that grows at this place.
    At([f32; 3]),
}

impl IndividualArguments {
    /// The individual that is asked for.
    pub(crate) fn individual(&self) -> Individual {
        match self.at {
            Some(place) => Individual::At(place),
            None => Individual::Seed(self.seed.unwrap_or(0)),
        }
    }
}

impl Arguments {
    /// What is told on standard error.
    pub(crate) fn level(&self) -> LevelFilter {
        match self.verbose {
            0 => LevelFilter::WARN,
            1 => LevelFilter::INFO,
            2 => LevelFilter::DEBUG,
            _ => LevelFilter::TRACE,
        }
    }
}

fn number(text: &str) -> Result<u64, String> {
    whole(text, 0..=u64::MAX)
}

/// Individuals of one sheet.
const MOST_INDIVIDUALS: u32 = 1000;

fn individuals(text: &str) -> Result<u32, String> {
    whole(text, 1..=MOST_INDIVIDUALS)
}

fn lines(text: &str) -> Result<usize, String> {
    whole(text, 0..=usize::MAX)
}

/// How many levels there are to choose from, the species decides.
fn levels(text: &str) -> Result<u32, String> {
    accepted(text.parse().ok(), |_| true, "1 up to the levels of the species")
}

fn share(text: &str) -> Result<f32, String> {
    accepted(text.parse().ok(), |share| (0.0..=1.0).contains(share), "0 to 1")
}

fn metres(text: &str) -> Result<f32, String> {
    accepted(text.parse().ok(), |range| *range >= 0.1 && *range <= 1e6, "0.1 to 1000000")
}

fn quality(text: &str) -> Result<f32, String> {
    accepted(text.parse().ok(), |quality| *quality > 0.0 && *quality <= 1.0, "above 0, up to 1")
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    use super::*;

    #[test]
    fn the_arguments_are_consistent_and_the_help_tells_exit_codes() {
        Arguments::command().debug_assert();
        let help = Arguments::command().render_long_help().to_string();
        assert!(help.contains("Exit codes:\n  0  done"), "{help}");
    }

    #[test]
    fn qualities_are_shares() {
        assert_eq!(quality("0.25"), Ok(0.25));
        for wrong in ["0", "-0.5", "1.01", "nan", "inf", "x", ""] {
            assert_eq!(quality(wrong), Err("accepted: above 0, up to 1".to_owned()), "{wrong}");
        }
    }

    #[test]
    fn seeds_and_budgets_are_whole_numbers() {
        assert_eq!(number("18446744073709551615"), Ok(u64::MAX));
        for wrong in ["-1", "1.5", "x", "18446744073709551616"] {
            assert!(number(wrong).unwrap_err().contains("whole numbers from 0"), "{wrong}");
        }
    }
}
