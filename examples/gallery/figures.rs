//! What the pictures of the gallery show: trees beside each other, each of its species and inside of
//! its envelope.

use std::error::Error;
use std::sync::Arc;

use sapwood::geom::glam::{Affine3, Mat3, Vec2, Vec3};
use sapwood::geom::{Envelope, Mesh, Profile};
use sapwood::graph::Material;
use sapwood::rules::weber_penn::{LeafMesh, Seed, Species, Tree, WrittenMesh};
use sapwood::scene::{EnvelopeSlot, Group, Handle, Scene, Transform};

/// A picture of trees in a row.
pub(super) struct Figure {
    pub(super) name: String,
    pub(super) trees: Vec<Exhibit>,
    /// Metres from one tree to the next.
    pub(super) apart: f32,
}

/// A tree, and what holds it in its own frame.
pub(super) struct Exhibit {
    species: Species,
    envelope: Option<Envelope>,
}

impl Figure {
    /// One tree of a built-in species.
    pub(super) fn of_species(name: &str) -> Result<Self, Box<dyn Error>> {
        let tree = Exhibit { species: sapwood::io::find_species(name)?, envelope: None };
        Ok(Self { name: name.to_owned(), trees: vec![tree], apart: 0.0 })
    }

    fn row(name: &str, apart: f32, trees: impl IntoIterator<Item = Exhibit>) -> Self {
        Self { name: name.to_owned(), trees: trees.into_iter().collect(), apart }
    }

    /// The trees in a scene, side by side.
    pub(super) fn planted(&self) -> Result<(Scene, Handle<Group>), Box<dyn Error>> {
        let mut scene = Scene::new();
        let row = scene.add(Group);
        for (number, Exhibit { species, envelope }) in self.trees.iter().enumerate() {
            let place = Vec3::X * (number as f32 * self.apart);
            let mut attribute = species.attribute();
            // Envelopes stand in the frame of the whole scene.
            let held =
                envelope.clone().map(|e| Envelope::placed(Affine3::from_translation(place), e));
            attribute.set::<EnvelopeSlot>(held);
            let attribute = scene.add_to(row, attribute)?;
            let place = scene.add_to(attribute, Transform(Affine3::from_translation(place)))?;
            scene.add_to(place, Tree { seed: Seed::Explicit(1) })?;
        }
        Ok((scene, row))
    }
}

/// The figures of the thesis that are not pictures of one species.
pub(super) fn of_the_thesis() -> Result<Vec<Figure>, Box<dyn Error>> {
    Ok(vec![attraction()?, flames()?, stems(), halves()?])
}

/// What species may say beyond the paper, one thing more from tree to tree: leaves on boughs, normals
/// that follow the crown, a mesh instead of leaves, roots with few sides.
pub(super) fn beyond_the_paper() -> Result<Figure, Box<dyn Error>> {
    let mut plain = steady("apple")?;
    (plain.scale, plain.ratio, plain.leaves.scale) = (5.0, 0.03, 0.22);
    (plain.level[1].branches, plain.level[2].branches, plain.leaves.count) = (20, 12, 18);
    let exhibit = |change: &dyn Fn(&mut Species)| {
        let mut species = plain.clone();
        change(&mut species);
        Exhibit { species, envelope: None }
    };
    let pear = LeafMesh::new(&pear(), Some(Arc::new(Material::matte("pear", 0.62, 0.5, 0.06))))?;
    let bare = |species: &mut Species| (species.levels, species.leaves.count) = (2, 0);
    let trees = [
        exhibit(&|_| ()),
        exhibit(&|leafy| leafy.level[1].leaves = 120),
        exhibit(&|round| round.leaves.roundness = 0.9),
        exhibit(&|laden| {
            let mesh = pear.clone();
            laden.leaves.mesh = Some(WrittenMesh { path: String::new(), mesh });
            (laden.leaves.count, laden.leaves.scale, laden.leaves.scale_x) = (2, 0.3, 1.0);
        }),
        exhibit(&|rooted| {
            bare(rooted);
            (rooted.roots.count, rooted.roots.length, rooted.roots.curve) = (7, 0.3, 6.0);
            (rooted.roots.down_angle, rooted.roots.radius) = (84.0, 0.9);
            for level in &mut rooted.level {
                (level.sides, level.segments) = (Some(5), Some(6));
            }
        }),
    ];
    Ok(Figure::row("beyond", 3.6, trees))
}

