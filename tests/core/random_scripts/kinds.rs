//! Kinds and rules of the random scripts: every way of reading slots, and every way of failing.

use sapwood::geom::glam::{Affine3, Vec3};
use sapwood::geom::{Aabb, Content, Digester, Purpose, Shared, SharedMesh, Stream, content};
use sapwood::graph::{Aspects, Fading, Falloff, Material, Named, Stretch};
use sapwood::scene::{
    Cell, ChildPath, Children, Component, Context, Held, KitRule, Placement, Rule, RuleError,
    RuleSet, Side, SideOfBox, Slot, Time, VisitContext, built_in_rules,
};

use crate::core::kinds::{Placed, PlacedRule, Plain, Size, Sized, SizedRule, triangle};

/// A slot that merges; the order of pushes matters.
pub(super) enum Tag {}
impl Slot for Tag {
    type Value = u32;
    type Rate = Held;
    const NAME: &'static str = "tag";
    const MERGES: bool = true;
    fn default() -> u32 {
        1
    }
    fn merge(inherited: &u32, pushed: &u32) -> u32 {
        (inherited * 3 + pushed) % 101
    }
}

/// What a kit is set with.
#[derive(Debug, Clone)]
pub(super) struct Knob {
    pub(super) number: u32,
}
content!(Knob { number });
impl Named for Knob {
    const NAME: &'static str = "knob";
}

/// The edge of the cells that gridded components stand in.
const CELL: f32 = 16.0;

/// How a small box about the component stands towards a large one about the root's origin.
const SIDE: SideOfBox = SideOfBox {
    own: Aabb { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) },
    region: Aabb { min: Vec3::splat(-6.5), max: Vec3::splat(6.5) },
};

/// What says how much of something is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum LimitedBy {
    Distance,
    Side,
}

impl Content for LimitedBy {
    fn write(&self, digester: &mut Digester) {
        digester.add(&u8::from(*self == Self::Side));
    }
}

/// How far away something is of which half is left.
pub(super) const REACH: f32 = 24.0;

