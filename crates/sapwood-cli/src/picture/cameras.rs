//! The cameras of a file, and which of them is asked for.

use sapwood::io::Model;
use sapwood::picture::PlacedCamera;

use crate::failure::Failure;

/// Cameras that are told of where none is found; more would drown the first.
const MOST_TOLD: usize = 12;
/// Characters of a name that are told.
const MOST_CHARACTERS: usize = 40;

/// A camera where a node puts it.
struct Found {
    placed: PlacedCamera,
    /// The name of its node.
    node: String,
}

impl Found {
    fn is_called(&self, name: &str) -> bool {
        !name.is_empty() && (self.placed.camera.name == name || self.node == name)
    }

    /// Its number and its name, or else that of its node.
    fn told(&self, number: usize) -> String {
        let own = &self.placed.camera.name;
        let name: String =
            if own.is_empty() { &self.node } else { own }.chars().take(MOST_CHARACTERS).collect();
        if name.is_empty() { number.to_string() } else { format!("{number} {name:?}") }
    }
}

/// The camera of a model with this name, whose node has this name, or with this number, counted
/// from 0 in the order of nodes.
pub(super) fn camera(model: &Model, wanted: &str) -> Result<PlacedCamera, Failure> {
    let placed = model.nodes.iter().zip(model.worlds()).filter_map(|(node, world)| {
        let camera = model.cameras[node.camera?].clone();
        Some(Found { placed: PlacedCamera { camera, world }, node: node.name.clone() })
    });
    chosen(placed.collect(), wanted)
        .map_err(|why| Failure::usage(format!("--camera {wanted}: {why}")))
}

fn chosen(mut cameras: Vec<Found>, wanted: &str) -> Result<PlacedCamera, String> {
    if cameras.is_empty() {
        return Err("there are no cameras in the file".to_owned());
    }
    let is_called = |(number, found): (usize, &Found)| found.is_called(wanted).then_some(number);
    let called: Vec<usize> = cameras.iter().enumerate().filter_map(is_called).collect();
    let told = |numbers: &[usize]| {
        let mut names: Vec<String> =
            numbers.iter().take(MOST_TOLD).map(|number| cameras[*number].told(*number)).collect();
        if numbers.len() > MOST_TOLD {
            names.push(format!("... {}", numbers[numbers.len() - 1]));
        }
        names.join(", ")
    };
    let number = match called.as_slice() {
        [number] => *number,
        [] => match wanted.parse().ok().filter(|number| *number < cameras.len()) {
            Some(number) => number,
            None => {
                let all: Vec<usize> = (0..cameras.len()).collect();
                return Err(format!("the file has no such camera (accepted: {})", told(&all)));
            }
        },
        several => {
            let n = several.len();
            return Err(format!("{n} cameras are called that (accepted: {})", told(several)));
        }
    };
    Ok(cameras.swap_remove(number).placed)
}

#[cfg(test)]
mod tests {
    use sapwood::geom::glam::{Affine3, Vec3};
    use sapwood::graph::{Camera, Lens};
    use sapwood::io::ModelNode;

    use super::*;

    /// A model with a node for each pair of names, of a camera and of its node; each stands at its
    /// number.
    fn model(names: &[(&str, &str)]) -> Model {
        let mut model = Model::default();
        for (number, (camera, node)) in names.iter().enumerate() {
            let lens = Lens::Perspective { vertical_angle: 1.0 };
            model.cameras.push(Camera { name: (*camera).to_owned(), lens, near: 0.1, far: None });
            model.roots.push(number);
            model.nodes.push(ModelNode {
                name: (*node).to_owned(),
                transform: Affine3::from_translation(Vec3::splat(number as f32)),
                camera: Some(number),
                ..ModelNode::default()
            });
        }
        model
    }

    fn found(names: &[(&str, &str)], wanted: &str) -> Result<f32, String> {
        match camera(&model(names), wanted) {
            Ok(placed) => Ok(placed.world.translation.x),
            Err(failure) => Err(format!("{failure:?}")),
        }
    }

    #[test]
    fn cameras_are_found_by_their_names_or_their_numbers() {
        let names = [("front", "a"), ("", "b"), ("0", ""), ("twin", "c"), ("twin", "d"), ("", "")];
        for (wanted, number) in
            [("front", 0.0), ("a", 0.0), ("b", 1.0), ("0", 2.0), ("1", 1.0), ("d", 4.0), ("5", 5.0)]
        {
            assert_eq!(found(&names, wanted), Ok(number), "{wanted}");
        }
        let error = |wanted: &str| found(&names, wanted).unwrap_err().replace('\\', "");
        let all = "(accepted: 0 \"front\", 1 \"b\", 2 \"0\", 3 \"twin\", 4 \"twin\", 5)";
        for wanted in ["back", "6", "-1", "", "Front"] {
            let told = format!("--camera {wanted}: the file has no such camera {all}");
            assert!(error(wanted).contains(&told), "{}", error(wanted));
        }
        let told = "2 cameras are called that (accepted: 3 \"twin\", 4 \"twin\")";
        assert!(error("twin").contains(told), "{}", error("twin"));
        let none = found(&[], "0").unwrap_err();
        assert!(none.contains("--camera 0: there are no cameras in the file"), "{none}");
        let many = found(&[("", ""); 20], "x").unwrap_err();
        assert!(
            many.contains("(accepted: 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, ... 19)"),
            "{many}"
        );
    }
}
