//! Ramps: colours in a row, laid across an image, down it, or over noise.

use sapwood_geom::{Content, Digester, Image, Shared, content};
use sapwood_graph::Named;
use sapwood_scene::Component;

use crate::color::{self, Encoded};
use crate::{NoiseImage, size};

/// The most stops of a ramp: no image of 8 bits shows more.
const MOST_STOPS: usize = 256;

/// Colours that pass into each other: compiled to a [`Shared`] [`Image`].
#[derive(Clone, Debug, PartialEq)]
pub struct RampImage {
    /// What the ramp goes along.
    pub over: Over,
    /// The colours, from the beginning to the end: 1 to 256 of them. Before the first and after
    /// the last nothing changes.
    pub stops: Vec<Stop>,
}

/// A colour of a ramp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// Where it is reached, 0 to 1, not before the stop above it in the list.
    pub at: f32,
    /// The colour, linear, each number in 0..=1.
    pub color: [f32; 3],
}

/// What a ramp goes along.
#[derive(Clone, Debug, PartialEq)]
pub enum Over {
    /// From the left edge to the right, in an image of this width and height in pixels; it tiles
    /// where the last colour is the first.
    Across([u32; 2]),
    /// From the upper edge to the lower, in an image of this width and height in pixels.
    Down([u32; 2]),
    /// From where noise is lowest to where it is highest; the noise's own colours do not count.
    Noise(NoiseImage),
}

content!(RampImage { over, stops });
content!(Stop { at, color });

impl Content for Over {
    fn write(&self, digester: &mut Digester) {
        match self {
            Self::Across(size) => digester.add(&0u8).add(size),
            Self::Down(size) => digester.add(&1u8).add(size),
            Self::Noise(noise) => digester.add(&2u8).add(noise),
        };
    }
}

impl Named for RampImage {
    const NAME: &'static str = "ramp_image";
}

impl Component for RampImage {}

impl RampImage {
    /// What is wrong with the ramp, in words, or nothing.
    pub fn fault(&self) -> Option<String> {
        let of_over = match &self.over {
            Over::Across(size) | Over::Down(size) => size::fault_of_both(*size),
            Over::Noise(noise) => noise.fault().map(|fault| format!("noise: {fault}")),
        };
        let n = self.stops.len();
        let of_number = || {
            let is_fine = (1..=MOST_STOPS).contains(&n);
            (!is_fine).then(|| format!("stops are {n}; accepted: 1 to {MOST_STOPS} of them"))
        };
        let of_stops = || {
            let mut before = 0.0;
            self.stops.iter().enumerate().find_map(|(i, stop)| {
                let of_place = size::number_fault(&format!("stop {i} at"), stop.at, before, 1.0);
                before = stop.at;
                of_place.or_else(|| color::fault(&format!("color of stop {i}"), &stop.color))
            })
        };
        of_over.or_else(of_number).or_else(of_stops)
    }

    /// The colours at 0 to 255.
    fn table(&self) -> Vec<[u8; 4]> {
        let stops: Vec<_> = self.stops.iter().map(|s| (s.at, Encoded::of(s.color))).collect();
        let color_at = |place: f32| {
            let next = stops.partition_point(|(at, _)| *at <= place);
            match (next.checked_sub(1).map(|i| stops[i]), stops.get(next).copied()) {
                (Some((from, a)), Some((to, b))) => a.mix(b, (place - from) / (to - from)),
                (Some((_, only)), None) | (None, Some((_, only))) => only,
                (None, None) => Encoded::of([0.0; 3]),
            }
        };
        (0..256).map(|i| color_at(i as f32 / 255.0).pixel(u8::MAX)).collect()
    }

    /// The image.
    ///
    /// # Panics
    /// Where the ramp has a [fault](Self::fault).
    pub fn image(&self) -> Shared<Image> {
        match &self.over {
            Over::Noise(noise) => self.image_over(&noise.grey().image()),
            Over::Across(_) | Over::Down(_) => {
                self.image_over(&Image::from_fn(0, 0, |_, _| [0; 4]))
            }
        }
    }

    /// The image over noise that was made already, from black to white.
    pub(crate) fn image_over(&self, grey: &Image) -> Shared<Image> {
        if let Some(fault) = self.fault() {
            panic!("{fault}");
        }
        let table = self.table();
        let along = |i: u32, n: u32| (u64::from(2 * i + 1) * 255 / u64::from(2 * n)) as usize;
        Shared::new(match self.over {
            Over::Across([width, height]) => {
                Image::from_fn(width, height, |x, _| table[along(x, width)])
            }
            Over::Down([width, height]) => {
                Image::from_fn(width, height, |_, y| table[along(y, height)])
            }
            Over::Noise(_) => Image {
                width: grey.width,
                height: grey.height,
                pixels: grey.pixels.iter().map(|pixel| table[usize::from(pixel[0])]).collect(),
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp(over: Over) -> RampImage {
        let stop = |at, color| Stop { at, color };
        let stops = vec![stop(0.25, [0.0; 3]), stop(0.5, [1.0; 3]), stop(0.75, [1.0, 0.0, 0.0])];
        RampImage { over, stops }
    }

    #[test]
    fn colors_pass_into_each_other_from_stop_to_stop() {
        let image = ramp(Over::Across([9, 2])).image();
        assert_eq!((image.width, image.height, image.fault()), (9, 2, None));
        assert_eq!([image.pixels[0], image.pixels[1]], [[0, 0, 0, 255]; 2]);
        let [red, green, ..] = image.pixels[3];
        assert!(red == green && (120..150).contains(&red), "{red}");
        assert_eq!(image.pixels[8], [255, 0, 0, 255]);
        let down = ramp(Over::Down([2, 9])).image();
        assert_eq!(down.pixels[6], image.pixels[3]);
    }

    #[test]
    fn over_noise_the_ramp_takes_the_place_of_its_colors() {
        let noise = NoiseImage { size: [64; 2], high: [0.0, 0.0, 1.0], ..NoiseImage::default() };
        let image = ramp(Over::Noise(noise.clone())).image();
        assert!(image.pixels.contains(&[0, 0, 0, 255]));
        assert!(image.pixels.iter().all(|pixel| pixel[1] == pixel[2]));
        let other = NoiseImage { high: [1.0; 3], ..noise };
        assert_eq!(image, ramp(Over::Noise(other)).image());
    }

    #[test]
    fn two_stops_at_one_place_are_a_step() {
        let stop = |at, grey| Stop { at, color: [grey; 3] };
        let stops = vec![stop(0.5, 0.0), stop(0.5, 1.0)];
        let image = RampImage { over: Over::Across([2, 1]), stops }.image();
        assert_eq!(image.pixels, [[0, 0, 0, 255], [255, 255, 255, 255]]);
    }

    #[test]
    fn faults_name_the_stop() {
        let mut wrong = ramp(Over::Across([4, 4]));
        assert_eq!(wrong.fault(), None);
        wrong.stops[1].at = 0.1;
        let told = "stop 1 at is 0.1; accepted: a number at least 0.25 and at most 1";
        assert_eq!(wrong.fault().as_deref(), Some(told));
        wrong.stops.clear();
        assert_eq!(wrong.fault().as_deref(), Some("stops are 0; accepted: 1 to 256 of them"));
        let noise = NoiseImage { octaves: 0, ..NoiseImage::default() };
        let told = "noise: octaves is 0; accepted: a whole number from 1 to 16";
        assert_eq!(ramp(Over::Noise(noise)).fault().as_deref(), Some(told));
        assert!(ramp(Over::Down([0, 1])).fault().is_some());
    }
}
