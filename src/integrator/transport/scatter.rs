//! BSDF sampling and Russian roulette: the next edge of a path.

use crate::color::Rgb;
use crate::fault::fault;
use crate::geometry::{PathRay, Side, SurfaceHit};
use crate::light::{CategoryPmf, LightSampleContext};
use crate::material::{Boundary, BsdfSample, Crossing, Lobe};
use crate::math::DVec3;
use crate::scene::settings::PathTermination;

use super::super::trace::{PathEvent, PathRecorder, Termination};
use super::batch::PathBatch;
use super::chain::Chain;
use super::paths::{MAX_PATH_EDGES, Path, PathState, PrevVertex};
use super::vertex::VertexNumbers;

/// Paths with fewer edges are never terminated by roulette.
const ROULETTE_MIN_DEPTH: u32 = 4;

/// A path may be totally reflected so often in succession before roulette.
const MIN_TOTAL_REFLECTIONS: u16 = 64;

/// Returns the probability of continuing after so many total reflections in succession, which may
/// go on for ever. Of all paths, the fraction `64 / n` survives n of them: a path has at most 390
/// edges on average, and no weight grows beyond `n / 64`.
///
/// A path that turns about the centre of a ball by a random angle has not found a small emitter
/// after n reflections with a probability in proportion to `1 / n`. So the second moment of its
/// weight grows like `log n` here, and like `n` if `(64 / n)^2` survived. For an emitter of radius
/// 0.02 in a ball of radius 1 it is 1.2 here, 11 with squares, 900 with cubes, and beyond any bound
/// with a constant probability such as 0.95.
fn total_reflection_survival(count: u16) -> f32 {
    if count <= MIN_TOTAL_REFLECTIONS { 1.0 } else { f32::from(count - 1) / f32::from(count) }
}

