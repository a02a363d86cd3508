//! Where along a stem its surface needs rings besides the ends of its segments: flared feet, ball
//! ends, the bumps of periodic taper and the turns of a helix.

use super::Detail;
use crate::weber_penn::{Stem, TrunkForm};

/// Finds where a stem needs rings between its segment ends because its profile is curved there
/// or its centre line winds; appends the places `z`, ascending.
pub(crate) fn find_places(
    stem: &Stem,
    form: &TrunkForm,
    detail: &Detail,
    sides: u32,
    places: &mut Vec<f32>,
) {
    let has_flare = stem.seed.level == 0 && form.flare != 0.0;
    let is_curved = stem.taper > 1.0 || has_flare || stem.helix_radius != 0.0;
    if !is_curved {
        return;
    }
    if has_flare {
        // Denser toward the foot, where the flare falls fastest.
        let n = detail.n_rings(10.0, 4);
        places.extend((1..=n).map(|i| {
            let part = i as f32 / n as f32;
            0.125 * part * part.sqrt()
        }));
    }
    if stem.helix_radius != 0.0 {
        // A turn for each segment; twigs wind in octagons.
        let n = detail.n_rings(if stem.seed.level < 2 { 10.0 } else { 8.0 }, 4) * stem.curve_res;
        places.extend((1..n).map(|i| i as f32 / n as f32));
    }
    if stem.taper > 1.0 {
        find_tip_places(stem, detail, sides, places);
        if stem.taper > 2.001 {
            find_bump_places(stem, detail, places);
        }
    }
    let z_start = stem.z_start();
    places.retain(|z| *z > z_start && *z < 1.0);
    places.sort_unstable_by(f32::total_cmp);
}

/// Adds to the places of a stem those that divide its segments evenly, where its level asks for more
/// pieces than segments; all stay ascending.
pub(crate) fn divide_segments(stem: &Stem, detail: &Detail, places: &mut Vec<f32>) {
    let n_before = places.len();
    for i in stem.start..stem.curve_res {
        let Some(pieces) = detail.n_pieces(stem, i) else { return };
        places.extend(
            (1..pieces)
                .map(|piece| (i as f32 + piece as f32 / pieces as f32) / stem.curve_res as f32),
        );
    }
    if n_before > 0 && places.len() > n_before {
        places.sort_unstable_by(f32::total_cmp);
    }
}

/// The ball end: rings at even angles of the quarter circle.
fn find_tip_places(stem: &Stem, detail: &Detail, sides: u32, places: &mut Vec<f32>) {
    let (length, radius) = (stem.seed.length, stem.seed.radius);
    let unit_taper = (2.0 - stem.taper).max(0.0);
    // Where the metres left equal the radius that the straight taper has there.
    let left = if length > radius {
        length * (1.0 - (length - radius) / (length - radius * unit_taper))
    } else {
        length
    };
    let n = detail.n_rings(0.5 * sides as f32, 2).min(64);
    places.extend((1..=n).map(|i| {
        let angle = std::f32::consts::FRAC_PI_2 * (i as f32 / n as f32);
        1.0 - left * (1.0 - libm::cosf(angle)) / length
    }));
}

/// Periodic taper: rings at even angles of every bump, pinches and widest places among them;
/// where there are too many bumps for that, even steps.
fn find_bump_places(stem: &Stem, detail: &Detail, places: &mut Vec<f32>) {
    let (length, radius) = (stem.seed.length, stem.seed.radius);
    let n_bumps = length / (2.0 * radius.max(1e-6));
    let n_even = detail.n_rings(20.0, 4) * stem.curve_res;
    let most = 3.0 * n_even as f32;
    let fine = 2 * detail.n_rings(3.0, 1);
    let Some(n) = [fine, 2].into_iter().find(|n| n_bumps * *n as f32 <= most) else {
        places.extend((1..n_even).map(|i| i as f32 / n_even as f32));
        return;
    };
    for bump in 0..n_bumps.ceil() as u32 {
        for i in 0..n {
            let angle = std::f32::consts::PI * (i as f32 / n as f32);
            let left = radius * (2.0 * bump as f32 + 1.0 - libm::cosf(angle));
            // The first half of the first bump is the ball end.
            if left >= radius {
                places.push(1.0 - left / length);
            }
        }
    }
}
