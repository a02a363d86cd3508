//! Procedural images: components that say what an image shows, generators that need no scene, and
//! the rules that compile the one with the other.

mod bark;
mod cells;
mod color;
mod field;
mod lattice;
mod leaf;
mod noise;
mod painted;
mod ramp;
mod relief;
mod rules;
mod size;

pub use bark::{BarkImage, BarkKind};
pub use leaf::{LeafImage, LeafOutline};
pub use noise::NoiseImage;
pub use painted::{Paint, Painted, PaintedMaterial};
pub use ramp::{Over, RampImage, Stop};
pub use rules::rules;
pub use size::LARGEST_IMAGE;