impl<R: PathRecorder> PathBatch<'_, R> {
    /// Continues behind a straight boundary. If shadow rays pass it, too, the path keeps its MIS
    /// record.
    pub(super) fn pass_boundary(
        &mut self,
        path: &mut Path,
        hit: &SurfaceHit,
        boundary: &Boundary,
        is_passable: bool,
    ) -> Option<PathRay> {
        self.recorder.record(|| match boundary.eta {
            None => PathEvent::HiddenBoundary,
            Some(_) => PathEvent::MatchedBoundary,
        });
        self.cross(&path.state, Some(boundary.crossing));
        if !is_passable || fault!(MisRecordLost) {
            path.state.has_prev_vertex = false;
            path.state.chain = Chain::Other;
        }
        self.continue_straight(path, hit)
    }

    /// Continues behind a surface that failed the opacity test.
    pub(super) fn pass_transparent(
        &mut self,
        path: &mut Path,
        hit: &SurfaceHit,
    ) -> Option<PathRay> {
        self.recorder.record(|| PathEvent::Transparent);
        self.continue_straight(path, hit)
    }

    /// Continues in the same direction on the other side of a surface.
    fn continue_straight(&mut self, path: &mut Path, hit: &SurfaceHit) -> Option<PathRay> {
        path.state.passthroughs += 1;
        if path.state.passthroughs >= MAX_PATH_EDGES {
            return self.terminate_at_length_limit();
        }
        match hit.spawn_ray(path.ray.direction) {
            Some(ray) => Some(ray),
            None => self.terminate(Termination::Grazing),
        }
    }

    /// Counts a total reflection from inside a medium, and returns true if the path is known to be
    /// trapped by it.
    pub(super) fn is_trapped(
        &self,
        state: &mut PathState,
        hit: &SurfaceHit,
        sample: &BsdfSample,
        eta: f64,
        direction: DVec3,
    ) -> bool {
        let is_inside = hit.side == Side::Inside;
        let is_reflected =
            is_inside && eta < 1.0 && sample.lobe == Lobe::Delta && sample.wi.z > 0.0;
        if !is_reflected || sample.pdf < 1.0 {
            state.total_reflections = 0;
            return false;
        }
        state.total_reflections += 1;
        let count = state.total_reflections;
        self.context.prepared.is_light_trapped(hit.id, hit.point, direction, count)
    }

    /// Continues the path in the sampled direction `wi`, from a point that sampled `lights`.
    /// Returns the ray on which it continues.
    #[inline(always)]
    pub(super) fn scatter(
        &mut self,
        state: &mut PathState,
        (from, lights): (&LightSampleContext, CategoryPmf),
        sample: &BsdfSample,
        wi: DVec3,
        crossing: Option<Crossing>,
        numbers: &impl VertexNumbers,
    ) -> Option<PathRay> {
        let BsdfSample { lobe, pdf, weight, eta, .. } = *sample;
        state.throughput *= weight;
        let throughput = state.throughput;
        self.recorder.record(|| PathEvent::BsdfSample { lobe, wi, pdf, weight, eta, throughput });
        let Some(ray) = from.hit.spawn_ray(wi) else { return self.terminate(Termination::Grazing) };
        state.eta_scale *= (eta * eta) as f32;
        if let Some(pairs) = self.context.prepared.connections() {
            self.advance_chain(pairs, state, from, sample, wi);
        }
        state.has_prev_vertex = lobe != Lobe::Delta;
        if state.has_prev_vertex {
            self.prev_vertices[state.batch_index as usize] = PrevVertex::new(from, pdf, lights);
            state.scatter_count += 1;
        }
        if sample.wi.z < 0.0 {
            self.cross(state, crossing);
        }
        let survives = self.survives(state, || numbers.roulette());
        state.depth += 1;
        survives.then_some(ray)
    }

    /// Returns true if Russian roulette may end a path after an edge. With other stop rules, only
    /// after many total reflections.
    pub(super) fn is_roulette_due(&self, depth: u32) -> bool {
        match self.integrator.stop {
            PathTermination::Roulette => depth >= ROULETTE_MIN_DEPTH,
            PathTermination::Depth | PathTermination::Threshold(_) => {
                depth > u32::from(MIN_TOTAL_REFLECTIONS)
            }
        }
    }

    /// Applies Russian roulette, by `u` in `[0, 1)`, and its throughput compensation. Returns true
    /// if the path continues.
    #[inline(always)]
    pub(super) fn survives(&mut self, state: &mut PathState, u: impl FnOnce() -> f64) -> bool {
        let brightest = state.throughput.max_element();
        let is_bright = match self.integrator.stop {
            PathTermination::Roulette if self.is_roulette_due(state.depth) => {
                let weight = brightest * state.eta_scale;
                return self.russian_roulette(state, weight.min(1.0), u);
            }
            PathTermination::Roulette | PathTermination::Depth => brightest > 0.0,
            // What totally reflected light has been weighed up counts for the threshold, too.
            PathTermination::Threshold(threshold) => f64::from(brightest) >= threshold,
        };
        if !is_bright {
            self.terminate(Termination::LowThroughput);
            return false;
        }
        self.integrator.stop == PathTermination::Roulette
            || state.total_reflections <= MIN_TOTAL_REFLECTIONS
            || self.russian_roulette(state, 1.0, u)
    }

    /// Russian roulette, with a probability of surviving that is at most `survival`. Returns true
    /// if the path continues, with compensated throughput.
    ///
    /// With the stop rule `roulette`, `survival` follows from a weight: the throughput times the
    /// squared index of refraction at the path's position (`eta_scale`), which undoes the scaling
    /// of radiance by refraction. A path with a weight `w` below 1 survives with probability `w`
    /// and then has weight 1; a path with a larger weight always survives. So no weight exceeds the
    /// larger of 1 and its value without roulette, and the square of a path's contribution grows by
    /// at most the factor `1 / w`, from `w^2` to `w`: the variance stays bounded. Terminating long
    /// paths with a fixed probability, as is often done, breaks this: weights would grow without
    /// limit in a room of albedo near 1.
    fn russian_roulette(
        &mut self,
        state: &mut PathState,
        survival: f32,
        u: impl FnOnce() -> f64,
    ) -> bool {
        let survival = survival * total_reflection_survival(state.total_reflections);
        let survival_pdf = if fault!(RouletteUncompensated) { 1.0 } else { survival };
        let throughput = state.throughput / survival_pdf.max(f32::MIN_POSITIVE);
        let survives = survival >= 1.0 || u() < f64::from(survival);
        self.recorder.record(|| PathEvent::Roulette { survival, survives, throughput });
        state.throughput = if survives { throughput } else { Rgb::ZERO };
        if !survives {
            self.terminate(Termination::Roulette);
        }
        survives
    }

    /// Takes a path to the other side of a boundary, if its media differ there.
    pub(super) fn cross(&mut self, state: &PathState, crossing: Option<Crossing>) {
        if let Some(crossing) = crossing {
            if let Some(media) = self.media.get_mut(state.batch_index as usize) {
                media.cross(crossing);
            }
        }
    }
}
