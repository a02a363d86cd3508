//! What is asked of a picture, complete: arguments with what holds where nothing was said.

use sapwood::geom::Aabb;
use sapwood::geom::glam::{Affine3, Mat3, Vec2, Vec3};
use sapwood::graph::{DrawList, Lens};
use sapwood::picture::{Background, Ground, PictureOptions, PlacedCamera, Sun};
use sapwood::scene::Style;

use super::arguments::PictureArguments;
use crate::failure::Failure;

/// Pixels of a picture where nobody says otherwise.
const SIZE: [u32; 2] = [1024, 1024];
/// Samples of a pixel where nobody says otherwise.
const SAMPLES: u32 = 16;
/// Vertical angle of view where nobody says otherwise, in degrees.
const ANGLE: f32 = 30.0;

/// What is asked of a picture.
#[derive(Clone, Debug)]
pub(crate) struct Order {
    /// The look, but for the height of the ground.
    options: PictureOptions,
    /// The style that everything is forced into.
    pub(crate) style: Option<Style>,
    view: View,
    lens: Lens,
    /// Whether somebody asked for that lens.
    has_lens: bool,
    /// How many pictures are taken around the scene, if it is turned.
    turns: Option<u32>,
}

/// Where the camera stands.
#[derive(Clone, Debug)]
enum View {
    /// Where everything is seen, in this direction.
    Fit(Vec3),
    /// At a place, looking at another, or at the middle of everything.
    Placed(Vec3, Option<Vec3>),
    /// Where a camera of the scene stands.
    Through(PlacedCamera),
    /// So many metres from a place, in this direction, looking at the middle of everything; with a
    /// lens that has all of it in view, or the one that is given.
    Range { range: f32, of: Vec3, from: Vec3, has_lens: bool },
}

/// How much room a scene takes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    /// A box around everything.
    pub(crate) aabb: Aabb,
    /// How far anything reaches from the vertical line through the middle of the box.
    pub(crate) girth: f32,
    /// The height that it stands at.
    pub(crate) foot: f32,
}

impl Extent {
    /// As far as the box tells.
    pub(crate) fn of_box(aabb: Aabb, foot: f32) -> Self {
        let half = aabb.size() * 0.5;
        Self { aabb, girth: Vec2::new(half.x, half.z).length(), foot }
    }

    /// No larger than what is drawn.
    pub(crate) fn tightened(self, list: &DrawList) -> Self {
        let middle = self.aabb.center();
        let mut girth = 0.0f32;
        let mut reach = |point: Vec3| {
            let away = point - middle;
            girth = girth.max(Vec2::new(away.x, away.z).length());
        };
        let list = list.as_drawn();
        for (world, row) in list.placed_rows() {
            match &row.instances {
                None => row.mesh.positions.iter().for_each(|p| reach(world.transform_point3(*p))),
                Some(instances) => {
                    let corners = row.mesh.bound().aabb.corners();
                    for instance in instances.iter() {
                        for corner in corners {
                            reach(world.transform_point3(instance.transform_point3(corner)));
                        }
                    }
                }
            }
        }
        for (world, row) in list.placed_lines() {
            let points = row.lines.iter().flat_map(|line| &line.points);
            points.for_each(|p| reach(world.transform_point3(*p)));
        }
        Self { girth: girth.min(self.girth), ..self }
    }
}

impl Order {
    /// What the arguments ask for; `size` where they ask for none.
    pub(crate) fn new(
        arguments: &PictureArguments,
        turns: Option<u32>,
        size: Option<[u32; 2]>,
    ) -> Result<Self, Failure> {
        let vector = |place: [f32; 3]| Vec3::from(place);
        let view = match (arguments.eye, arguments.target) {
            (None, _) => View::Fit(arguments.from.map_or(PlacedCamera::THREE_QUARTER, vector)),
            (Some(eye), target) if target == Some(eye) => {
                let [x, y, z] = eye;
                return Err(Failure::usage(format!(
                    "--target {x},{y},{z}: the eye is there (accepted: any other place)"
                )));
            }
            (Some(eye), target) => View::Placed(vector(eye), target.map(vector)),
        };
        let lens = match (arguments.orthographic, &view) {
            (None, _) => {
                let vertical_angle = arguments.fov.unwrap_or(ANGLE).to_radians();
                Lens::Perspective { vertical_angle }
            }
            (Some(None), View::Placed(..)) => {
                return Err(Failure::usage(
                    "--orthographic: with --eye the height of the picture is needed (accepted: \
                     --orthographic=METRES)"
                        .to_owned(),
                ));
            }
            (Some(Some(height)), View::Fit(_)) => {
                return Err(Failure::usage(format!(
                    "--orthographic={height}: the height follows from what is to be seen \
                     (accepted: --orthographic, or --eye too)"
                )));
            }
            (Some(height), _) => Lens::Orthographic { height: height.unwrap_or(1.0) },
        };
        let options = PictureOptions {
            size: arguments.size.or(size).unwrap_or(SIZE),
            samples: arguments.samples.unwrap_or(SAMPLES),
            sun: Some(Sun {
                toward: arguments.sun.map_or(Sun::default().toward, vector),
                ..Sun::default()
            }),
            ground: arguments.ground.then(Ground::default),
            background: match arguments.transparent {
                true => Background::Transparent,
                false => Background::Sky,
            },
            ..PictureOptions::default()
        };
        let style = arguments.style.map(Style::from);
        let has_lens = arguments.fov.is_some();
        Ok(Self { options, style, view, lens, has_lens, turns })
    }