/// A pear that hangs along +z from its stalk.
fn pear() -> Mesh {
    const RADII: [f32; 7] = [0.02, 0.05, 0.16, 0.24, 0.34, 0.3, 0.05];
    const SIDES: u32 = 10;
    let mut pear = Mesh::default();
    for (row, radius) in (0..).zip(RADII) {
        let along = row as f32 / (RADII.len() - 1) as f32;
        for side in 0..SIDES {
            let angle = std::f32::consts::TAU * side as f32 / SIDES as f32;
            let normal = Vec3::new(angle.cos(), angle.sin(), 0.0);
            pear.positions.push(normal * radius + Vec3::Z * along);
            pear.normals.push((normal + Vec3::Z * (along - 0.6)).normalize());
            pear.uvs.push(Vec2::new(side as f32 / SIDES as f32, along));
            if row > 0 {
                let (here, next) = (row * SIDES + side, row * SIDES + (side + 1) % SIDES);
                pear.indices.extend([here - SIDES, next - SIDES, next, here - SIDES, next, here]);
            }
        }
    }
    pear
}

/// A built-in species, always of the same size and upright.
fn steady(name: &str) -> Result<Species, Box<dyn Error>> {
    let mut species = Species { scale_v: 0.0, ..sapwood::io::find_species(name)? };
    species.level[0].curve_v = 0.0;
    Ok(species)
}

/// Three tupelos: none, negative and positive attraction.
fn attraction() -> Result<Figure, Box<dyn Error>> {
    let mut tupelo = steady("black_tupelo")?;
    // Bare, for leaves would hide what becomes of the twigs.
    tupelo.leaves.count = 0;
    let trees = [0.0, -8.0, 8.0].map(|attraction_up| Exhibit {
        species: Species { attraction_up, ..tupelo.clone() },
        envelope: None,
    });
    Ok(Figure::row("figure_5_1", 15.0, trees))
}

/// Three aspens, a flame around the lower part, around everything and around the upper part.
fn flames() -> Result<Figure, Box<dyn Error>> {
    let aspen = steady("quaking_aspen")?;
    let flame = upright(Profile {
        base: 2.0,
        top: 15.0,
        width: 1.6,
        peak: 0.4,
        power_low: 0.6,
        power_high: 1.0,
    });
    let middle = 8.5;
    let low = Envelope::union([flame.clone(), above(middle)]);
    let high = Envelope::union([flame.clone(), below(middle)]);
    let trees = [low, flame, high]
        .map(|envelope| Exhibit { species: aspen.clone(), envelope: Some(envelope) });
    Ok(Figure::row("figure_5_2", 6.0, trees))
}

/// Five stems without anything on them.
fn stems() -> Figure {
    let plain = Species { levels: 1, scale: 4.0, ratio: 0.06, flare: 0.0, ..Species::default() };
    let stem = |change: &dyn Fn(&mut Species)| {
        let mut species = plain.clone();
        species.level[0].curve_res = 16;
        change(&mut species);
        Exhibit { species, envelope: None }
    };
    let curved = stem(&|stem| (stem.level[0].curve, stem.level[0].taper) = (70.0, 0.6));
    let round = stem(&|stem| stem.level[0].taper = 2.0);
    let bumpy = stem(&|stem| stem.level[0].taper = 2.7);
    let pointed = stem(&|stem| (stem.level[0].taper, stem.flare) = (1.0, 1.5));
    let lobed = stem(&|stem| {
        (stem.lobes, stem.lobe_depth) = (7, 0.25);
        let level = &mut stem.level[0];
        (level.curve, level.curve_back, level.taper) = (70.0, -90.0, 0.6);
    });
    Figure::row("figure_5_3", 1.6, [curved, round, bumpy, pointed, lobed])
}

/// An aspen that is held narrow below and is free above, and a tupelo the other way round.
fn halves() -> Result<Figure, Box<dyn Error>> {
    let column = |top, width| {
        upright(Profile { base: -1.0, top, width, peak: 0.5, power_low: 0.0, power_high: 0.0 })
    };
    let aspen = Exhibit {
        species: steady("quaking_aspen")?,
        envelope: Some(Envelope::union([column(14.0, 0.8), above(9.0)])),
    };
    let tupelo = Exhibit {
        species: Species { scale: 14.0, ..steady("black_tupelo")? },
        envelope: Some(Envelope::union([column(15.0, 0.8), below(7.0)])),
    };
    Ok(Figure::row("figure_5_4", 7.0, [aspen, tupelo]))
}

/// A solid of revolution with its axis upright, for trees that stand y up.
fn upright(profile: Profile) -> Envelope {
    let turn = Mat3::from_cols(Vec3::X, Vec3::NEG_Z, Vec3::Y);
    Envelope::placed(Affine3::from_mat3(turn), Envelope::revolution(profile))
}

fn above(height: f32) -> Envelope {
    Envelope::half_space(Vec3::NEG_Y, -height)
}

fn below(height: f32) -> Envelope {
    Envelope::half_space(Vec3::Y, height)
}
