//! MTL in: colours and images of the materials that an OBJ file names.

use std::path::Path;
use std::sync::Arc;

use sapwood_geom::Shared;
use sapwood_graph::{Alpha, Material};

use crate::gltf::Folder;
use crate::raster::Raster;
use crate::{Error, ErrorKind, ReadLimits};

/// A material by its name in the file.
pub(super) struct Named {
    pub(super) name: String,
    pub(super) material: Arc<Material>,
}

impl Named {
    pub(super) fn as_tobj(&self) -> tobj::Material {
        tobj::Material { name: self.name.clone(), ..tobj::Material::default() }
    }
}

/// The materials of one OBJ file, from the files beside it that it names.
pub(super) struct Library {
    folder: Folder,
    named: Vec<Named>,
    n_read: usize,
    /// Pixels that images may still have.
    pixels: u64,
}

impl Library {
    /// That of the file at `path`, of which so many bytes were read.
    pub(super) fn beside(path: &Path, n_read: u64, limits: &ReadLimits) -> Self {
        let folder = Folder::of(Some(path), n_read, limits.bytes);
        Self { folder, named: Vec::new(), n_read: 0, pixels: limits.pixels }
    }

    /// What was read.
    pub(super) fn named(self) -> Vec<Named> {
        self.named
    }

    /// How many files were read.
    pub(super) fn n_read(&self) -> usize {
        self.n_read
    }

    /// Adds the materials of a file.
    pub(super) fn read(&mut self, name: &str) -> Result<(), Error> {
        let bytes = self.folder.read(name, "mtllib")?;
        self.n_read += 1;
        let text = String::from_utf8_lossy(&bytes);
        let mut understood = String::with_capacity(text.len());
        for (number, line) in (1..).zip(text.lines()) {
            let mut words = line.split_whitespace();
            let is_known = match words.next() {
                Some("newmtl" | "map_Kd") => words.next().is_some(),
                Some("Kd") => {
                    let numbers: Vec<f32> = words.map_while(|word| word.parse().ok()).collect();
                    let is_color = numbers.len() >= 3 && numbers.iter().all(|x| x.is_finite());
                    if !is_color {
                        let found = format!("line {number} of {name:?} has no colour");
                        let accepted = "Kd and three numbers".to_owned();
                        let at = "mtllib".to_owned();
                        return Err(Error::new(ErrorKind::Invalid { at, found, accepted }));
                    }
                    true
                }
                Some("Pr") => words.next().is_some_and(|word| word.parse::<f32>().is_ok()),
                _ => false,
            };
            if is_known {
                understood.extend([line.trim(), "\n"]);
            }
        }
        let (materials, _) = tobj::load_mtl_buf(&mut understood.as_bytes()).map_err(|error| {
            let (at, found) = ("mtllib".to_owned(), format!("{name:?} is not valid MTL: {error}"));
            Error::new(ErrorKind::Invalid { at, found, accepted: String::new() })
        })?;
        for read in materials {
            let material = Arc::new(self.material(&read)?);
            self.named.push(Named { name: read.name, material });
        }
        Ok(())
    }

    /// What is drawn on both sides, for the format knows none that are not.
    fn material(&mut self, read: &tobj::Material) -> Result<Material, Error> {
        let [red, green, blue] =
            read.diffuse.unwrap_or([1.0; 3]).map(|share| share.clamp(0.0, 1.0));
        let mut material =
            Material { double_sided: true, ..Material::matte(&read.name, red, green, blue) };
        let roughness = read.unknown_param.get("Pr").and_then(|text| text.parse::<f32>().ok());
        if let Some(roughness) = roughness.filter(|roughness| roughness.is_finite()) {
            material.roughness = roughness.clamp(0.0, 1.0);
        }
        if let Some(name) = &read.diffuse_texture {
            // Options may stand before the name, which then has no spaces.
            let name = match name.strip_prefix('-') {
                Some(options) => options.split_whitespace().last().unwrap_or_default(),
                None => name,
            };
            let bytes = self.folder.read(name, "map_Kd")?;
            let at = format!("map_Kd {name:?}");
            let raster = Raster::of(&bytes).map_err(|fault| fault.into_error(&at))?;
            let found = raster.n_pixels();
            if found > self.pixels {
                let (what, limit) = ("pixels", self.pixels);
                return Err(Error::new(ErrorKind::OverLimit { at, found, what, limit }));
            }
            self.pixels -= found;
            let image = raster.decode().map_err(|fault| fault.into_error(&at))?;
            if image.pixels.iter().any(|pixel| pixel[3] < 128) {
                material.alpha = Alpha::Mask(0.5);
            }
            material.images.base_color = Some(Shared::new(image));
        }
        Ok(material)
    }
}