macro_rules! kinds {
    ($($kind:ident { $($field:ident: $type:ty),* } $name:literal $children:ident;)*) => {$(
        #[derive(Debug, Clone)]
        pub(super) struct $kind { $(pub(super) $field: $type),* }
        content!($kind { $($field),* });
        impl Named for $kind { const NAME: &'static str = $name; }
        impl Component for $kind { const CHILDREN: Children = Children::$children; }
    )*};
}

kinds! {
    Tagged {} "tagged" None;
    Limited { size: f32, by: LimitedBy } "limited" None;
    Keyed {} "keyed" None;
    Gridded {} "gridded" None;
    Sided {} "sided" None;
    Chooser {} "chooser" None;
    Nest { depth: u32 } "nest" None;
    Fragile { value: u32 } "fragile" None;
    Yarn { depth: u32 } "yarn" None;
    Woven { depth: u32 } "woven" None;
    Porch { tag: u32 } "porch" Many;
    Spinner { speed: f32 } "spinner" Many;
}

macro_rules! rules {
    ($($rule:ident $kind:ident |$component:ident, $cx:ident| $init:expr;)*) => {$(
        pub(super) struct $rule;
        impl Rule for $rule {
            type Component = $kind;
            type Data = ();
            const NAME: &'static str = stringify!($rule);
            fn init(&self, $component: &$kind, $cx: &mut Context<'_>) -> Result<(), RuleError> {
                $init
            }
        }
    )*};
}

rules! {
    TaggedRule Tagged |_tagged, cx| { let tag = *cx.read::<Tag>(); draw(cx, tagged_size(tag)) };
    KeyedRule Keyed |_keyed, cx| { let path = *cx.read::<ChildPath>(); draw(cx, keyed_size(path)) };
    GriddedRule Gridded |_gridded, cx| {
        let cell = cx.project(Cell { size: CELL });
        draw(cx, gridded_size(cell))
    };
    SidedRule Sided |_sided, cx| { let side = cx.project(SIDE); draw(cx, sided_size(side)) };
    LimitedRule Limited |limited, cx| {
        let mut both = triangle(limited.size);
        both.append(&triangle(limited.size), &Affine3::IDENTITY);
        let material = Material::matte("m", 1.0, 1.0, 1.0).into();
        let inside = |cx: &mut Context<'_>| cx.mesh(SharedMesh::new(both), material);
        match limited.by {
            LimitedBy::Distance => {
                let far = Stretch::constant(f32::INFINITY, 0.5);
                let shown = Falloff(vec![Stretch::constant(REACH, 1.0), far]);
                let replaced = Falloff::default();
                let fading = Fading { shown, replaced, mass: 2, ends: None, keeps_coverage: false };
                cx.fading(fading, inside);
            }
            LimitedBy::Side => {
                let toward = Shared::new(vec![Vec3::X, Vec3::NEG_X]);
                cx.aspects(Aspects { toward, center: Vec3::ZERO, without_eye: 2, blends: false }, inside);
            }
        }
        Ok(())
    };
    // What it reads depends on what it read before.
    ChooserRule Chooser |_chooser, cx| {
        let tag = *cx.read::<Tag>();
        let size = match tag % 3 {
            0 => *cx.read::<Size>(),
            1 => placed_size(&cx.read::<Placement>()),
            _ => 3.0,
        };
        draw(cx, size)
    };
    NestRule Nest |nest, cx| {
        let Some(depth) = nest.depth.checked_sub(1) else { return draw(cx, 0.5) };
        cx.emit(Placed);
        cx.transform(nest_step(), |cx| {
            cx.emit(Nest { depth });
            cx.emit(Keyed {});
        });
        cx.push::<Size>(nest.depth as f32, |cx| cx.emit(Sized));
        cx.push::<Tag>(nest.depth, |cx| cx.emit(Tagged {}));
        Ok(())
    };
    FragileRule Fragile |fragile, cx| {
        let size = *cx.read::<Size>();
        match fragile_fate(fragile.value, size) {
            Fate::Draws => draw(cx, size + 0.25),
            Fate::Fails => Err(RuleError::Failed("fragile failed".to_owned())),
            Fate::Panics => panic!("fragile panicked on purpose"),
        }
    };
    // Made of yarn; every other one does without where that cannot be had.
    WovenRule Woven |woven, cx| {
        let yarn = cx.ingredient::<f32>(Yarn { depth: woven.depth });
        if let (Err(why), true) = (&yarn, woven.depth.is_multiple_of(2)) {
            return Err(why.clone());
        }
        draw(cx, yarn.map_or(0.25, |size| *size))?;
        cx.emit(Yarn { depth: woven.depth });
        Ok(())
    };
    PorchRule Porch |porch, cx| {
        cx.emit(Sized);
        cx.push::<Tag>(porch.tag, Context::children);
        cx.emit(Placed);
        Ok(())
    };
    FlatPlacedRule Placed |_placed, cx| draw(cx, 0.75);
}

/// A rule with a setting.
pub(super) struct ScaledPlainRule(pub(super) u32);
impl Rule for ScaledPlainRule {
    type Component = Plain;
    type Data = ();
    const NAME: &'static str = "scaled_plain";
    fn settings(&self, digester: &mut Digester) {
        digester.add(&self.0);
    }
    fn init(&self, plain: &Plain, cx: &mut Context<'_>) -> Result<(), RuleError> {
        draw(cx, plain.size * self.0 as f32)
    }
}

/// Yarn is made of yarn, or reads this or that; and it is drawn where it is a child.
struct YarnRule(u32);
impl Rule for YarnRule {
    type Component = Yarn;
    type Data = f32;
    const NAME: &'static str = "yarn";
    fn settings(&self, digester: &mut Digester) {
        digester.add(&self.0);
    }
    fn init(&self, yarn: &Yarn, cx: &mut Context<'_>) -> Result<f32, RuleError> {
        let size = match yarn.depth.checked_sub(1) {
            Some(depth) => yarn_step(*cx.ingredient::<f32>(Yarn { depth })?, self.0),
            None => match yarn_source(*cx.read::<Tag>()) {
                Source::Size => *cx.read::<Size>(),
                Source::Placement => placed_size(&cx.read::<Placement>()),
                Source::Path => keyed_size(*cx.read::<ChildPath>()),
                Source::Cell => gridded_size(cx.project(Cell { size: CELL })),
                Source::Failure => return Err(RuleError::Failed("no yarn".to_owned())),
                Source::Panic => panic!("yarn panicked on purpose"),
            },
        };
        draw(cx, size)?;
        Ok(size)
    }
}

struct SpinnerRule;
impl Rule for SpinnerRule {
    type Component = Spinner;
    type Data = f32;
    const NAME: &'static str = "spinner";
    fn init(&self, spinner: &Spinner, cx: &mut Context<'_>) -> Result<f32, RuleError> {
        cx.live(Context::children);
        Ok(spinner.speed)
    }
    fn visit(&self, speed: &f32, cx: &VisitContext<'_>, live: &mut [Affine3]) {
        live[0] = spun(*speed, *cx.read::<Time>() as f32);
    }
}

fn draw(cx: &mut Context<'_>, size: f32) -> Result<(), RuleError> {
    cx.mesh(SharedMesh::new(triangle(size)), Material::matte("m", 1.0, 1.0, 1.0).into());
    Ok(())
}

/// The formulas that rules and reference share.
pub(super) fn tagged_size(tag: u32) -> f32 {
    (1 + tag % 7) as f32
}

pub(super) fn keyed_size(path: sapwood::geom::StreamPath) -> f32 {
    1.0 + (Stream::new(path, Purpose("size")).unit() * 64.0).floor() / 4.0
}

pub(super) fn gridded_size(cell: [i32; 3]) -> f32 {
    let [x, y, z] = cell;
    1.0 + (x.wrapping_mul(5).wrapping_add(y).wrapping_sub(z.wrapping_mul(3)) & 7) as f32
}

pub(super) fn sided_size(side: Side) -> f32 {
    match side {
        Side::Inside => 1.0,
        Side::Crossing => 2.0,
        Side::Outside => 3.0,
    }
}

/// In which cell something stands, by the reference's own reckoning.
pub(super) fn cell_of(place: &Affine3) -> [i32; 3] {
    place.translation.to_array().map(|x| (f64::from(x) / f64::from(CELL)).floor() as i32)
}

/// How something stands towards the large box: all turns are by right angles, so only the
/// origin's place counts.
pub(super) fn side_of(place: &Affine3) -> Side {
    let far = place.translation.abs().max_element();
    if far > 7.5 {
        Side::Outside
    } else if far <= 5.5 {
        Side::Inside
    } else {
        Side::Crossing
    }
}

pub(super) fn placed_size(place: &Affine3) -> f32 {
    1.0 + place.translation.x.abs().min(10.0)
}

pub(super) fn spun(speed: f32, time: f32) -> Affine3 {
    Affine3::from_translation(Vec3::new(0.0, 0.0, 1.0 + speed * time))
}

pub(super) fn nest_step() -> Affine3 {
    Affine3::from_translation(Vec3::new(2.0, 1.0, 0.0))
}

pub(super) enum Fate {
    Draws,
    Fails,
    Panics,
}

pub(super) fn fragile_fate(value: u32, size: f32) -> Fate {
    match (value + size as u32) % 4 {
        0 => Fate::Fails,
        1 => Fate::Panics,
        _ => Fate::Draws,
    }
}

/// What the last yarn of all takes its size from.
pub(super) enum Source {
    Size,
    Placement,
    Path,
    Cell,
    Failure,
    Panic,
}

pub(super) fn yarn_source(tag: u32) -> Source {
    match tag % 9 {
        0..=2 => Source::Size,
        3 | 4 => Source::Placement,
        5 => Source::Path,
        6 => Source::Cell,
        7 => Source::Failure,
        _ => Source::Panic,
    }
}

pub(super) fn yarn_step(below: f32, factor: u32) -> f32 {
    below + 0.5 * factor as f32
}

/// Which rules a view has.
#[derive(Clone, Copy, Debug)]
pub(super) struct Variant {
    pub(super) plain_factor: u32,
    pub(super) placed_is_flat: bool,
    pub(super) has_tagged: bool,
    /// The setting of the rule for yarn, if there is one.
    pub(super) yarn_factor: Option<u32>,
}

impl Variant {
    pub(super) fn rules(self) -> RuleSet {
        let base = RuleSet::new()
            .with(PlacedRule)
            .with(SizedRule)
            .with(KeyedRule)
            .with(GriddedRule)
            .with(SidedRule)
            .with(LimitedRule)
            .with(ChooserRule)
            .with(NestRule)
            .with(FragileRule)
            .with(WovenRule)
            .with(PorchRule)
            .with(SpinnerRule)
            .with(KitRule::<Knob>::new())
            .over(&built_in_rules());
        let mut top = RuleSet::new().with(ScaledPlainRule(self.plain_factor));
        if self.placed_is_flat {
            top = top.with(FlatPlacedRule);
        }
        if self.has_tagged {
            top = top.with(TaggedRule);
        }
        if let Some(factor) = self.yarn_factor {
            top = top.with(YarnRule(factor));
        }
        top.over(&base)
    }
}
