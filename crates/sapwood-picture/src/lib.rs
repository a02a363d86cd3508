//! Pictures: rays through a render graph, which is compiled only where rays go.
//!
//! A [`Studio`] holds what rays have found of a scene so far. [`Studio::picture`] sends them from
//! a [`PlacedCamera`] in rounds. What lies behind a link that nobody has filled yet stands in the
//! scene as its foreseen bound; a ray that enters it waits, everything waited for is provided as
//! one batch, and the pixels concerned are tried again. Without a foreseen bound there is nothing
//! that a ray could miss, so such links are filled first.
//!
//! Colours are linear while they are reckoned with and sRGB-encoded in the picture. The same
//! scene, camera and options give the same bytes on any number of threads.
//!
//! Lights behind a foreseen bound do not shine, for nobody knows of them; labels and cameras are
//! not drawn. A [`Sheet`] holds many pictures with their captions. [`Impostors`] holds boards with
//! pictures that stand for something from afar. This crate opens no files: the
//! picture is an [`Image`](sapwood_geom::Image).

mod camera;
mod error;
mod film;
mod impostor;
mod lettering;
mod light;
mod options;
mod pattern;
mod placed;
mod rounds;
mod shade;
mod sheet;
mod spot;
mod studio;
mod texture;
mod trace;
mod world;

pub use error::PictureError;
pub use impostor::{ImpostorLight, ImpostorOptions, Impostors};
pub use options::{Background, Ground, PictureOptions, Sky, Sun};
pub use placed::PlacedCamera;
pub use sheet::{Paper, Sheet};
pub use studio::{Picture, Progress, RayCounts, Sight, Studio};
