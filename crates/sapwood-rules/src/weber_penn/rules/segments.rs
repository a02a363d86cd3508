//! Trees whose stems are drawn segment by segment, as the thesis drew them before welding.

use sapwood_geom::{Content, Digester, Pieces, Shared, SharedMesh};
use sapwood_graph::{Named, Offers, Pieced, Shown};
use sapwood_scene::{Context, Rule, RuleError, Style, StyleSlot};

use super::super::geometry::segments_by_stem;
use super::super::slots::{BarkLookSlot, BarkSlot};
use super::super::{Stem, StemSurface};
use super::geometry::{material, stem_detail, trunk_form};
use super::skeleton::draw_stem_lines;

/// Compiles stems into one mesh of separate segments, or what else the style asks for.
pub(super) struct SegmentsRule;

/// The segments of a batch of stems, for whoever welds them; nothing where no surface was made.
pub(super) struct Segmented(Option<Shared<Pieces>>);

impl Content for Segmented {
    fn write(&self, digester: &mut Digester) {
        digester.add(&self.0);
    }
}

impl Pieced for Segmented {
    fn pieces(&self) -> Option<&Shared<Pieces>> {
        self.0.as_ref()
    }
}

impl Rule for SegmentsRule {
    type Component = StemSurface;
    type Data = Segmented;
    const NAME: &'static str = "weber_penn.segments";

    fn interfaces(offers: &mut Offers<Segmented>) {
        offers.offer::<dyn Pieced>(|segmented| segmented);
    }

    fn init(&self, of: &StemSurface, cx: &mut Context<'_>) -> Result<Segmented, RuleError> {
        let style = *cx.read::<StyleSlot>();
        if style == Style::Skeleton {
            draw_stem_lines(of, cx);
            return Ok(Segmented(None));
        }
        let detail = stem_detail(cx);
        let look = cx.read::<BarkLookSlot>();
        let bark = if style == Style::Solid {
            let level = of.stems.stems.first().map_or(0, |stem| stem.seed.level);
            Some(material::<BarkSlot, _>(|| look.material(level, &detail), cx)?.0)
        } else {
            None
        };
        let form = trunk_form(of, cx);
        let charge = |triangles| cx.reserve_triangles(triangles as u64);
        let (pieces, ends) = segments_by_stem(&of.stems, &form, &detail, look.width, charge)?;
        if pieces.mesh.is_empty() {
            return Ok(Segmented(None));
        }
        let Some(bark) = bark else {
            cx.lines(Shared::new(pieces.mesh.edges()));
            return Ok(Segmented(None));
        };
        cx.mesh(SharedMesh::new(pieces.mesh.clone()), bark);
        cx.shows(Shown::spans::<Stem>(ends));
        // The pieces follow from these alone.
        let mut digester = Digester::new();
        digester.add(StemSurface::NAME).add(of).add(&*form).add(&*detail).add(&look.width);
        Ok(Segmented(Some(Shared::with_digest(digester.finish(), pieces))))
    }
}
