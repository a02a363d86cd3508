//! MTL in: colours and images of the materials that an OBJ file names.

use std::path::Path;
use std::sync::Arc;

use sapwood_geom::{FixedSet, Shared, fixed_state};
use sapwood_graph::{Alpha, Material};

use crate::gltf::Folder;
use crate::raster::Raster;
use crate::{Error, ErrorKind, Place, ReadLimits};

/// What a file says of a material.
struct Told {
    read: tobj::Material,
    /// The line of the OBJ file that names that file.
    line: usize,
}

/// The materials of one OBJ file, from the files beside it that it names.
pub(super) struct Library {
    folder: Folder,
    told: Vec<Told>,
    names: FixedSet<String>,
    /// Pixels that images may still have.
    pixels: u64,
}

impl Library {
    /// That of the file at `path`, of which so many bytes were read.
    pub(super) fn beside(path: &Path, n_read: u64, limits: &ReadLimits) -> Self {
        let folder = Folder::of(Some(path), n_read, limits.bytes);
        let (told, names) = (Vec::new(), FixedSet::with_hasher(fixed_state()));
        Self { folder, told, names, pixels: limits.pixels }
    }

    /// Whether a material is called so.
    pub(super) fn knows(&self, name: &str) -> bool {
        self.names.contains(name)
    }

    /// The names of the materials, each with its number. Of equal names, the last counts.
    pub(super) fn names(&self) -> impl ExactSizeIterator<Item = (&str, usize)> {
        self.told.iter().enumerate().map(|(number, told)| (told.read.name.as_str(), number))
    }

    /// Adds the materials of the files that a line names: of one whose name has spaces, or of
    /// several; `words` are those before a comment.
    pub(super) fn read<'a>(
        &mut self,
        names: &str,
        words: impl Iterator<Item = &'a str> + Clone,
        line: usize,
    ) -> Result<(), Error> {
        const AT: &str = "mtllib";
        let mut no_such = match self.folder.read_path(names, AT) {
            Ok(bytes) => return self.add(names, &bytes, line),
            Err(error) => Some(error),
        };
        if words.clone().count() == 1 {
            no_such = None;
        }
        for word in words {
            let bytes = self.folder.read_path(word, AT);
            // Where not even the first is there, one name was meant.
            let bytes = bytes.map_err(|error| no_such.take().unwrap_or(error))?;
            no_such = None;
            self.add(word, &bytes, line)?;
        }
        match no_such {
            Some(error) => Err(error),
            None => Ok(()),
        }
    }

    fn add(&mut self, name: &str, bytes: &[u8], line: usize) -> Result<(), Error> {
        let text = String::from_utf8_lossy(bytes);
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
            self.names.insert(read.name.clone());
            self.told.push(Told { read, line });
        }
        Ok(())
    }

    /// Makes the material of a number, and reads its image.
    pub(super) fn material(&mut self, number: usize) -> Result<Option<Arc<Material>>, Error> {
        let Some(Told { read, line }) = self.told.get(number) else { return Ok(None) };
        let (read, place) = (read.clone(), Place { line: *line, column: 1 });
        let material = self.made(&read).map_err(|error| error.at(place))?;
        Ok(Some(Arc::new(material)))
    }

    /// What is drawn on both sides, for the format knows none that are not.
    fn made(&mut self, read: &tobj::Material) -> Result<Material, Error> {
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
            let bytes = self.folder.read_path(name, "map_Kd")?;
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
