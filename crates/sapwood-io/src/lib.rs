//! Files in and out: species in TOML and in XML of Arbaro, glTF and SVG out, all errors with file
//! and place.
//!
//! The only crate that opens files. It grows nothing: what it writes it is given as a draw list.

mod atomic;
mod error;
mod glb;
mod species;
mod spelling;
mod svg;

pub use atomic::{FileSet, write_atomically};
pub use error::{Error, ErrorKind, Place};
pub use glb::{glb_bytes, write_glb};
pub use species::{
    built_in, built_in_names, built_in_text, find_species, parse_species, read_species, suggest,
    write_species,
};
pub use svg::{svg, write_svg};
