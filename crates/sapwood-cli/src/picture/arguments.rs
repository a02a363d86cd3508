//! The arguments that say what a picture is to look like, shared by all commands that make one.
//!
//! Each is a wish or nothing, so that a command can tell when wishes are uttered in vain; what
//! holds where nothing is wished for stands in `order.rs`.

use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, ValueEnum};
use sapwood::scene::Style;

use crate::accepted::{accepted, whole};

/// Largest number of pixels of a picture.
const MOST_PIXELS: u64 = 1 << 26;
/// Most samples of a pixel.
const MOST_SAMPLES: u32 = 4096;
/// Most pictures of one turn.
const MOST_TURNS: u32 = 1000;

/// What a picture is to look like.
#[derive(Args, Clone, Debug, Default, PartialEq)]
#[command(next_help_heading = "Pictures")]
pub(crate) struct PictureArguments {
    /// Width and height in pixels [default: 1024x1024; for each of a family 256x320]
    #[arg(long, value_name = "WxH", value_parser = size, allow_hyphen_values = true)]
    pub(crate) size: Option<[u32; 2]>,
    /// Rays through each pixel: the more, the less grain [default: 16]
    #[arg(long, value_name = "N", value_parser = samples, allow_negative_numbers = true)]
    pub(crate) samples: Option<u32>,
    /// Draw everything in this style
    #[arg(long, value_enum)]
    pub(crate) style: Option<StyleName>,
    /// Look from this direction, y up, from where everything is seen [default: from the right in
    /// front, somewhat above]
    #[arg(
        long,
        value_name = "X,Y,Z",
        value_parser = direction,
        allow_hyphen_values = true,
        conflicts_with = "eye"
    )]
    pub(crate) from: Option<[f32; 3]>,
    /// Look from this place, in metres, y up
    #[arg(long, value_name = "X,Y,Z", value_parser = place, allow_hyphen_values = true)]
    pub(crate) eye: Option<[f32; 3]>,
    /// Look at this place [default: the middle of everything]
    #[arg(
        long,
        value_name = "X,Y,Z",
        value_parser = place,
        allow_hyphen_values = true,
        requires = "eye"
    )]
    pub(crate) target: Option<[f32; 3]>,
    /// Angle of view from the lower to the upper edge of the picture [default: 30]
    #[arg(long, value_name = "DEGREES", value_parser = angle, allow_negative_numbers = true)]
    pub(crate) fov: Option<f32>,
    /// Look along parallel lines; with --eye the height of the picture is needed, in metres
    #[arg(
        long,
        value_name = "HEIGHT",
        num_args = 0..=1,
        require_equals = true,
        value_parser = height,
        conflicts_with = "fov"
    )]
    pub(crate) orthographic: Option<Option<f32>>,
    /// Where the sun stands, y up [default: in front, to the upper left]
    #[arg(long, value_name = "X,Y,Z", value_parser = direction, allow_hyphen_values = true)]
    pub(crate) sun: Option<[f32; 3]>,
    /// Put ground below everything
    #[arg(long, overrides_with = "no_ground")]
    pub(crate) ground: bool,
    /// Put no ground below everything, as by default
    #[arg(long, overrides_with = "ground")]
    pub(crate) no_ground: bool,
    /// Leave out the sky: nothing covers the picture where nothing is
    #[arg(long, conflicts_with = "ground")]
    pub(crate) transparent: bool,
}

/// How many pictures are taken around something.
#[derive(Args, Clone, Debug, Default, PartialEq)]
#[command(next_help_heading = "Pictures")]
pub(crate) struct TurntableArguments {
    /// Take this many pictures, once around the vertical axis, as NAME-000.png, NAME-001.png and
    /// so on
    #[arg(long, value_name = "N", value_parser = turns, allow_negative_numbers = true)]
    pub(crate) turntable: Option<u32>,
}

/// What things are drawn as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum StyleName {
    /// Surfaces
    Solid,
    /// The edges of their triangles
    Wire,
    /// The lines that they were grown along, or else their edges
    Skeleton,
}

impl From<StyleName> for Style {
    fn from(name: StyleName) -> Self {
        match name {
            StyleName::Solid => Self::Solid,
            StyleName::Wire => Self::Wire,
            StyleName::Skeleton => Self::Skeleton,
        }
    }
}

/// A file to write one picture to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct PictureFile(pub(crate) PathBuf);

impl FromStr for PictureFile {
    type Err = &'static str;

    fn from_str(path: &str) -> Result<Self, Self::Err> {
        let path = PathBuf::from(path);
        let is_png = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png"));
        if is_png { Ok(Self(path)) } else { Err("accepted: names that end in .png") }
    }
}