    /// The same through this camera.
    pub(crate) fn through(self, camera: PlacedCamera) -> Self {
        Self { view: View::Through(camera), ..self }
    }

    /// The same from so many metres away from a place, if any.
    pub(crate) fn at_range(mut self, range: Option<f32>, of: Vec3) -> Self {
        if let (Some(range), &View::Fit(from)) = (range, &self.view) {
            self.view = View::Range { range, of, from, has_lens: self.has_lens };
        }
        self
    }

    /// The look of a picture of something that stands at this height.
    pub(crate) fn options(&self, foot: f32) -> PictureOptions {
        let ground = self.options.ground.map(|ground| Ground { height: foot, ..ground });
        PictureOptions { ground, ..self.options.clone() }
    }

    pub(crate) fn size(&self) -> [u32; 2] {
        self.options.size
    }

    pub(crate) fn is_transparent(&self) -> bool {
        self.options.background == Background::Transparent
    }

    /// How many pictures are taken.
    pub(crate) fn n_pictures(&self) -> u32 {
        self.turns.unwrap_or(1)
    }

    /// Whether pictures are taken from all around.
    pub(crate) fn is_turned(&self) -> bool {
        self.turns.is_some()
    }

    /// The cameras, one for each picture. Where the scene is turned they stand on a circle, and
    /// everything is seen from each.
    pub(crate) fn cameras(&self, extent: &Extent) -> Result<Vec<PlacedCamera>, Failure> {
        let Extent { aabb, girth, .. } = *extent;
        let middle = aabb.center();
        let (first, axis) = match &self.view {
            &View::Fit(from) if self.is_turned() => {
                let around = self.fit_around(&aabb, girth, from)?;
                // Looking from straight above there is no side to begin with.
                let side =
                    if horizontal(from) == Vec2::ZERO { 0.0 } else { horizontal(from).to_angle() };
                (turned(&around, middle, side), middle)
            }
            &View::Fit(from) => (self.fit(&aabb, from)?, middle),
            &View::Placed(eye, target) => {
                if target.is_none() && aabb.is_empty() {
                    return Err(sapwood::picture::PictureError::Empty.into());
                }
                let target = target.unwrap_or(middle);
                (PlacedCamera::look_at(self.lens, eye, target)?, target)
            }
            View::Through(camera) => (camera.clone(), middle),
            &View::Range { range, of, from, has_lens } => {
                let eye = of + from.normalize_or(Vec3::Z) * range;
                let reach = 0.5 * aabb.size().length();
                let lens = match (self.lens, eye.distance(middle)) {
                    (Lens::Perspective { .. }, away) if !has_lens && away > 0.0 => {
                        // Nothing touches the edge; from inside nobody sees all.
                        let seen = 2.0
                            * Vec2::new((away * away - reach * reach).max(0.0).sqrt(), reach)
                                .to_angle();
                        let [width, height] = self.options.size.map(|n| n as f32);
                        let narrow = (seen * 1.05 * (height / width).max(1.0)).max(1e-4);
                        Lens::Perspective { vertical_angle: narrow.min(120f32.to_radians()) }
                    }
                    (lens, _) => lens,
                };
                (PlacedCamera::look_at(lens, eye, middle)?, middle)
            }
        };
        let n = self.n_pictures();
        let angle = |i: u32| std::f32::consts::TAU * i as f32 / n as f32;
        Ok((0..n).map(|i| turned(&first, axis, angle(i))).collect())
    }

    fn fit(&self, aabb: &Aabb, from: Vec3) -> Result<PlacedCamera, Failure> {
        let margin = PlacedCamera::MARGIN;
        Ok(PlacedCamera::fit(aabb, from, self.lens, self.options.size, margin)?)
    }

    /// A camera that sees everything however it is turned about the middle of `aabb`, as steeply
    /// as in the direction `from`, but on the side of +z.
    fn fit_around(&self, aabb: &Aabb, girth: f32, from: Vec3) -> Result<PlacedCamera, Failure> {
        if aabb.is_empty() {
            return self.fit(aabb, from);
        }
        // A box that is as wide and deep as a cylinder around everything.
        let half = Vec3::new(girth, 0.5 * aabb.size().y, girth);
        let around = Aabb { min: aabb.center() - half, max: aabb.center() + half };
        self.fit(&around, Vec3::new(0.0, from.y, horizontal(from).length()))
    }
}

/// The part of a direction that is not up; its angle is that from +z towards +x.
fn horizontal(direction: Vec3) -> Vec2 {
    Vec2::new(direction.z, direction.x)
}

/// The camera, turned about the vertical line through `axis`.
fn turned(camera: &PlacedCamera, axis: Vec3, angle: f32) -> PlacedCamera {
    if angle == 0.0 {
        return camera.clone();
    }
    let turn = Affine3::from_mat3(Mat3::from_rotation_y(angle));
    let about = Affine3::from_translation(axis) * turn * Affine3::from_translation(-axis);
    PlacedCamera { world: about * camera.world, ..camera.clone() }
}
