//! Images in: PNG and JPEG, told apart by their first bytes.
//!
//! What an image would take is known from its header, before anything of its size is allocated.

use std::fs::File;
use std::io::{Cursor, Read as _};
use std::path::Path;

use sapwood_geom::Image;
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use crate::spelling::shortened_to;
use crate::{Error, ErrorKind};

/// The longest file that is read.
const LONGEST: u64 = 1 << 30;
/// The most pixels that are read from one file: a gibibyte of them.
const MOST_PIXELS: u64 = 1 << 28;

/// No JPEG packs more pixels than this into a byte: with the coarsest colours 256 of them take six
/// blocks of at least one bit. What claims more has lost its end.
const PIXELS_PER_BYTE: u64 = 512;

/// Deflate packs no more bytes than this into one: two bits, a length and a distance, stand for at
/// most 258 bytes. A PNG that claims more has lost its end.
const INFLATED_PER_BYTE: u64 = 1032;

/// Reads the image at `path`, a PNG or a JPEG of any kind, as eight bits for each channel.
///
/// # Errors
/// When the file cannot be read, is longer than 1 GiB, is neither of the two or a damaged one, or
/// has more than 2^28 pixels; the size is found before the pixels are decoded.
pub fn read_image(path: impl AsRef<Path>) -> Result<Image, Error> {
    read_image_of(path.as_ref(), MOST_PIXELS)
}

/// As [`read_image`], of at most so many pixels.
pub(crate) fn read_image_of(path: &Path, most: u64) -> Result<Image, Error> {
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|file| file.take(LONGEST + 1).read_to_end(&mut bytes))
        .map_err(|cause| Error::read(path, cause))?;
    image_of(&bytes, most).map_err(|error| error.in_file(&path.display().to_string()))
}

fn image_of(bytes: &[u8], limit: u64) -> Result<Image, Error> {
    let length = bytes.len() as u64;
    if length > LONGEST {
        return Err(Error::new(ErrorKind::TooLong { bytes: length, limit: LONGEST }));
    }
    let raster = Raster::of(bytes).map_err(|fault| fault.into_error(""))?;
    if raster.n_pixels() > limit {
        let found = raster.n_pixels();
        let at = "the image".to_owned();
        return Err(Error::new(ErrorKind::OverLimit { at, found, what: "pixels", limit }));
    }
    raster.decode().map_err(|fault| fault.into_error(""))
}

/// An encoded image whose header has been read.
pub(crate) struct Raster<'a> {
    bytes: &'a [u8],
    format: Format,
    width: u32,
    height: u32,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Format {
    Png,
    Jpeg,
}

/// Why bytes are no image: the format that they begin like, and what is wrong with them.
#[derive(Debug)]
pub(crate) struct NoImage {
    /// `None` where they begin like none that is read.
    format: Option<&'static str>,
    reason: String,
}

impl Format {
    fn name(self) -> &'static str {
        match self {
            Self::Png => "PNG",
            Self::Jpeg => "JPEG",
        }
    }

    fn fault(self, reason: impl ToString) -> NoImage {
        NoImage { format: Some(self.name()), reason: reason.to_string() }
    }
}

impl NoImage {
    /// The error about the image at a place in a file, or of the file as a whole.
    pub(crate) fn into_error(self, at: &str) -> Error {
        let found = match self.format {
            Some(format) => format!("not valid {format}: {}", self.reason),
            None => self.reason,
        };
        let accepted = "a PNG or JPEG image".to_owned();
        Error::new(ErrorKind::Invalid { at: at.to_owned(), found, accepted })
    }
}

impl<'a> Raster<'a> {
    /// Looks at the header.
    pub(crate) fn of(bytes: &'a [u8]) -> Result<Self, NoImage> {
        if bytes.starts_with(b"\x89PNG\r\n\x1a\n") {
            return Self::png(bytes);
        }
        if bytes.starts_with(b"\xff\xd8\xff") {
            return Self::jpeg(bytes);
        }
        let reason = match bytes.len() {
            0 => "no bytes".to_owned(),
            n => format!("{n} bytes that begin with {:02x?}", &bytes[..n.min(4)]),
        };
        Err(NoImage { format: None, reason })
    }

