//! Event-by-event traces of single paths.
//!
//! The stages of [`crate::integrator`] report their events to a [`PathRecorder`]. Renders use
//! [`NullRecorder`], which ignores events at no cost: they are not even computed. The other
//! recorder keeps a list, so a trace shows exactly the path that contributes to the picture, not a
//! reconstruction.

use crate::color::{PathRadiance, Rgb};
use crate::geometry::{PathRay, SurfaceHit};
use crate::light::specular::{Connection, SpecularPath};
use crate::light::{LightSample, LightSource};
use crate::material::Lobe;
use crate::math::DVec3;

use super::sample::{RenderStats, SampleAddress};

/// The traced path of one sample.
#[derive(Clone, Debug)]
pub struct PathTrace {
    /// The address of the sample.
    pub address: SampleAddress,
    /// The events in order. Summing the contributions of all [`PathEvent::Emission`] and
    /// [`PathEvent::ShadowRay`] in this order, layer by layer in f32, gives `radiance` to the bit.
    pub events: Vec<PathEvent>,
    /// The sample's contribution to its pixel.
    pub radiance: PathRadiance,
    /// Counters: rays traced and the like.
    pub stats: RenderStats,
}

/// Light that an event adds to the sample: radiance times path throughput and all weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contribution {
    /// The contribution; black where the light is occluded.
    pub radiance: Rgb,
    /// The factor applied by `clamp_indirect`; 1 if no clamping occurred.
    pub clamp: f32,
    /// True if it goes to the direct layer, false for the indirect layer.
    pub is_direct: bool,
}

/// A technique that could have found the same light as BSDF sampling, with its pdf; 0 if it could
/// not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rival {
    /// Light sampling, which would have sampled the same direction.
    LightSample(f64),
    /// A connection over the ball that the path has met.
    Connection(f64),
}

/// The light that a shadow catcher asks for, chosen among candidates in proportion to what each
/// would send.
#[derive(Clone, Copy, Debug)]
pub struct ChosenLight {
    /// The source, the direction and the radiance; its pdf is that of light sampling alone.
    pub sample: LightSample,
    /// The probability with which it was chosen.
    pub probability: f64,
    /// Number of candidates.
    pub count: usize,
}

