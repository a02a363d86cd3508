//! Materials as a `.mtl` file, and their images.
//!
//! Colours are written as they are, linear, which is what Blender takes them for; roughness and
//! metallic as `Pr` and `Pm` of the extension for physically based rendering, and roughness also
//! as `Ns` in the way that Blender turns one into the other.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use sapwood_geom::{Digest, FixedMap, FixedSet, Image, Shared, fixed_state};
use sapwood_graph::{Alpha, Body, DrawList, Material};

use super::{name_of, without_spaces};
use crate::png::{Packing, png_bytes};
use crate::{Error, ErrorKind, parts};

/// Every distinct material of a draw list.
pub(super) struct Materials {
    /// The file with all of them.
    pub(super) text: String,
    /// Every distinct image: its path and its bytes.
    pub(super) images: Vec<(PathBuf, Vec<u8>)>,
    names: FixedMap<Digest, String>,
}

impl Materials {
    /// The materials of everything that has triangles; `path` tells where the image of a number
    /// goes, from 1.
    pub(super) fn of(list: &DrawList, path: impl Fn(usize) -> PathBuf) -> Result<Self, Error> {
        let mut builder = Builder {
            path: &path,
            made: Self {
                text: format!("# Sapwood {}\n", env!("CARGO_PKG_VERSION")),
                images: Vec::new(),
                names: FixedMap::with_hasher(fixed_state()),
            },
            taken: FixedSet::with_hasher(fixed_state()),
            known: FixedMap::with_hasher(fixed_state()),
        };
        for body in &list.bodies {
            for part in parts::parts(body) {
                builder
                    .add(part.material)
                    .map_err(|reason| refused(body, part.material, &reason))?;
            }
        }
        Ok(builder.made)
    }

    pub(super) fn is_empty(&self) -> bool {
        self.names.is_empty()
    }

    /// What a material of the list is called in the file.
    pub(super) fn name(&self, material: &Material) -> &str {
        &self.names[&Digest::of(material)]
    }
}

fn refused(body: &Body, material: &Material, reason: &str) -> Error {
    Error::new(ErrorKind::Unwritable {
        component: body.kind.name().to_owned(),
        reason: format!("material '{}' has {reason}", material.name),
    })
}

/// A channel of an image that becomes an image of its own, and the factor on it.
type Channel = Option<(usize, u32)>;

struct Builder<'a> {
    path: &'a dyn Fn(usize) -> PathBuf,
    made: Materials,
    /// Names that materials have.
    taken: FixedSet<String>,
    /// The file names of images.
    known: FixedMap<(Digest, Channel), String>,
}

impl Builder<'_> {
    fn add(&mut self, material: &Material) -> Result<(), String> {
        let digest = Digest::of(material);
        if self.made.names.contains_key(&digest) {
            return Ok(());
        }
        let lines = self.lines(material)?;
        let name = self.free_name(&material.name);
        // Writing to a text cannot fail.
        let _ = write!(self.made.text, "\nnewmtl {name}\n{lines}");
        self.made.names.insert(digest, name);
        Ok(())
    }

    fn lines(&mut self, material: &Material) -> Result<String, String> {
        let Material { base_color, metallic, roughness, emissive, ref images, .. } = *material;
        let numbers = base_color.iter().chain(&emissive).chain([&metallic, &roughness]);
        if let Some(bad) = numbers.into_iter().find(|number| !number.is_finite()) {
            return Err(format!("a factor of {bad}"));
        }
        let [red, green, blue, coverage] = base_color;
        let coverage = if material.alpha == Alpha::Opaque { 1.0 } else { coverage };
        let smooth = 1.0 - roughness.clamp(0.0, 1.0);
        let mut lines = format!("Kd {red} {green} {blue}\n");
        let mut line = |text: std::fmt::Arguments<'_>| {
            let _ = writeln!(lines, "{text}");
        };
        if emissive != [0.0; 3] {
            let [red, green, blue] = emissive;
            line(format_args!("Ke {red} {green} {blue}"));
        }
        line(format_args!("Ns {}", 900.0 * smooth * smooth));
        line(format_args!("Pr {roughness}\nPm {metallic}\nd {coverage}\nillum 2"));
        if let Some(image) = &images.base_color {
            let file = self.image(image)?;
            line(format_args!("map_Kd {file}"));
            let covers_all = image.pixels.iter().all(|pixel| pixel[3] == u8::MAX);
            if material.alpha != Alpha::Opaque && !covers_all {
                line(format_args!("map_d {file}"));
            }
        }
        if let Some(image) = &images.emissive {
            line(format_args!("map_Ke {}", self.image(image)?));
        }
        if let Some(image) = &images.metallic_roughness {
            line(format_args!("map_Pr {}", self.channel(image, 1, roughness)?));
            line(format_args!("map_Pm {}", self.channel(image, 2, metallic)?));
        }
        if let Some(image) = &images.normal {
            // Blender takes the one for a map of normals, three.js the other.
            let file = self.image(image)?;
            line(format_args!("norm {file}\nmap_Bump {file}"));
        }
        Ok(lines)
    }

    /// The file name of an image.
    fn image(&mut self, image: &Shared<Image>) -> Result<String, String> {
        self.file((image.digest(), None), || png_bytes(image, Packing::Fast))
    }

    /// The file name of one channel of an image times a factor, in grey.
    fn channel(
        &mut self,
        image: &Shared<Image>,
        channel: usize,
        factor: f32,
    ) -> Result<String, String> {
        self.file((image.digest(), Some((channel, factor.to_bits()))), || {
            let grey = |pixel: &[u8; 4]| {
                let value = (f32::from(pixel[channel]) * factor.clamp(0.0, 1.0)).round() as u8;
                [value, value, value, u8::MAX]
            };
            let pixels = image.pixels.iter().map(grey).collect();
            let image = Image { width: image.width, height: image.height, pixels };
            png_bytes(&image, Packing::Fast)
        })
    }

    fn file(
        &mut self,
        key: (Digest, Channel),
        bytes: impl FnOnce() -> Result<Vec<u8>, String>,
    ) -> Result<String, String> {
        if let Some(name) = self.known.get(&key) {
            return Ok(name.clone());
        }
        let path = (self.path)(self.made.images.len() + 1);
        let name = name_of(Path::new(&path));
        self.made.images.push((path, bytes()?));
        self.known.insert(key, name.clone());
        Ok(name)
    }

    /// A name that no other material has.
    fn free_name(&mut self, name: &str) -> String {
        let plain = if name.is_empty() { "material".to_owned() } else { without_spaces(name) };
        let mut free = plain.clone();
        for n in 2.. {
            if self.taken.insert(free.clone()) {
                break;
            }
            free = format!("{plain}.{n}");
        }
        free
    }
}
