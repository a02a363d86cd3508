//! `--billboard`: boards with images of the tree instead of the tree.

use clap::ValueEnum;
use sapwood::picture::{ImpostorLight, ImpostorOptions, Impostors, PictureOptions};
use sapwood::scene::{Attribute, Handle, HeldImpostor, Scene, Style, ViewId};

use super::output::{Format, ListFormat};
use crate::arguments::{Detail, GrowArguments};
use crate::failure::Failure;
use crate::picture::Order;
use crate::watch::Watch;

/// The light that a tree's images are taken in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Light {
    /// That of pictures, which the boards then shine in, whatever light falls on them
    Baked,
    /// White light from all sides: the boards have the tree's own colours, and are lit as boards are
    Even,
}

impl Light {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Baked => "baked",
            Self::Even => "even",
        }
    }
}

/// Refuses boards of what has no surfaces, and files of what boards do not have.
pub(super) fn check(arguments: &GrowArguments, order: Option<&Order>) -> Result<(), Failure> {
    if arguments.billboard.is_none() {
        return Ok(());
    }
    if matches!(arguments.tree.detail, Detail::Skeleton | Detail::Segments) {
        return Err(Failure::usage(
            "--billboard: images are taken of whole trees (accepted: with --detail full or draft)"
                .to_owned(),
        ));
    }
    let has_lines = |format| matches!(format, Format::List(ListFormat::Svg));
    if let Some(output) = arguments.output.iter().find(|output| has_lines(output.format())) {
        return Err(Failure::usage(format!(
            "{}: billboards have no lines (accepted: .glb, .gltf, .obj, .png)",
            output.path().display()
        )));
    }
    if order.and_then(|order| order.style) == Some(Style::Skeleton) {
        return Err(Failure::usage(
            "--style skeleton: billboards have no lines (accepted: another --style)".to_owned(),
        ));
    }
    Ok(())
}

/// A scene that shows boards where the view shows a tree.
pub(super) fn stand_in(
    scene: &mut Scene,
    view: ViewId,
    light: Light,
    order: Option<&Order>,
    watch: &Watch,
) -> Result<(Scene, Handle<Attribute>), Failure> {
    let light = match light {
        Light::Baked => {
            let order = order.map(|order| order.options(0.0));
            let PictureOptions { sun, sky, .. } = order.unwrap_or_default();
            ImpostorLight::Baked { sun, sky }
        }
        Light::Even => ImpostorLight::Even,
    };
    let mut impostors = Impostors::new(ImpostorOptions { light, ..ImpostorOptions::default() });
    let mut supply = scene.supply(view)?;
    let impostor = impostors
        .of(&mut supply, &mut |progress| watch.drawn(progress.n_done, progress.n_pixels))?;
    let mut boards = Scene::new();
    let root = boards.add(Attribute::new());
    boards.add_to(root, HeldImpostor { impostor })?;
    Ok((boards, root))
}
