//! The wood of every built-in species as one closed surface: time, triangles, what had to be
//! mended, and whether the surface is what it should be.
//!
//! *tips*: of the stems more than 2 mm thick, how many have their tip farther than 1 mm from the
//! surface. *volume*: of the union, against that of a million random points of which each is
//! looked for in every single stem. Names of species after `--` take these alone.

use std::convert::Infallible;
use std::time::Instant;

use sapwood::geom::glam::Vec3;
use sapwood::geom::{
    Aabb, BoxTree, Mesh, MeshBvh, Purpose, Ray, Sides, Solid, Stream, StreamPath, union_of_meshes,
};
use sapwood::rules::weber_penn::{
    Crown, Detail, Level, Segment, Species, Target, TrunkForm, children, closed_stems, grow, trunks,
};

const N_POINTS: u32 = 1_000_000;

fn main() {
    let wanted: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    println!("species, stems, triangles before, after, seconds, mended, tips, volume");
    for name in sapwood::io::built_in_names() {
        if wanted.is_empty() || wanted.iter().any(|wanted| *wanted == *name) {
            let species = sapwood::io::find_species(name).expect("the species is built in");
            println!("{name}, {}", row(&Wood::of(&species)));
        }
    }
}

fn row(wood: &Wood) -> String {
    let start = Instant::now();
    let groups = vec![0; wood.stems.len()];
    let joined = union_of_meshes(&wood.stems, &groups, 1, u64::MAX, &|_| true);
    let seconds = start.elapsed().as_secs_f64();
    let before: usize = wood.stems.iter().map(Mesh::n_triangles).sum();
    let (_, union) = match joined {
        Ok(joined) => joined,
        Err(error) => return format!("{before}, {seconds:.1} s: {error}"),
    };
    let boxes = (0..union.solid.triangles.len())
        .map(|triangle| Aabb::of_points(union.solid.corners(triangle)));
    let tree = BoxTree::new(boxes);
    let is_far = |tip: &&Vec3| !is_near(&union.solid, &tree, **tip, 1e-3);
    let n_far = wood.tips.iter().filter(is_far).count();
    let expected = wood.volume();
    format!(
        "{}, {before}, {}, {seconds:.1}, {}, {n_far} of {}, {:+.2} % of {expected:.4} m3; {}",
        wood.stems.len(),
        union.solid.triangles.len(),
        union.mended.faults,
        wood.tips.len(),
        100.0 * (union.report.volume / expected - 1.0),
        union.report
    )
}

/// Whether the surface comes as near to a point as `reach` metres.
fn is_near(solid: &Solid, tree: &BoxTree, point: Vec3, reach: f32) -> bool {
    let around = Aabb { min: point - Vec3::splat(reach), max: point + Vec3::splat(reach) };
    let mut is_near = false;
    tree.within(&around, |triangle| {
        is_near |= distance(solid.corners(triangle as usize), point) <= reach;
    });
    is_near
}

/// The distance of a point from a triangle.
fn distance([a, b, c]: [Vec3; 3], point: Vec3) -> f32 {
    let normal = (b - a).cross(c - a);
    let sides = [(a, b), (b, c), (c, a)];
    if sides.iter().all(|(from, to)| (to - from).cross(point - from).dot(normal) >= 0.0) {
        return (point - a).dot(normal.normalize_or_zero()).abs();
    }
    let beside = sides.map(|(from, to)| {
        let along = to - from;
        let share = (point - from).dot(along) / along.length_squared();
        point.distance(from + along * share.clamp(0.0, 1.0))
    });
    beside.into_iter().fold(f32::INFINITY, f32::min)
}

/// The stems of a tree, each by itself.
struct Wood {
    stems: Vec<Mesh>,
    /// Of stems more than 2 mm thick.
    tips: Vec<Vec3>,
    /// Boxes around segments, which cover all stems.
    boxes: Vec<SegmentBox>,
}

/// A box along a segment.
struct SegmentBox {
    segment: Segment,
    half_width: f32,
}

impl SegmentBox {
    fn length(&self) -> f32 {
        self.segment.length + 2.0 * self.half_width
    }

    fn volume(&self) -> f64 {
        4.0 * f64::from(self.half_width * self.half_width * self.length())
    }

    /// The point at shares from 0 to 1 of its edges.
    fn point(&self, [x, y, z]: [f32; 3]) -> Vec3 {
        let across = |share: f32| (2.0 * share - 1.0) * self.half_width;
        let along = z * self.length() - self.half_width;
        self.segment.frame.point(Vec3::new(across(x), across(y), along))
    }

