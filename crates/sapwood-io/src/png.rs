//! Images as PNG files.

use std::path::Path;

use sapwood_geom::Image;

use crate::{Error, ErrorKind, FileSet};

/// Writes `image` to the PNG file at `path`, whole or not at all.
///
/// Colours are written as they are, with eight bits for each channel; coverage is left out where
/// the image covers everything. The same image gives the same bytes.
///
/// # Errors
/// When the image has not as many pixels as it should have, or none, and those of
/// [`write_atomically`](crate::write_atomically).
pub fn write_png(path: impl AsRef<Path>, image: &Image) -> Result<(), Error> {
    let mut files = FileSet::new();
    files.add_png(path, image)?;
    files.commit()
}

/// PNG.
impl FileSet {
    /// Adds what [`write_png`] writes.
    ///
    /// # Errors
    /// Those of [`write_png`].
    pub fn add_png(&mut self, path: impl AsRef<Path>, image: &Image) -> Result<(), Error> {
        let path = path.as_ref();
        let bytes = png_bytes(image, Packing::Small).map_err(|reason| {
            Error::new(ErrorKind::UnwritableImage { reason }).in_file(&path.display().to_string())
        })?;
        self.write(path, |out| out.write_all(&bytes))
    }
}

/// What is spared where an image is packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Packing {
    /// Bytes, for images that are looked at as they are.
    Small,
    /// Time, for images that go with a model: some tenths more bytes in a tenth of the time.
    Fast,
}

/// The bytes of a PNG file; the same image gives the same bytes. The error says what is wrong
/// with the image.
///
/// Coverage is left out where the image covers everything.
pub(crate) fn png_bytes(image: &Image, packing: Packing) -> Result<Vec<u8>, String> {
    if let Some(fault) = image.fault() {
        return Err(fault);
    }
    let is_opaque = image.pixels.iter().all(|pixel| pixel[3] == u8::MAX);
    let (color, pixels): (_, Vec<u8>) = if is_opaque {
        let colors = image.pixels.iter().flat_map(|[red, green, blue, _]| [*red, *green, *blue]);
        (png::ColorType::Rgb, colors.collect())
    } else {
        (png::ColorType::Rgba, image.pixels.as_flattened().to_vec())
    };
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, image.width, image.height);
    encoder.set_color(color);
    encoder.set_depth(png::BitDepth::Eight);
    match packing {
        Packing::Small => {
            encoder.set_compression(png::Compression::Balanced);
            encoder.set_filter(png::Filter::Adaptive);
        }
        Packing::Fast => encoder.set_compression(png::Compression::Fast),
    }
    let write = || {
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&pixels)?;
        writer.finish()
    };
    write().map_err(|error| error.to_string())?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reread(image: &Image, packing: Packing) -> (png::ColorType, Vec<u8>) {
        let bytes = png_bytes(image, packing).unwrap();
        let decoder = png::Decoder::new(std::io::Cursor::new(bytes));
        let mut reader = decoder.read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut pixels).unwrap();
        assert_eq!((info.width, info.height), (image.width, image.height));
        (info.color_type, pixels)
    }

    #[test]
    fn pixels_come_back() {
        let image = Image::from_fn(5, 3, |x, y| [x as u8, 50 * y as u8, 7, 255 - x as u8]);
        for packing in [Packing::Small, Packing::Fast] {
            let (color, pixels) = reread(&image, packing);
            assert_eq!(color, png::ColorType::Rgba);
            assert_eq!(pixels, image.pixels.as_flattened(), "{packing:?}");
        }
    }

    #[test]
    fn full_coverage_is_left_out() {
        let image = Image::from_fn(2, 1, |x, _| [1, 2, x as u8, 255]);
        let read = reread(&image, Packing::Small);
        assert_eq!(read, (png::ColorType::Rgb, vec![1, 2, 0, 1, 2, 1]));
    }

    fn check_both_ways(image: &Image) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("image.png");
        write_png(&path, image).unwrap();
        assert_eq!(crate::read_image(&path).unwrap(), *image);
    }

    #[test]
    fn files_come_back() {
        check_both_ways(&Image::from_fn(7, 5, |x, y| [x as u8, 50 * y as u8, 7, 255]));
        check_both_ways(&Image::from_fn(1, 300, |x, y| [x as u8, 5, 7, y as u8]));
    }

    #[test]
    fn a_refused_image_leaves_the_old_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("image.png");
        std::fs::write(&path, "old").unwrap();
        let image = Image { width: 0, height: 2, pixels: Vec::new() };
        let error = write_png(&path, &image).unwrap_err();
        let told = "image.png: the image cannot be written: 0 pixels in an image of 0 x 2";
        assert!(error.to_string().ends_with(told), "{error}");
        assert!(error.is_write());
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
    }

    #[test]
    fn missing_pixels_are_refused() {
        let image = Image { width: 2, height: 2, pixels: vec![[0; 4]; 3] };
        assert_eq!(png_bytes(&image, Packing::Small).unwrap_err(), "3 pixels in an image of 2 x 2");
    }
}
