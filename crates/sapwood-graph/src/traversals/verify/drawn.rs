//! Faults of what a plan's own nodes draw and show.

use sapwood_geom::SharedMesh;
use sapwood_geom::glam::Affine3;

use super::{Severity, Verifier};
use crate::{Facing, Kind, Material, PlanRef, RenderNode};

impl Verifier<'_> {
    /// Looks at every node of a plan that is met for the first time.
    pub(super) fn look_at_plan(&mut self, plan: &PlanRef<'_>) {
        let kind = plan.kind;
        for index in 0..plan.fragment.len() {
            match plan.fragment.node(index) {
                RenderNode::Group | RenderNode::Live(_) | RenderNode::Deferred(_) => {}
                RenderNode::Transform(transform) => {
                    self.look_at_transform(kind, &format!("transform {index}"), transform);
                }
                RenderNode::Facing(Facing::Eye) => {}
                RenderNode::Swaying(rig) => self.tell_fault(kind, "rig", rig.fault()),
                limiting @ (RenderNode::Fading(_) | RenderNode::Aspects(_)) => {
                    let limiter = limiting.limiter();
                    let mut below = index + 1;
                    while below < plan.fragment.after(index) {
                        let fault = limiter.zip(plan.fragment.n_drawn(below));
                        let fault = fault.and_then(|(limiter, n)| limiter.fault(n));
                        self.tell_fault(kind, "node", fault);
                        let is_nested = plan.fragment.node(below).limiter().is_some();
                        below = if is_nested { plan.fragment.after(below) } else { below + 1 };
                    }
                }
                RenderNode::Facing(Facing::Axis(axis)) => {
                    if (axis.length() - 1.0).abs() > 1e-3 || !axis.is_finite() {
                        let message = format!("turns about {axis}, which is no unit vector");
                        self.tell(Severity::Error, kind, message);
                    }
                }
                RenderNode::Mesh { mesh, material } => {
                    self.look_at_mesh(kind, mesh);
                    self.look_at_material(kind, material);
                    self.look_at_shown(plan, index, mesh.n_triangles());
                }
                RenderNode::Instances { mesh, material, transforms } => {
                    self.look_at_mesh(kind, mesh);
                    self.look_at_material(kind, material);
                    self.look_at_instances(kind, transforms);
                    self.look_at_shown(plan, index, transforms.len());
                }
                RenderNode::Lines(lines) => {
                    let faults = lines
                        .iter()
                        .enumerate()
                        .filter_map(|(i, line)| Some(format!("line {i}: {}", line.fault()?)));
                    self.tell_first(Severity::Error, kind, faults);
                    self.look_at_shown(plan, index, lines.len());
                }
                RenderNode::Light(light) => self.tell_fault(kind, "light", light.fault()),
                RenderNode::Camera(camera) => self.tell_fault(kind, "camera", camera.fault()),
                RenderNode::Label(label) => self.tell_fault(kind, "label", label.fault()),
            }
        }
    }

    fn tell_fault(&mut self, kind: Kind, what: &str, fault: Option<String>) {
        if let Some(fault) = fault {
            self.tell(Severity::Error, kind, format!("{what}: {fault}"));
        }
    }

    /// Tells the first of many faults alike, and how many there are.
    fn tell_first(
        &mut self,
        severity: Severity,
        kind: Kind,
        mut faults: impl Iterator<Item = String>,
    ) {
        if let Some(first) = faults.next() {
            let message = match faults.count() {
                0 => first,
                n => format!("{first}; and {n} more like it"),
            };
            self.tell(severity, kind, message);
        }
    }

    fn look_at_mesh(&mut self, kind: Kind, mesh: &SharedMesh) {
        if !self.is_new(mesh) {
            return;
        }
        self.report.n_meshes += 1;
        self.report.n_triangles += mesh.n_triangles() as u64;
        if let Some(fault) = mesh.fault() {
            self.tell(Severity::Error, kind, format!("mesh: {fault}"));
            // Its triangles may lead nowhere.
            return;
        }
        if mesh.is_empty() {
            self.tell(Severity::Warning, kind, "mesh without triangles".to_owned());
        }
        self.report.n_open_edges += mesh.n_open_edges() as u64;
        let bound = mesh.bound();
        let outside = mesh.positions.iter().find(|position| !bound.aabb.contains(**position));
        if let Some(position) = outside {
            self.tell(Severity::Error, kind, format!("mesh: {position} is outside its bound"));
        }
    }

    fn look_at_material(&mut self, kind: Kind, material: &Material) {
        if let Some(fault) = material.fault() {
            self.tell(Severity::Error, kind, format!("material {:?}: {fault}", material.name));
        }
    }

    fn look_at_instances(&mut self, kind: Kind, transforms: &[Affine3]) {
        let numbered = || transforms.iter().enumerate();
        let broken = numbered().filter(|(_, transform)| !transform.is_finite());
        let broken =
            broken.map(|(i, transform)| format!("instance {i} is not finite: {transform:?}"));
        self.tell_first(Severity::Error, kind, broken);
        let flat = numbered().filter(|(_, transform)| {
            transform.is_finite() && transform.matrix3.determinant() == 0.0
        });
        self.tell_first(
            Severity::Warning,
            kind,
            flat.map(|(i, _)| format!("instance {i} is flat")),
        );
    }

    /// What a node shows is there to be shown.
    fn look_at_shown(&mut self, plan: &PlanRef<'_>, index: u32, n: usize) {
        let Some(shown) = plan.fragment.shown(index) else { return };
        if let Some(fault) = shown.fault(n) {
            self.tell(Severity::Error, plan.kind, fault);
        }
        let n_rows = self.above.iter().rev().find_map(|site| {
            let mut lengths = self.supply.plan(*site).parts.lengths();
            lengths.find(|(kind, _)| *kind == shown.kind()).map(|(_, n_rows)| n_rows)
        });
        let most = shown.largest_row(n);
        let message = match (n_rows, most) {
            (None, Some(_)) => {
                format!("shows parts of kind {} that nothing here has", shown.kind())
            }
            (Some(n_rows), Some(most)) if most as usize >= n_rows => {
                format!("shows row {most} of {n_rows} parts of kind {}", shown.kind())
            }
            _ => return,
        };
        self.tell(Severity::Error, plan.kind, message);
    }
}
