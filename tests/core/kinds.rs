//! Kinds, slots and rules for the tests, and helpers that say what ran.

use sapwood::geom::glam::{Affine3, Vec3};
use sapwood::geom::{Mesh, SharedMesh, content};
use sapwood::graph::{Material, Named};
use sapwood::scene::{
    Action, Component, Context, Held, Placement, Rule, RuleError, RuleSet, Scene, Slot, Transform,
    built_in_rules,
};

/// A box whose edge length is a parameter; its rule reads nothing.
#[derive(Debug, Clone)]
pub(crate) struct Plain {
    pub(crate) size: f32,
}
content!(Plain { size });
impl Named for Plain {
    const NAME: &'static str = "plain";
}
impl Component for Plain {}

pub(crate) struct PlainRule;
impl Rule for PlainRule {
    type Component = Plain;
    type Data = ();
    const NAME: &'static str = "plain";
    fn init(&self, plain: &Plain, cx: &mut Context<'_>) -> Result<(), RuleError> {
        cx.mesh(SharedMesh::new(triangle(plain.size)), Material::matte("m", 1.0, 0.0, 0.0).into());
        Ok(())
    }
}

/// A component whose rule reads where it stands.
#[derive(Debug, Clone)]
pub(crate) struct Placed;
content!(Placed {});
impl Named for Placed {
    const NAME: &'static str = "placed";
}
impl Component for Placed {}

pub(crate) struct PlacedRule;
impl Rule for PlacedRule {
    type Component = Placed;
    type Data = ();
    const NAME: &'static str = "placed";
    fn init(&self, _: &Placed, cx: &mut Context<'_>) -> Result<(), RuleError> {
        let here = cx.read::<Placement>().translation;
        let size = 1.0 + here.x.abs().min(10.0);
        cx.mesh(SharedMesh::new(triangle(size)), Material::matte("m", 0.0, 1.0, 0.0).into());
        Ok(())
    }
}

/// A slot that replaces.
pub(crate) enum Size {}
impl Slot for Size {
    type Value = f32;
    type Rate = Held;
    const NAME: &'static str = "size";
    fn default() -> f32 {
        1.0
    }
}

/// A component whose rule reads [`Size`].
#[derive(Debug, Clone)]
pub(crate) struct Sized;
content!(Sized {});
impl Named for Sized {
    const NAME: &'static str = "sized";
}
impl Component for Sized {}

pub(crate) struct SizedRule;
impl Rule for SizedRule {
    type Component = Sized;
    type Data = ();
    const NAME: &'static str = "sized";
    fn init(&self, _: &Sized, cx: &mut Context<'_>) -> Result<(), RuleError> {
        let size = *cx.read::<Size>();
        cx.mesh(SharedMesh::new(triangle(size)), Material::matte("m", 0.0, 0.0, 1.0).into());
        Ok(())
    }
}

/// A component that reads nothing and emits one that reads where it stands.
#[derive(Debug, Clone)]
pub(crate) struct Grandparent;
content!(Grandparent {});
impl Named for Grandparent {
    const NAME: &'static str = "grandparent";
}
impl Component for Grandparent {}

pub(crate) struct GrandparentRule;
impl Rule for GrandparentRule {
    type Component = Grandparent;
    type Data = ();
    const NAME: &'static str = "grandparent";
    fn init(&self, _: &Grandparent, cx: &mut Context<'_>) -> Result<(), RuleError> {
        cx.transform(Affine3::from_translation(Vec3::Y), |cx| cx.emit(Placed));
        Ok(())
    }
}

pub(crate) fn rules() -> RuleSet {
    RuleSet::new()
        .with(PlainRule)
        .with(PlacedRule)
        .with(SizedRule)
        .with(GrandparentRule)
        .over(&built_in_rules())
}

pub(crate) fn triangle(size: f32) -> Mesh {
    Mesh {
        positions: vec![Vec3::ZERO, Vec3::X * size, Vec3::Y * size],
        normals: vec![Vec3::Z; 3],
        uvs: vec![Default::default(); 3],
        indices: vec![0, 1, 2],
    }
}

/// A transform that moves by whole metres.
pub(crate) fn at(x: usize) -> Transform {
    Transform::translation(x as f32, 0.0, 0.0)
}

/// A scene with its log on and in check mode.
pub(crate) fn checked_scene() -> Scene {
    let mut scene = Scene::new();
    scene.set_logging(true);
    scene.set_check_mode(true);
    scene
}

/// How many times rules compiled components of this kind since the log was taken last; the rest
/// of the log is kept out.
pub(crate) fn compiled(scene: &mut Scene, kind: &str) -> usize {
    let log = scene.take_log();
    log.iter().filter(|e| e.action == Action::Compiled && e.kind.name() == kind).count()
}

/// What was compiled since the log was taken last, as sorted kind names with numbers.
pub(crate) fn all_compiled(scene: &mut Scene) -> Vec<(&'static str, usize)> {
    let log = scene.take_log();
    let mut names: Vec<_> =
        log.iter().filter(|e| e.action == Action::Compiled).map(|e| e.kind.name()).collect();
    names.sort_unstable();
    names.chunk_by(|a, b| a == b).map(|run| (run[0], run.len())).collect()
}
