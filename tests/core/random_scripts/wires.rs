//! Field connections of the scripts: numbers go from components to fields of others.

use sapwood::scene::{
    Attribute, Component, EditError, Kit, NodeId, PushMode, Scene, Selector, Switch, Transform,
};

use super::kinds::*;
use super::what::{Push, What};
use crate::core::kinds::{Plain, Size};

/// What a connection makes of a number.
#[derive(Clone, Copy, Debug)]
pub(super) struct Drive {
    pub(super) input: &'static str,
    pub(super) add: u32,
    /// The remainder by five at which it panics.
    pub(super) panics_at: Option<u32>,
}

impl Drive {
    /// What goes to the input; nothing where the connection panics.
    pub(super) fn of(&self, number: u32) -> Option<u32> {
        let number = number.wrapping_add(self.add);
        (self.panics_at != Some(number % 5)).then_some(number)
    }
}

/// The inputs of a node that can be driven.
pub(super) fn inputs(what: &What) -> &'static [&'static str] {
    match what {
        What::Plain(_) => &["size"],
        What::Fragile(_) => &["value"],
        What::Transform(_) => &["x", "y"],
        What::Switch(_) => &["on"],
        What::Porch(_) => &["tag"],
        What::Selector(_) => &["shown"],
        What::Attribute(_) => &["size", "tag"],
        _ => &[],
    }
}

/// The number that a node gives to what it drives; nothing where it drives nothing.
pub(super) fn number(what: &What) -> Option<u32> {
    Some(match *what {
        What::Plain(size) => plain_number(size),
        What::Fragile(value) => value,
        What::Transform(transform) => transform_number(&Transform(transform)),
        What::Switch(on) => u32::from(on),
        What::Porch(tag) => tag,
        What::Selector(shown) => shown_number(shown),
        What::Kit(number) => number,
        _ => return None,
    })
}

/// What a driven input makes of a node.
pub(super) fn drive(what: &mut What, input: &str, number: u32) {
    match what {
        What::Plain(size) => *size = driven_size(number),
        What::Fragile(value) => *value = number % 4,
        What::Transform(transform) => move_transform(transform, input, number),
        What::Switch(on) => *on = driven_switch(number),
        What::Porch(tag) => *tag = number % 40,
        What::Selector(shown) => *shown = driven_choice(number),
        What::Attribute(pushes) if input == "size" => {
            pushes.size = Some(Push::normal(driven_size(number)));
        }
        What::Attribute(pushes) => pushes.tag = Some(Push::normal(number % 40)),
        _ => {}
    }
}

/// The formulas that components and the mirror share.
fn plain_number(size: f32) -> u32 {
    (size * 2.0) as u32
}

fn transform_number(transform: &Transform) -> u32 {
    (transform.0.translation.x as i32 as u32) % 16
}

fn shown_number(shown: Option<usize>) -> u32 {
    shown.map_or(7, |shown| shown as u32)
}

fn driven_size(number: u32) -> f32 {
    1.0 + (number % 8) as f32 / 2.0
}

fn driven_switch(number: u32) -> bool {
    !number.is_multiple_of(3)
}

fn driven_choice(number: u32) -> Option<usize> {
    Some(number as usize % 4)
}

fn move_transform(transform: &mut sapwood::geom::glam::Affine3, input: &str, number: u32) {
    let to = (number % 7) as f32 - 3.0;
    match input {
        "x" => transform.translation.x = to,
        _ => transform.translation.y = to,
    }
}

/// A component that gives a number.
trait Source: Component {
    fn number(&self) -> u32;
}

/// A component that takes numbers.
trait Target: Component + Clone {
    fn take(&mut self, input: &str, number: u32);
}

macro_rules! sources {
    ($($kind:ty, |$it:ident| $number:expr;)*) => {$(
        impl Source for $kind {
            fn number(&self) -> u32 {
                let $it = self;
                $number
            }
        }
    )*};
}

sources! {
    Plain, |plain| plain_number(plain.size);
    Fragile, |fragile| fragile.value;
    Transform, |transform| transform_number(transform);
    Switch, |switch| u32::from(switch.on);
    Porch, |porch| porch.tag;
    Selector, |selector| shown_number(selector.shown);
    Kit<Knob>, |kit| kit.parameters.number;
}

macro_rules! targets {
    ($($kind:ty, |$it:ident, $input:ident, $number:ident| $drive:expr;)*) => {$(
        impl Target for $kind {
            fn take(&mut self, $input: &str, $number: u32) {
                let $it = self;
                $drive
            }
        }
    )*};
}

targets! {
    Plain, |plain, _input, number| plain.size = driven_size(number);
    Fragile, |fragile, _input, number| fragile.value = number % 4;
    Transform, |transform, input, number| move_transform(&mut transform.0, input, number);
    Switch, |switch, _input, number| switch.on = driven_switch(number);
    Porch, |porch, _input, number| porch.tag = number % 40;
    Selector, |selector, _input, number| selector.shown = driven_choice(number);
    Attribute, |attribute, input, number| match input {
        "size" => attribute.set_as::<Size>(PushMode::Normal, driven_size(number)),
        _ => attribute.set_as::<Tag>(PushMode::Normal, number % 40),
    };
}

/// Makes a connection in a scene.
pub(super) fn connect(
    scene: &mut Scene,
    (source, from): (NodeId, &What),
    (target, to): (NodeId, &What),
    drive: Drive,
) -> Result<(), EditError> {
    match from {
        What::Plain(_) => connect_from::<Plain>(scene, source, target, to, drive),
        What::Fragile(_) => connect_from::<Fragile>(scene, source, target, to, drive),
        What::Transform(_) => connect_from::<Transform>(scene, source, target, to, drive),
        What::Switch(_) => connect_from::<Switch>(scene, source, target, to, drive),
        What::Porch(_) => connect_from::<Porch>(scene, source, target, to, drive),
        What::Selector(_) => connect_from::<Selector>(scene, source, target, to, drive),
        What::Kit(_) => connect_from::<Kit<Knob>>(scene, source, target, to, drive),
        other => panic!("{other:?} drives nothing"),
    }
}

fn connect_from<A: Source>(
    scene: &mut Scene,
    source: NodeId,
    target: NodeId,
    to: &What,
    drive: Drive,
) -> Result<(), EditError> {
    match to {
        What::Plain(_) => connect_both::<A, Plain>(scene, source, target, drive),
        What::Fragile(_) => connect_both::<A, Fragile>(scene, source, target, drive),
        What::Transform(_) => connect_both::<A, Transform>(scene, source, target, drive),
        What::Switch(_) => connect_both::<A, Switch>(scene, source, target, drive),
        What::Porch(_) => connect_both::<A, Porch>(scene, source, target, drive),
        What::Selector(_) => connect_both::<A, Selector>(scene, source, target, drive),
        What::Attribute(_) => connect_both::<A, Attribute>(scene, source, target, drive),
        other => panic!("{other:?} is not driven"),
    }
}

fn connect_both<A: Source, B: Target>(
    scene: &mut Scene,
    source: NodeId,
    target: NodeId,
    drive: Drive,
) -> Result<(), EditError> {
    let (source, target) = (scene.handle::<A>(source), scene.handle::<B>(target));
    let (source, target) = (source.unwrap(), target.unwrap());
    scene.connect(source, target, drive.input, move |source: &A, target: &mut B| {
        let number = drive.of(source.number());
        let number = number.unwrap_or_else(|| panic!("a drive panicked on purpose"));
        target.take(drive.input, number);
    })
}
