//! How stone is drawn.

use sapwood::geom::glam::{Affine3, Vec3};
use sapwood::geom::{Cap, Mesh, Ring, Section, SharedMesh, Sweep, SweepOptions};
use sapwood::graph::{Material, Offers};
use sapwood::scene::{Context, Rule, RuleError, RuleSet};

use crate::{Block, Column, Ruin, Solid, Wall};

/// The rules of everything here.
pub fn rules() -> RuleSet {
    RuleSet::new().with(WallRule).with(ColumnRule).with(RuinRule)
}

struct WallRule;

impl Rule for WallRule {
    type Component = Wall;
    type Data = Block;
    const NAME: &'static str = "masonry.wall";

    fn init(&self, wall: &Wall, cx: &mut Context<'_>) -> Result<Block, RuleError> {
        let size = [wall.length, wall.height, 0.4];
        draw(cx, 4, size);
        Ok(Block { size })
    }

    fn interfaces(offers: &mut Offers<Block>) {
        offers.offer::<dyn Solid>(|block| block);
    }
}

struct ColumnRule;

impl Rule for ColumnRule {
    type Component = Column;
    type Data = Column;
    const NAME: &'static str = "masonry.column";

    fn init(&self, column: &Column, cx: &mut Context<'_>) -> Result<Column, RuleError> {
        draw(cx, 24, [2.0 * column.radius, column.height, 2.0 * column.radius]);
        Ok(column.clone())
    }

    fn interfaces(offers: &mut Offers<Column>) {
        offers.offer::<dyn Solid>(|column| column);
    }
}

impl Solid for Column {
    fn cubic_metres(&self) -> f64 {
        std::f64::consts::PI * f64::from(self.radius).powi(2) * f64::from(self.height)
    }
}

struct RuinRule;

impl Rule for RuinRule {
    type Component = Ruin;
    type Data = ();
    const NAME: &'static str = "masonry.ruin";

    fn init(&self, ruin: &Ruin, cx: &mut Context<'_>) -> Result<(), RuleError> {
        draw(cx, 3, [ruin.of.length, ruin.of.height * 0.6, 0.4]);
        Ok(())
    }
}

/// Draws an upright prism that fits into a box on the ground.
fn draw(cx: &mut Context<'_>, sides: u32, [width, height, depth]: [f32; 3]) {
    let rings = [Vec3::ZERO, Vec3::Y * height].map(|center| Ring { center, radius: 0.5 });
    let (section, mut sweep, mut mesh) = (Section::round(sides), Sweep::default(), Mesh::default());
    sweep.lay(&section, &rings, &SweepOptions { base: Cap::Flat, ..SweepOptions::default() });
    sweep.write(&section, &mut mesh);
    let mut fitting = Mesh::default();
    let size = mesh.bound().aabb.size();
    fitting.append(&mesh, &Affine3::from_scale(Vec3::new(width / size.x, 1.0, depth / size.z)));
    cx.mesh(SharedMesh::new(fitting), Material::matte("stone", 0.4, 0.4, 0.38).into());
}
