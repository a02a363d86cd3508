//! Stems as solids: each tube shut at both ends, so that tubes can be joined to one body. The
//! tubes are those of [`surface`](super::surface()); joining them is geometry's work.

use sapwood_geom::{Cap, Mesh, Ring, Sweep, SweepOptions};

use super::Detail;
use super::surface::Tubes;
use crate::weber_penn::{Stems, TrunkForm};

/// Every stem of a batch as a closed tube of its own, in tree space and in the stems' order; empty
/// meshes stand for stems that have no surface.
///
/// Stems begin inside their parent, where they do in [`surface`](super::surface()) too. A clone
/// begins inside the stem that it split from: half a radius before the ring where it leaves, and
/// a little thinner there than that stem, so that no two tubes share a surface. Charged as by
/// [`surface`](super::surface()).
pub fn closed_stems<E>(
    stems: &Stems,
    form: &TrunkForm,
    detail: &Detail,
    bark_width: f32,
    mut charge: impl FnMut(usize) -> Result<(), E>,
) -> Result<Vec<Mesh>, E> {
    let mut tubes = Tubes::new(stems, form, detail, bark_width);
    let mut sweep = Sweep::default();
    let mut rings = Vec::new();
    let mut closed = Vec::with_capacity(stems.stems.len());
    for (index, stem) in stems.stems.iter().enumerate() {
        tubes.lay(index);
        let (section, laid, options) = tubes.laid();
        let options = SweepOptions { base: Cap::Flat, ..*options };
        rings.clear();
        rings.extend_from_slice(laid);
        if let (Some(_), Some(tangent), Some(foot)) =
            (stem.clone_of, options.start.tangent, rings.first_mut())
        {
            // Clones that leave at one place must not share a surface either.
            let thinner = 0.99 - 0.04 * share(index);
            let Ring { center, radius } = *foot;
            foot.radius = radius * thinner;
            let inside =
                Ring { center: center - tangent * (0.5 * radius), radius: 0.9 * foot.radius };
            rings.insert(0, inside);
        }
        charge(sweep.lay(section, &rings, &options))?;
        let mut mesh = Mesh::default();
        sweep.write(section, &mut mesh);
        closed.push(mesh);
    }
    Ok(closed)
}

/// A share from 0 to 1 that differs well between neighbouring numbers: multiples of the golden
/// ratio.
fn share(number: usize) -> f32 {
    ((number as u32).wrapping_mul(0x9e37_79b9) >> 8) as f32 / (1 << 24) as f32
}
