//! Images as PNG files.

use sapwood_geom::Image;

/// The bytes of a PNG file; the same image gives the same bytes. The error says what is wrong
/// with the image.
///
/// Coverage is left out where the image covers everything.
pub(crate) fn png_bytes(image: &Image) -> Result<Vec<u8>, String> {
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
    encoder.set_compression(png::Compression::Balanced);
    encoder.set_filter(png::Filter::Adaptive);
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

    fn reread(image: &Image) -> (png::ColorType, Vec<u8>) {
        let bytes = png_bytes(image).unwrap();
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
        assert_eq!(reread(&image), (png::ColorType::Rgba, image.pixels.as_flattened().to_vec()));
    }

    #[test]
    fn full_coverage_is_left_out() {
        let image = Image::from_fn(2, 1, |x, _| [1, 2, x as u8, 255]);
        assert_eq!(reread(&image), (png::ColorType::Rgb, vec![1, 2, 0, 1, 2, 1]));
    }

    #[test]
    fn missing_pixels_are_refused() {
        let image = Image { width: 2, height: 2, pixels: vec![[0; 4]; 3] };
        assert_eq!(png_bytes(&image).unwrap_err(), "3 pixels in an image of 2 x 2");
    }
}
