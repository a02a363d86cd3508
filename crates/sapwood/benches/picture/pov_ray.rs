//! The same mesh, camera and sun in POV-Ray: a ray tracer of long standing.

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use sapwood::geom::Mesh;
use sapwood::geom::glam::Vec3;
use sapwood::graph::{DrawList, Lens};
use sapwood::picture::{PlacedCamera, Sun};

use crate::{Time, timed};

/// Draws what a list holds with POV-Ray, with the same number of rays through each pixel and one
/// toward the sun from where each arrives, and tells how long it took. Images are left out, for
/// both: POV-Ray gets one colour for each material.
pub(crate) fn compare(list: &DrawList, camera: &PlacedCamera, size: u32) {
    let folder = std::env::temp_dir().join(format!("sapwood-pov-{}", std::process::id()));
    let is_there = Command::new("povray").arg("--version").output().is_ok();
    if !is_there {
        println!("\nPOV-Ray is not installed: not compared");
        return;
    }
    std::fs::create_dir_all(&folder).expect("there is room for temporary files");
    let scene = folder.join("tupelo.pov");
    std::fs::write(&scene, described(list, camera)).expect("there is room for temporary files");
    println!("\nPOV-Ray, {size} x {size}, 4 samples, shadows of the sun, no sky:");
    for n_threads in [1, 2] {
        let (Time { wall, .. }, told) = timed(|| run(&folder, &scene, size, n_threads));
        println!("{n_threads} threads: {:.3} s wall, reading included", wall.as_secs_f64());
        for line in
            told.lines().filter(|line| line.contains("e Time:") || line.contains("Samples:"))
        {
            println!("  {}", line.trim());
        }
    }
    // What is left over harms nobody.
    let _ = std::fs::remove_dir_all(&folder);
}

fn run(folder: &Path, scene: &Path, size: u32, n_threads: u32) -> String {
    let output = Command::new("povray")
        .current_dir(folder)
        .arg(format!("+I{}", scene.display()))
        .arg("+Otupelo.png")
        .args([format!("+W{size}"), format!("+H{size}"), format!("+WT{n_threads}")])
        // Two by two rays through each pixel, whatever they see.
        .args(["-D", "+A0.0", "+AM1", "+R2", "-J"])
        .output()
        .expect("POV-Ray was there a moment ago");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The scene in POV-Ray's language. Ours is right-handed, which a camera with a negative `right`
/// makes of POV-Ray's.
fn described(list: &DrawList, camera: &PlacedCamera) -> String {
    let Lens::Perspective { vertical_angle } = camera.camera.lens else {
        unreachable!("the bench's camera has a perspective lens")
    };
    let eye = camera.world.translation;
    let ahead = eye - camera.world.matrix3.z_axis;
    let sun = Sun::default();
    let place = eye + sun.toward.normalize() * 1e4;
    let angle = vertical_angle.to_degrees();
    let mut text = format!(
        "#version 3.7;\nglobal_settings {{ assumed_gamma 1.0 }}\nbackground {{ rgb 0.8 }}\n\
         camera {{ perspective location {} right -x up y look_at {} angle {angle} }}\n\
         light_source {{ {} rgb 1.0 parallel point_at {} }}\n",
        vector(eye),
        vector(ahead),
        vector(place),
        vector(eye),
    );
    let mut materials: Vec<(String, Mesh)> = Vec::new();
    let list = list.as_drawn();
    for (world, row) in list.placed_rows() {
        let [r, g, b, _] = row.material.base_color;
        let color = format!("<{r},{g},{b}>");
        let number = materials.iter().position(|(known, _)| *known == color);
        let number = number.unwrap_or_else(|| {
            materials.push((color, Mesh::default()));
            materials.len() - 1
        });
        let mesh = &mut materials[number].1;
        match &row.instances {
            None => mesh.append(&row.mesh, &world),
            Some(places) => {
                places.iter().for_each(|place| mesh.append(&row.mesh, &(world * *place)));
            }
        }
    }
    for (color, mesh) in &materials {
        text.push_str("mesh2 {\n");
        list_of(&mut text, "vertex_vectors", mesh.positions.iter().map(|p| vector(*p)));
        list_of(&mut text, "normal_vectors", mesh.normals.iter().map(|n| vector(*n)));
        let corners = mesh.indices.chunks_exact(3).map(|t| format!("<{},{},{}>", t[0], t[1], t[2]));
        list_of(&mut text, "face_indices", corners);
        let _ = writeln!(
            text,
            "  texture {{ pigment {{ rgb {color} }} finish {{ ambient 0.3 diffuse 0.7 }} }}\n}}"
        );
    }
    text
}

fn vector(v: Vec3) -> String {
    format!("<{},{},{}>", v.x, v.y, v.z)
}

fn list_of(text: &mut String, name: &str, items: impl ExactSizeIterator<Item = String>) {
    let _ = write!(text, "  {name} {{ {}", items.len());
    for item in items {
        let _ = write!(text, ",{item}");
    }
    text.push_str(" }\n");
}
