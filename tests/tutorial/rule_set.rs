//! Step 6 of `docs/writing-rules.md`, which prints this file.

use std::error::Error;
use std::f32::consts::FRAC_PI_2;

use sapwood::geom::glam::{Affine3, Quat, Vec3};
use sapwood::geom::{Polyline, Shared};
use sapwood::graph::Shown;
use sapwood::scene::{Context, Group, Rule, RuleError, RuleSet, Scene, Transform};

use super::building_code::{StaircaseRule, compiled};
use super::detail::FlightRule;
use super::flight::outline;
use super::rules::{Flight, Tread};
use super::staircase::Staircase;

/// Staircases as solids.
pub fn rules() -> RuleSet {
    RuleSet::new().with(StaircaseRule).with(FlightRule)
}

/// Staircases as the outlines of their treads.
pub fn drawing_rules() -> RuleSet {
    RuleSet::new().with(OutlineRule).over(&rules())
}

pub struct OutlineRule;

impl Rule for OutlineRule {
    type Component = Flight;
    type Data = ();
    const NAME: &'static str = "outline";

    fn init(&self, flight: &Flight, cx: &mut Context<'_>) -> Result<(), RuleError> {
        let corners = outline(flight, 6);
        let closed = || corners.iter().chain(corners.first()).map(|p| Vec3::new(p.x, 0.0, -p.y));
        // Lines have no budget of their own; each piece is asked for as if it were a triangle.
        cx.reserve_triangles(corners.len() as u64 * u64::from(flight.n_steps))?;
        let line = |i: u32| {
            let place = flight.place(i as f32);
            let points: Vec<Vec3> = closed().map(|corner| place.transform_point3(corner)).collect();
            Polyline { radii: vec![0.0; points.len()], points }
        };
        cx.lines(Shared::new((0..flight.n_steps).map(line).collect()));
        cx.shows(Shown::each::<Tread>());
        Ok(())
    }
}

#[test]
fn solids_and_drawing_stay_as_they_are() -> Result<(), Box<dyn Error>> {
    let mut scene = Scene::new();
    scene.set_check_mode(true);
    scene.set_logging(true);
    // Once as it stands, and once with its top turned to the front.
    let sheet = scene.add(Group);
    let front = scene.add_to(sheet, Transform::translation(2.2, 0.0, 0.0))?;
    let turn = Quat::from_rotation_x(FRAC_PI_2);
    let above = Affine3::from_rotation_translation(turn, Vec3::new(0.0, 1.5, 0.0));
    let above = scene.add_to(sheet, Transform(above))?;
    let staircase = scene.add_to(front, Staircase::default())?;
    scene.append(above, staircase)?;

    let solids = scene.open_view(front, &rules().over(&sapwood::standard_rules()))?;
    insta::assert_snapshot!(scene.dump(solids, 100)?, @r"
    transform
      place [1 0 0 | 0 1 0 | 0 0 1 | 2.2 0 0]
          staircase, 16 tread
              flight
                instances 16 x 32 triangles oak (-0.9629 0.1475 -0.9629)..(0.9629 3 0.9629)
                mesh 52 vertices 48 triangles steel (-0.07 0 -0.07)..(0.07 4 0.07)
                instances 16 x 48 triangles steel (-0.8552 0.1675 -0.8552)..(0.8552 3.9 0.8552)
                mesh 819 vertices 1464 triangles steel (-0.882 1.0684 -0.8814)..(0.865 3.9188 0.8816)
    ");
    compiled(&mut scene);
    let drawing = scene.open_view(sheet, &drawing_rules().over(&sapwood::standard_rules()))?;
    insta::assert_snapshot!(scene.dump(drawing, 100)?, @r"
    group
        transform
          place [1 0 0 | 0 1 0 | 0 0 1 | 2.2 0 0]
              staircase, 16 tread
                  flight
                    lines 16 (-0.9 0.1875 -0.9)..(0.9 3 0.9)
        transform
          place [1 0 0 | 0 0 1 | 0 -1 0 | 0 1.5 0]
              staircase, 16 tread
                  flight
                    lines 16 (-0.9 0.1875 -0.9)..(0.9 3 0.9)
    ");
    assert_eq!(compiled(&mut scene), ["group", "transform", "flight"]);

    // The file that `sapwood::io::write_svg` writes of the same list.
    let picture = sapwood::io::svg(&scene.draw_list(drawing, 100)?)?;
    assert_eq!(picture, include_str!("../../docs/staircase.svg"));
    Ok(())
}
