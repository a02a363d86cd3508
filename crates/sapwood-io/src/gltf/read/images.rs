//! Images: found and measured one after the other, decoded side by side.

use std::borrow::Cow;

use rayon::prelude::*;
use sapwood_geom::{FixedMap, Image, Shared, fixed_state};

use super::ReadLimits;
use super::buffers::Buffers;
use super::document::{List, invalid};
use super::folder::Folder;
use super::schema;
use crate::raster::Raster;
use crate::{Error, ErrorKind};

/// The images that materials have.
pub(super) struct Images<'a, 'b> {
    buffers: &'b Buffers<'a>,
    folder: &'b mut Folder,
    limit: u64,
    n_pixels: u64,
    found: FixedMap<usize, usize>,
    encoded: Vec<(usize, Cow<'b, [u8]>)>,
}

impl<'a, 'b> Images<'a, 'b> {
    pub(super) fn new(
        buffers: &'b Buffers<'a>,
        folder: &'b mut Folder,
        limits: &ReadLimits,
    ) -> Self {
        let (found, encoded) = (FixedMap::with_hasher(fixed_state()), Vec::new());
        Self { buffers, folder, limit: limits.pixels, n_pixels: 0, found, encoded }
    }

    /// Notes that image `index` is needed by something at `user`.
    pub(super) fn note(&mut self, index: usize, user: &str) -> Result<(), Error> {
        if self.found.contains_key(&index) {
            return Ok(());
        }
        let at = List::Images.entry(index);
        let image: schema::Image<'_> = self.buffers.document.get(List::Images, index, user)?;
        let bytes = match (&image.uri, image.buffer_view) {
            (Some(uri), None) => Cow::Owned(self.folder.read(&uri.0, &format!("{at}.uri"))?),
            (None, Some(view)) => {
                Cow::Borrowed(self.buffers.view(view, &format!("{at}.bufferView"))?.bytes)
            }
            (None, None) => return Err(invalid(at, "it has no bytes", "a URI or a buffer view")),
            (Some(_), Some(_)) => {
                return Err(invalid(at, "a URI and a buffer view", "one of the two"));
            }
        };
        let raster = Raster::of(&bytes).map_err(|fault| fault.into_error(&at))?;
        self.n_pixels = self.n_pixels.saturating_add(raster.n_pixels());
        if self.n_pixels > self.limit {
            let (found, limit) = (self.n_pixels, self.limit);
            let what = "pixels in all images of the scene";
            return Err(Error::new(ErrorKind::OverLimit { at, found, what, limit }));
        }
        self.found.insert(index, self.encoded.len());
        self.encoded.push((index, bytes));
        Ok(())
    }

    /// The pixels of all images, by their numbers.
    pub(super) fn decode(self) -> Result<FixedMap<usize, Shared<Image>>, Error> {
        let decoded: Vec<Result<(usize, Shared<Image>), Error>> = self
            .encoded
            .par_iter()
            .map(|(index, bytes)| {
                let image = Raster::of(bytes).and_then(|raster| raster.decode());
                let image = image.map_err(|fault| fault.into_error(&List::Images.entry(*index)))?;
                Ok((*index, Shared::new(image)))
            })
            .collect();
        let mut images = FixedMap::with_hasher(fixed_state());
        for image in decoded {
            let (index, image) = image?;
            images.insert(index, image);
        }
        Ok(images)
    }
}