    fn contains(&self, point: Vec3) -> bool {
        let local = self.segment.frame.axes.transpose() * (point - self.segment.frame.origin);
        let along = local.z + self.half_width;
        local.x.abs() <= self.half_width
            && local.y.abs() <= self.half_width
            && (0.0..=self.length()).contains(&along)
    }

    fn aabb(&self) -> Aabb {
        let ends = [0.0, 1.0];
        let corners = ends.into_iter().flat_map(|x| {
            ends.into_iter().flat_map(move |y| ends.into_iter().map(move |z| [x, y, z]))
        });
        Aabb::of_points(corners.map(|corner| self.point(corner)))
    }
}

impl Wood {
    fn of(species: &Species) -> Self {
        let free = &mut |_| Ok::<(), Infallible>(());
        let (crown, levels) = (Crown::new(species), Level::all(species));
        let (trunk, plain) = (TrunkForm::new(species), TrunkForm::new(&Species::default()));
        let mut wood = Self { stems: Vec::new(), tips: Vec::new(), boxes: Vec::new() };
        let Ok(mut seeds) = trunks(&crown, &levels[0], StreamPath::new(0), free);
        for n in 0..species.levels as usize {
            let Ok(stems) = grow(&seeds, &crown, &levels[n], &Target::Up, free);
            let form = if n == 0 { &trunk } else { &plain };
            if n + 1 < species.levels as usize {
                let Ok(next) =
                    children(&stems, &crown, (n == 0).then_some(form), &levels[n + 1], free);
                seeds = next;
            }
            let Ok(closed) = closed_stems(&stems, form, &Detail::default(), 0.5, &mut *free);
            for (index, mesh) in closed.into_iter().enumerate() {
                let stem = &stems.stems[index];
                let segments = stems.segments_of(index);
                if let Some(last) = segments.last().filter(|_| !mesh.is_empty()) {
                    if stem.seed.radius > 1e-3 && stem.helix_radius == 0.0 {
                        wood.tips.push(last.end());
                    }
                    wood.stems.push(mesh);
                }
                let wider = if n == 0 { 3.0 } else { 1.3 };
                wood.boxes.extend(segments.iter().map(|segment| SegmentBox {
                    segment: *segment,
                    half_width: wider * segment.radius_foot.max(segment.radius_end)
                        + 2.0 * stem.helix_radius.abs(),
                }));
            }
        }
        wood
    }

    /// The volume of what is inside any stem: points in boxes that overlap weigh as much less.
    fn volume(&self) -> f64 {
        let in_boxes = BoxTree::new(self.boxes.iter().map(SegmentBox::aabb));
        let in_stems = BoxTree::new(self.stems.iter().map(|mesh| mesh.bound().aabb));
        let trees: Vec<MeshBvh> = self.stems.iter().map(MeshBvh::new).collect();
        let mut sums = vec![0.0];
        for segment in &self.boxes {
            sums.push(sums[sums.len() - 1] + segment.volume());
        }
        let all = sums[sums.len() - 1];
        let mut stream = Stream::new(StreamPath::new(1), Purpose("volume"));
        let mut weight = 0.0;
        for number in 0..N_POINTS {
            // Points are spread evenly over the boxes' volume.
            let place = all * (f64::from(number) + f64::from(stream.unit())) / f64::from(N_POINTS);
            let index = sums.partition_point(|sum| *sum <= place).clamp(1, self.boxes.len()) - 1;
            let point = self.boxes[index].point([(); 3].map(|()| stream.unit()));
            let here = Aabb { min: point, max: point };
            let ray = Ray::new(point, Vec3::new(0.36, 0.48, 0.8));
            let mut is_inside = false;
            in_stems.within(&here, |stem| {
                let (mesh, tree) = (&self.stems[stem as usize], &trees[stem as usize]);
                is_inside = is_inside
                    || tree
                        .closest(mesh, &ray, f64::INFINITY, Sides::Both)
                        .is_some_and(|hit| !hit.is_front);
            });
            if is_inside {
                let mut n_boxes = 0;
                in_boxes.within(&here, |i| {
                    n_boxes += u32::from(self.boxes[i as usize].contains(point));
                });
                weight += 1.0 / f64::from(n_boxes.max(1));
            }
        }
        all * weight / f64::from(N_POINTS)
    }
}
