//! Trees that sway in the wind: the same stems and surfaces, and what each hangs on.
//!
//! Structure alone is replaced. A branch makes the rig of its stems and hands it down in a slot;
//! whatever draws finds it there, and says which joints its vertices and instances follow.

use glam::Affine3;
use sapwood_geom::Shared;
use sapwood_graph::Rig;
use sapwood_scene::{Context, Rule, RuleError};

use super::super::growth::helix_radius;
use super::super::slots::{RigSlot, SwaySlot};
use super::super::sway::{Riding, rig_of};
use super::super::{Branch, Children, LeafSurface, Segment, StemSeed, Stems, Tree, Twigs};
use super::leaves::emit_leaves_beside;
use super::roots::emit_roots;
use super::structure::{Offspring, branch_stems, emit_grown, level, offspring, plant, twig_stems};

/// Compiles a tree as the rule without wind does, and foresees that it sways.
pub(super) struct SwayingTreeRule;

impl Rule for SwayingTreeRule {
    type Component = Tree;
    type Data = ();
    const NAME: &'static str = "weber_penn.swaying_tree";

    fn init(&self, tree: &Tree, cx: &mut Context<'_>) -> Result<(), RuleError> {
        plant(tree, cx, |seeds, reach, cx| {
            let trunk = level(cx, 0);
            let aside = 2.0 * helix_radius(trunk.curve_v, 1.0 / trunk.curve_res as f32);
            let reach = reach.any_way(aside);
            for (key, seed) in (0..).zip(seeds) {
                let foreseen = reach.bound(seed.frame.origin, seed.length);
                cx.emit_keyed(key, Branch { seed }, foreseen);
            }
        })
    }
}

/// Compiles a branch as the rule without wind does, with its rig.
pub(super) struct SwayingBranchRule;

impl Rule for SwayingBranchRule {
    type Component = Branch;
    type Data = Shared<Stems>;
    const NAME: &'static str = "weber_penn.swaying_branch";

    fn init(&self, branch: &Branch, cx: &mut Context<'_>) -> Result<Shared<Stems>, RuleError> {
        let stems = branch_stems(branch, cx)?;
        emit_rigged(&stems, cx);
        emit_roots(&stems, cx);
        Ok(stems)
    }
}

/// Compiles twigs as the rule without wind does, with their rig.
pub(super) struct SwayingTwigsRule;

impl Rule for SwayingTwigsRule {
    type Component = Twigs;
    type Data = Shared<Stems>;
    const NAME: &'static str = "weber_penn.swaying_twigs";

    fn init(&self, twigs: &Twigs, cx: &mut Context<'_>) -> Result<Shared<Stems>, RuleError> {
        let stems = twig_stems(twigs, cx)?;
        emit_rigged(&stems, cx);
        Ok(stems)
    }
}

/// Emits what draws stems, and what grows on them, below their rig.
fn emit_rigged(stems: &Shared<Stems>, cx: &mut Context<'_>) {
    if stems.stems.is_empty() {
        return;
    }
    let carried = cx.read::<RigSlot>();
    let params = cx.read::<SwaySlot>();
    let rig = Shared::new(rig_of(stems, (*carried).as_ref(), &params));
    let riding = Riding { rig, on: Vec::new() };
    cx.push::<RigSlot>(Some(riding), |cx| emit_grown(stems, cx));
}

/// What something drawn hangs on: the rig that the rules have handed down.
#[derive(Clone)]
pub(super) struct Carried {
    rig: Shared<Rig>,
    /// The joint of the first segment of the stems that are drawn.
    first: u32,
}

impl Carried {
    /// What the drawing of stems, or on stems, hangs on, if it sways; not asked where it does not.
    pub(super) fn of(stems: &Stems, asked: bool, cx: &mut Context<'_>) -> Option<Self> {
        if !asked {
            return None;
        }
        let riding = cx.read::<RigSlot>();
        let riding = (*riding).as_ref()?;
        Some(Self { rig: riding.rig.clone(), first: riding.first_joint(stems) })
    }

    /// Draws something that follows these segments of the stems, one for each vertex or instance:
    /// `draw` adds it, and calls what it is given right after. Where nothing sways that does
    /// nothing.
    pub(super) fn sway(
        carried: Option<Self>,
        segments: Option<Vec<u32>>,
        cx: &mut Context<'_>,
        draw: impl FnOnce(&mut Context<'_>, &dyn Fn(&mut Context<'_>)),
    ) {
        let (Some(Self { rig, first }), Some(mut joints)) = (carried, segments) else {
            draw(cx, &|_| ());
            return;
        };
        joints.iter_mut().for_each(|joint| *joint += first);
        let joints = Shared::new(joints);
        cx.swaying(rig, |cx| draw(cx, &|cx| cx.follows(joints.clone())));
    }
}

/// Compiles what grows on stems as the rule without wind does, and tells each what it hangs on.
pub(super) struct SwayingChildrenRule;

impl Rule for SwayingChildrenRule {
    type Component = Children;
    type Data = Offspring;
    const NAME: &'static str = "weber_penn.swaying_children";

    fn init(&self, parents: &Children, cx: &mut Context<'_>) -> Result<Offspring, RuleError> {
        let mut segments: Vec<u32> = Vec::new();
        let offspring = offspring(parents, cx, &mut |segment| segments.push(segment as u32))?;
        let carrying = cx.read::<RigSlot>();
        let riding = |seeds: &[StemSeed], segments: &[u32]| {
            let carrying = (*carrying).as_ref()?;
            let first = carrying.first_joint(&parents.stems);
            let joints = segments.iter().map(|segment| first + segment);
            let on = seeds.iter().map(|seed| seed.path).zip(joints).collect();
            Some(Riding { rig: carrying.rig.clone(), on })
        };
        match &offspring {
            Offspring::None => {}
            Offspring::Branches(seeds) => {
                for (seed, segment) in seeds.iter().zip(&segments) {
                    let riding = riding(&[*seed], &[*segment]);
                    cx.push::<RigSlot>(riding, |cx| cx.emit(Branch { seed: *seed }));
                }
            }
            Offspring::Twigs(seeds) => {
                let riding = riding(seeds, &segments);
                cx.push::<RigSlot>(riding, |cx| cx.emit(Twigs { seeds: seeds.clone() }));
            }
        }
        emit_leaves_beside(parents, cx);
        Ok(offspring)
    }
}

/// The segment that each leaf sits on: of those of its stem the one whose axis it is nearest to.
pub(super) fn segments_of(leaves: &LeafSurface) -> Vec<u32> {
    let LeafSurface { stems, places, on } = leaves;
    let nearest = |(place, stem): (&Affine3, &u32)| {
        let distance = |segment: &Segment| {
            let to = place.translation - segment.frame.origin;
            let along = to.dot(segment.frame.axes.z_axis).clamp(0.0, segment.length);
            to.distance_squared(along * segment.frame.axes.z_axis)
        };
        let stem = *stem as usize;
        let segments = stems.segments_of(stem).iter().map(distance).enumerate();
        let nearest = segments.min_by(|(_, a), (_, b)| a.total_cmp(b));
        stems.stems[stem].first_segment + nearest.map_or(0, |(number, _)| number as u32)
    };
    places.iter().zip(on.iter()).map(nearest).collect()
}
