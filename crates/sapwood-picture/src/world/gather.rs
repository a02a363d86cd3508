//! Gathering: from what is compiled to clusters.

use std::sync::Arc;

use sapwood_geom::glam::{Affine3, Vec3};
use sapwood_geom::{FixedSet, Polyline, SharedMesh, fixed_state};
use sapwood_graph::{
    CrossFade, DrawnPart, EnvId, Interrupted, LimitsAbove, Material, RenderNode, Run, SiteId,
    Supplied, Supply, Vantage,
};

use super::{Cluster, Item, LinePiece, MOST_ITEMS, Place, PlacedLight, Surface, Wait, World};

/// A site to be gathered into a cluster.
#[derive(Clone, Copy)]
pub(super) struct Task {
    pub(super) env: EnvId,
    pub(super) site: SiteId,
    /// From the site's frame to that of the cluster above.
    pub(super) base: Affine3,
    /// From the frame of the cluster above to the root's.
    pub(super) outside: Affine3,
    /// The way to the site.
    pub(super) way: u32,
    /// The cluster above.
    pub(super) above: Option<u32>,
    /// Whether lights in it are known to everybody.
    pub(super) shows_lights: bool,
}

pub(super) struct Gather<'a> {
    world: &'a mut World,
    supply: &'a dyn Supply,
    /// Clusters to be filled, by number.
    tasks: Vec<(u32, Task)>,
    /// Sites to be looked at for the cluster at hand.
    sites: Vec<Here>,
}

/// A site, and where it is.
struct Here {
    env: EnvId,
    site: SiteId,
    /// From the site's frame to the cluster's.
    frame: Affine3,
    way: u32,
}

impl<'a> Gather<'a> {
    /// Gathers everything that is compiled at and below a site, with a bound for what is not, and
    /// gives back what stands for it in the cluster above.
    pub(super) fn run(
        world: &'a mut World,
        supply: &'a dyn Supply,
        task: Task,
    ) -> Result<Item, Interrupted> {
        world.survey.look_at(supply, task.site);
        let first = world.clusters.len() as u32;
        let mut gather = Self { world, supply, tasks: Vec::new(), sites: Vec::new() };
        let item = gather.cluster(task);
        while let Some((cluster, task)) = gather.tasks.pop() {
            gather.fill(cluster, task)?;
        }
        gather.grow_trees(first);
        Ok(item)
    }

    /// A cluster for a site: the one that is there, or one that is still to be filled.
    fn cluster(&mut self, task: Task) -> Item {
        let is_finished = self.supply.is_settled(task.site);
        let to_local = task.base.inverse();
        let stands_alone =
            is_finished && self.world.survey.is_same_everywhere(task.site) && to_local.is_finite();
        let next = self.world.clusters.len() as u32;
        if !stands_alone {
            self.world.clusters.push(Cluster::new(task.above));
            self.tasks.push((next, task));
            return Item::Cluster(self.world.place(Affine3::IDENTITY, next));
        }
        let cluster = *self.world.cluster_of.entry(task.site).or_insert(next);
        if cluster == next {
            self.world.clusters.push(Cluster::new(None));
            let (base, outside) = (Affine3::IDENTITY, task.outside * task.base);
            self.tasks.push((cluster, Task { base, outside, above: None, ..task }));
        }
        Item::Cluster(self.world.place(to_local, cluster))
    }

    /// Fills a cluster with a site and what is below it, up to the next clusters.
    fn fill(&mut self, cluster: u32, task: Task) -> Result<(), Interrupted> {
        let Task { env, site, base, way, .. } = task;
        self.sites.push(Here { env, site, frame: base, way });
        let mut items = Vec::new();
        while let Some(here) = self.sites.pop() {
            let before = items.len();
            self.scan(&here, cluster, &task, &mut items);
            // Sites count as well, for a graph may have many that hold nothing.
            self.world.n_items += 1 + (items.len() - before) as u64;
            if self.world.n_items > MOST_ITEMS {
                return Err(Interrupted::Exhausted {
                    what: "things in a picture",
                    limit: MOST_ITEMS,
                    component: self.supply.plan(here.site).kind.name(),
                });
            }
        }
        // The same at the same place is seen once.
        let mut known = FixedSet::with_hasher(fixed_state());
        for item in &mut items {
            if let Item::Cluster(place) = item {
                let Place { to_local, number } = &self.world.places[*place as usize];
                if !known.insert((*number, to_local.to_cols_array().map(f32::to_bits))) {
                    *item = Item::Nothing;
                }
            }
        }
        self.world.clusters[cluster as usize].items = items;
        Ok(())
    }

