//! Step 1 of `docs/writing-rules.md`, which prints this file.

use std::error::Error;
use std::f32::consts::TAU;

use sapwood::geom::content;
use sapwood::graph::Named;
use sapwood::scene::{Component, Scene};

/// A spiral staircase: its axis stands on the origin, along +y; the first tread begins at +x.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Staircase {
    /// From floor to floor, in metres.
    pub height: f32,
    /// From the axis to the outer ends of the treads, in metres.
    pub radius: f32,
    /// The angle climbed, in radians; counter-clockwise seen from above where it is positive.
    pub turn: f32,
}

impl Default for Staircase {
    fn default() -> Self {
        Self { height: 3.0, radius: 0.9, turn: TAU }
    }
}

content!(Staircase { height, radius, turn });

impl Named for Staircase {
    const NAME: &'static str = "staircase";
}

impl Component for Staircase {}

#[test]
fn no_rule_serves_the_staircase_yet() -> Result<(), Box<dyn Error>> {
    let mut scene = Scene::new();
    let staircase = scene.add(Staircase::default());
    scene.edit(staircase, |staircase| staircase.height = 2.8)?;

    let view = scene.open_view(staircase, &sapwood::standard_rules())?;
    let found = scene.diagnostics(view, 10)?;
    let messages: Vec<&str> = found.iter().map(|(_, found)| &*found.message).collect();
    assert_eq!(messages, ["the view has no rule for components of kind staircase"]);
    Ok(())
}
