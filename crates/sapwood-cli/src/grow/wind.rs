//! `--wind`: how a tree sways, as an animation in glTF files and as one moment of it elsewhere.

use clap::Args;
use sapwood::graph::{DrawList, Poses, Wind};
use sapwood::io::SwayAnimation;
use sapwood::rules::weber_penn::{self, SwayParams};
use sapwood::scene::{RuleSet, Style};

use super::output::{Format, ListFormat};
use crate::accepted::{accepted, whole};
use crate::arguments::{Detail, GrowArguments};
use crate::failure::Failure;
use crate::picture::Order;

/// The strongest wind, and the strongest gusts, in metres per second.
const STRONGEST: f32 = 30.0;

/// What is said of the wind.
#[derive(Args, Debug)]
pub(crate) struct WindArguments {
    /// Have the tree sway in a wind of this speed with gusts that are so much stronger, in metres
    /// per second, each 0 to 30, as in 5,2: glTF files hold an animation that repeats without a
    /// jump, .obj and .png files one moment of it. Not for .svg files, with --cut, --weld or --range
    #[arg(
        long,
        value_name = "SPEED,GUST",
        value_parser = wind,
        allow_hyphen_values = true,
        conflicts_with_all = ["cut", "weld", "range"],
        help_heading = "Wind"
    )]
    pub(crate) wind: Option<Wind>,
    /// After how many seconds the animation begins again, 0.5 to 600; everything sways a whole number
    /// of times in that, at least once [default: 6]
    #[arg(
        long,
        value_name = "S",
        value_parser = seconds,
        allow_negative_numbers = true,
        requires = "wind",
        help_heading = "Wind"
    )]
    pub(crate) seconds: Option<f32>,
    /// Keyframes for each second of the animation, 1 to 120 [default: 12]
    #[arg(
        long,
        value_name = "N",
        value_parser = keys,
        allow_negative_numbers = true,
        requires = "wind",
        help_heading = "Wind"
    )]
    pub(crate) keys: Option<u32>,
    /// Move at most that many joints in glTF files, 1 to 65534: those that carry things furthest;
    /// what hangs on others rides rigidly on what carries it [default: 255]
    #[arg(
        long,
        value_name = "N",
        value_parser = joints,
        allow_negative_numbers = true,
        requires = "wind",
        help_heading = "Wind"
    )]
    pub(crate) joints: Option<u32>,
    /// Which moment .obj and .png files show, in seconds, 0 to 1000000 [default: 0]
    #[arg(
        long,
        value_name = "S",
        value_parser = time,
        allow_negative_numbers = true,
        requires = "wind",
        help_heading = "Wind"
    )]
    pub(crate) time: Option<f32>,
}

impl WindArguments {
    /// How glTF files move, if anything does.
    pub(super) fn animation(&self) -> Option<SwayAnimation> {
        let animation = SwayAnimation::new(self.wind?, self.seconds.unwrap_or(6.0));
        Some(SwayAnimation {
            keys_per_second: self.keys.map_or(animation.keys_per_second, |keys| keys as f32),
            max_joints: self.joints.map_or(animation.max_joints, |joints| joints as usize),
            ..animation
        })
    }

    /// The rules of trees that sway, if any do, over others.
    pub(super) fn rules(&self, below: RuleSet) -> RuleSet {
        match self.wind {
            Some(_) => weber_penn::swaying().over(&below),
            None => below,
        }
    }

    /// What trees sway by: nothing is cut off from the wind that is asked for.
    pub(super) fn sway(&self) -> SwayParams {
        let most = self.wind.map_or(0.0, |wind| wind.speed + wind.gust);
        let params = SwayParams::default();
        SwayParams { strongest: params.strongest.max(most), ..params }
    }

    /// The list at the moment that is asked for, if anything sways: wherever the tree stands, as
    /// animations have it then.
    pub(super) fn moment(&self, list: &DrawList) -> Option<DrawList> {
        let wind = self.wind?;
        let mut poses = Poses::new(list).in_phases(1);
        poses.update(wind, f64::from(self.time.unwrap_or(0.0)), None);
        Some(poses.posed(list))
    }
}

