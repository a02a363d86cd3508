//! What a node of a script is, with its parameters; and the component for it.

use sapwood::geom::glam::{Affine3, Vec3};
use sapwood::geom::{SharedMesh, StreamPath};
use sapwood::graph::{Anchor, Camera, Facing, Label, Lens, Light, LightShape, Material};
use sapwood::scene::{
    Attribute, Billboard, ChildPath, Group, Held, HeldGeometry, KitTemplate, LevelOfDetail,
    MaterialSlot, NodeId, Placement, PushMode, Rotor, Scene, Selector, Slot, Style, StyleSlot,
    Switch, Transform,
};

use super::kinds::*;
use crate::core::kinds::{Placed, Plain, Size, Sized, triangle};

/// What a node is, with its parameters.
#[derive(Clone, Copy, Debug)]
pub(super) enum What {
    Group,
    Transform(Affine3),
    Attribute(Pushes),
    Switch(bool),
    Selector(Option<usize>),
    Levels([f32; 2]),
    Rotor(Turning),
    Billboard(Facing),
    Kit(u32),
    Held { size: f32, look: Option<u8> },
    Light(f32),
    Camera(f32),
    Label(f32),
    Porch(u32),
    Spinner(f32),
    Plain(f32),
    Placed,
    Sized,
    Tagged,
    Keyed,
    Gridded,
    Sided,
    Limited { size: f32, by: LimitedBy },
    Chooser,
    Nest(u32),
    Fragile(u32),
    Woven(u32),
    Yarn(u32),
}

/// The parameters of a rotor.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turning {
    pub(super) axis: Vec3,
    pub(super) velocity: f32,
    pub(super) phase: f32,
}

/// What an attribute pushes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pushes {
    pub(super) size: Option<Push<f32>>,
    pub(super) tag: Option<Push<u32>>,
    pub(super) path: Option<Push<StreamPath>>,
    pub(super) place: Option<Push<Affine3>>,
    pub(super) style: Option<Push<Style>>,
    pub(super) look: Option<Push<u8>>,
}

/// One push: how strong, and the value; nothing where the value sub-graph is asked.
#[derive(Clone, Copy, Debug)]
pub(super) struct Push<T> {
    pub(super) mode: PushMode,
    pub(super) held: Option<T>,
}

impl<T> Push<T> {
    pub(super) fn normal(value: T) -> Self {
        Self { mode: PushMode::Normal, held: Some(value) }
    }

    fn map<U>(self, change: impl FnOnce(T) -> U) -> Push<U> {
        Push { mode: self.mode, held: self.held.map(change) }
    }
}

impl What {
    /// How many children the node may have.
    pub(super) fn room(&self) -> usize {
        match self {
            Self::Group
            | Self::Selector(_)
            | Self::Levels(_)
            | Self::Kit(_)
            | Self::Porch(_)
            | Self::Spinner(_) => usize::MAX,
            Self::Transform(_)
            | Self::Attribute(_)
            | Self::Switch(_)
            | Self::Rotor(_)
            | Self::Billboard(_) => 1,
            _ => 0,
        }
    }

    /// Components and draw rows that one occurrence stands for, its children left out.
    pub(super) fn weight(&self) -> u64 {
        match self {
            Self::Nest(depth) => 6 + 5 * u64::from(*depth),
            Self::Porch(_) => 3,
            Self::Woven(_) => 2,
            _ => 1,
        }
    }

    /// Whether the node's rule asks its value sub-graph.
    pub(super) fn may_ask(&self) -> bool {
        matches!(
            self,
            Self::Attribute(_) | Self::Transform(_) | Self::Switch(_) | Self::Selector(_)
        )
    }

    /// Places the component in a scene.
    pub(super) fn place(&self, scene: &mut Scene) -> NodeId {
        match *self {
            Self::Group => scene.add(Group).id(),
            Self::Transform(transform) => scene.add(Transform(transform)).id(),
            Self::Attribute(pushes) => scene.add(pushes.attribute()).id(),
            Self::Switch(on) => scene.add(Switch { on }).id(),
            Self::Selector(shown) => scene.add(Selector { shown }).id(),
            Self::Levels(distances) => scene.add(LevelOfDetail::new(distances)).id(),
            Self::Rotor(turning) => scene.add(turning.rotor()).id(),
            Self::Billboard(facing) => scene.add(Billboard { facing }).id(),
            Self::Kit(number) => scene.add_kit(&KitTemplate::new(), Knob { number }).unwrap().id(),
            Self::Held { size, look } => scene.add(held(size, look)).id(),
            Self::Light(intensity) => scene.add(light(intensity)).id(),
            Self::Camera(near) => scene.add(camera(near)).id(),
            Self::Label(height) => scene.add(label(height)).id(),
            Self::Porch(tag) => scene.add(Porch { tag }).id(),
            Self::Spinner(speed) => scene.add(Spinner { speed }).id(),
            Self::Plain(size) => scene.add(Plain { size }).id(),
            Self::Placed => scene.add(Placed).id(),
            Self::Sized => scene.add(Sized).id(),
            Self::Tagged => scene.add(Tagged {}).id(),
            Self::Keyed => scene.add(Keyed {}).id(),
            Self::Gridded => scene.add(Gridded {}).id(),
            Self::Sided => scene.add(Sided {}).id(),
            Self::Limited { size, by } => scene.add(Limited { size, by }).id(),
            Self::Chooser => scene.add(Chooser {}).id(),
            Self::Nest(depth) => scene.add(Nest { depth }).id(),
            Self::Fragile(value) => scene.add(Fragile { value }).id(),
            Self::Woven(depth) => scene.add(Woven { depth }).id(),
            Self::Yarn(depth) => scene.add(Yarn { depth }).id(),
        }
    }

