//! A traversal of one's own: how much wood and leaf there is on each metre of height.
//!
//! `cargo run --example own_traversal` prints it for a group, for a held mesh and for a tree.

use std::collections::BTreeMap;
use std::error::Error;
use std::f32::consts::FRAC_PI_4;

use sapwood::geom::glam::Vec3;
use sapwood::geom::{Cap, Mesh, Ring, Section, Sweep, SweepOptions};
use sapwood::graph::{Everything, Handlers, Material, Order};
use sapwood::rules::weber_penn::{Leaf, Seed, Segment, Tree};
use sapwood::scene::{Group, HeldGeometry, NodeId, Scene, Transform};

fn main() -> Result<(), Box<dyn Error>> {
    // An aspen, and another one on a pedestal of stone.
    let species = sapwood::io::find_species("quaking_aspen")?;
    let mut scene = Scene::new();
    let garden = scene.add(Group);
    let aspen = scene.add_to(garden, species.attribute())?;
    scene.add_to(aspen, Tree { seed: Seed::Explicit(1) })?;
    let stone = HeldGeometry::new(column(2.0, 1.0), Material::matte("stone", 0.4, 0.4, 0.38));
    let place = scene.add_to(garden, Transform::translation(8.0, 0.0, 0.0))?;
    let stone = scene.add_to(place, stone)?;
    let place = scene.add_to(garden, Transform::translation(8.0, 2.0, 0.0))?;
    let raised = scene.add_to(place, species.attribute())?;
    scene.add_to(raised, Tree { seed: Seed::Explicit(2) })?;

    // The same traversal goes over whatever there is.
    let roots: [(&str, NodeId); 3] =
        [("the garden", garden.into()), ("the stone", stone.into()), ("an aspen", aspen.into())];
    for (name, root) in roots {
        let table = per_metre(&mut scene, root)?;
        println!("{name}, wood and leaves on {} metres:", table.len());
        // From the top down, as trees stand.
        for (height, (wood, leaves)) in table.iter().rev() {
            println!("{height:>5} m: {wood:>6.1} m of wood, {leaves:>6.2} m2 of leaves");
        }
    }
    Ok(())
}

/// Metres of wood and square metres of leaves, by whole metres of height in the world.
type PerMetre = BTreeMap<i32, (f32, f32)>;

/// Goes over everything below `root`. What has no segments and no leaves is passed through,
/// whatever it is.
fn per_metre(scene: &mut Scene, root: NodeId) -> Result<PerMetre, Box<dyn Error>> {
    let handlers = Handlers::<PerMetre>::new()
        .on_parts::<Segment>(|table, segments, at| {
            for segment in segments {
                let ends = [segment.frame.origin, segment.end()];
                let [foot, end] = ends.map(|end| at.world().transform_point3(end));
                // In pieces, for a segment may pass several metres.
                for piece in 0..16u8 {
                    let middle = foot.lerp(end, (f32::from(piece) + 0.5) / 16.0);
                    row(table, middle).0 += foot.distance(end) / 16.0;
                }
            }
        })
        .on_parts::<Leaf>(|table, leaves, at| {
            for leaf in leaves {
                // As an ellipse; a transform above may stretch it.
                let across = at.world().transform_vector3(leaf.frame.axes.x_axis * leaf.width);
                let along = at.world().transform_vector3(leaf.frame.axes.z_axis * leaf.length);
                let middle = at.world().transform_point3(leaf.frame.origin) + along / 2.0;
                row(table, middle).1 += FRAC_PI_4 * across.cross(along).length();
            }
        });
    let mut table = PerMetre::new();
    let view = scene.open_view(root, &sapwood::standard_rules())?;
    scene.traverse(view, Order::Pre, &Everything, &mut |at| handlers.handle(&mut table, at))?;
    scene.close_view(view)?;
    Ok(table)
}

fn row(table: &mut PerMetre, at: Vec3) -> &mut (f32, f32) {
    table.entry(at.y.floor() as i32).or_default()
}

/// A round column on the ground.
fn column(height: f32, radius: f32) -> Mesh {
    let rings = [Vec3::ZERO, Vec3::Y * height].map(|center| Ring { center, radius });
    let (section, mut sweep, mut mesh) = (Section::round(24), Sweep::default(), Mesh::default());
    sweep.lay(&section, &rings, &SweepOptions { base: Cap::Flat, ..SweepOptions::default() });
    sweep.write(&section, &mut mesh);
    mesh
}
