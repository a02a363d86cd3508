//! How much two pictures differ, and pictures that are kept.

use std::path::{Path, PathBuf};

use sapwood::geom::Image;

/// Pixels along the edge of the squares that are looked at one by one.
const TILE: u32 = 16;

/// The most that pictures which count as equal differ by, on average over all channels.
const MOST: f64 = 2.0 / 255.0;

/// The same over any one square.
const MOST_IN_TILE: f64 = 8.0 / 255.0;

/// How much two pictures differ, as shares of the range of a channel.
#[derive(Debug)]
pub(super) struct Difference {
    /// On average over all.
    mean: f64,
    /// On average over the square where that is most.
    worst_tile: f64,
}

impl Difference {
    /// Of pictures of the same size.
    pub(super) fn of(one: &Image, other: &Image) -> Self {
        assert_eq!((one.width, one.height), (other.width, other.height));
        let columns = one.width.div_ceil(TILE);
        let mut tiles = vec![(0u64, 0u64); (columns * one.height.div_ceil(TILE)) as usize];
        for (i, (a, b)) in one.pixels.iter().zip(&other.pixels).enumerate() {
            let (x, y) = (i as u32 % one.width, i as u32 / one.width);
            let (sum, n) = &mut tiles[(y / TILE * columns + x / TILE) as usize];
            *sum += a.iter().zip(b).map(|(a, b)| u64::from(a.abs_diff(*b))).sum::<u64>();
            *n += 4;
        }
        let share = |sum: u64, n: u64| sum as f64 / n as f64 / 255.0;
        let (sum, n) = tiles.iter().fold((0, 0), |(sum, n), tile| (sum + tile.0, n + tile.1));
        let worst_tile = tiles.iter().map(|(sum, n)| share(*sum, *n)).fold(0.0, f64::max);
        Self { mean: share(sum, n), worst_tile }
    }

    /// Whether the pictures count as equal.
    pub(super) fn is_small(&self) -> bool {
        self.mean <= MOST && self.worst_tile <= MOST_IN_TILE
    }
}

fn kept_path(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../snapshots/pictures");
    folder.join(name).with_extension("png")
}

/// The picture that was kept under a name.
pub(super) fn kept(name: &str) -> Image {
    sapwood::io::read_image(kept_path(name)).unwrap()
}

/// Compares a picture with the one that was kept. With `SAPWOOD_KEEP_PICTURES` set it is kept
/// instead, to be looked at before it is committed.
pub(super) fn check(name: &str, picture: &Image) {
    if std::env::var_os("SAPWOOD_KEEP_PICTURES").is_some() {
        std::fs::create_dir_all(kept_path(name).parent().unwrap()).unwrap();
        sapwood::io::write_png(kept_path(name), picture).unwrap();
        return;
    }
    let difference = Difference::of(&kept(name), picture);
    if !difference.is_small() {
        let seen = std::env::temp_dir().join(format!("sapwood-{name}.png"));
        sapwood::io::write_png(&seen, picture).unwrap();
        panic!("{name}: {difference:?}; what was seen is in {}", seen.display());
    }
}

#[test]
fn differences_are_shares_of_the_range() {
    let black = Image::from_fn(40, 20, |_, _| [0, 0, 0, 255]);
    let spot =
        Image::from_fn(40, 20, |x, y| if x < 16 && y < 16 { [51; 4] } else { [0, 0, 0, 255] });
    assert!(Difference::of(&black, &black).is_small());
    let difference = Difference::of(&black, &spot);
    assert!((difference.worst_tile - (3.0 * 51.0 + 204.0) / 4.0 / 255.0).abs() < 1e-9);
    assert!((difference.mean - difference.worst_tile * 256.0 / 800.0).abs() < 1e-9);
    assert!(!difference.is_small());
}