/// Refuses what has no surface that sways.
pub(super) fn check(arguments: &GrowArguments, order: Option<&Order>) -> Result<(), Failure> {
    let WindArguments { wind, seconds, keys, joints, time } = arguments.wind;
    if wind.is_none() {
        return Ok(());
    }
    if matches!(arguments.tree.detail, Detail::Segments | Detail::Skeleton) {
        return Err(Failure::usage(
            "--wind: surfaces sway, and segments and skeletons do not (accepted: --detail full, \
             --detail draft)"
                .to_owned(),
        ));
    }
    let is_svg = |format| format == Format::List(ListFormat::Svg);
    if let Some(output) = arguments.output.iter().find(|output| is_svg(output.format())) {
        return Err(Failure::usage(format!(
            "--wind: {} holds a skeleton, which does not sway (accepted: .glb and .gltf for an \
             animation, .obj and .png for a moment)",
            output.path().display()
        )));
    }
    if order.is_some_and(|order| order.style == Some(Style::Skeleton)) {
        return Err(Failure::usage(
            "--wind: skeletons do not sway (accepted: another --style)".to_owned(),
        ));
    }
    let is_gltf = |format| matches!(format, Format::List(ListFormat::Glb | ListFormat::Gltf));
    let moves = [("--seconds", seconds.is_some()), ("--keys", keys.is_some())];
    let moves = moves.into_iter().chain([("--joints", joints.is_some())]);
    let in_vain = |says: bool, option: &str, files: &str| match says {
        true => Err(Failure::usage(format!(
            "{option}: there is no file that it is for (accepted: with -o {files})"
        ))),
        false => Ok(()),
    };
    if !arguments.output.iter().any(|output| is_gltf(output.format())) {
        for (option, is_given) in moves {
            in_vain(is_given, option, "FILE.glb or FILE.gltf")?;
        }
    }
    let is_still = arguments.output.iter().any(|output| !is_gltf(output.format()));
    in_vain(time.is_some() && !is_still, "--time", "FILE.obj or FILE.png")
}

/// Two numbers that are no stronger than a gale.
fn wind(text: &str) -> Result<Wind, String> {
    let numbers = text.split(',').map(|number| number.trim().parse::<f32>());
    let numbers: Vec<f32> = numbers.collect::<Result<_, _>>().unwrap_or_default();
    let numbers: Option<[f32; 2]> = numbers.try_into().ok();
    let is_accepted =
        |wind: &Wind| [wind.speed, wind.gust].iter().all(|speed| (0.0..=STRONGEST).contains(speed));
    let told = format!("two numbers, each 0 to {STRONGEST}, as in 5,2");
    accepted(numbers.map(|[speed, gust]| Wind::new(speed, gust)), is_accepted, told)
}

fn seconds(text: &str) -> Result<f32, String> {
    accepted(text.parse().ok(), |seconds| (0.5..=600.0).contains(seconds), "0.5 to 600")
}

fn keys(text: &str) -> Result<u32, String> {
    whole(text, 1..=120)
}

fn joints(text: &str) -> Result<u32, String> {
    whole(text, 1..=65534)
}

fn time(text: &str) -> Result<f32, String> {
    accepted(text.parse().ok(), |time| (0.0..=1e6).contains(time), "0 to 1000000")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn winds_are_two_numbers_of_a_range() {
        assert_eq!(wind("5,2"), Ok(Wind::new(5.0, 2.0)));
        assert_eq!(wind(" 0 , 30"), Ok(Wind::new(0.0, 30.0)));
        for wrong in ["", "5", "5,2,1", "5;2", "-1,0", "31,0", "0,31", "nan,1", "1,inf", "a,b"] {
            let told = "accepted: two numbers, each 0 to 30, as in 5,2";
            assert_eq!(wind(wrong), Err(told.to_owned()), "{wrong}");
        }
    }

    #[test]
    fn times_and_numbers_keep_to_their_ranges() {
        assert_eq!((seconds("0.5"), keys("24"), joints("1")), (Ok(0.5), Ok(24), Ok(1)));
        for wrong in ["0", "601", "nan", "x", "-6"] {
            assert_eq!(seconds(wrong), Err("accepted: 0.5 to 600".to_owned()), "{wrong}");
        }
        assert!(keys("0").is_err() && keys("2.5").is_err() && joints("70000").is_err());
        assert!(time("-1").is_err() && time("3.5") == Ok(3.5));
    }

    #[test]
    fn nothing_is_cut_off_from_the_wind() {
        for wind in [Wind::new(3.0, 0.0), Wind::new(30.0, 30.0), Wind::new(0.0, 30.0)] {
            let none = (None, None, None, None);
            let (seconds, keys, joints, time) = none;
            let arguments = WindArguments { wind: Some(wind), seconds, keys, joints, time };
            let strongest = arguments.sway().strongest;
            assert_eq!(wind.shares(strongest), wind.shares(1e9), "{wind:?}");
        }
    }
}
