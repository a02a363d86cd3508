//! Radius along a stem: taper, ball ends and periodic bumps, and the foot of the trunk
//! (Weber and Penn 1995, section 4.4).

/// The radius in metres at `z` (0 base, 1 tip) of a stem with this taper code, base radius and
/// length in metres.
pub(crate) fn taper_radius(n_taper: f32, radius: f32, length: f32, z: f32) -> f32 {
    let unit_taper = match n_taper {
        t if t < 1.0 => t,
        t if t < 2.0 => 2.0 - t,
        _ => 0.0,
    };
    let taper_z = radius * (1.0 - unit_taper * z);
    if n_taper < 1.0 {
        return taper_z.max(0.0);
    }
    // Where the cone has come to its point there is nothing to divide by.
    if taper_z <= 0.0 {
        return 0.0;
    }
    let z_2 = (1.0 - z) * length;
    let depth = if n_taper < 2.0 || z_2 < taper_z { 1.0 } else { n_taper - 2.0 };
    let z_3 = if n_taper < 2.0 {
        z_2
    } else {
        (z_2 - 2.0 * taper_z * (z_2 / (2.0 * taper_z) + 0.5).trunc()).abs()
    };
    if n_taper < 2.0 && z_3 >= taper_z {
        return taper_z;
    }
    let chord = taper_z * taper_z - (z_3 - taper_z) * (z_3 - taper_z);
    (1.0 - depth) * taper_z + depth * chord.max(0.0).sqrt()
}

/// The factor by which the trunk's foot widens at `z`; 1 above the lowest eighth.
pub(crate) fn flare_factor(flare: f32, z: f32) -> f32 {
    let y = 1.0 - 8.0 * z;
    if flare == 0.0 || y <= 0.0 {
        return 1.0;
    }
    flare * (libm::powf(100.0, y) - 1.0) / 100.0 + 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn taper_follows_the_check_table() {
        let z = [0.0, 0.25, 0.5, 0.9, 0.96, 0.98, 0.99, 1.0];
        let rows: [(f32, [f32; 8]); 6] = [
            (0.5, [0.2, 0.175, 0.15, 0.11, 0.104, 0.102, 0.101, 0.1]),
            (1.0, [0.2, 0.15, 0.1, 0.02, 0.008, 0.004, 0.002, 0.0]),
            (1.5, [0.2, 0.175, 0.15, 0.11, 0.104, 0.0996, 0.0805, 0.0]),
            (2.0, [0.2, 0.2, 0.2, 0.2, 0.19596, 0.16, 0.12, 0.0]),
            (2.2, [0.16, 0.2, 0.16, 0.16, 0.19596, 0.16, 0.12, 0.0]),
            (2.9, [0.02, 0.2, 0.02, 0.02, 0.19596, 0.16, 0.12, 0.0]),
        ];
        for (n_taper, radii) in rows {
            for (z, expected) in z.into_iter().zip(radii) {
                let radius = taper_radius(n_taper, 0.2, 4.0, z);
                // The table has up to five digits; near the tip a rounding of z in the seventh
                // place moves the root of a small difference into the fourth.
                assert!((radius - expected).abs() < 2e-4, "{n_taper} at {z}: {radius}");
            }
        }
    }

    #[test]
    fn a_cylinder_keeps_its_radius() {
        assert_eq!(taper_radius(0.0, 0.3, 2.0, 1.0), 0.3);
    }

    #[test]
    fn nothing_divides_by_a_radius_of_zero() {
        for n_taper in [0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 2.99] {
            for z in [0.0, 0.5, 1.0] {
                assert_eq!(taper_radius(n_taper, 0.0, 4.0, z), 0.0);
                assert!(taper_radius(n_taper, 0.2, 0.0, z).is_finite());
            }
        }
    }

    #[test]
    fn flare_follows_the_check_values() {
        for (z, expected) in
            [(0.0, 1.594), (0.05, 1.08909), (0.1, 1.00907), (0.125, 1.0), (0.5, 1.0)]
        {
            assert!((flare_factor(0.6, z) - expected).abs() < 1e-4, "at {z}");
        }
    }
}