impl PictureArguments {
    /// The name of an argument that was given, if any was.
    pub(crate) fn given(&self) -> Option<&'static str> {
        let Self { size, samples, style, from, eye, target, fov, orthographic, sun, .. } = self;
        let all = [
            (size.is_some(), "--size"),
            (samples.is_some(), "--samples"),
            (style.is_some(), "--style"),
            (from.is_some(), "--from"),
            (eye.is_some(), "--eye"),
            (target.is_some(), "--target"),
            (fov.is_some(), "--fov"),
            (orthographic.is_some(), "--orthographic"),
            (sun.is_some(), "--sun"),
            (self.ground, "--ground"),
            (self.no_ground, "--no-ground"),
            (self.transparent, "--transparent"),
        ];
        all.into_iter().find(|(is_given, _)| *is_given).map(|(_, name)| name)
    }
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let numbers = text.split_once(['x', 'X']);
    let size = numbers.and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    let is_fit = |[w, h]: &[u32; 2]| (1..=MOST_PIXELS).contains(&(u64::from(*w) * u64::from(*h)));
    let told = format!("1x1 and more, as in 1024x768, up to {MOST_PIXELS} pixels together");
    accepted(size, is_fit, told)
}

fn samples(text: &str) -> Result<u32, String> {
    whole(text, 1..=MOST_SAMPLES)
}

fn turns(text: &str) -> Result<u32, String> {
    whole(text, 1..=MOST_TURNS)
}

fn angle(text: &str) -> Result<f32, String> {
    accepted(text.parse().ok(), |angle| (1.0..=170.0).contains(angle), "1 to 170 degrees")
}

fn height(text: &str) -> Result<f32, String> {
    let told = "0.000001 to 1000000000 metres";
    accepted(text.parse().ok(), |height| (1e-6..=1e9).contains(height), told)
}

/// Three finite numbers, in metres.
pub(crate) fn place(text: &str) -> Result<[f32; 3], String> {
    let numbers = text.split(',').map(|number| number.trim().parse::<f32>());
    let numbers: Vec<f32> = numbers.collect::<Result<_, _>>().unwrap_or_default();
    let is_finite = |place: &[f32; 3]| place.iter().all(|x| x.is_finite());
    accepted(numbers.try_into().ok(), is_finite, "three finite numbers, as in 12,0,-3.5")
}

fn direction(text: &str) -> Result<[f32; 3], String> {
    let has_length = |direction: &[f32; 3]| {
        let square: f32 = direction.iter().map(|x| x * x).sum();
        square.is_normal()
    };
    accepted(place(text).ok(), has_length, "three numbers, not all 0, as in 1,0.5,-2")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_three_finite_numbers() {
        assert_eq!(place("1,-2.5, 3e1"), Ok([1.0, -2.5, 30.0]));
        for wrong in ["", "1,2", "1,2,3,4", "1,2,x", "1,2,nan", "inf,0,0", "1e39,0,0", "1;2;3"] {
            let error = place(wrong).unwrap_err();
            assert!(error.starts_with("accepted: three finite numbers"), "{wrong}: {error}");
        }
    }

    #[test]
    fn directions_have_a_length() {
        assert_eq!(direction("0,-0.001,0"), Ok([0.0, -0.001, 0.0]));
        for wrong in ["0,0,0", "1,2", "nan,0,1", "1e-30,0,0", "1e30,0,0"] {
            let error = direction(wrong).unwrap_err();
            assert!(error.starts_with("accepted: three numbers, not all 0"), "{wrong}: {error}");
        }
    }

    #[test]
    fn sizes_are_two_numbers_of_pixels() {
        assert_eq!(size("640x480"), Ok([640, 480]));
        assert_eq!(size("1X67108864"), Ok([1, 67_108_864]));
        for wrong in ["", "640", "0x5", "5x0", "-1x5", "5 x 5", "1.5x2", "8193x8192", "x", "1x2x3"]
        {
            let error = size(wrong).unwrap_err();
            assert!(error.starts_with("accepted: 1x1 and more"), "{wrong}: {error}");
        }
    }

    #[test]
    fn numbers_keep_to_their_ranges() {
        assert_eq!((samples("4096"), turns("1000")), (Ok(4096), Ok(1000)));
        assert_eq!((angle("45.5"), height("12")), (Ok(45.5), Ok(12.0)));
        for wrong in ["0", "-1", "4097", "1.5", "nan", "many"] {
            assert!(samples(wrong).unwrap_err().ends_with("from 1 to 4096"), "{wrong}");
            assert!(turns(wrong).unwrap_err().ends_with("from 1 to 1000"), "{wrong}");
        }
        for wrong in ["0", "-1", "180", "nan", "inf", "wide"] {
            assert_eq!(angle(wrong), Err("accepted: 1 to 170 degrees".to_owned()), "{wrong}");
        }
        for wrong in ["0", "-1", "2e9", "nan", "inf", "high"] {
            assert!(height(wrong).unwrap_err().ends_with("1000000000 metres"), "{wrong}");
        }
    }

    #[test]
    fn pictures_are_png_files() {
        assert_eq!("a/b.PNG".parse(), Ok(PictureFile(PathBuf::from("a/b.PNG"))));
        for wrong in ["", "a", "a.jpg", ".png", "png"] {
            assert!(wrong.parse::<PictureFile>().is_err(), "{wrong}");
        }
    }
}
