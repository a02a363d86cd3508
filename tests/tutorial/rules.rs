//! Step 2 of `docs/writing-rules.md`, which prints this file.

use std::error::Error;
use std::sync::Arc;

use sapwood::geom::glam::{Affine3, Vec3};
use sapwood::geom::{Shared, SharedMesh, content};
use sapwood::graph::{Material, Named, Part, Shown};
use sapwood::scene::{Component, Context, Rule, RuleError, RuleSet, Scene};

use super::flight::{POLE, bar, outline, slab};
use super::staircase::Staircase;

/// All steps of one staircase.
#[derive(Clone, Copy, Debug)]
pub struct Flight {
    pub n_steps: u32,
    pub rise: f32,
    pub radius: f32,
    pub turn: f32,
}

content!(Flight { n_steps, rise, radius, turn });

impl Named for Flight {
    const NAME: &'static str = "flight";
}

impl Component for Flight {}

/// A step, for whoever asks about steps and not about triangles.
#[derive(Clone, Copy, Debug)]
pub struct Tread {
    /// The front edge on the walking line, in the staircase's frame.
    pub edge: Vec3,
    /// How much higher it is than the one before.
    pub rise: f32,
}

content!(Tread { edge, rise });

impl Named for Tread {
    const NAME: &'static str = "tread";
}

impl Part for Tread {}

/// Adds a flight and its treads.
pub fn lay(flight: Flight, cx: &mut Context<'_>) -> Result<(), RuleError> {
    cx.reserve_parts(flight.n_steps.into())?;
    let walking_line = Vec3::X * (0.67 * flight.radius);
    let treads = (0..flight.n_steps).map(|i| {
        let edge = flight.place(i as f32).transform_point3(walking_line);
        Tread { edge, rise: flight.rise }
    });
    cx.parts::<Tread>(treads.collect::<Vec<_>>());
    cx.emit(flight);
    Ok(())
}

pub fn cannot_build(staircase: &Staircase) -> RuleError {
    RuleError::Failed(format!("{staircase:?} cannot be built"))
}

pub struct StaircaseRule;

impl Rule for StaircaseRule {
    type Component = Staircase;
    type Data = ();
    const NAME: &'static str = "staircase";

    fn init(&self, staircase: &Staircase, cx: &mut Context<'_>) -> Result<(), RuleError> {
        let flight = Flight::of(staircase, 0.19);
        lay(flight.ok_or_else(|| cannot_build(staircase))?, cx)
    }
}

pub struct FlightRule;

impl Rule for FlightRule {
    type Component = Flight;
    type Data = ();
    const NAME: &'static str = "flight";

    fn init(&self, flight: &Flight, cx: &mut Context<'_>) -> Result<(), RuleError> {
        draw(flight, true, cx)
    }
}

/// Draws a flight: all of it when it is near, else what is seen from afar.
pub fn draw(flight: &Flight, is_near: bool, cx: &mut Context<'_>) -> Result<(), RuleError> {
    let Flight { n_steps, rise, radius, .. } = *flight;
    let sides = if is_near { 12 } else { 4 };

    let wedge = slab(&outline(flight, sides / 2), 0.04);
    cx.reserve_triangles(wedge.n_triangles() as u64 * u64::from(n_steps))?;
    let places = Shared::new((0..n_steps).map(|i| flight.place(i as f32)).collect::<Vec<_>>());
    let oak = Arc::new(Material::matte("oak", 0.42, 0.25, 0.12));
    cx.instances(SharedMesh::new(wedge), oak, places.clone());
    cx.shows(Shown::each::<Tread>());

    let steel = Arc::new(Material::matte("steel", 0.13, 0.14, 0.16));
    let top = Vec3::Y * (rise * n_steps as f32 + 1.0);
    let pole = bar(&[Vec3::ZERO, top], POLE, sides, 1, cx)?;
    cx.mesh(pole, Arc::clone(&steel));
    if is_near {
        // Balusters begin inside the treads and end inside the rail.
        let half = Affine3::from_rotation_y(0.5 * flight.turn_of_step());
        let foot = half.transform_point3(Vec3::new(radius - 0.04, -0.02, 0.0));
        let head = foot + Vec3::Y * 0.92;
        let baluster = bar(&[foot, head], 0.009, sides, n_steps, cx)?;
        cx.instances(baluster, Arc::clone(&steel), places);
        let along = (0..=4 * (n_steps - 1)).map(|i| flight.place(i as f32 / 4.0));
        let along: Vec<Vec3> = along.map(|place| place.transform_point3(head)).collect();
        let rail = bar(&along, 0.022, sides, 1, cx)?;
        cx.mesh(rail, steel);
    }
    Ok(())
}

#[test]
fn a_staircase_has_treads_a_pole_and_a_rail() -> Result<(), Box<dyn Error>> {
    let rules = RuleSet::new().with(StaircaseRule).with(FlightRule);
    let mut scene = Scene::new();
    let staircase = scene.add(Staircase::default());
    let view = scene.open_view(staircase, &rules.over(&sapwood::standard_rules()))?;
    insta::assert_snapshot!(scene.dump(view, 100)?, @r"
    staircase, 16 tread
        flight
          instances 16 x 32 triangles oak (-0.9629 0.1475 -0.9629)..(0.9629 3 0.9629)
          mesh 52 vertices 48 triangles steel (-0.07 0 -0.07)..(0.07 4 0.07)
          instances 16 x 48 triangles steel (-0.8552 0.1675 -0.8552)..(0.8552 3.9 0.8552)
          mesh 819 vertices 1464 triangles steel (-0.882 1.0684 -0.8814)..(0.865 3.9188 0.8816)
    ");
    assert_eq!(scene.count(view)?.parts_of("tread"), 16);
    for row in &scene.draw_list(view, 100)?.bodies[0].rows {
        assert_eq!(row.mesh.fault(), None);
    }

    scene.edit(staircase, |staircase| staircase.radius = -1.0)?;
    let dump = scene.dump(view, 100)?;
    assert!(dump.starts_with("staircase, error: Staircase { height: 3.0, radius: -1.0"), "{dump}");

    scene.edit(staircase, |staircase| (staircase.radius, staircase.height) = (0.9, 1e9))?;
    let refusal = scene.count(view).map_err(|refusal| refusal.to_string());
    let told = "more than 20000000 parts would be needed; \
                the limit was met in a component of kind staircase";
    assert_eq!(refusal, Err(told.to_owned()));
    Ok(())
}
