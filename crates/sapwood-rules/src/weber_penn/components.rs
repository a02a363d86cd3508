//! The components that a tree is made of: plain data, compiled by `rules`.
//!
//! [`Tree`] is what users place. It is compiled into one [`Branch`] for each trunk; a branch
//! emits its [`StemSurface`] and [`Children`], or its [`Leaves`] where it is of the last level;
//! these grow and emit their [`LeafSurface`].
//! Children of a trunk are branches again, unless they are of the last level. All others come in
//! batches of [`Twigs`], one for each branch and level, with their surface and their own children
//! or leaves; trunks may have [`Roots`]. Stems, segments and leaves are parts of these. Everything below the tree
//! is in tree space: z up, metres.
//!
//! Rules that tell of trees compile them into a [`TreeSurvey`] instead, which asks for the same
//! branches and twigs as ingredients.

use std::sync::Arc;

use glam::{Affine3, Vec2};
use sapwood_geom::{Content, Digester, Shared, SharedMesh, content};
use sapwood_graph::{Named, Part};
use sapwood_images::LeafOutline;
use sapwood_scene::Component;

use super::{Leaf, LeafShape, Segment, Stem, StemSeed, Stems};

/// A tree of the species that the slots above it describe.
///
/// The world is y-up: a tree grows along its own y axis, from the origin of its frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tree {
    /// What tells the tree from others of its species.
    pub seed: Seed,
}

/// Where a tree's random streams start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Seed {
    /// At a number: the same tree wherever it stands.
    Explicit(u64),
    /// At the tree's path in the scene: each occurrence is another tree, and moving it about
    /// changes nothing.
    Path,
    /// At the place in the world where the tree stands, rounded to cells of this many metres:
    /// a tree that is moved further becomes another.
    Position {
        /// Edge length of a cell in metres, above 0.
        cell: f32,
    },
}

impl Content for Seed {
    fn write(&self, digester: &mut Digester) {
        match self {
            Self::Explicit(seed) => digester.add(&0u8).add(seed),
            Self::Path => digester.add(&1u8),
            Self::Position { cell } => digester.add(&2u8).add(cell),
        };
    }
}

content!(Tree { seed });

impl Named for Tree {
    const NAME: &'static str = "tree";
}

impl Component for Tree {}

/// A stem with its clones, and everything that grows on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Branch {
    /// What the stem grows from.
    pub seed: StemSeed,
}

content!(Branch { seed });

impl Named for Branch {
    const NAME: &'static str = "branch";
}

impl Component for Branch {}

/// What grows on stems: the branches or twigs of the next level.
#[derive(Clone, Debug)]
pub struct Children {
    /// The stems that carry the children.
    pub stems: Shared<Stems>,
}

content!(Children { stems });

impl Named for Children {
    const NAME: &'static str = "children";
}

impl Component for Children {}

/// The stems of one level on one branch, in one batch.
#[derive(Clone, Debug)]
pub struct Twigs {
    /// What the stems grow from.
    pub seeds: Shared<Vec<StemSeed>>,
}

content!(Twigs { seeds });

impl Named for Twigs {
    const NAME: &'static str = "twigs";
}

impl Component for Twigs {}

/// The roots of trunks.
#[derive(Clone, Debug)]
pub struct Roots {
    /// The trunks that they grow from, among other stems.
    pub stems: Shared<Stems>,
}

content!(Roots { stems });

impl Named for Roots {
    const NAME: &'static str = "roots";
}

impl Component for Roots {}

/// The surface of stems.
#[derive(Clone, Debug)]
pub struct StemSurface {
    /// The stems.
    pub stems: Shared<Stems>,
}

content!(StemSurface { stems });

impl Named for StemSurface {
    const NAME: &'static str = "stem_surface";
}

impl Component for StemSurface {}

/// The leaves on stems of the last level.
#[derive(Clone, Debug)]
pub struct Leaves {
    /// The stems that carry the leaves.
    pub stems: Shared<Stems>,
}

content!(Leaves { stems });

impl Named for Leaves {
    const NAME: &'static str = "leaves";
}

impl Component for Leaves {}

/// A tree as a whole, for rules that tell of it instead of drawing it.
#[derive(Clone, Debug)]
pub struct TreeSurvey {
    /// What tells the tree from others of its species.
    pub seed: Seed,
    /// What its trunks grow from.
    pub trunks: Shared<Vec<StemSeed>>,
}

content!(TreeSurvey { seed, trunks });

impl Named for TreeSurvey {
    const NAME: &'static str = "tree_survey";
}

impl Component for TreeSurvey {}

/// An ingredient: branches, with everything that grows on them.
#[derive(Clone, Debug)]
pub struct SurveyedBranches {
    /// What each of them grows from.
    pub seeds: Shared<Vec<StemSeed>>,
}

content!(SurveyedBranches { seeds });

impl Named for SurveyedBranches {
    const NAME: &'static str = "surveyed_branches";
}

impl Component for SurveyedBranches {}

/// An ingredient: everything that grows on stems.
#[derive(Clone, Debug)]
pub struct SurveyedGrowth {
    /// The stems.
    pub stems: Shared<Stems>,
}

content!(SurveyedGrowth { stems });

impl Named for SurveyedGrowth {
    const NAME: &'static str = "surveyed_growth";
}

impl Component for SurveyedGrowth {}

/// What leaves look like where they have grown.
#[derive(Clone, Debug)]
pub struct LeafSurface {
    /// The stems that carry the leaves.
    pub stems: Shared<Stems>,
    /// Where each leaf sits on its stem: [`LeafPlaces::places`](super::LeafPlaces::places).
    pub places: Shared<Vec<Affine3>>,
    /// The stem of each leaf, an index into `stems`.
    pub on: Arc<[u32]>,
}

impl Content for LeafSurface {
    fn write(&self, digester: &mut Digester) {
        // Which stem carries which leaf follows from what the places follow from.
        digester.add(&self.stems).add(&self.places);
    }
}

impl Named for LeafSurface {
    const NAME: &'static str = "leaf_surface";
}

impl Component for LeafSurface {}

/// The meshes of one leaf; an ingredient of all leaves that look the same.
#[derive(Clone, Debug, PartialEq)]
pub struct LeafModel {
    /// The shape.
    pub shape: LeafShape,
    /// The outline that its image cuts out of it, if one does.
    pub outline: Option<LeafOutline>,
    /// What is drawn instead of the shape, one long: a mesh of somebody's own, or the card of an
    /// image.
    pub mesh: Option<SharedMesh>,
    /// Where on its texture the triangle lies that stands for it from afar.
    pub spot: Vec2,
    /// Its length in metres, without the petiole.
    pub length: f32,
    /// Its width in metres.
    pub width: f32,
    /// The length of its petiole in metres.
    pub petiole: f32,
}

content!(LeafModel { shape, outline, mesh, spot, length, width, petiole });

impl Named for LeafModel {
    const NAME: &'static str = "leaf_model";
}

impl Component for LeafModel {}

impl Named for Stem {
    const NAME: &'static str = "stem";
}

impl Part for Stem {}

impl Named for Segment {
    const NAME: &'static str = "segment";
}

impl Part for Segment {}

impl Named for Leaf {
    const NAME: &'static str = "leaf";
}

impl Part for Leaf {}