    /// Gives the node at `id`, which is of this kind, these parameters.
    pub(super) fn set(&self, scene: &mut Scene, id: NodeId) {
        macro_rules! edit {
            ($kind:ty, $new:expr) => {{
                let handle = scene.handle::<$kind>(id).unwrap();
                scene.edit(handle, |component| *component = $new).unwrap();
            }};
        }
        match *self {
            Self::Transform(transform) => edit!(Transform, Transform(transform)),
            Self::Attribute(pushes) => edit!(Attribute, pushes.attribute()),
            Self::Switch(on) => edit!(Switch, Switch { on }),
            Self::Selector(shown) => edit!(Selector, Selector { shown }),
            Self::Levels(distances) => edit!(LevelOfDetail, LevelOfDetail::new(distances)),
            Self::Rotor(turning) => edit!(Rotor, turning.rotor()),
            Self::Billboard(facing) => edit!(Billboard, Billboard { facing }),
            Self::Kit(number) => {
                let kit = scene.handle::<sapwood::scene::Kit<Knob>>(id).unwrap();
                scene.edit(kit, |kit| kit.parameters.number = number).unwrap();
            }
            Self::Held { size, look } => edit!(HeldGeometry, held(size, look)),
            Self::Light(intensity) => edit!(Light, light(intensity)),
            Self::Camera(near) => edit!(Camera, camera(near)),
            Self::Label(height) => edit!(Label, label(height)),
            Self::Porch(tag) => edit!(Porch, Porch { tag }),
            Self::Spinner(speed) => edit!(Spinner, Spinner { speed }),
            Self::Plain(size) => edit!(Plain, Plain { size }),
            Self::Nest(depth) => edit!(Nest, Nest { depth }),
            Self::Fragile(value) => edit!(Fragile, Fragile { value }),
            Self::Woven(depth) => edit!(Woven, Woven { depth }),
            Self::Yarn(depth) => edit!(Yarn, Yarn { depth }),
            Self::Limited { size, by } => edit!(Limited, Limited { size, by }),
            Self::Keyed => edit!(Keyed, Keyed {}),
            Self::Group
            | Self::Placed
            | Self::Sized
            | Self::Tagged
            | Self::Gridded
            | Self::Sided
            | Self::Chooser => {}
        }
    }
}

impl Pushes {
    fn attribute(self) -> Attribute {
        fn set<S: Slot<Rate = Held>>(attribute: &mut Attribute, push: Option<Push<S::Value>>) {
            match push {
                None => {}
                Some(Push { mode, held: Some(value) }) => attribute.set_as::<S>(mode, value),
                Some(Push { mode, held: None }) => attribute.ask_as::<S>(mode),
            }
        }
        let mut attribute = Attribute::new();
        set::<Size>(&mut attribute, self.size);
        set::<Tag>(&mut attribute, self.tag);
        set::<ChildPath>(&mut attribute, self.path);
        set::<Placement>(&mut attribute, self.place);
        set::<StyleSlot>(&mut attribute, self.style);
        set::<MaterialSlot>(&mut attribute, self.look.map(|look| look.map(material)));
        attribute
    }
}

impl Turning {
    fn rotor(self) -> Rotor {
        Rotor { axis: self.axis, velocity: self.velocity, phase: self.phase }
    }
}

/// The name of a material by its number.
pub(super) fn look_name(look: u8) -> &'static str {
    ["plain", "red", "green", "blue"][usize::from(look % 4)]
}

pub(super) fn material(look: u8) -> Material {
    match look_name(look) {
        "plain" => MaterialSlot::default(),
        name => Material::matte(name, f32::from(look), 0.5, 0.0),
    }
}

fn held(size: f32, look: Option<u8>) -> HeldGeometry {
    let mesh = SharedMesh::new(triangle(size));
    HeldGeometry { mesh, material: look.map(|look| material(look).into()) }
}

fn light(intensity: f32) -> Light {
    let shape = LightShape::Point { range: None };
    Light { name: "light".to_owned(), color: [1.0; 3], intensity, shape }
}

fn camera(near: f32) -> Camera {
    let lens = Lens::Perspective { vertical_angle: 1.0 };
    Camera { name: "camera".to_owned(), lens, near, far: None }
}

pub(super) fn label(height: f32) -> Label {
    Label { anchor: Anchor::Middle, ..Label::new("abc", height) }
}
