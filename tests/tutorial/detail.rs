//! Step 4 of `docs/writing-rules.md`, which prints this file.

use std::error::Error;

use sapwood::geom::glam::Vec3;
use sapwood::scene::{
    Context, DistanceBand, Rule, RuleError, RuleSet, Scene, Transform, Viewpoint,
};

use super::building_code::{StaircaseRule, compiled};
use super::rules::{Flight, draw};
use super::staircase::Staircase;

pub struct FlightRule;

impl Rule for FlightRule {
    type Component = Flight;
    type Data = ();
    const NAME: &'static str = "flight";

    fn init(&self, flight: &Flight, cx: &mut Context<'_>) -> Result<(), RuleError> {
        let (distances, center) = (vec![30.0], Vec3::ZERO);
        let band = cx.project(DistanceBand { distances, hysteresis: 0.1, center });
        draw(flight, band == 0, cx)
    }
}

#[test]
fn a_flight_is_compiled_when_its_band_changes() -> Result<(), Box<dyn Error>> {
    let rules = RuleSet::new().with(StaircaseRule).with(FlightRule);
    let mut scene = Scene::new();
    let place = scene.add(Transform::translation(10.0, 0.0, 0.0));
    scene.add_to(place, Staircase::default())?;
    let view = scene.open_view(place, &rules.over(&sapwood::standard_rules()))?;
    scene.set_held::<Viewpoint>(view, Some(Vec3::ZERO))?;
    scene.set_logging(true);
    for (x, n_triangles, kinds) in [
        (20.0, 2792, &["transform", "staircase", "flight"][..]),
        (29.0, 2792, &["transform"]),
        (31.0, 2792, &["transform"]), // Still within 30 m and a tenth of that.
        (34.0, 272, &["transform", "flight"]),
        (90.0, 272, &["transform"]),
        (20.0, 2792, &["transform"]), // The plan for this band is still there.
    ] {
        scene.edit(place, |place| *place = Transform::translation(x, 0.0, 0.0))?;
        let (_, n_drawn) = scene.draw_list(view, 100)?.n_vertices_and_triangles();
        assert_eq!((n_drawn, &*compiled(&mut scene)), (n_triangles, kinds), "{x} m away");
    }
    scene.set_held::<Viewpoint>(view, Some(Vec3::Y))?;
    scene.bounds(view)?;
    assert!(compiled(&mut scene).is_empty());
    Ok(())
}
