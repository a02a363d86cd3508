//! Step 7 of `docs/writing-rules.md`, which prints this file.

use std::error::Error;
use std::sync::Arc;

use sapwood::geom::{Shared, SharedMesh, content};
use sapwood::graph::{Material, Named, Shown};
use sapwood::scene::{
    Attribute, Component, Context, Group, Held, Rule, RuleError, RuleSet, Scene, Slot,
};

use super::building_code::compiled;
use super::flight::{outline, slab};
use super::rule_set;
use super::rules::{Flight, Tread};
use super::staircase::Staircase;

/// What treads are made of: pine and oak, in some proportion.
#[derive(Clone, Copy, Debug)]
pub struct Timber {
    pub oak: f32,
}

content!(Timber { oak });

impl Named for Timber {
    const NAME: &'static str = "timber";
}

impl Component for Timber {}

/// How many coats of varnish wood has.
pub enum Varnish {}

impl Slot for Varnish {
    type Value = u32;
    type Rate = Held;
    const NAME: &'static str = "varnish";

    fn default() -> u32 {
        1
    }
}

pub struct TimberRule;

impl Rule for TimberRule {
    type Component = Timber;
    type Data = Arc<Material>;
    const NAME: &'static str = "timber";

    fn init(&self, timber: &Timber, cx: &mut Context<'_>) -> Result<Arc<Material>, RuleError> {
        let light = 0.9 / (1.0 + *cx.read::<Varnish>() as f32);
        let [red, green, blue] = [0.9, 0.6, 0.3].map(|pine| light * (pine - 0.2 * timber.oak));
        Ok(Arc::new(Material::matte("timber", red, green, blue)))
    }
}

/// Treads of timber, and nothing else.
pub struct BoardsRule;

impl Rule for BoardsRule {
    type Component = Flight;
    type Data = ();
    const NAME: &'static str = "boards";

    fn init(&self, flight: &Flight, cx: &mut Context<'_>) -> Result<(), RuleError> {
        let timber = cx.ingredient::<Arc<Material>>(Timber { oak: 0.75 })?;
        let board = slab(&outline(flight, 6), 0.04);
        cx.reserve_triangles(board.n_triangles() as u64 * u64::from(flight.n_steps))?;
        let places = (0..flight.n_steps).map(|i| flight.place(i as f32)).collect();
        cx.instances(SharedMesh::new(board), Arc::clone(timber), Shared::new(places));
        cx.shows(Shown::each::<Tread>());
        Ok(())
    }
}

#[test]
fn all_flights_share_their_timber() -> Result<(), Box<dyn Error>> {
    let rules = RuleSet::new().with(TimberRule).with(BoardsRule).over(&rule_set::rules());
    let mut scene = Scene::new();
    scene.set_check_mode(true);
    scene.set_logging(true);
    let town = scene.add(Group);
    scene.add_to(town, Staircase { height: 2.8, ..Staircase::default() })?;
    let school = scene.add_to(town, Attribute::new().with::<Varnish>(1))?;
    scene.add_to(school, Staircase::default())?;
    let view = scene.open_view(town, &rules.over(&sapwood::standard_rules()))?;
    scene.bounds(view)?;
    let kinds = ["group", "staircase", "attribute", "flight", "timber", "staircase", "flight"];
    assert_eq!(compiled(&mut scene), kinds);

    // The rule for timber has read the varnish, so both read it; nothing else did.
    scene.push::<Varnish>(school, 3)?;
    scene.bounds(view)?;
    assert_eq!(compiled(&mut scene), ["attribute", "flight", "timber"]);
    Ok(())
}
