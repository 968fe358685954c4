//! The next direction of a path, and whether it goes on.

use crate::color::Rgb;
use crate::fault::fault;
use crate::geometry::SurfaceHit;
use crate::light::Receiver;
use crate::material::{BsdfSample, Lobe, Media};
use crate::math::{DVec3, nearly_unit};
use crate::scene::settings::Stop;

use super::super::dimension::Vertex;
use super::super::trace::{End, Recorder, Step};
use super::batch::Batch;
use super::paths::{Drawn, LONGEST, Path, State};

/// Paths shorter than this many edges are never ended by roulette.
const ROULETTE_FROM: u32 = 4;

impl<R: Recorder> Batch<'_, R> {
    /// Goes on behind a boundary that lies hidden in another medium.
    pub(super) fn pass_through(
        &mut self,
        path: &mut Path,
        hit: &SurfaceHit,
        beyond: Option<&Media>,
    ) -> bool {
        self.recorder.note(|| Step::Hidden);
        self.enter(path, beyond);
        path.state.is_drawn = false;
        self.go_straight_on(path, hit)
    }

    /// Goes on behind a surface that is not there.
    pub(super) fn pass_unhindered(&mut self, path: &mut Path, hit: &SurfaceHit) -> bool {
        self.recorder.note(|| Step::Absent);
        self.go_straight_on(path, hit)
    }

    /// Goes on in the same direction on the other side of a surface.
    fn go_straight_on(&mut self, path: &mut Path, hit: &SurfaceHit) -> bool {
        path.state.passes += 1;
        if path.state.passes >= LONGEST {
            return self.cut_off();
        }
        let Some(ray) = hit.leave(path.ray.direction) else { return self.end(End::Grazing) };
        path.ray = ray;
        true
    }

    /// Turns the path into the sampled direction. Returns whether it goes on.
    pub(super) fn scatter(
        &mut self,
        path: &mut Path,
        from: &Receiver,
        sample: &BsdfSample,
        direction: DVec3,
        beyond: Option<&Media>,
    ) -> bool {
        let BsdfSample { lobe, pdf, weight, eta, .. } = *sample;
        let wi = nearly_unit(direction);
        path.state.throughput *= weight;
        let throughput = path.state.throughput;
        self.recorder.note(|| Step::Scatter { lobe, wi, pdf, weight, eta, throughput });
        let Some(ray) = from.hit.leave(wi) else { return self.end(End::Grazing) };
        path.ray = ray;
        path.state.index_squared *= (eta * eta) as f32;
        path.state.is_drawn = lobe != Lobe::Delta;
        if path.state.is_drawn {
            self.drawn[path.state.sample as usize] = Drawn::new(from, pdf);
            path.state.scatterings += 1;
        }
        if sample.wi.z < 0.0 {
            self.enter(path, beyond);
        }
        self.survives(&mut path.state)
    }

    /// Whether a path that has just scattered goes on, with its throughput made up for that.
    #[inline(always)]
    pub(super) fn survives(&mut self, state: &mut State) -> bool {
        let largest = state.throughput.max_element();
        let goes_on = match self.transport.stop {
            Stop::Roulette if state.depth >= ROULETTE_FROM => {
                let survivor = self.roulette(*state);
                state.throughput = survivor.unwrap_or(Rgb::ZERO);
                survivor.is_some()
            }
            Stop::Roulette | Stop::Depth => largest > 0.0,
            Stop::Threshold(threshold) => f64::from(largest) >= threshold,
        };
        goes_on || self.end(End::Stopped)
    }

    /// Russian roulette. The throughput of a path that goes on; `None` for one that does not.
    ///
    /// What counts is the throughput times the squared index of refraction where the path is: light
    /// that refraction compressed is going to be spread again. A path whose weight `w` is below 1
    /// survives with that probability, and then weighs 1; one that weighs more always survives. So
    /// no weight ever exceeds the larger of 1 and what it was without roulette, and the square of
    /// what a path gathers grows by at most the factor `1 / w`, from `w^2` to `w`: the variance stays
    /// bounded. Ending long paths with a fixed share whatever they weigh, as is often done, breaks
    /// that: weights would grow without limit in a room of albedo near 1.
    fn roulette(&mut self, state: State) -> Option<Rgb> {
        let weight = state.throughput.max_element() * state.index_squared;
        let survival = weight.min(1.0);
        let paid = if fault!(RouletteUnpaid) { 1.0 } else { survival };
        let throughput = state.throughput / paid.max(f32::MIN_POSITIVE);
        let u = || self.samplers[state.sample as usize].get(Vertex::at(state.depth).roulette());
        let survives = survival >= 1.0 || u() < f64::from(survival);
        self.recorder.note(|| Step::Roulette { survival, survives, throughput });
        survives.then_some(throughput)
    }

    /// Goes over to the media beyond a boundary, if they are others.
    fn enter(&mut self, path: &Path, beyond: Option<&Media>) {
        let Some(media) = beyond else { return };
        if let Some(here) = self.media.get_mut(path.state.sample as usize) {
            self.tally.media_overflows += u64::from(media.overflowed() && !here.overflowed());
            *here = *media;
        }
    }
}
