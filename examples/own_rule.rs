//! A rule and a traversal of one's own: trees of square timber, and how much wood and leaf there
//! is on each metre of height.
//!
//! `cargo run --example own_rule [FOLDER]` writes `own_rule.glb`.

use std::collections::BTreeMap;
use std::error::Error;
use std::f32::consts::{FRAC_PI_4, PI};
use std::path::PathBuf;
use std::sync::Arc;

use sapwood::geom::glam::{Affine3, Mat3, Vec2, Vec3};
use sapwood::geom::{Mesh, SharedMesh};
use sapwood::graph::{Everything, Handlers, Material, Order};
use sapwood::rules::weber_penn::{Leaf, Seed, Segment, StemSurface, Tree};
use sapwood::scene::{
    Context, Group, HeldGeometry, NodeId, Rule, RuleError, RuleSet, Scene, Transform,
};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).unwrap_or("target/examples-out".into());
    let folder = PathBuf::from(folder);
    std::fs::create_dir_all(&folder)?;

    // Two aspens on a slab of stone.
    let species = sapwood::io::find_species("quaking_aspen")?;
    let mut scene = Scene::new();
    let garden = scene.add(Group);
    let slab = HeldGeometry::new(slab(), Material::matte("stone", 0.4, 0.4, 0.38));
    let slab = scene.add_to(garden, slab)?;
    let mut aspens = Vec::new();
    for (seed, x) in [(1, -4.0), (2, 4.0)] {
        let place = scene.add_to(garden, Transform::translation(x, 0.0, 0.0))?;
        let aspen = scene.add_to(place, species.attribute())?;
        scene.add_to(aspen, Tree { seed: Seed::Explicit(seed) })?;
        aspens.push(aspen);
    }

    // The standard rules, but for the surface of stems: a layer over them replaces one rule.
    let rules = RuleSet::new().with(TimberRule).over(&sapwood::standard_rules());

    // The same traversal goes over whatever there is.
    let roots: [(&str, NodeId); 3] =
        [("the garden", garden.into()), ("the slab", slab.into()), ("an aspen", aspens[0].into())];
    for (name, root) in roots {
        println!("{name}:\n{}", PerMetre::of(&mut scene, root, &rules)?.table());
    }

    let view = scene.open_view(garden, &rules)?;
    let path = folder.join("own_rule.glb");
    sapwood::io::write_glb(&path, &scene.draw_list(view, 100_000)?)?;
    println!("{}", path.display());
    Ok(())
}

/// Compiles stems into beams of square timber, one for each segment, with as much wood in them
/// as the stem has at the middle of the segment.
struct TimberRule;

impl Rule for TimberRule {
    type Component = StemSurface;
    type Data = ();
    const NAME: &'static str = "timber";

    fn init(&self, of: &StemSurface, cx: &mut Context<'_>) -> Result<(), RuleError> {
        let beam = cuboid();
        let mut mesh = Mesh::default();
        for segment in &of.stems.segments {
            let radius = (segment.radius_foot + segment.radius_end) / 2.0;
            let side = radius * PI.sqrt();
            // Too thin to be sawn.
            if side < 2e-3 {
                continue;
            }
            // A budget is asked before memory is taken, so that no species can exhaust it.
            cx.reserve_triangles(beam.n_triangles() as u64)?;
            let Mat3 { x_axis, y_axis, z_axis } = segment.frame.axes;
            let size = Mat3::from_cols(x_axis * side, y_axis * side, z_axis * segment.length);
            let middle = (segment.frame.origin + segment.end()) / 2.0;
            mesh.append(&beam, &Affine3::from_mat3_translation(size, middle));
        }
        if !mesh.is_empty() {
            let oak = Material::matte("timber", 0.45, 0.28, 0.13);
            cx.mesh(SharedMesh::new(mesh), Arc::new(oak));
        }
        Ok(())
    }
}

/// Metres of wood and square metres of leaves, by whole metres of height in the world.
#[derive(Default)]
struct PerMetre(BTreeMap<i32, (f32, f32)>);

impl PerMetre {
    /// Goes over everything below `root`. Plans without segments and leaves are passed through,
    /// whatever they are.
    fn of(scene: &mut Scene, root: NodeId, rules: &RuleSet) -> Result<Self, Box<dyn Error>> {
        let handlers = Handlers::<Self>::new()
            .on_parts::<Segment>(|table, segments, at| {
                for segment in segments {
                    let ends = [segment.frame.origin, segment.end()];
                    let [foot, end] = ends.map(|end| at.world().transform_point3(end));
                    table.add_wood(foot, end);
                }
            })
            .on_parts::<Leaf>(|table, leaves, at| {
                for leaf in leaves {
                    // As an ellipse; a transform above may stretch it.
                    let across = at.world().transform_vector3(leaf.frame.axes.x_axis * leaf.width);
                    let along = at.world().transform_vector3(leaf.frame.axes.z_axis * leaf.length);
                    let middle = leaf.frame.origin + leaf.frame.axes.z_axis * leaf.length / 2.0;
                    let height = at.world().transform_point3(middle).y;
                    table.at(height).1 += FRAC_PI_4 * across.cross(along).length();
                }
            });
        let view = scene.open_view(root, rules)?;
        let mut table = Self::default();
        scene.traverse(view, Order::Pre, &Everything, &mut |at| handlers.handle(&mut table, at))?;
        scene.close_view(view)?;
        Ok(table)
    }

    fn at(&mut self, height: f32) -> &mut (f32, f32) {
        self.0.entry(height.floor() as i32).or_default()
    }

    /// Shares a piece of wood out among the metres that it passes.
    fn add_wood(&mut self, foot: Vec3, end: Vec3) {
        let (low, high) = (foot.y.min(end.y), foot.y.max(end.y));
        let mut from = low;
        while from < high {
            let to = high.min(from.floor() + 1.0);
            self.at(from).0 += foot.distance(end) * (to - from) / (high - low);
            from = to;
        }
        if low == high {
            self.at(low).0 += foot.distance(end);
        }
    }

    /// The table, from the top down as trees stand.
    fn table(&self) -> String {
        if self.0.is_empty() {
            return "  no wood and no leaves\n".to_owned();
        }
        let mut text = "  height     wood     leaves\n".to_owned();
        for (height, (wood, leaves)) in self.0.iter().rev() {
            text += &format!("{height:>5} m  {wood:>5.1} m  {leaves:>6.2} m2\n");
        }
        text
    }
}

/// A slab, its top at height 0.
fn slab() -> Mesh {
    let size = Mat3::from_diagonal(Vec3::new(16.0, 0.5, 8.0));
    let mut mesh = Mesh::default();
    mesh.append(&cuboid(), &Affine3::from_mat3_translation(size, Vec3::new(0.0, -0.25, 0.0)));
    mesh
}

/// A box of edge length 1 about the origin.
fn cuboid() -> Mesh {
    let mut mesh = Mesh::default();
    for normal in [Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z] {
        let across = normal.any_orthonormal_vector();
        let up = normal.cross(across);
        let first = mesh.positions.len() as u32;
        for (u, v) in [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)] {
            mesh.positions.push(0.5 * normal + u * across + v * up);
            mesh.normals.push(normal);
            mesh.uvs.push(Vec2::new(0.5 + u, 0.5 - v));
        }
        // Counter-clockwise seen from outside.
        mesh.indices.extend([0, 1, 2, 0, 2, 3].map(|corner| first + corner));
    }
    mesh
}