    fn png(bytes: &'a [u8]) -> Result<Self, NoImage> {
        let format = Format::Png;
        let mut decoder = png::Decoder::new(Cursor::new(bytes));
        let info = decoder.read_header_info().map_err(|error| format.fault(error))?;
        let raster = Self { bytes, format, width: info.width, height: info.height };
        // In 128 bits, which any size that the header has room for fits.
        let inflated = u128::from(raster.n_pixels()) * info.bits_per_pixel() as u128 / 8;
        if inflated / u128::from(INFLATED_PER_BYTE) > bytes.len() as u128 {
            return Err(raster.too_short());
        }
        Ok(raster)
    }

    fn jpeg(bytes: &'a [u8]) -> Result<Self, NoImage> {
        let format = Format::Jpeg;
        let mut decoder = jpeg_decoder(bytes);
        decoder.decode_headers().map_err(|error| format.fault(one_line(&error)))?;
        let (width, height) = decoder.dimensions().ok_or_else(|| format.fault("no size"))?;
        // The format counts in 16 bits.
        let raster = Self { bytes, format, width: width as u32, height: height as u32 };
        if raster.n_pixels() / PIXELS_PER_BYTE > bytes.len() as u64 {
            return Err(raster.too_short());
        }
        Ok(raster)
    }

    fn too_short(&self) -> NoImage {
        let (n, width, height) = (self.bytes.len(), self.width, self.height);
        self.format.fault(format!("{n} bytes cannot hold {width} x {height} pixels"))
    }

    pub(crate) fn n_pixels(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }

    /// The pixels.
    pub(crate) fn decode(&self) -> Result<Image, NoImage> {
        let pixels = match self.format {
            Format::Png => self.decode_png(),
            Format::Jpeg => self.decode_jpeg(),
        };
        let pixels = pixels.map_err(|reason| self.format.fault(reason))?;
        let image = Image { width: self.width, height: self.height, pixels };
        image.fault().map_or(Ok(image), |fault| Err(self.format.fault(fault)))
    }

    fn decode_png(&self) -> Result<Vec<[u8; 4]>, String> {
        let mut decoder = png::Decoder::new(Cursor::new(self.bytes));
        decoder.set_ignore_text_chunk(true);
        decoder.set_ignore_iccp_chunk(true);
        decoder.set_transformations(
            png::Transformations::EXPAND
                | png::Transformations::STRIP_16
                | png::Transformations::ALPHA,
        );
        let mut reader = decoder.read_info().map_err(|error| error.to_string())?;
        let mut pixels = vec![[0; 4]; self.n_pixels() as usize];
        let expected = match reader.output_color_type() {
            (png::ColorType::Rgba, png::BitDepth::Eight) => pixels.len() * 4,
            (png::ColorType::GrayscaleAlpha, png::BitDepth::Eight) => pixels.len() * 2,
            (color, depth) => return Err(format!("{color:?} of {depth:?} bits")),
        };
        if reader.output_buffer_size() != Some(expected) {
            return Err("its size is not that of its header".to_owned());
        }
        if expected == pixels.len() * 4 {
            reader.next_frame(pixels.as_flattened_mut()).map_err(|error| error.to_string())?;
        } else {
            // They go into the last half and are spread from the front, which never catches up
            // with what is still to be read: a large image takes its own size and no more.
            let bytes = pixels.as_flattened_mut();
            let half = bytes.len() / 2;
            reader.next_frame(&mut bytes[half..]).map_err(|error| error.to_string())?;
            for i in 0..half / 2 {
                let (grey, coverage) = (bytes[half + 2 * i], bytes[half + 2 * i + 1]);
                bytes[4 * i..4 * i + 4].copy_from_slice(&[grey, grey, grey, coverage]);
            }
        }
        Ok(pixels)
    }

    fn decode_jpeg(&self) -> Result<Vec<[u8; 4]>, String> {
        let mut decoder = jpeg_decoder(self.bytes);
        decoder.decode_headers().map_err(|error| one_line(&error))?;
        let mut pixels = vec![[0; 4]; self.n_pixels() as usize];
        let bytes = pixels.as_flattened_mut();
        if decoder.output_buffer_size() != Some(bytes.len()) {
            return Err("it has neither one, three nor four channels".to_owned());
        }
        decoder.decode_into(bytes).map_err(|error| one_line(&error))?;
        Ok(pixels)
    }
}