    /// Looks at every node of one site.
    fn scan(&mut self, here: &Here, cluster: u32, task: &Task, items: &mut Vec<Item>) {
        let plan = self.supply.plan(here.site);
        // Transforms above the node at hand: where each ends, and the product so far.
        let mut above: Vec<(u32, Affine3)> = Vec::new();
        let mut frame = here.frame;
        let mut limits = LimitsAbove::default();
        for index in 0..plan.fragment.len() {
            while let Some((_, outer)) = above.pop_if(|(end, _)| *end <= index) {
                frame = outer;
            }
            limits.go_on_to(index);
            let place = match plan.fragment.node(index) {
                RenderNode::Group
                | RenderNode::Swaying(_)
                | RenderNode::Camera(_)
                | RenderNode::Label(_) => continue,
                RenderNode::Transform(transform) => *transform,
                RenderNode::Live(live) => plan.live[live as usize],
                RenderNode::Facing(facing) => {
                    facing.turn(&(task.outside * frame), self.supply.eye())
                }
                limiting @ (RenderNode::Fading(_) | RenderNode::Aspects(_)) => {
                    if let Some(limiter) = limiting.limiter() {
                        let vantage = Vantage::of(&(task.outside * frame), self.supply.eye());
                        limits.enter(plan.fragment.after(index), limiter, vantage);
                    }
                    continue;
                }
                drawn @ (RenderNode::Mesh { .. }
                | RenderNode::Instances { .. }
                | RenderNode::Lines(_)
                | RenderNode::Light(_)) => {
                    let n = plan.fragment.n_drawn(index).unwrap_or(1);
                    let of_lines = plan.fragment.line_material(index);
                    if let RenderNode::Lines(lines) = drawn {
                        let (part, _) = limits.drawn(n);
                        self.add_lines(part.of(lines), of_lines, &frame, task, items);
                        continue;
                    }
                    let (parts, growth) = limits.parts(n);
                    // A light shines once, whatever fades around it.
                    let most = if let RenderNode::Light(_) = drawn { 1 } else { usize::MAX };
                    for part in parts.take(most) {
                        self.add(drawn, (part, growth), &frame, task, items);
                    }
                    continue;
                }
                RenderNode::Deferred(run) => {
                    self.approach(run, here, &frame, cluster, task, items);
                    continue;
                }
            };
            above.push((plan.fragment.after(index), frame));
            frame *= place;
        }
    }

    /// Adds what one node draws, as far as it is drawn, instances larger by a factor.
    fn add(
        &mut self,
        drawn: RenderNode<'_>,
        (DrawnPart { range: part, cross_fade }, growth): (DrawnPart, f32),
        frame: &Affine3,
        task: &Task,
        items: &mut Vec<Item>,
    ) {
        let once = [Affine3::IDENTITY];
        let is_repeated = matches!(drawn, RenderNode::Instances { .. });
        let grown = Affine3::from_scale(Vec3::splat(growth));
        let left;
        let (mesh, material, transforms) = match drawn {
            RenderNode::Mesh { mesh, .. } if part.is_empty() || mesh.unsound().is_some() => return,
            RenderNode::Mesh { mesh, material } if (part.len() as usize) < mesh.n_triangles() => {
                // Its own copy, unlike all others.
                self.world.n_items += u64::from(part.len());
                left = SharedMesh::new(mesh.part(part.numbers()));
                (&left, material, &once[..])
            }
            RenderNode::Mesh { mesh, material } => (mesh, material, &once[..]),
            RenderNode::Instances { mesh, material, transforms } => {
                (mesh, material, part.of(transforms))
            }
            RenderNode::Light(light) => {
                if task.shows_lights && light.fault().is_none() {
                    let world = task.outside * *frame;
                    self.world.lights.push(PlacedLight { light: light.clone(), world });
                }
                return;
            }
            RenderNode::Group
            | RenderNode::Transform(_)
            | RenderNode::Live(_)
            | RenderNode::Facing(_)
            | RenderNode::Fading(_)
            | RenderNode::Aspects(_)
            | RenderNode::Swaying(_)
            | RenderNode::Lines(_)
            | RenderNode::Camera(_)
            | RenderNode::Label(_)
            | RenderNode::Deferred(_) => return,
        };
        if mesh.is_empty() || mesh.unsound().is_some() {
            return;
        }
        let look = self.world.look(material);
        let surface = self.surface(mesh.clone(), look, cross_fade);
        for transform in transforms {
            if self.world.n_items > MOST_ITEMS {
                return;
            }
            let mut frame = *frame * *transform;
            if growth != 1.0 && is_repeated {
                frame *= grown;
            }
            let to_local = frame.inverse();
            if to_local.is_finite() {
                self.stand(surface, to_local, transforms.len() == 1, items);
            } else if frame.is_finite() {
                // Nobody can be inside a flat frame, so its triangles are taken out of it.
                let mut flat = sapwood_geom::Mesh::default();
                flat.append(mesh, &frame);
                // Its own copy, unlike all others.
                self.world.n_items += mesh.n_triangles() as u64;
                let surface = self.surface(SharedMesh::new(flat), look, cross_fade);
                self.stand(surface, Affine3::IDENTITY, true, items);
            }
        }
    }

