//! Step 5 of `docs/writing-rules.md`, which prints this file.

use std::error::Error;

use sapwood::geom::glam::{Affine3, Vec3};
use sapwood::graph::{Approach, Handlers, Interest, Kind, Order};
use sapwood::scene::{RuleSet, Scene, Transform, ViewError, ViewId};

use super::building_code::{BuildingCode, StaircaseRule, compiled};
use super::detail::FlightRule;
use super::rules::{Flight, Tread};
use super::staircase::Staircase;

/// A step that is too high.
pub struct Fault {
    pub edge: Vec3,
    pub rise: f32,
}

struct NoFlights;

impl Interest for NoFlights {
    type State = ();

    fn start(&self) {}

    fn enter(&self, (): &(), child: &Approach<'_>) -> Option<()> {
        (child.kind != Kind::of::<Flight>()).then_some(())
    }
}

/// All steps in a view that are higher than the building code allows, as they stand in the world.
pub fn inspect(scene: &mut Scene, view: ViewId) -> Result<Vec<Fault>, ViewError> {
    let handlers = Handlers::<Vec<Fault>>::new().on_plan::<BuildingCode>(|faults, code, at| {
        for tread in at.plan().parts.of::<Tread>() {
            let rise = at.world().transform_vector3(Vec3::Y * tread.rise).length();
            if rise > code.greatest_rise {
                faults.push(Fault { edge: at.world().transform_point3(tread.edge), rise });
            }
        }
    });
    let mut faults = Vec::new();
    scene.traverse(view, Order::Pre, &NoFlights, &mut |at| handlers.handle(&mut faults, at))?;
    Ok(faults)
}

#[test]
fn a_stretched_staircase_is_too_steep() -> Result<(), Box<dyn Error>> {
    let rules = RuleSet::new().with(StaircaseRule).with(FlightRule);
    let mut scene = Scene::new();
    scene.set_logging(true);
    let stretch = scene.add(Transform(Affine3::from_scale(Vec3::new(1.0, 1.2, 1.0))));
    scene.add_to(stretch, Staircase::default())?;
    let view = scene.open_view(stretch, &rules.over(&sapwood::standard_rules()))?;
    let faults = inspect(&mut scene, view)?;
    assert_eq!(faults.len(), 16);
    let fourth = format!("{:.3} m at {:.2}", faults[3].rise, faults[3].edge);
    assert_eq!(fourth, "0.225 m at [0.23, 0.90, -0.56]");
    assert_eq!(compiled(&mut scene), ["transform", "staircase"]);

    scene.edit(stretch, |stretch| stretch.0 = Affine3::IDENTITY)?;
    assert!(inspect(&mut scene, view)?.is_empty());
    assert_eq!(compiled(&mut scene), ["transform"]);
    Ok(())
}
