//! Building fragments.

use std::sync::{Arc, OnceLock};

use sapwood_geom::glam::{Affine3, Vec3};
use sapwood_geom::{Bound, Polyline, Shared, SharedMesh};
use smallvec::SmallVec;

use super::{
    Code, Drawn, Followed, Fragment, Instanced, Lined, Packed, RenderNode, Shown, StoredRun,
};
use crate::{Aspects, Camera, Facing, Fading, Kind, Label, Light, Limiter, Material, Rig};

/// Builds a [`Fragment`] node by node; whoever opens a node closes it.
pub struct FragmentBuilder {
    fragment: Fragment,
    open: SmallVec<[u32; 8]>,
    /// The run at the end of the node that is open, which further children may lengthen.
    run: Option<u32>,
}

impl FragmentBuilder {
    /// A builder whose top group is open.
    pub fn new() -> Self {
        let top = Packed { code: Code::Group, span: 1 };
        Self {
            fragment: Fragment {
                nodes: smallvec::smallvec![top],
                transforms: SmallVec::new(),
                runs: SmallVec::new(),
                drawn: None,
                n_links: 0,
                n_live: 0,
            },
            open: smallvec::smallvec![0],
            run: None,
        }
    }

    fn push(&mut self, code: Code) {
        self.run = None;
        self.fragment.nodes.push(Packed { code, span: 1 });
    }

    fn open(&mut self, code: Code) {
        self.open.push(self.fragment.len());
        self.push(code);
    }

    /// Opens a turn to whoever looks: what follows, up to the matching [`close`](Self::close),
    /// is turned by it.
    pub fn open_facing(&mut self, facing: Facing) {
        let i = number_of(&mut self.drawn().facings, facing);
        self.open(Code::Facing(i));
    }

    /// Opens a node under which less is drawn further away: what this fragment draws up to the
    /// matching [`close`](Self::close).
    pub fn open_fading(&mut self, fading: Fading) {
        let i = number_of(&mut self.drawn().fadings, fading);
        self.open(Code::Fading(i));
    }

    /// Opens a node under which one aspect, or two that blend, are drawn of what this fragment
    /// draws up to the matching [`close`](Self::close).
    pub fn open_aspects(&mut self, aspects: Aspects) {
        let i = number_of(&mut self.drawn().aspects, aspects);
        self.open(Code::Aspects(i));
    }

    /// Opens a node under which meshes and instances may sway: those of this fragment, up to the
    /// matching [`close`](Self::close), that [follow](Self::follows) joints of the rig.
    pub fn open_swaying(&mut self, rig: Shared<Rig>) {
        let i = number_of(&mut self.drawn().rigs, rig);
        self.open(Code::Swaying(i));
    }

    /// How much larger instances may be drawn where the next node stands.
    fn largest_growth(&self) -> f32 {
        for index in self.open.iter().rev() {
            match self.fragment.node(*index).limiter() {
                Some(Limiter::Fading(fading)) => return fading.largest_growth(),
                Some(Limiter::Aspects(_)) => return 1.0,
                None => {}
            }
        }
        1.0
    }

    fn drawn(&mut self) -> &mut Drawn {
        self.fragment.drawn.get_or_insert_default()
    }

    /// Opens a transform: what follows, up to the matching [`close`](Self::close), is placed
    /// by it.
    pub fn open_transform(&mut self, transform: Affine3) {
        let i = self.fragment.transforms.len() as u32;
        self.fragment.transforms.push(transform);
        self.open(Code::Transform(i));
    }

    /// Opens a transform whose value `visit` keeps up to date, and tells its number.
    pub fn open_live(&mut self) -> u32 {
        let live = self.fragment.n_live;
        self.fragment.n_live += 1;
        self.open(Code::Live(live));
        live
    }

