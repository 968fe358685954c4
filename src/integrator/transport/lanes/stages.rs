//! The stages of a batch of vertices.

use crate::color::Rgb;
use crate::material::{Diffuse, Model};
use crate::math::{Hit, Isa};
use crate::sampling::SamplerKind;
use crate::scene::Surface;

use super::super::super::profile::Stage;
use super::super::super::trace::PathRecorder;
use super::super::batch::PathBatch;
use super::super::paths::{PathState, StageQueues};
use super::kernels::{ChoosePairs, DrawNumbers, Intersect, Needs, ReflectAtMirror, ScatterDiffuse};
use super::vertex_batch::{Vertex, VertexBatch, VertexBatches};
use super::vertex_kind::VertexKind;

impl<R: PathRecorder> PathBatch<'_, R> {
    /// Returns true if vertices are shaded in lanes.
    pub(in super::super) fn uses_lanes(&self) -> bool {
        !R::ENABLED && self.context.prepared.render_settings().sampler == SamplerKind::Sobol
    }

    /// Adds a vertex to the batch of its kind, and shades that batch if it is full. Returns false
    /// if the scalar code has to shade the vertex.
    #[inline(always)]
    pub(in super::super) fn enqueue(
        &mut self,
        isa: Isa,
        batches: &mut VertexBatches,
        queues: &mut StageQueues<'_>,
        index: usize,
        hit: Hit,
    ) -> bool {
        let is_exit = hit.is_miss();
        let ray = queues.paths.rays.get(index);
        let id = if is_exit { ray.origin_sphere } else { hit.id };
        let state = &queues.paths.states[index];
        let surface = self.context.scene.surface(id);
        if surface.material.opacity < 1.0 {
            return false;
        }
        let kind = VertexKind::of_model(&surface.material.model, self.integrator.hemisphere);
        let Some(vertex) = self.vertex(index, id, kind, state, &surface) else { return true };
        let sphere = self.context.scene.spheres().sphere(id);
        let sampler = self.samplers[state.batch_index as usize];
        let batch = batches.of_kind(kind);
        batch.push(vertex, &ray, (&sphere, is_exit), sampler, state.depth);
        if batch.is_full() {
            self.flush(isa, kind, batch, queues);
        }
        true
    }

    /// Returns the vertex of a path; `None` if the path ends there and finds nothing.
    #[inline(always)]
    fn vertex(
        &mut self,
        index: usize,
        id: u32,
        kind: VertexKind,
        state: &PathState,
        surface: &Surface<'_>,
    ) -> Option<Vertex> {
        let color = match &surface.material.model {
            Model::Diffuse(Diffuse { albedo }) => surface.color.unwrap_or(*albedo),
            Model::Mirror(mirror) => surface.color.unwrap_or(mirror.reflectance),
            _ => Rgb::ONE,
        };
        let is_in_medium = self.media.get(state.batch_index as usize);
        let is_in_medium = is_in_medium.is_some_and(|media| !media.is_vacuum());
        let is_emissive = surface.emission().max_element() > 0.0;
        let may_cross = matches!(kind, VertexKind::SmoothDielectric | VertexKind::Other);
        let has_arrival = is_in_medium || is_emissive || may_cross;
        if !has_arrival && self.is_at_last_edge(state) {
            return None;
        }
        Some(Vertex { path: index as u32, id, color, has_arrival })
    }

    /// Shades the rest of all vertices.
    pub(in super::super) fn flush_all(
        &mut self,
        isa: Isa,
        batches: &mut VertexBatches,
        queues: &mut StageQueues<'_>,
    ) {
        for kind in VertexKind::ALL {
            self.flush(isa, kind, batches.of_kind(kind), queues);
        }
    }

    /// Shades the vertices of a batch and empties it. Continuing paths are appended to the next
    /// queue.
    #[inline(never)]
    fn flush(
        &mut self,
        isa: Isa,
        kind: VertexKind,
        batch: &mut VertexBatch,
        queues: &mut StageQueues<'_>,
    ) {
        if batch.count == 0 {
            return;
        }
        self.clock.end(Stage::Sorting);
        self.clock.count(batch.count, 0);
        isa.run(Intersect { batch });
        self.clock.end(Stage::HitPoints);
        let needs = self.needs(kind, batch);
        isa.run(DrawNumbers { batch, needs });
        self.clock.end(Stage::RandomNumbers);
        if needs.light {
            self.sample_lights(isa, kind, batch);
        }
        if let Some(pairs) = self.context.prepared.connections().filter(|_| needs.connection) {
            isa.run(ChoosePairs { batch, worths: pairs.worths() });
            self.solve_connections(isa, pairs, batch, queues);
        }
        self.clock.end(Stage::LightSamples);
        match kind {
            VertexKind::Diffuse => {
                isa.run(ScatterDiffuse { batch, estimator: self.integrator.estimator });
                self.clock.end(Stage::Directions);
                self.finish_lanes(batch, queues, Self::finish_diffuse);
            }
            VertexKind::Mirror => {
                isa.run(ReflectAtMirror { batch });
                self.clock.end(Stage::Directions);
                self.finish_lanes(batch, queues, Self::finish_mirror);
            }
            VertexKind::SmoothDielectric | VertexKind::Other => {
                self.finish_lanes(batch, queues, Self::finish_any);
            }
        }
        batch.count = 0;
        self.clock.end(Stage::Finishing);
    }

    /// Returns the random numbers that a batch needs.
    fn needs(&self, kind: VertexKind, batch: &VertexBatch) -> Needs {
        let light = kind.samples_lights() && self.samples_lights();
        let deepest = batch.depth.0[..batch.count].iter().copied().max().unwrap_or(0);
        Needs {
            light,
            light_selection: light && self.context.prepared.lights().needs_selection(),
            direction: kind.samples_lights(),
            lobe: matches!(kind, VertexKind::SmoothDielectric | VertexKind::Other),
            roulette: self.is_roulette_due(deepest),
            connection: kind.samples_lights() && self.context.prepared.connections().is_some(),
        }
    }
}
