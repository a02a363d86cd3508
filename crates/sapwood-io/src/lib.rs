//! Files in and out: species in TOML and in XML of Arbaro, glTF and PNG in and out, JPEG in, OBJ
//! out and leaves of it in, STL and SVG out, all errors with file and place.
//!
//! The only crate that opens files. It grows nothing: what it writes it is given as a draw list.

mod atomic;
mod error;
mod gltf;
mod obj;
mod own_leaf;
mod parts;
mod png;
mod raster;
mod shape;
mod sound;
mod species;
mod spelling;
mod stl;
mod svg;

pub use self::gltf::{
    Model, ModelNode, ReadLimits, SwayAnimation, Swayed, glb_bytes, gltf_buffer_path, read_gltf,
    swaying_glb_bytes, write_glb, write_gltf,
};
pub use atomic::{FileSet, write_atomically};
pub use error::{Error, ErrorKind, Place};
pub use obj::{obj_image_path, obj_material_path, write_obj};
pub use own_leaf::{read_leaf_image, read_leaf_mesh};
pub use png::write_png;
pub use raster::read_image;
pub use shape::{SHAPES, Shape, ShapeFault};
pub use species::{
    built_in, built_in_names, built_in_text, find_species, parse_species, read_species, suggest,
    write_species,
};
pub use stl::write_stl;
pub use svg::{svg, svg_map, write_svg, write_svg_map};