/// One event of a path. Directions are in world space; points are relative to the spheres' origin.
#[derive(Clone, Copy, Debug)]
pub enum PathEvent {
    /// A camera ray is generated.
    CameraRay {
        /// The ray.
        ray: PathRay,
        /// Number of earlier attempts that were redrawn.
        redraws: u32,
    },
    /// A ray hits a sphere.
    Hit {
        /// Number of edges so far, counted from 1.
        depth: u32,
        /// Sphere, point, normal, distance and side.
        hit: SurfaceHit,
        /// Unit direction to the previous vertex.
        wo: DVec3,
        /// The surface's opacity: the probability that the ray does not pass straight through.
        opacity: f32,
        /// Transmittance of the medium along the ray.
        transmittance: Rgb,
        /// Path throughput: the product of `f cos / p` and transmittances so far.
        throughput: Rgb,
    },
    /// A ray misses.
    Miss {
        /// Number of edges so far, counted from 1.
        depth: u32,
        /// Unit direction to the previous vertex.
        wo: DVec3,
        /// Path throughput: the product of `f cos / p` so far.
        throughput: Rgb,
    },
    /// Emission found by BSDF sampling: from the sphere just hit, or from the environment.
    Emission {
        /// The light source.
        source: LightSource,
        /// `Le`, times the emitter's opacity.
        radiance: Rgb,
        /// Pdf with which the direction was sampled, times the probabilities of the choices at a
        /// ball since; `None` from the camera and after delta lobes that nothing can replace.
        pdf: Option<f64>,
        /// What else could have found this light.
        rival: Rival,
        /// MIS weight of BSDF sampling against it.
        weight: f32,
        /// Throughput times radiance times weight.
        contribution: Contribution,
    },
    /// The boundary just hit is hidden in a medium of higher priority; the path passes straight
    /// through.
    HiddenBoundary,
    /// The boundary just hit has media of the same index on both sides; the path passes straight
    /// through.
    MatchedBoundary,
    /// The surface just hit failed the opacity test; the path passes straight through.
    Transparent,
    /// A light sample. It contributes only if a later [`PathEvent::ShadowRay`] is unoccluded.
    LightSample {
        /// The source, the direction `wi`, its pdf and the radiance `Le`, times the emitter's
        /// opacity.
        sample: LightSample,
        /// Transmittance of the medium towards the light; 1 in scenes where a shadow ray may enter
        /// other media, whose visibility includes it.
        transmittance: Rgb,
        /// BSDF value for the light direction.
        f: Rgb,
        /// `|cos wi|`.
        cos: f64,
        /// Pdf with which BSDF sampling would have sampled `wi`.
        pdf_bsdf: f64,
        /// MIS weight of light sampling against BSDF sampling.
        weight: f64,
    },
    /// A connection to a light over a polished ball. It contributes only if a later
    /// [`PathEvent::ShadowRay`] with its number is unoccluded.
    Connection {
        /// Number of the connection at this vertex, from 1.
        number: u8,
        /// Id of the ball.
        caster: u32,
        /// The way over the ball.
        kind: SpecularPath,
        /// The light: an emitter, or the sun.
        source: LightSource,
        /// Points, directions and spread.
        connection: Connection,
        /// The radiance `Le` that the light emits.
        radiance: Rgb,
        /// What the ball multiplies it by: reflectance, or Fresnel factors, absorption and the
        /// change of radiance between media.
        transmittance: Rgb,
        /// BSDF value for the connection's direction.
        f: Rgb,
        /// `|cos wi|`.
        cos: f64,
        /// Probability of the pair of the ball and the light.
        pmf: f64,
        /// Pdf of the connection per solid angle at the vertex, times `pmf`.
        pdf: f64,
        /// Pdf with which BSDF sampling would have found this path.
        pdf_chance: f64,
        /// MIS weight of the connection against BSDF sampling.
        weight: f64,
    },
    /// A camera ray hits a shadow catcher, behind which the camera sees what is behind everything.
    /// The [`PathEvent::ShadowRay`] after it adds that.
    ShadowCatcher {
        /// The radiance of what is behind everything.
        behind: Rgb,
        /// The light whose shadow ray decides; `None` where no light can arrive, which counts as
        /// unoccluded.
        light: Option<ChosenLight>,
    },
    /// The result of the shadow ray of a light sample or shadow catcher, or of those along a
    /// connection.
    ShadowRay {
        /// 0 for the light sample at the last vertex; the number of a connection otherwise.
        connection: u8,
        /// Fraction of light that passes: 1 if unoccluded, 0 behind an opaque surface, otherwise
        /// the product of 1 minus opacity over the surfaces in between, and of the transmittances
        /// of the media if light can enter them in a straight line.
        visibility: Rgb,
        /// Throughput times `f cos Le weight / p`, or times what is behind a shadow catcher; times
        /// visibility.
        contribution: Contribution,
    },
    /// The BSDF samples a direction.
    BsdfSample {
        /// The kind of lobe sampled.
        lobe: Lobe,
        /// Sampled direction, leaving the surface.
        wi: DVec3,
        /// Pdf of the direction; for a delta lobe, the probability of selecting it.
        pdf: f64,
        /// `f cos / p`.
        weight: Rgb,
        /// Index of refraction beyond the interface over that in front of it; 1 without refraction.
        eta: f64,
        /// Path throughput: the product of `f cos / p` so far, this one included.
        throughput: Rgb,
    },
    /// Russian roulette.
    Roulette {
        /// Survival probability.
        survival: f32,
        /// True if the path survives; its throughput is then divided by the survival probability.
        survives: bool,
        /// Throughput after roulette.
        throughput: Rgb,
    },
    /// The path ends.
    End(Termination),
}

/// The reason a path ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Termination {
    /// The ray missed every sphere.
    Escaped,
    /// `max_depth` is reached.
    MaxDepth,
    /// The path reached the hard length limit.
    LengthLimit,
    /// Total reflection keeps the path in a sphere in which it finds no light.
    Trapped,
    /// The surface scatters no light in the sampled direction.
    Absorbed,
    /// The direction grazes the surface so closely that no ray leaves it.
    Grazing,
    /// Russian roulette terminated the path.
    Roulette,
    /// The throughput is zero or fell below the threshold.
    LowThroughput,
    /// The integrator follows light through one scattering only.
    DirectOnly,
    /// The camera sees only the shadow on the surface.
    ShadowCatcher,
}

/// Receives the events of a path from the stages.
pub(super) trait PathRecorder {
    /// True if events are recorded.
    const ENABLED: bool;

    /// Records an event. The closure is not evaluated where recording is disabled.
    fn record(&mut self, event: impl FnOnce() -> PathEvent);
}

/// A recorder that ignores all events.
pub(super) struct NullRecorder;

impl PathRecorder for NullRecorder {
    const ENABLED: bool = false;

    #[inline(always)]
    fn record(&mut self, _: impl FnOnce() -> PathEvent) {}
}

impl PathRecorder for Vec<PathEvent> {
    const ENABLED: bool = true;

    fn record(&mut self, event: impl FnOnce() -> PathEvent) {
        self.push(event());
    }
}

impl PathTrace {
    /// Sums the contributions of the events in order.
    pub fn sum(&self) -> PathRadiance {
        let mut sum = PathRadiance::default();
        for event in &self.events {
            if let PathEvent::Emission { contribution, .. }
            | PathEvent::ShadowRay { contribution, .. } = event
            {
                let layer =
                    if contribution.is_direct { &mut sum.direct } else { &mut sum.indirect };
                *layer += contribution.radiance;
            }
        }
        sum
    }
}
