//! What a rule draws with: nodes that place, turn or limit others, and what they hold.

use std::sync::Arc;

use sapwood_geom::glam::Affine3;
use sapwood_geom::{Polyline, Shared, SharedMesh};
use sapwood_graph::{Aspects, Camera, Facing, Fading, Label, Light, Material, Rig, Shown};

use super::Context;
use crate::slots::Placement;

/// Nodes that have others inside.
impl Context<'_> {
    /// Places whatever `inside` adds.
    pub fn transform(&mut self, transform: Affine3, inside: impl FnOnce(&mut Self)) {
        self.fragment.open_transform(transform);
        self.push::<Placement>(transform, inside);
        self.fragment.close();
    }

    /// Places whatever `inside` adds by a live value that the rule's `visit` keeps up to date,
    /// and tells the value's number. Placement does not include it: live values move.
    pub fn live(&mut self, inside: impl FnOnce(&mut Self)) -> u32 {
        let live = self.fragment.open_live();
        inside(self);
        self.fragment.close();
        live
    }

    /// Turns whatever `inside` adds to the eye. Placement does not include the turn: it follows
    /// the eye.
    pub fn facing(&mut self, facing: Facing, inside: impl FnOnce(&mut Self)) {
        self.fragment.open_facing(facing);
        inside(self);
        self.fragment.close();
    }

    /// Has less drawn, further from the eye, of what `inside` draws: of each mesh, of instances and
    /// of lines as if nothing else were there. What it emits is not concerned.
    pub fn fading(&mut self, fading: Fading, inside: impl FnOnce(&mut Self)) {
        self.fragment.open_fading(fading);
        inside(self);
        self.fragment.close();
    }

    /// Has that aspect drawn of each mesh, of instances and of lines that `inside` draws whose
    /// direction is nearest to the eye's, or where they blend, the two nearest. What it emits is
    /// not concerned.
    pub fn aspects(&mut self, aspects: Aspects, inside: impl FnOnce(&mut Self)) {
        self.fragment.open_aspects(aspects);
        inside(self);
        self.fragment.close();
    }

    /// Has meshes and instances that `inside` draws sway with joints of a rig: those that
    /// [follow](Self::follows) some. What it emits is not concerned.
    pub fn swaying(&mut self, rig: Shared<Rig>, inside: impl FnOnce(&mut Self)) {
        self.fragment.open_swaying(rig);
        inside(self);
        self.fragment.close();
    }

    /// Tells for each vertex of the mesh added last, or for each of the instances, which joint it
    /// follows, of the rig that it [sways](Self::swaying) by. Bounds grow to hold it in any wind.
    ///
    /// # Panics
    /// Where nothing of the kind was added last, numbers differ, or there is no such joint; the
    /// component becomes an error then.
    pub fn follows(&mut self, joints: Shared<Vec<u32>>) {
        self.fragment.follows(joints);
    }
}

/// Nodes that are drawn.
impl Context<'_> {
    /// Adds a mesh. The component becomes an error where it is not [sound](SharedMesh::unsound).
    pub fn mesh(&mut self, mesh: SharedMesh, material: Arc<Material>) {
        self.check_sound(&mesh);
        self.fragment.mesh(mesh, material);
    }

    /// Adds a mesh repeated at each of `transforms`. The component becomes an error where the mesh
    /// is not [sound](SharedMesh::unsound).
    pub fn instances(
        &mut self,
        mesh: SharedMesh,
        material: Arc<Material>,
        transforms: Shared<Vec<Affine3>>,
    ) {
        self.check_sound(&mesh);
        self.fragment.instances(mesh, material, transforms);
    }

    fn check_sound(&mut self, mesh: &SharedMesh) {
        if self.unsound.is_none() {
            self.unsound = mesh.unsound().map(|why| format!("mesh: {why}"));
        }
    }

    /// Adds lines, in the colour that whoever draws them chooses.
    pub fn lines(&mut self, lines: Shared<Vec<Polyline>>) {
        self.fragment.lines(lines, None);
    }

    /// Adds lines that stand in for something with this material: pictures draw them in the mean
    /// of its colours.
    pub fn lines_of(&mut self, lines: Shared<Vec<Polyline>>, material: Arc<Material>) {
        self.fragment.lines(lines, Some(material));
    }

    /// Tells which parts the mesh, the instances or the lines added last show, so that picking
    /// finds them.
    ///
    /// # Panics
    /// When something else was added last; the component becomes an error then.
    pub fn shows(&mut self, shown: Shown) {
        self.fragment.shows(shown);
    }

    /// Adds a light.
    pub fn light(&mut self, light: Light) {
        self.fragment.light(light);
    }

    /// Adds a camera.
    pub fn camera(&mut self, camera: Camera) {
        self.fragment.camera(camera);
    }

    /// Adds a line of text.
    pub fn label(&mut self, label: Label) {
        self.fragment.label(label);
    }
}