    /// Closes what was opened last.
    ///
    /// # Panics
    /// When nothing is open.
    pub fn close(&mut self) {
        assert!(self.open.len() > 1, "a node is closed that was never opened");
        self.run = None;
        let index = self.open.pop().expect("the top group is open") as usize;
        self.fragment.nodes[index].span = (self.fragment.nodes.len() - index) as u32;
    }

    /// Adds a mesh.
    pub fn mesh(&mut self, mesh: SharedMesh, material: Arc<Material>) {
        let i = number_of(&mut self.drawn().meshes, (mesh, material));
        self.push(Code::Mesh(i));
    }

    /// Adds a mesh repeated at each of `transforms`; costs one pass over them.
    pub fn instances(
        &mut self,
        mesh: SharedMesh,
        material: Arc<Material>,
        transforms: Shared<Vec<Affine3>>,
    ) {
        let mut each = *mesh.bound();
        let growth = self.largest_growth();
        if growth > 1.0 {
            each = each.union(&each.transformed(&Affine3::from_scale(Vec3::splat(growth))));
        }
        let bound = each.repeated(&transforms);
        let instanced =
            Instanced { mesh, material, transforms, each, bound, tree: OnceLock::new() };
        let i = number_of(&mut self.drawn().instances, instanced);
        self.push(Code::Instances(i));
    }

    /// Adds lines, with a look of their own or what whoever draws them chooses.
    pub fn lines(&mut self, lines: Shared<Vec<Polyline>>, material: Option<Arc<Material>>) {
        let i = number_of(&mut self.drawn().lines, Lined { lines, material });
        self.push(Code::Lines(i));
    }

    /// Tells which parts the node added last shows.
    ///
    /// # Panics
    /// When that node draws neither a mesh nor lines, or the parts were told already.
    pub fn shows(&mut self, shown: Shown) {
        let index = self.fragment.len() - 1;
        let code = self.fragment.nodes[index as usize].code;
        let can_show = matches!(code, Code::Mesh(_) | Code::Instances(_) | Code::Lines(_));
        let is_new = self.drawn().shown.last().is_none_or(|(told, _)| *told < index);
        assert!(
            can_show && is_new,
            "parts are told right after the mesh or the lines that show them"
        );
        self.drawn().shown.push((index, shown));
    }

    /// Tells for each vertex of the mesh that was added last, or for each of the instances, which
    /// joint it follows, of the rig of the swaying node that was opened last. Costs one pass over
    /// them, for their bound.
    ///
    /// # Panics
    /// When that node draws neither a mesh nor instances, stands under no swaying node, follows
    /// something already, or has another number of vertices or instances; or where there is no such
    /// joint.
    pub fn follows(&mut self, joints: Shared<Vec<u32>>) {
        let index = self.fragment.len() - 1;
        let is_new = self.drawn().followed.last().is_none_or(|(told, _)| *told < index);
        assert!(is_new, "joints are told once");
        let rig = self.open.iter().rev().find_map(|open| match self.fragment.node(*open) {
            RenderNode::Swaying(rig) => Some(rig),
            _ => None,
        });
        let rig = rig.expect("joints are those of a swaying node");
        let n_joints = rig.joints.len();
        assert!(joints.iter().all(|joint| (*joint as usize) < n_joints), "there is no such joint");
        let told = "joints are told right after the mesh or the instances that follow them";
        let bound = match self.fragment.node(index) {
            RenderNode::Mesh { mesh, .. } => {
                assert_eq!(mesh.n_vertices(), joints.len(), "{told}");
                let points = joints.iter().zip(&mesh.positions);
                rig.bound_of(points.map(|(joint, point)| (*joint, *point, 0.0)))
            }
            RenderNode::Instances { transforms, .. } => {
                assert_eq!(transforms.len(), joints.len(), "{told}");
                let of_each = self.fragment.instanced_bound(index).unwrap_or(Bound::EMPTY).sphere;
                let balls = joints.iter().zip(transforms.iter()).map(|(joint, place)| {
                    let sphere = of_each.transformed(place);
                    (*joint, sphere.center, sphere.radius)
                });
                rig.bound_of(balls.filter(|(_, _, radius)| *radius >= 0.0))
            }
            _ => panic!("{told}"),
        };
        self.drawn().followed.push((index, Followed { joints, bound }));
    }

