//! Step 3 of `docs/writing-rules.md`, which prints this file.

use std::error::Error;

use sapwood::geom::content;
use sapwood::scene::{
    Action, Attribute, Context, Group, Held, Rule, RuleError, RuleSet, Scene, Slot,
};

use super::rules::{Flight, FlightRule, cannot_build, lay};
use super::staircase::Staircase;

/// What is asked of staircases.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BuildingCode {
    /// How high a step may be, in metres.
    pub greatest_rise: f32,
}

content!(BuildingCode { greatest_rise });

/// The building code that holds where a staircase stands.
pub enum BuildingCodeSlot {}

impl Slot for BuildingCodeSlot {
    type Value = BuildingCode;
    type Rate = Held;
    const NAME: &'static str = "building_code";

    fn default() -> BuildingCode {
        BuildingCode { greatest_rise: 0.19 }
    }
}

pub struct StaircaseRule;

impl Rule for StaircaseRule {
    type Component = Staircase;
    type Data = BuildingCode;
    const NAME: &'static str = "staircase";

    fn init(&self, of: &Staircase, cx: &mut Context<'_>) -> Result<BuildingCode, RuleError> {
        let code = *cx.read::<BuildingCodeSlot>();
        let flight = Flight::of(of, code.greatest_rise);
        lay(flight.ok_or_else(|| cannot_build(of))?, cx)?;
        Ok(code)
    }
}

/// The kinds of what was compiled since the log was taken last.
pub fn compiled(scene: &mut Scene) -> Vec<&'static str> {
    let log = scene.take_log();
    let compiled = log.iter().filter(|event| event.action == Action::Compiled);
    compiled.map(|event| event.kind.name()).collect()
}

#[test]
fn an_edit_of_the_code_compiles_what_read_it() -> Result<(), Box<dyn Error>> {
    let rules = RuleSet::new().with(StaircaseRule).with(FlightRule);
    let code = |greatest_rise| BuildingCode { greatest_rise };
    let mut scene = Scene::new();
    scene.set_logging(true);
    let town = scene.add(Group);
    let home = scene.add_to(town, Staircase::default())?;
    let school = scene.add_to(town, Attribute::new().with::<BuildingCodeSlot>(code(0.15)))?;
    scene.add_to(school, Staircase::default())?;
    let view = scene.open_view(town, &rules.over(&sapwood::standard_rules()))?;
    assert_eq!(scene.count(view)?.parts_of("tread"), 16 + 20);
    let kinds = ["group", "staircase", "attribute", "flight", "staircase", "flight"];
    assert_eq!(compiled(&mut scene), kinds);

    // Other steps: the staircase below the attribute is compiled again, and its new flight.
    scene.push::<BuildingCodeSlot>(school, code(0.17))?;
    assert_eq!(scene.count(view)?.parts_of("tread"), 16 + 18);
    assert_eq!(compiled(&mut scene), ["attribute", "staircase", "flight"]);

    // Another code, the same steps: the rule runs, and emits a flight that is there already.
    scene.push::<BuildingCodeSlot>(school, code(0.174))?;
    assert_eq!(scene.count(view)?.parts_of("tread"), 16 + 18);
    assert_eq!(compiled(&mut scene), ["attribute", "staircase"]);

    // The steps of the other staircase: both show one flight.
    scene.push::<BuildingCodeSlot>(school, code(0.19))?;
    assert_eq!(scene.count(view)?.parts_of("tread"), 16 + 16);
    assert_eq!(compiled(&mut scene), ["attribute", "staircase"]);

    // The staircase at home, once more, where it reads what it read there: one plan serves both.
    let annex = scene.add_to(town, Attribute::new().with::<BuildingCodeSlot>(code(0.19)))?;
    scene.append(annex, home)?;
    assert_eq!(scene.count(view)?.parts_of("tread"), 16 + 16 + 16);
    assert_eq!(compiled(&mut scene), ["group", "attribute"]);
    Ok(())
}
