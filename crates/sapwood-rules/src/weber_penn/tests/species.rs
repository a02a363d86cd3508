//! Species for tests, built in code: what differs from the defaults.

use crate::weber_penn::{LeafShape, Origin, Species, Value, key};

fn species(name: &str, origin: Origin, values: &[(&str, f32)]) -> Species {
    let mut species = Species { name: name.into(), origin, ..Species::default() };
    for (name, value) in values {
        key(name).unwrap().set(&mut species, &Value::Number(*value)).unwrap();
    }
    assert_eq!(species.faults(), []);
    species
}

pub(super) fn aspen() -> Species {
    species(
        "Quaking Aspen",
        Origin::Paper,
        &[
            ("shape", 7.0),
            ("base_size", 0.4),
            ("scale", 13.0),
            ("scale_v", 3.0),
            ("ratio", 0.015),
            ("ratio_power", 1.2),
            ("lobes", 5.0),
            ("lobe_depth", 0.07),
            ("flare", 0.6),
            ("attraction_up", 0.5),
            ("leaves.count", 25.0),
            ("leaves.scale", 0.17),
            ("leaves.scale_x", 1.0),
            ("level.0.curve_v", 20.0),
            ("level.1.down_angle", 60.0),
            ("level.1.down_angle_v", -50.0),
            ("level.1.rotate", 140.0),
            ("level.1.branches", 50.0),
            ("level.1.length", 0.3),
            ("level.1.curve_res", 5.0),
            ("level.1.curve", -40.0),
            ("level.1.curve_v", 50.0),
            ("level.2.down_angle", 45.0),
            ("level.2.down_angle_v", 10.0),
            ("level.2.rotate", 140.0),
            ("level.2.branches", 30.0),
            ("level.2.length", 0.6),
            ("level.2.curve_res", 3.0),
            ("level.2.curve", -40.0),
            ("level.2.curve_v", 75.0),
            ("level.3.down_angle", 45.0),
            ("level.3.down_angle_v", 10.0),
            ("level.3.rotate", 77.0),
            ("level.3.branches", 10.0),
            ("level.3.length", 0.0),
        ],
    )
}

pub(super) fn tupelo() -> Species {
    species(
        "Black Tupelo",
        Origin::Paper,
        &[
            ("shape", 4.0),
            ("base_size", 0.2),
            ("scale", 23.0),
            ("scale_v", 5.0),
            ("levels", 4.0),
            ("ratio", 0.015),
            ("ratio_power", 1.3),
            ("lobes", 3.0),
            ("lobe_depth", 0.1),
            ("flare", 1.0),
            ("attraction_up", 0.5),
            ("leaves.count", 6.0),
            ("leaves.scale", 0.3),
            ("level.0.taper", 1.1),
            ("level.0.curve_res", 10.0),
            ("level.0.curve_v", 40.0),
            ("level.1.down_angle", 60.0),
            ("level.1.down_angle_v", -40.0),
            ("level.1.rotate", 140.0),
            ("level.1.branches", 50.0),
            ("level.1.length", 0.3),
            ("level.1.length_v", 0.05),
            ("level.1.curve_res", 10.0),
            ("level.1.curve_v", 90.0),
            ("level.2.down_angle_v", 10.0),
            ("level.2.rotate", 140.0),
            ("level.2.branches", 25.0),
            ("level.2.length", 0.6),
            ("level.2.length_v", 0.1),
            ("level.2.curve_res", 10.0),
            ("level.2.curve", -10.0),
            ("level.2.curve_v", 150.0),
            ("level.3.down_angle", 45.0),
            ("level.3.down_angle_v", 10.0),
            ("level.3.rotate", 140.0),
            ("level.3.branches", 12.0),
            ("level.3.length", 0.4),
        ],
    )
}

