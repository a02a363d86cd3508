//! Components of stone. Nobody here knows what traversals there are: rules offer their data as
//! something [`Solid`], and a kind that is hard to describe lets something simpler stand in.

mod rules;

use sapwood::geom::content;
use sapwood::graph::{Fallbacks, Named};
use sapwood::scene::Component;

pub use rules::rules;

/// A wall along x, 0.4 m thick.
#[derive(Clone, Debug)]
pub struct Wall {
    /// Metres along x.
    pub length: f32,
    /// Metres along y.
    pub height: f32,
}

/// A round column.
#[derive(Clone, Debug)]
pub struct Column {
    /// Metres along y.
    pub height: f32,
    /// The radius in metres.
    pub radius: f32,
}

/// What is left of a wall.
#[derive(Clone, Debug)]
pub struct Ruin {
    /// The wall that it was.
    pub of: Wall,
}

content!(Wall { length, height });
content!(Column { height, radius });
content!(Ruin { of });

macro_rules! components {
    ($($component:ty => $name:literal),*) => {$(
        impl Named for $component {
            const NAME: &'static str = $name;
        }
        impl Component for $component {}
    )*};
}
components!(Wall => "wall", Column => "column", Ruin => "ruin");

/// What fills space.
pub trait Solid {
    /// How much of it.
    fn cubic_metres(&self) -> f64;
}

/// A block with right angles: what the rule makes of a wall.
#[derive(Clone, Debug)]
pub struct Block {
    /// Metres along x, y and z.
    pub size: [f32; 3],
}

content!(Block { size });

impl Solid for Block {
    fn cubic_metres(&self) -> f64 {
        self.size.iter().map(|edge| f64::from(*edge)).product()
    }
}

/// For traversals that know nothing of ruins: as a block of half the size of what is drawn.
pub fn fallbacks() -> Fallbacks {
    Fallbacks::new().with::<Ruin, Block>(|plan| {
        let drawn = (0..plan.fragment.len()).filter_map(|node| plan.fragment.drawn_bound(node));
        let sizes = drawn.map(|bound| bound.aabb.size().to_array());
        let largest =
            sizes.fold([0.0f32; 3], |a, b| [a[0].max(b[0]), a[1].max(b[1]), a[2].max(b[2])]);
        Block { size: [largest[0], largest[1] / 2.0, largest[2]] }
    })
}