fn jpeg_decoder(bytes: &[u8]) -> JpegDecoder<ZCursor<&[u8]>> {
    // The caller limits the size; the decoder's own limits are those of the format.
    let options = DecoderOptions::new_safe()
        .set_max_width(usize::from(u16::MAX))
        .set_max_height(usize::from(u16::MAX))
        .jpeg_set_out_colorspace(ColorSpace::RGBA);
    JpegDecoder::new_with_options(ZCursor::new(bytes), options)
}

/// The decoder's message, which may have several lines and be long.
fn one_line(error: &impl ToString) -> String {
    shortened_to(120, &error.to_string())
}

#[cfg(test)]
pub(crate) mod jpegs;

/// The check sum of a PNG's chunk, for tests that change one.
#[cfg(test)]
pub(crate) fn check_sum(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |sum, byte| {
        (0..8).fold(sum ^ u32::from(*byte), |sum, _| match sum & 1 {
            1 => sum >> 1 ^ 0xedb8_8320,
            _ => sum >> 1,
        })
    })
}

#[cfg(test)]
mod tests {
    use sapwood_geom::{Purpose, Stream, StreamPath};

    use super::*;

    fn image_of(bytes: &[u8]) -> Result<Image, Error> {
        super::image_of(bytes, MOST_PIXELS)
    }

