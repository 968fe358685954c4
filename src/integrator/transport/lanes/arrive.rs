//! What happens to a path at a surface before it is scattered.

use crate::geometry::Side;
use crate::light::LightSource;
use crate::material::Crossing;
use crate::scene::SphereMaterial;

use super::super::super::trace::PathRecorder;
use super::super::batch::PathBatch;
use super::super::opacity;
use super::super::paths::StageQueues;
use super::vertex_batch::VertexBatch;

/// The boundary at which a path arrives.
pub(super) struct Arrival<'a> {
    pub(super) surface: SphereMaterial<'a>,
    /// Index of refraction beyond the surface over the index on this side.
    pub(super) eta: f64,
    /// What a path does that goes through, if the media differ on both sides.
    pub(super) crossing: Option<Crossing>,
}

impl<'a, R: PathRecorder> PathBatch<'a, R> {
    /// Dims a path by the medium behind it and adds emission, as [`Self::shade_hit`] does. `None`
    /// if the path ends here, or if the scalar code has shaded it.
    #[inline(never)]
    pub(super) fn arrive(
        &mut self,
        batch: &VertexBatch,
        lane: usize,
        queues: &mut StageQueues<'_>,
    ) -> Option<Arrival<'a>> {
        let hit = &batch.hit(lane);
        let surface = self.context.scene.sphere_material(hit.id);
        let path = batch.vertices[lane].path as usize;
        let mut state = queues.paths.states[path];
        let media = self.media_of(&state);
        let entering = hit.side == Side::Outside;
        let boundary = surface.medium(hit.id).map(|medium| media.boundary(medium, entering));
        if boundary.is_some_and(|boundary| surface.is_straight(&boundary)) {
            self.shade_scalar(queues, path, batch.backend_hit(lane));
            return None;
        }
        state.throughput *= media.transmittance(hit.t - batch.rays.t_min.0[lane]);
        if surface.material.is_emissive() {
            let is_far = opacity::is_far_wall(self.context.scene, self.prev_vertex(&state), hit);
            let wall = if is_far { LightSource::FarWall } else { LightSource::Emitter };
            let direction = batch.rays.direction.get(lane);
            self.add_emission(&state, direction, wall, hit, surface.material.emission);
        }
        if self.is_at_last_edge(&state) {
            return None;
        }
        queues.paths.states[path] = state;
        Some(Arrival {
            surface,
            eta: boundary.and_then(|boundary| boundary.eta).unwrap_or(1.0),
            crossing: boundary.map(|boundary| boundary.crossing),
        })
    }
}
