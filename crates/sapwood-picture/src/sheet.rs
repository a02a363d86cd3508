//! Contact sheets: pictures in rows and columns, each with a line of text below it.

use sapwood_geom::Image;

use crate::lettering::Lettering;

/// A sheet with a title and rows of cells, each a picture with a line of text below it.
#[derive(Clone, Debug)]
pub struct Sheet {
    image: Image,
    cells: Cells,
}

/// Where the cells are.
#[derive(Clone, Copy, Debug)]
struct Cells {
    /// Pixels of a picture.
    size: [u32; 2],
    /// Pixels from one cell to the next.
    pitch: [u32; 2],
    /// Where the first cell begins, from the left and from above.
    start: [u32; 2],
    columns: u32,
    n: u32,
}

/// What a sheet is written on, and with what.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Paper {
    /// The colour of the sheet, sRGB-encoded, with its coverage.
    pub color: [u8; 4],
    /// The colour of letters, sRGB-encoded.
    pub ink: [u8; 3],
}

impl Default for Paper {
    /// Dark grey on white.
    fn default() -> Self {
        Self { color: [255; 4], ink: [50; 3] }
    }
}

/// Width over height that a sheet comes close to.
const ASPECT: f32 = 1.4;

impl Sheet {
    /// A sheet of cells that are empty yet, one for each of `captions`, for pictures of this
    /// size; nothing where it would have more than 2^26 pixels, or none. An empty title takes no
    /// room.
    pub fn new(title: &str, captions: &[String], cell: [u32; 2], paper: Paper) -> Option<Self> {
        let caption = Lettering::small(cell[0]);
        let heading = caption.heading();
        let gap = (caption.height() / 2).max(cell[0] / 32);
        let widest = captions.iter().map(|text| caption.width(text)).max()?.max(cell[0]);
        let pitch = [
            u64::from(widest) + u64::from(gap),
            u64::from(cell[1]) + u64::from(caption.height()) + u64::from(gap),
        ];
        let n_cells = captions.len().try_into().ok()?;
        let columns = columns(n_cells, pitch);
        let rows = n_cells.div_ceil(columns);
        let (top, wide) = match title {
            "" => (gap, 0),
            _ => (2 * gap + heading.height(), heading.width(title)),
        };
        let width = u64::from(gap) + (u64::from(columns) * pitch[0]).max(wide.into());
        let height = u64::from(top) + u64::from(rows) * pitch[1];
        if cell.contains(&0) || width.saturating_mul(height) > 1 << 26 {
            return None;
        }
        let [width, height] = [width, height].map(|pixels| pixels as u32);
        let mut image = Image::from_fn(width, height, |_, _| paper.color);
        heading.write(title, gap, gap, paper.ink, &mut image);
        let pitch = pitch.map(|pixels| pixels as u32);
        let start = [gap + (widest - cell[0]) / 2, top];
        let cells = Cells { size: cell, pitch, start, columns, n: n_cells };
        for (number, text) in (0..).zip(captions) {
            let [left, top] = cells.corner(number);
            // In the middle below the picture.
            let left = left + cell[0] / 2 - caption.width(text) / 2;
            caption.write(text, left, top + cell[1], paper.ink, &mut image);
        }
        Some(Self { image, cells })
    }

    /// Puts a picture into the cell of this number; what does not fit in is left out. Cells that
    /// the sheet has not are none, and images with a fault are no pictures.
    pub fn put(&mut self, number: u32, picture: &Image) {
        if number >= self.cells.n || picture.fault().is_some() {
            return;
        }
        let [left, top] = self.cells.corner(number);
        let width = picture.width.min(self.cells.size[0]) as usize;
        for y in 0..picture.height.min(self.cells.size[1]) {
            let from = y as usize * picture.width as usize;
            let to = (top + y) as usize * self.image.width as usize + left as usize;
            self.image.pixels[to..to + width].copy_from_slice(&picture.pixels[from..from + width]);
        }
    }

    /// How many cells stand side by side.
    pub fn n_columns(&self) -> u32 {
        self.cells.columns
    }

    /// The sheet as it is.
    pub fn image(&self) -> &Image {
        &self.image
    }
}

impl Cells {
    /// The upper left corner of a cell.
    fn corner(&self, number: u32) -> [u32; 2] {
        let [across, down] = [number % self.columns, number / self.columns];
        [self.start[0] + across * self.pitch[0], self.start[1] + down * self.pitch[1]]
    }
}

/// How many cells stand side by side, so that the sheet has about the right aspect and its last
/// row few gaps.
fn columns(n_cells: u32, [width, height]: [u64; 2]) -> u32 {
    let fault = |columns: u32| {
        let rows = n_cells.div_ceil(columns);
        let (w, h) = (width as f32 * columns as f32, height as f32 * rows as f32);
        let aspect = w / h / ASPECT;
        let gaps = (rows * columns - n_cells) as f32 / n_cells as f32;
        aspect.max(1.0 / aspect) + 2.0 * gaps
    };
    // Sheets of thousands of cells have no choice that matters.
    let choice = 1..=n_cells.clamp(1, 4096);
    choice.min_by(|a, b| fault(*a).total_cmp(&fault(*b))).unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sheet(title: &str, n: usize, cell: [u32; 2]) -> Sheet {
        let captions: Vec<String> = (0..n).map(|i| i.to_string()).collect();
        Sheet::new(title, &captions, cell, Paper::default()).unwrap()
    }

    #[test]
    fn pictures_stand_in_their_cells_and_nowhere_else() {
        let mut sheet = sheet("Title", 6, [40, 50]);
        let bare = sheet.image().clone();
        for number in 0..6 {
            sheet.put(number, &Image::from_fn(40, 50, |_, _| [number as u8, 0, 0, 255]));
        }
        sheet.put(6, &Image::from_fn(40, 50, |_, _| [99, 0, 0, 255]));
        let n_of = |color| sheet.image().pixels.iter().filter(|pixel| **pixel == color).count();
        for number in 0..6 {
            assert_eq!(n_of([number, 0, 0, 255]), 40 * 50);
        }
        assert_eq!(n_of([99, 0, 0, 255]), 0);
        let changed = bare.pixels.iter().zip(&sheet.image().pixels).filter(|(a, b)| a != b);
        assert_eq!(changed.count(), 6 * 40 * 50);
        assert_eq!(sheet.n_columns(), 3);
    }

    #[test]
    fn columns_suit_the_number() {
        let check = |n, cell, expected| assert_eq!(sheet("", n, cell).n_columns(), expected, "{n}");
        check(1, [300, 300], 1);
        check(2, [300, 300], 2);
        check(12, [300, 300], 4);
        check(16, [240, 300], 6);
        check(7, [300, 300], 4);
        // Captions are wider than such small pictures.
        check(100, [10, 10], 15);
    }

    #[test]
    fn long_captions_and_titles_make_room() {
        let caption = [u64::MAX.to_string()];
        let sheet = Sheet::new("A long title", &caption, [8, 8], Paper::default()).unwrap();
        assert!(sheet.image().width > Lettering::small(8).width(&caption[0]));
        assert_eq!(sheet.image().fault(), None);
    }

    #[test]
    fn sheets_without_cells_or_of_any_size_are_none() {
        let new = |n, cell| Sheet::new("", &vec![String::new(); n], cell, Paper::default());
        assert!(new(0, [8, 8]).is_none());
        assert!(new(1, [0, 8]).is_none());
        assert!(new(1, [u32::MAX, u32::MAX]).is_none());
        assert!(new(300, [512, 512]).is_none());
        assert!(new(200, [512, 512]).is_some());
    }
}
