//! BSDF sampling and Russian roulette: the next edge of a path.

use crate::color::Rgb;
use crate::fault::fault;
use crate::geometry::{Side, SurfaceHit};
use crate::light::LightSampleContext;
use crate::material::{Boundary, BsdfSample, Lobe, MediumStack};
use crate::math::{DVec3, renormalize};
use crate::scene::settings::PathTermination;

use super::super::dimension::VertexDimensions;
use super::super::trace::{PathEvent, PathRecorder, Termination};
use super::batch::PathBatch;
use super::paths::{MAX_PATH_EDGES, Path, PathState, PrevVertex};

/// Paths with fewer edges are never terminated by roulette.
const ROULETTE_MIN_DEPTH: u32 = 4;

/// A path may be totally reflected so often in succession before roulette.
const MIN_TOTAL_REFLECTIONS: u16 = 64;

/// Returns the probability of continuing after so many total reflections in succession, which may
/// go on for ever. Of all paths, the fraction `64 / n` survives n of them: a path has at most a few
/// hundred edges on average, and no weight grows beyond `n / 64`. With a constant probability q,
/// the second moment of a weight is `q^-n`. Where a path finds a small emitter after 33 reflections
/// on average, it is 1e52 for q = 0.95, and 1.08 here.
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
    ) -> bool {
        self.recorder.record(|| match boundary.eta {
            None => PathEvent::HiddenBoundary,
            Some(_) => PathEvent::MatchedBoundary,
        });
        self.set_media(path, Some(&boundary.transmitted_media));
        if !is_passable || fault!(MisRecordLost) {
            path.state.has_prev_vertex = false;
        }
        self.continue_straight(path, hit)
    }

    /// Continues behind a surface that failed the opacity test.
    pub(super) fn pass_transparent(&mut self, path: &mut Path, hit: &SurfaceHit) -> bool {
        self.recorder.record(|| PathEvent::Transparent);
        self.continue_straight(path, hit)
    }

    /// Continues in the same direction on the other side of a surface.
    fn continue_straight(&mut self, path: &mut Path, hit: &SurfaceHit) -> bool {
        path.state.passthroughs += 1;
        if path.state.passthroughs >= MAX_PATH_EDGES {
            return self.terminate_at_length_limit();
        }
        let Some(ray) = hit.spawn_ray(path.ray.direction) else {
            return self.terminate(Termination::Grazing);
        };
        path.ray = ray;
        true
    }

    /// Counts a total reflection from inside a medium, and returns true if the path is known to be
    /// trapped by it.
    pub(super) fn is_trapped(
        &self,
        path: &mut Path,
        hit: &SurfaceHit,
        sample: &BsdfSample,
        eta: f64,
        direction: DVec3,
    ) -> bool {
        let is_inside = hit.side == Side::Inside;
        let is_reflected =
            is_inside && eta < 1.0 && sample.lobe == Lobe::Delta && sample.wi.z > 0.0;
        if !is_reflected || sample.pdf < 1.0 {
            path.state.total_reflections = 0;
            return false;
        }
        path.state.total_reflections += 1;
        self.context.prepared.is_light_trapped(hit.id, hit.point, direction)
    }

    /// Continues the path in the sampled direction. Returns true if the path continues.
    pub(super) fn scatter(
        &mut self,
        path: &mut Path,
        from: &LightSampleContext,
        sample: &BsdfSample,
        direction: DVec3,
        transmitted_media: Option<&MediumStack>,
    ) -> bool {
        let BsdfSample { lobe, pdf, weight, eta, .. } = *sample;
        let wi = renormalize(direction);
        path.state.throughput *= weight;
        let throughput = path.state.throughput;
        self.recorder.record(|| PathEvent::BsdfSample { lobe, wi, pdf, weight, eta, throughput });
        let Some(ray) = from.hit.spawn_ray(wi) else { return self.terminate(Termination::Grazing) };
        path.ray = ray;
        path.state.eta_scale *= (eta * eta) as f32;
        path.state.has_prev_vertex = lobe != Lobe::Delta;
        if path.state.has_prev_vertex {
            self.prev_vertices[path.state.batch_index as usize] = PrevVertex::new(from, pdf);
            path.state.scatter_count += 1;
        }
        if sample.wi.z < 0.0 {
            self.set_media(path, transmitted_media);
        }
        self.survives(&mut path.state)
    }

    /// Applies Russian roulette and its throughput compensation. Returns true if the path
    /// continues.
    #[inline(always)]
    pub(super) fn survives(&mut self, state: &mut PathState) -> bool {
        let brightest = state.throughput.max_element();
        let continues = match self.integrator.stop {
            PathTermination::Roulette if state.depth >= ROULETTE_MIN_DEPTH => {
                let survivor = self.russian_roulette(*state);
                state.throughput = survivor.unwrap_or(Rgb::ZERO);
                survivor.is_some()
            }
            PathTermination::Roulette | PathTermination::Depth => brightest > 0.0,
            PathTermination::Threshold(threshold) => f64::from(brightest) >= threshold,
        };
        continues || self.terminate(Termination::LowThroughput)
    }

    /// Russian roulette. Returns the throughput of a surviving path, `None` if it is terminated.
    ///
    /// The survival weight `w` is the throughput times the squared index of refraction at the
    /// path's position (`eta_scale`), which undoes the scaling of radiance by refraction. A path
    /// with `w` below 1 survives with probability `w` and then has weight 1; a path with a larger
    /// weight always survives. So no weight exceeds the larger of 1 and its value without roulette,
    /// and the square of a path's contribution grows by at most the factor `1 / w`, from `w^2` to
    /// `w`: the variance stays bounded. Terminating long paths with a fixed probability, as is
    /// often done, breaks this: weights would grow without limit in a room of albedo near 1.
    fn russian_roulette(&mut self, state: PathState) -> Option<Rgb> {
        let weight = state.throughput.max_element() * state.eta_scale;
        let survival = weight.min(1.0) * total_reflection_survival(state.total_reflections);
        let survival_pdf = if fault!(RouletteUncompensated) { 1.0 } else { survival };
        let throughput = state.throughput / survival_pdf.max(f32::MIN_POSITIVE);
        let u = || {
            self.samplers[state.batch_index as usize]
                .get(VertexDimensions::at(state.depth).roulette())
        };
        let survives = survival >= 1.0 || u() < f64::from(survival);
        self.recorder.record(|| PathEvent::Roulette { survival, survives, throughput });
        survives.then_some(throughput)
    }

    /// Switches to the media beyond a boundary, if they differ.
    fn set_media(&mut self, path: &Path, transmitted_media: Option<&MediumStack>) {
        let Some(media) = transmitted_media else { return };
        if let Some(current) = self.media.get_mut(path.state.batch_index as usize) {
            current.clone_from(media);
        }
    }
}
