//! From heights to a normal map.

use sapwood_geom::Image;

use crate::field::Field;

/// The normals of a surface with these heights, which repeat as the field does.
///
/// Heights are shares of the image's width, which is also the unit down the image where pixels
/// are square. Red runs right, green up, as in glTF; 128 is zero.
pub(crate) fn normal_map(heights: &Field) -> Image {
    let (width, height) = (heights.width(), heights.height());
    let rows: Vec<&[f32]> = heights.rows().collect();
    let mut pixels = Vec::with_capacity(width * height);
    // Half of what two pixels apart differ, per pixel.
    let steep = 0.5 * width as f32;
    for (y, row) in rows.iter().enumerate() {
        let above = rows[(y + height - 1) % height];
        let below = rows[(y + 1) % height];
        let mut left = row[width - 1];
        for x in 0..width {
            let right = row[if x + 1 == width { 0 } else { x + 1 }];
            let (dx, up) = ((right - left) * steep, (above[x] - below[x]) * steep);
            left = row[x];
            let scale = 127.0 / (dx * dx + up * up + 1.0).sqrt();
            let code = |x: f32| (x * scale + 128.5) as u8;
            pixels.push([code(-dx), code(-up), code(1.0), u8::MAX]);
        }
    }
    Image { width: width as u32, height: height as u32, pixels }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_become_normals() {
        let mut flat = Field::new(4, 4);
        assert_eq!(normal_map(&flat).pixels, vec![[128, 128, 255, 255]; 16]);
        // A bump of a quarter of the width on one pixel: a slope of one half each way.
        flat.update(|x, y, _| if (x, y) == (1, 1) { 0.25 } else { 0.0 });
        let image = normal_map(&flat);
        let at = |x: usize, y: usize| image.pixels[y * 4 + x];
        assert!(at(0, 1)[0] < 100, "the left flank faces left: {:?}", at(0, 1));
        assert!(at(2, 1)[0] > 156 && at(2, 1)[1] == 128);
        assert!(at(1, 0)[1] > 156, "the upper flank faces up: {:?}", at(1, 0));
        assert!(at(1, 2)[1] < 100);
        assert_eq!(at(1, 1), [128, 128, 255, 255]);
    }
}