    /// A file of this kind.
    fn encoded(color: png::ColorType, depth: png::BitDepth, data: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 2, 1);
        encoder.set_color(color);
        encoder.set_depth(depth);
        if color == png::ColorType::Indexed {
            encoder.set_palette(vec![1, 2, 3, 4, 5, 6]);
            encoder.set_trns(vec![7]);
        }
        encoder.write_header().unwrap().write_image_data(data).unwrap();
        bytes
    }

    #[test]
    fn every_kind_of_png_is_read() {
        use png::{BitDepth, ColorType};
        let check = |color, depth, data: &[u8], expected: [[u8; 4]; 2]| {
            let image = image_of(&encoded(color, depth, data)).unwrap();
            assert_eq!(image.pixels, expected, "{color:?} {depth:?}");
        };
        let grey = [[0, 0, 0, 255], [255, 255, 255, 255]];
        check(ColorType::Grayscale, BitDepth::One, &[0b0100_0000], grey);
        check(ColorType::Grayscale, BitDepth::Sixteen, &[0, 9, 255, 9], grey);
        check(ColorType::Rgb, BitDepth::Eight, &[0, 0, 0, 255, 255, 255], grey);
        let seen = [[9, 9, 9, 1], [8, 8, 8, 2]];
        check(ColorType::GrayscaleAlpha, BitDepth::Eight, &[9, 1, 8, 2], seen);
        let of_palette = [[4, 5, 6, 255], [1, 2, 3, 7]];
        check(ColorType::Indexed, BitDepth::Eight, &[1, 0], of_palette);
    }

    #[test]
    fn a_bomb_is_refused_by_its_header() {
        let mut bytes = encoded(png::ColorType::Grayscale, png::BitDepth::Eight, &[0, 0]);
        bytes[16..24].copy_from_slice(&[0, 1, 0, 0, 0, 1, 0, 0]);
        let sum = check_sum(&bytes[12..29]);
        bytes[29..33].copy_from_slice(&sum.to_be_bytes());
        let error = image_of(&bytes).unwrap_err().to_string();
        let n = bytes.len();
        let told = format!("not valid PNG: {n} bytes cannot hold 65536 x 65536 pixels");
        assert_eq!(error, format!("{told} (accepted: a PNG or JPEG image)"));
        // With as many bytes as it would take, it is refused for its size.
        bytes.resize((1 << 32) / 1032, 0);
        let error = image_of(&bytes).unwrap_err().to_string();
        assert_eq!(error, "the image: 4294967296 pixels; at most 268435456 are read");
        bytes.pop();
        assert!(image_of(&bytes).unwrap_err().to_string().starts_with("not valid PNG: "));
    }

    #[test]
    fn the_most_tightly_packed_png_is_read() {
        for (color, depth, row) in [
            (png::ColorType::Grayscale, png::BitDepth::One, 512),
            (png::ColorType::Grayscale, png::BitDepth::Eight, 4096),
            (png::ColorType::Rgba, png::BitDepth::Sixteen, 32_768),
        ] {
            let mut bytes = Vec::new();
            let mut encoder = png::Encoder::new(&mut bytes, 4096, 512);
            encoder.set_color(color);
            encoder.set_depth(depth);
            encoder.set_compression(png::Compression::High);
            encoder.set_filter(png::Filter::NoFilter);
            let data = vec![0; row * 512];
            encoder.write_header().unwrap().write_image_data(&data).unwrap();
            let image = image_of(&bytes).unwrap();
            assert_eq!((image.width, image.height), (4096, 512), "{color:?} {depth:?}");
        }
    }

    #[test]
    fn grey_pixels_stay_in_their_order() {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 7, 3);
        encoder.set_color(png::ColorType::GrayscaleAlpha);
        let data: Vec<u8> = (0..42).collect();
        encoder.write_header().unwrap().write_image_data(&data).unwrap();
        let expected: Vec<_> = (0..21).map(|i| [2 * i, 2 * i, 2 * i, 2 * i + 1]).collect();
        assert_eq!(image_of(&bytes).unwrap().pixels, expected);
    }

    #[test]
    fn jpegs_of_one_and_of_several_scans_are_read() {
        let near = |pixel: [u8; 4], expected: [u8; 4]| {
            let apart = pixel.iter().zip(expected).map(|(a, b)| a.abs_diff(b));
            assert!(apart.max() <= Some(6), "{pixel:?} {expected:?}");
        };
        let check = |bytes: &[u8], left, right| {
            let image = image_of(bytes).unwrap();
            assert_eq!((image.width, image.height), (16, 8));
            near(image.pixels[2 * 16 + 2], left);
            near(image.pixels[5 * 16 + 12], right);
        };
        check(jpegs::BASELINE, [200, 40, 20, 255], [20, 60, 200, 255]);
        check(jpegs::PROGRESSIVE, [200, 40, 20, 255], [20, 60, 200, 255]);
        check(jpegs::GREY, [86, 86, 86, 255], [64, 64, 64, 255]);
    }

    #[test]
    fn a_jpeg_with_more_pixels_than_its_bytes_can_hold_is_refused() {
        let mut bytes = jpegs::BASELINE.to_vec();
        let size = bytes.windows(2).position(|marker| marker == [0xff, 0xc0]).unwrap() + 5;
        bytes[size..size + 4].fill(0xff);
        let error = image_of(&bytes).unwrap_err().to_string();
        let told = "bytes cannot hold 65535 x 65535 pixels (accepted: a PNG or JPEG image)";
        assert!(error.starts_with("not valid JPEG: ") && error.ends_with(told), "{error}");
    }

    #[test]
    fn damaged_images_are_read_or_refused() {
        let png = encoded(png::ColorType::Indexed, png::BitDepth::Eight, &[1, 0]);
        let mut stream = Stream::new(StreamPath::new(3), Purpose("damage"));
        let mut pick = |n: usize| (stream.bits() % n as u64) as usize;
        let read = |bytes: &[u8]| match image_of(bytes) {
            Ok(image) => assert_eq!(image.fault(), None),
            Err(error) => assert!(error.to_string().len() < 300, "{error}"),
        };
        for whole in [jpegs::BASELINE, jpegs::PROGRESSIVE, jpegs::GREY, &png] {
            (0..whole.len()).for_each(|n| read(&whole[..n]));
            for _ in 0..2000 {
                let mut bytes = whole.to_vec();
                for _ in 0..=pick(3) {
                    let at = pick(bytes.len());
                    bytes[at] = pick(256) as u8;
                }
                read(&bytes);
            }
        }
    }

    #[test]
    fn what_is_no_image_is_told_so() {
        let check = |bytes: &[u8], expected: &str| {
            let error = image_of(bytes).unwrap_err().to_string();
            assert_eq!(error, format!("{expected} (accepted: a PNG or JPEG image)"));
        };
        check(b"", "no bytes");
        check(b"GIF89a", "6 bytes that begin with [47, 49, 46, 38]");
        let whole = encoded(png::ColorType::Grayscale, png::BitDepth::Eight, &[0, 0]);
        for n in 8..whole.len() {
            let error = image_of(&whole[..n]).map(drop).err().map(|error| error.to_string());
            // The end marker may be missing: the pixels are all there.
            assert!(error.is_none_or(|error| error.starts_with("not valid PNG: ")), "{n}");
        }
    }
}