    /// Adds a light.
    pub fn light(&mut self, light: Light) {
        let i = number_of(&mut self.drawn().lights, light);
        self.push(Code::Light(i));
    }

    /// Adds a camera.
    pub fn camera(&mut self, camera: Camera) {
        let i = number_of(&mut self.drawn().cameras, camera);
        self.push(Code::Camera(i));
    }

    /// Adds a line of text.
    pub fn label(&mut self, label: Label) {
        let i = number_of(&mut self.drawn().labels, label);
        self.push(Code::Label(i));
    }

    /// Adds a deferred child and tells its link. Children of one kind that follow each other
    /// under one parent, without a foreseen bound, become one run.
    pub fn deferred(&mut self, kind: Kind, foreseen: Option<Bound>) -> u32 {
        let link = self.fragment.n_links;
        self.fragment.n_links += 1;
        if let (Some(i), None) = (self.run, foreseen) {
            let run = &mut self.fragment.runs[i as usize];
            if run.kind == kind {
                run.count += 1;
                return link;
            }
        }
        let i = self.fragment.runs.len() as u32;
        let foreseen = foreseen.map(Box::new);
        let can_grow = foreseen.is_none();
        self.fragment.runs.push(StoredRun { first: link, count: 1, kind, foreseen });
        self.push(Code::Deferred(i));
        self.run = can_grow.then_some(i);
        link
    }

    /// The finished fragment; whatever is still open is closed.
    pub fn finish(mut self) -> Fragment {
        while self.open.len() > 1 {
            self.close();
        }
        self.fragment.nodes[0].span = self.fragment.len();
        self.fragment
    }
}

impl Default for FragmentBuilder {
    fn default() -> Self {
        Self::new()
    }
}

/// Adds a row to an array and tells its number.
fn number_of<T>(rows: &mut Vec<T>, row: T) -> u32 {
    rows.push(row);
    rows.len() as u32 - 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Named;
    use sapwood_geom::Digest;

    struct Stone;
    impl Named for Stone {
        const NAME: &'static str = "stone";
    }

    #[test]
    fn spans_lead_from_sibling_to_sibling() {
        let mut builder = FragmentBuilder::new();
        builder.open_transform(Affine3::IDENTITY);
        assert_eq!(builder.deferred(Kind::of::<Stone>(), None), 0);
        assert_eq!(builder.deferred(Kind::of::<Stone>(), None), 1);
        builder.close();
        assert_eq!(builder.deferred(Kind::of::<Stone>(), None), 2);
        let fragment = builder.finish();
        assert_eq!(fragment.len(), 4);
        assert_eq!(fragment.children(0).collect::<Vec<_>>(), [1, 3]);
        assert_eq!(fragment.children(1).collect::<Vec<_>>(), [2]);
        assert!(matches!(fragment.node(2), RenderNode::Deferred(run) if run.count == 2));
        assert!(matches!(fragment.node(3), RenderNode::Deferred(run) if run.first == 2));
        let firsts = [0, 1, 2, 3].map(|link| fragment.run_of(link).map(|run| run.first));
        assert_eq!(firsts, [Some(0), Some(0), Some(2), None]);
    }

    #[test]
    fn structure_counts_in_the_digest() {
        let digest = |close_early: bool| {
            let mut builder = FragmentBuilder::new();
            builder.open_transform(Affine3::IDENTITY);
            if close_early {
                builder.close();
            }
            builder.lines(Shared::new(vec![Polyline::default()]), None);
            Digest::of(&builder.finish())
        };
        assert_ne!(digest(true), digest(false));
    }

    #[test]
    #[should_panic(expected = "never opened")]
    fn closing_too_much_is_a_programmer_error() {
        FragmentBuilder::new().close();
    }
}
