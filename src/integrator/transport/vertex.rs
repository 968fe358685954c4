//! A vertex of a path, and the random numbers that decide what happens there.

use crate::geometry::SurfaceHit;
use crate::light::specular::{CasterPairs, Connection, PairSampler, SpecularPath};
use crate::light::{CategoryPmf, ConnectedPoint, LightSample, LightSampleContext, Lights};
use crate::material::Crossing;
use crate::math::DVec3;
use crate::sampling::Sampler;
use crate::scene::SphereMaterial;

use super::super::context::RenderContext;
use super::super::dimension::VertexDimensions;
use super::pair_site::PairSite;

/// A path's vertex on a surface.
pub(super) struct SurfaceVertex<'a> {
    pub(super) hit: SurfaceHit,
    /// Unit direction to the previous vertex.
    pub(super) wo: DVec3,
    pub(super) surface: SphereMaterial<'a>,
    /// Index of refraction beyond the surface over the index on this side.
    pub(super) eta: f64,
    /// What a path does that goes through, if the media differ on both sides.
    pub(super) crossing: Option<Crossing>,
}

/// The random numbers of a vertex.
pub(super) trait VertexNumbers {
    /// Samples a light, and returns the probabilities of all categories of lights as well.
    fn sample_light(
        &self,
        context: RenderContext<'_>,
        ctx: &LightSampleContext,
    ) -> (CategoryPmf, Option<LightSample>);
    /// Chooses the pairs of a polished ball and a light to connect, of all or of those of the ball
    /// `inside` which the vertex is. `u_light` selects among many lights.
    fn choose_pairs(
        &self,
        pairs: &PairSampler,
        ctx: &LightSampleContext,
        inside: Option<u32>,
        u_light: impl FnOnce() -> f64,
    ) -> CasterPairs;
    /// Connects the vertex with a pair by `u`, and hands `found` every connection. Returns false if
    /// the light does not face the ball.
    fn connect(
        &self,
        lights: &Lights,
        site: &PairSite<'_>,
        u: impl FnOnce() -> [f64; 2],
        found: impl FnMut(&ConnectedPoint, SpecularPath, &Connection),
    ) -> bool {
        site.connect(lights, u(), found)
    }
    /// Two numbers for the BSDF's direction.
    fn direction(&self) -> [f64; 2];
    /// For the selection of the BSDF's lobe.
    fn lobe(&self) -> f64;
    /// For Russian roulette.
    fn roulette(&self) -> f64;
}

impl VertexNumbers for (Sampler, VertexDimensions) {
    fn sample_light(
        &self,
        context: RenderContext<'_>,
        ctx: &LightSampleContext,
    ) -> (CategoryPmf, Option<LightSample>) {
        let (sampler, vertex) = *self;
        let lights = context.prepared.lights();
        let u = sampler.get_2d(vertex.light_direction());
        let has_choice = lights.needs_selection();
        let u_select = if has_choice { sampler.get(vertex.light_selection()) } else { 0.0 };
        let category_pmf = lights.category_pmf(ctx);
        let spheres = context.scene.spheres();
        (category_pmf, lights.sample_by(&category_pmf, spheres, ctx, u_select, u))
    }

    fn choose_pairs(
        &self,
        pairs: &PairSampler,
        ctx: &LightSampleContext,
        inside: Option<u32>,
        u_light: impl FnOnce() -> f64,
    ) -> CasterPairs {
        pairs.sample(ctx, inside, self.0.get_2d(self.1.connection_choice()), u_light)
    }

    fn direction(&self) -> [f64; 2] {
        self.0.get_2d(self.1.bsdf_direction())
    }

    fn lobe(&self) -> f64 {
        self.0.get(self.1.lobe())
    }

    fn roulette(&self) -> f64 {
        self.0.get(self.1.roulette())
    }
}
