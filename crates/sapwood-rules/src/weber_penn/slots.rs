//! The held slots by which species values reach the rules.
//!
//! One slot for each level, one for the leaves, one for the trunk's surface, one each for the look
//! of bark and leaves and one for what holds for the whole tree: an edit of one leaves whoever reads the others alone.

use sapwood_graph::Material;
use sapwood_scene::{Attribute, Held, Slot};

use super::{
    BarkLook, Crown, Detail, FadingParams, LeafLook, LeafParams, LeafTarget, Level, LevelDetail,
    Riding, RootParams, Species, SwayParams, Target, TrunkForm,
};

macro_rules! slot {
    ($(#[$doc:meta])* $slot:ident: $value:ty = $name:literal, $default:expr) => {
        $(#[$doc])*
        #[derive(Debug)]
        pub enum $slot {}

        impl Slot for $slot {
            type Value = $value;
            type Rate = Held;
            const NAME: &'static str = $name;

            fn default() -> $value {
                $default
            }
        }
    };
}

slot! {
    /// What holds for the whole tree.
    CrownSlot: Crown = "weber_penn.crown", Crown::new(&Species::default())
}
slot! {
    /// The name of the species, for people.
    SpeciesNameSlot: String = "weber_penn.species_name", String::new()
}
slot! {
    /// What the trunk's surface needs beyond its level.
    TrunkFormSlot: TrunkForm = "weber_penn.trunk_form", TrunkForm::new(&Species::default())
}
slot! {
    /// The roots.
    RootsSlot: RootParams = "weber_penn.roots", RootParams::new(&Species::default())
}
slot! {
    /// The leaves.
    LeavesSlot: LeafParams = "weber_penn.leaves", LeafParams::new(&Species::default())
}
slot! {
    /// How finely stems are meshed.
    DetailSlot: Detail = "weber_penn.detail", Detail::default()
}
slot! {
    /// What the species says of how finely the stems of each level are meshed.
    LevelDetailSlot: [LevelDetail; 4] = "weber_penn.level_detail", [LevelDetail::default(); 4]
}
slot! {
    /// How trees fade under the rules that have them do so.
    FadingSlot: FadingParams = "weber_penn.fading", FadingParams::default()
}
slot! {
    /// How trees sway under the rules that have them do so.
    SwaySlot: SwayParams = "weber_penn.sway", SwayParams::default()
}
slot! {
    /// What stems, and what draws them, hang on; set by the rules of trees that sway, for what they
    /// emit.
    RigSlot: Option<Riding> = "weber_penn.rig", None
}
slot! {
    /// The bark of the species, of which the rules make the material of stems.
    BarkLookSlot: BarkLook = "weber_penn.bark_look", BarkLook::new(&Species::default())
}
slot! {
    /// The leaves of the species, of which the rules make their material.
    LeafLookSlot: LeafLook = "weber_penn.leaf_look", LeafLook::new(&Species::default())
}
slot! {
    /// The material of stems instead of the species' own.
    BarkSlot: Option<Material> = "weber_penn.bark", None
}
slot! {
    /// The material of leaves instead of the species' own. Leaves have the outline of their shape
    /// then, for nothing is known of the material's images.
    FoliageSlot: Option<Material> = "weber_penn.foliage", None
}
slot! {
    /// How firmly stems are held inside the envelope of the slot
    /// [`EnvelopeSlot`](sapwood_scene::EnvelopeSlot): 0 not at all, 1 fully; the paper's PruneRatio.
    PruneRatioSlot: f32 = "weber_penn.prune_ratio", 1.0
}
slot! {
    /// Whether part of the tree may lie outside the envelope; set by the tree's own rule, so that
    /// no branch asks where all lie inside.
    IsPrunedSlot: bool = "weber_penn.is_pruned", false
}
slot! {
    /// What stems turn toward, in tree space; set by the tree's own rule.
    StemTargetSlot: Target = "weber_penn.stem_target", Target::Up
}
slot! {
    /// What leaves turn toward, in tree space; set by the tree's own rule.
    LeafTargetSlot: LeafTarget = "weber_penn.leaf_target", LeafTarget::Outward
}

/// The parameters of level `N`, 0 to 3; deeper levels take those of 3.
#[derive(Debug)]
pub enum LevelSlot<const N: usize> {}

impl<const N: usize> Slot for LevelSlot<N> {
    type Value = Level;
    type Rate = Held;
    const NAME: &'static str = match N {
        0 => "weber_penn.level_0",
        1 => "weber_penn.level_1",
        2 => "weber_penn.level_2",
        _ => "weber_penn.level_3",
    };

    fn default() -> Level {
        Level::new(&Species::default(), N)
    }
}

impl Species {
    /// An attribute that sets this species for everything below it.
    pub fn attribute(&self) -> Attribute {
        let mut attribute = Attribute::new();
        self.set(&mut attribute);
        attribute
    }

    /// Sets this species on an attribute. Slots whose values stay the same change nothing
    /// below.
    pub fn set(&self, attribute: &mut Attribute) {
        let [level_0, level_1, level_2, level_3] = Level::all(self);
        attribute.set::<SpeciesNameSlot>(self.name.clone());
        attribute.set::<CrownSlot>(Crown::new(self));
        attribute.set::<TrunkFormSlot>(TrunkForm::new(self));
        attribute.set::<LevelSlot<0>>(level_0);
        attribute.set::<LevelSlot<1>>(level_1);
        attribute.set::<LevelSlot<2>>(level_2);
        attribute.set::<LevelSlot<3>>(level_3);
        attribute.set::<LevelDetailSlot>(LevelDetail::all(self));
        attribute.set::<RootsSlot>(RootParams::new(self));
        attribute.set::<LeavesSlot>(LeafParams::new(self));
        attribute.set::<BarkLookSlot>(BarkLook::new(self));
        attribute.set::<LeafLookSlot>(LeafLook::new(self));
    }
}