pub(super) fn willow() -> Species {
    species(
        "Weeping Willow",
        Origin::Paper,
        &[
            ("shape", 3.0),
            ("base_size", 0.05),
            ("scale", 15.0),
            ("scale_v", 5.0),
            ("levels", 4.0),
            ("ratio", 0.03),
            ("ratio_power", 2.0),
            ("lobes", 9.0),
            ("lobe_depth", 0.03),
            ("flare", 0.75),
            ("attraction_up", -3.0),
            ("trunk.base_splits", 2.0),
            ("leaves.count", 15.0),
            ("leaves.scale", 0.12),
            ("leaves.scale_x", 0.2),
            ("pruning.ratio", 1.0),
            ("pruning.width", 0.4),
            ("pruning.width_peak", 0.6),
            ("pruning.power_low", 0.001),
            ("level.0.length", 0.8),
            ("level.0.seg_splits", 0.1),
            ("level.0.split_angle", 3.0),
            ("level.0.curve_res", 8.0),
            ("level.0.curve_back", 20.0),
            ("level.0.curve_v", 120.0),
            ("level.1.down_angle", 20.0),
            ("level.1.down_angle_v", 10.0),
            ("level.1.rotate", -120.0),
            ("level.1.rotate_v", 30.0),
            ("level.1.branches", 25.0),
            ("level.1.length_v", 0.1),
            ("level.1.seg_splits", 0.2),
            ("level.1.split_angle", 30.0),
            ("level.1.split_angle_v", 10.0),
            ("level.1.curve_res", 16.0),
            ("level.1.curve", 40.0),
            ("level.1.curve_back", 80.0),
            ("level.1.curve_v", 90.0),
            ("level.2.down_angle_v", 10.0),
            ("level.2.rotate", -120.0),
            ("level.2.rotate_v", 30.0),
            ("level.2.branches", 10.0),
            ("level.2.length", 1.5),
            ("level.2.seg_splits", 0.2),
            ("level.2.split_angle", 45.0),
            ("level.2.split_angle_v", 20.0),
            ("level.2.curve_res", 12.0),
            ("level.3.down_angle", 20.0),
            ("level.3.down_angle_v", 10.0),
            ("level.3.rotate", 140.0),
            ("level.3.branches", 300.0),
            ("level.3.length", 0.1),
        ],
    )
}

pub(super) fn palm() -> Species {
    let mut species = species(
        "Palm",
        Origin::Arbaro,
        &[
            ("shape", 4.0),
            ("base_size", 0.95),
            ("scale", 12.0),
            ("scale_v", 10.0),
            ("levels", 2.0),
            ("ratio", 0.015),
            ("ratio_power", 2.0),
            ("flare", 0.0),
            ("leaves.count", 250.0),
            ("leaves.scale", 0.6),
            ("leaves.scale_x", 0.06),
            ("leaves.stem_len", 0.0),
            ("level.0.taper", 2.1),
            ("level.0.curve_res", 12.0),
            ("level.0.curve", 20.0),
            ("level.0.curve_back", -5.0),
            ("level.0.curve_v", 10.0),
            ("level.1.down_angle", 70.0),
            ("level.1.down_angle_v", -80.0),
            ("level.1.rotate_v", 60.0),
            ("level.1.branches", 33.0),
            ("level.1.length", 0.4),
            ("level.1.length_v", 0.05),
            ("level.1.curve_res", 9.0),
            ("level.1.curve", 50.0),
            ("level.1.curve_v", 20.0),
            ("level.2.down_angle", 50.0),
            ("level.2.down_angle_v", -50.0),
            ("level.2.rotate", -120.0),
            ("level.2.rotate_v", 20.0),
        ],
    );
    species.leaves.shape = LeafShape::Palm;
    species
}

pub(super) fn wheat() -> Species {
    let mut species = species(
        "Wheat",
        Origin::Arbaro,
        &[
            ("shape", 3.0),
            ("base_size", 0.85),
            ("scale", 0.6),
            ("scale_v", 0.1),
            ("levels", 2.0),
            ("ratio", 0.002),
            ("ratio_power", 0.0),
            ("flare", 0.0),
            ("leaves.count", -1.0),
            ("leaves.scale", 0.01),
            ("leaves.bend", 0.0),
            ("leaves.stem_len", -1.2),
            ("leaves.distrib", 3.0),
            ("level.0.down_angle_v", 40.0),
            ("level.0.rotate_v", 80.0),
            ("level.0.branches", 49.0),
            ("level.0.branch_dist", 0.1),
            ("level.0.taper", 0.5),
            ("level.0.curve_res", 13.0),
            ("level.0.curve_back", 30.0),
            ("level.0.curve_v", 20.0),
            ("level.1.down_angle", 25.0),
            ("level.1.down_angle_v", -5.0),
            ("level.1.rotate_v", 10.0),
            ("level.1.branches", 35.0),
            ("level.1.length", 0.025),
            ("level.1.taper", 0.5),
            ("level.1.curve_back", 20.0),
            ("level.2.down_angle", 0.0),
            ("level.2.rotate", 0.0),
        ],
    );
    species.leaves.shape = LeafShape::Sphere;
    species
}

pub(super) fn all() -> [Species; 5] {
    [aspen(), tupelo(), willow(), palm(), wheat()]
}