    /// Adds lines.
    fn add_lines(
        &mut self,
        lines: &[Polyline],
        material: Option<&Arc<Material>>,
        frame: &Affine3,
        task: &Task,
        items: &mut Vec<Item>,
    ) {
        let width = self.world.line_width;
        self.world.has_lines = true;
        let look = material.map(|material| self.world.look(material));
        for line in lines.iter().filter(|line| line.fault().is_none()) {
            let piece = |i: usize| {
                let ends = [i, i + 1].map(|i| frame.transform_point3(line.points[i]));
                let radii = [line.radii[i], line.radii[i + 1]];
                LinePiece::new(ends, radii, look, &width, &task.outside)
            };
            let first = self.world.lines.len() as u32;
            let n_pieces = line.points.len().saturating_sub(1);
            self.world.lines.extend((0..n_pieces).map(piece));
            items.extend((first..).take(n_pieces).map(Item::Line));
        }
    }

    /// Adds a surface at a place.
    fn stand(&mut self, surface: u32, to_local: Affine3, alone: bool, items: &mut Vec<Item>) {
        let place = self.world.place(to_local, surface);
        let World { surfaces, packs, .. } = &mut *self.world;
        packs.put(&surfaces[surface as usize].mesh, place, alone, items);
    }

    fn surface(&mut self, mesh: SharedMesh, look: u32, cross_fade: Option<CrossFade>) -> u32 {
        self.world.surfaces.push(Surface { mesh, look, cross_fade });
        self.world.surfaces.len() as u32 - 1
    }

    /// Goes on to the children of a run, notes clusters for those that are to have one, and waits
    /// for those that are not compiled.
    fn approach(
        &mut self,
        run: Run<'_>,
        here: &Here,
        frame: &Affine3,
        cluster: u32,
        task: &Task,
        items: &mut Vec<Item>,
    ) {
        let is_finished = self.supply.is_settled(here.site);
        for link in run.first..run.first + run.count {
            let (env, supplied) = self.supply.enter(here.env, here.site, link);
            // Below what is finished nothing waits, so no way is ever asked for.
            let mut way = here.way;
            if !is_finished {
                way = self.world.ways.len() as u32;
                self.world.ways.push((here.way, link));
            }
            match supplied {
                Supplied::Ready(site) => {
                    if !is_finished {
                        self.world.survey.look_at(self.supply, site);
                    }
                    if self.world.survey.is_empty(site) {
                        continue;
                    }
                    if run.foreseen.is_some() || self.world.survey.is_shared(site) {
                        let shows_lights = task.shows_lights && run.foreseen.is_none();
                        let (base, outside, above) = (*frame, task.outside, Some(cluster));
                        let below = Task { env, site, base, outside, way, above, shows_lights };
                        items.push(self.cluster(below));
                    } else {
                        self.sites.push(Here { env, site, frame: *frame, way });
                    }
                }
                Supplied::Failed(_) => {}
                // What nothing was foreseen of was compiled before, or cannot be.
                Supplied::Foreseen(_) | Supplied::Previous(_) | Supplied::Unknown => {
                    let Some(foreseen) = run.foreseen.filter(|bound| !bound.is_empty()) else {
                        continue;
                    };
                    let item = items.len() as u32;
                    items.push(Item::Waiting(self.world.waits.len() as u32));
                    self.world.waits.push(Wait {
                        bound: foreseen.transformed(frame),
                        cluster,
                        item,
                        frame: *frame,
                        outside: task.outside,
                        way,
                    });
                }
            }
        }
    }

    /// Makes the trees of all clusters from `first` on, each after those in it.
    fn grow_trees(&mut self, first: u32) {
        let n_new = self.world.clusters.len() - first as usize;
        let mut is_seen = vec![false; n_new];
        let mut stack: Vec<(u32, bool)> =
            (n_new > 0).then_some((first, false)).into_iter().collect();
        while let Some((cluster, is_left)) = stack.pop() {
            if is_left {
                self.world.grow_tree(cluster);
                continue;
            }
            if std::mem::replace(&mut is_seen[(cluster - first) as usize], true) {
                continue;
            }
            stack.push((cluster, true));
            let items = &self.world.clusters[cluster as usize].items;
            stack.extend(items.iter().filter_map(|item| match item {
                Item::Cluster(place) => {
                    let cluster = self.world.places[*place as usize].number;
                    (cluster >= first).then_some((cluster, false))
                }
                _ => None,
            }));
        }
    }
}
