//! Surfaces: what a path meets, the light that is there, and what happens to the path.

use crate::color::Rgb;
use crate::fault::fault;
use crate::geometry::{Side, SurfaceHit};
use crate::light::{Receiver, Source};
use crate::material::{Lobe, Media};
use crate::math::Frame;
use crate::sampling::power_heuristic;
use crate::scene::Surface;
use crate::scene::settings::{Estimator, Miss};

use super::super::dimension::{Vertex, direction_again};
use super::super::trace::{End, Recorder, Step};
use super::batch::Batch;
use super::opacity;
use super::paths::{Aims, Drawn, LONGEST, Path, State};

impl<R: Recorder> Batch<'_, R> {
    /// A path that meets nothing: it sees the background. Returns whether it goes on.
    pub(super) fn miss(&mut self, path: &mut Path) -> bool {
        self.tell_miss(path);
        if self.redraw(path) {
            return true;
        }
        let (scene, direction) = (self.world.scene, path.ray.direction);
        let radiance = if path.state.depth == 1 {
            // Nothing has turned this path yet: it looks straight from the camera.
            let radiance = scene.seen_by_camera(direction);
            self.radiance[path.state.sample as usize].alpha = radiance.alpha;
            self.see_nothing(path, radiance.direct);
            radiance.direct
        } else {
            scene.background(direction)
        };
        let is_lost = path.state.depth > 1 && fault!(BackgroundOnlySeen);
        let radiance = if is_lost { Rgb::ZERO } else { radiance };
        self.gather(path, Source::Background, radiance, true);
        self.end(End::Missed)
    }

    /// The radiance of a background that is the same from everywhere, where meeting it takes no more
    /// than [`Self::miss_evenly`].
    pub(super) fn even_background(&self) -> Option<Rgb> {
        let is_plain = !R::LISTENS && self.seen.is_empty() && self.transport.miss != Miss::Redraw;
        self.world.shot.lights().background().even().filter(|_| is_plain)
    }

    /// Ends a path that meets nothing but a background of this radiance, as [`Self::miss`] does:
    /// nobody aims at such a background.
    #[inline(always)]
    pub(super) fn miss_evenly(&mut self, state: &State, mut radiance: Rgb) {
        if state.depth == 1 {
            self.radiance[state.sample as usize].alpha = 0.0;
            if !self.world.scene.shows_background() {
                radiance = Rgb::ZERO;
            }
        }
        if state.depth > 1 && fault!(BackgroundOnlySeen) {
            radiance = Rgb::ZERO;
        }
        if radiance != Rgb::ZERO {
            let added = self.arriving(state.throughput * radiance, state.is_direct());
            self.add(state.sample, added);
        }
    }

    /// A path that meets a surface. Returns whether it goes on.
    pub(super) fn shade(&mut self, path: &mut Path, hit: SurfaceHit, aims: &mut Aims<'_>) -> bool {
        let scene = self.world.scene;
        let transmittance = match scene.has_media() {
            true => self.media_of(path).transmittance(hit.t - path.ray.t_min),
            false => Rgb::ONE,
        };
        path.state.throughput *= transmittance;
        let State { depth, throughput, .. } = path.state;
        let surface = scene.surface(hit.id);
        let presence = surface.presence(hit.id, hit.side, self.media_of(path));
        let wo = -path.ray.direction;
        let meet = || Step::Meet { depth, hit, wo, presence, transmittance, throughput };
        self.recorder.note(meet);
        if surface.material.is_emissive() {
            let is_aimed_at = !opacity::is_behind_a_lamp(scene, self.drawn(path), &hit);
            let radiance = surface.material.emission * presence;
            self.gather(path, Source::Lamp(hit.id), radiance, is_aimed_at);
        }
        if presence < 1.0 && !opacity::is_there(path, self.sampler(path), presence) {
            return self.pass_unhindered(path, &hit);
        }

        // Straight through where a dielectric's boundary lies hidden in another one.
        let entering = hit.side == Side::Outside;
        let boundary = surface.medium(hit.id).map(|m| self.media_of(path).meet(m, entering));
        let beyond = boundary.as_ref().map(|boundary| &boundary.beyond);
        let eta = boundary.as_ref().map_or(Some(1.0), |boundary| boundary.eta);
        let Some(eta) = eta else { return self.pass_through(path, &hit, beyond) };

        // Is another edge allowed?
        if self.is_at_its_end(&path.state) {
            return self.end(End::Depth);
        }
        if depth >= LONGEST {
            return self.cut_off();
        }
        self.turn(path, &hit, &surface, eta, beyond, aims)
    }

    /// Whether a path has as many edges as it may.
    pub(super) fn is_at_its_end(&self, state: &State) -> bool {
        state.depth - u32::from(fault!(DepthOffByOne)) >= self.transport.max_depth
    }

    /// Aims at a light, then scatters. Returns whether the path goes on.
    pub(super) fn turn(
        &mut self,
        path: &mut Path,
        hit: &SurfaceHit,
        surface: &Surface<'_>,
        eta: f64,
        beyond: Option<&Media>,
        aims: &mut Aims<'_>,
    ) -> bool {
        let scene = self.world.scene;
        let bsdf = surface.material.bsdf(surface.albedo, eta, self.transport.hemisphere);
        let receiver = Receiver { hit: *hit, is_two_sided: bsdf.transmits() };
        let frame = Frame::around(hit.facing_normal());
        let wo = frame.to_local(-path.ray.direction);
        let may_scatter = path.state.scatterings < self.transport.most_scatterings;
        if self.transport.estimator != Estimator::Bsdf && may_scatter && !bsdf.is_delta() {
            let aimed = self.aim_at_light(path, &receiver, &bsdf, &frame, wo, beyond);
            aims.extend(scene, aimed);
        }
        let vertex = Vertex::at(path.state.depth);
        let sampler = self.sampler(path);
        let u = sampler.get_2d(vertex.direction());
        let u = if fault!(NumberReused) { [u[0]; 2] } else { u };
        let lobe = if bsdf.has_lobes() { sampler.get(vertex.lobe()) } else { 0.0 };
        let again = || sampler.get_2d(direction_again(path.state.depth));
        let Some(sample) = bsdf.sample(wo, lobe, u, &again) else {
            return self.end(End::Absorbed);
        };
        if sample.lobe != Lobe::Delta && !may_scatter {
            return self.end(End::DirectOnly);
        }
        let goes_on = self.scatter(path, &receiver, &sample, frame.to_world(sample.wi), beyond);
        path.state.depth += 1;
        goes_on
    }

    /// Adds light that a path came across, and might have aimed at.
    pub(super) fn gather(&mut self, path: &Path, source: Source, radiance: Rgb, is_aimed_at: bool) {
        if radiance == Rgb::ZERO && !R::LISTENS {
            return;
        }
        let drawn = self.drawn(path);
        let aimed = drawn.filter(|_| is_aimed_at);
        let pdf_light = aimed.map_or(0.0, |drawn| self.pdf_light(path, drawn, source));
        let pdf = drawn.map(|drawn| drawn.pdf);
        let weight = match (self.transport.estimator, pdf) {
            (Estimator::Mis, Some(_)) if fault!(DoubleCounting) => 1.0,
            (Estimator::Mis, Some(p)) if fault!(HeuristicSwapped) => {
                power_heuristic(pdf_light, p) as f32
            }
            (Estimator::Mis, Some(pdf)) => power_heuristic(pdf, pdf_light) as f32,
            (Estimator::Light, Some(_)) if pdf_light > 0.0 => 0.0,
            _ => 1.0,
        };
        let added =
            self.arriving(path.state.throughput * radiance * weight, path.state.is_direct());
        self.add(path.state.sample, added);
        self.recorder.note(|| Step::Light { source, radiance, pdf, pdf_light, weight, added });
    }

    /// The density with which the direction of a path's ray would have been drawn towards a light.
    fn pdf_light(&self, path: &Path, drawn: &Drawn, source: Source) -> f64 {
        if self.transport.estimator == Estimator::Bsdf {
            return 0.0;
        }
        let scene = self.world.scene;
        self.world.shot.lights().pdf(
            scene.spheres(),
            &drawn.at(scene.spheres()),
            source,
            path.ray.direction,
        )
    }
}
