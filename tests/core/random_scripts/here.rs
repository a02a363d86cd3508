//! What the reference hands down: where an occurrence stands, and the value of each slot.

use sapwood::geom::StreamPath;
use sapwood::geom::glam::{Affine3, Vec3};
use sapwood::scene::{PushMode, Style};

use super::frame::Frame;
use super::mirror::{RootValue, View};

/// A slot's value, and whether it is forced.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inherited<T> {
    pub(super) value: T,
    is_forced: bool,
}

impl<T: Copy> Inherited<T> {
    fn above(root: Option<RootValue<T>>, default: T) -> Self {
        let (value, is_forced) = root.map_or((default, false), |root| (root.value, root.is_forced));
        Self { value, is_forced }
    }

    /// Below a push: the outermost force wins, and only what is protected breaks it.
    pub(super) fn pushed(self, mode: PushMode, new: T, merge: impl FnOnce(T, T) -> T) -> Self {
        match mode {
            PushMode::Inherit => self,
            PushMode::Normal | PushMode::Force if self.is_forced => self,
            PushMode::Normal | PushMode::Force | PushMode::Protect => {
                Self { value: merge(self.value, new), is_forced: mode == PushMode::Force }
            }
        }
    }

    /// What something has that asks for a value of its own, unless another is forced.
    pub(super) fn own_or_forced(self, own: Option<T>) -> T {
        own.filter(|_| !self.is_forced).unwrap_or(self.value)
    }
}

/// What is pushed counts alone.
pub(super) fn replace<T>(_: T, new: T) -> T {
    new
}

pub(super) fn merge_tags(inherited: u32, pushed: u32) -> u32 {
    (inherited * 3 + pushed) % 101
}

pub(super) fn merge_places(inherited: Affine3, pushed: Affine3) -> Affine3 {
    inherited * pushed
}

/// What is handed down.
#[derive(Clone)]
pub(super) struct Here {
    /// With what turns and spins.
    pub(super) world: Frame,
    pub(super) place: Inherited<Affine3>,
    pub(super) size: Inherited<f32>,
    pub(super) tag: Inherited<u32>,
    pub(super) path: Inherited<StreamPath>,
    pub(super) style: Inherited<Style>,
    pub(super) look: Inherited<u8>,
    pub(super) viewpoint: Inherited<Option<Vec3>>,
    pub(super) links: Vec<u32>,
    /// Whether anything above turns by angles that are not right.
    pub(super) is_turned: bool,
    /// Whether a turn above is so ill determined that places below it mean nothing.
    pub(super) is_vague: bool,
}

impl Here {
    /// Above the root of a view.
    pub(super) fn above(view: &View) -> Self {
        let values = &view.values;
        Self {
            world: Frame::IDENTITY,
            place: Inherited::above(None, Affine3::IDENTITY),
            size: Inherited::above(values.size, 1.0),
            tag: Inherited::above(values.tag, 1),
            path: Inherited::above(values.path, StreamPath::new(0)),
            style: Inherited::above(values.style, Style::Solid),
            look: Inherited::above(values.look, 0),
            viewpoint: Inherited::above(values.viewpoint, None),
            links: Vec::new(),
            is_turned: false,
            is_vague: false,
        }
    }

    /// Behind a transform, which moves what is below it and says so.
    pub(super) fn placed(&self, by: &Affine3) -> Self {
        let place = self.place.pushed(PushMode::Normal, *by, merge_places);
        Self { world: self.world.after(&Frame::of(by)), place, ..self.clone() }
    }

    pub(super) fn tagged(&self, new: u32) -> Self {
        Self { tag: self.tag.pushed(PushMode::Normal, new, merge_tags), ..self.clone() }
    }

    pub(super) fn sized(&self, new: f32) -> Self {
        Self { size: self.size.pushed(PushMode::Normal, new, replace), ..self.clone() }
    }

    /// Through one link to the child with this key.
    pub(super) fn child(&self, link: u32, key: u64) -> Self {
        let mut child = self.clone();
        child.path.value = self.path.value.child(key);
        child.links.push(link);
        child
    }
}
