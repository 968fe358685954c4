//! One path told step by step.
//!
//! The stages of [`super::integrator`] tell a [`PathRecorder`] what they do. The one that renders are
//! made with, [`NullRecorder`], listens to nothing and costs nothing: what would be told is not even
//! computed. The other keeps a list, so that a trace is not a retelling but the very path that the
//! picture was made from.

use crate::color::{PathRadiance, Rgb};
use crate::geometry::{PathRay, SurfaceHit};
use crate::light::{LightSample, LightSource};
use crate::material::Lobe;
use crate::math::DVec3;

use super::sample::{RenderStats, SampleAddress};

/// The path of one sample.
#[derive(Clone, Debug)]
pub struct PathTrace {
    /// Which sample.
    pub address: SampleAddress,
    /// What happened, in order. Adding up the light of all [`PathEvent::Emission`] and [`PathEvent::ShadowRay`] in
    /// this order, layer by layer in f32, gives `radiance` to the bit.
    pub events: Vec<PathEvent>,
    /// What the sample brings to its pixel.
    pub radiance: PathRadiance,
    /// Rays traced, and the like.
    pub stats: RenderStats,
}

/// Light that a step brings to the sample: radiance times the path's throughput and all weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contribution {
    /// The light; black where something stands in the way.
    pub radiance: Rgb,
    /// What `clamp_indirect` left of it; 1 where that did not bite.
    pub clamp: f32,
    /// Which layer it goes to.
    pub is_direct: bool,
}

/// One event of a path. Directions are in world space, points relative to the spheres' origin.
#[derive(Clone, Copy, Debug)]
pub enum PathEvent {
    /// A ray leaves the camera.
    CameraRay {
        /// The ray.
        ray: PathRay,
        /// How often it was drawn again before.
        redraws: u32,
    },
    /// A ray meets a sphere.
    Hit {
        /// Edges so far, counted from 1.
        depth: u32,
        /// Sphere, point, normal, distance and side.
        hit: SurfaceHit,
        /// Unit direction to the previous vertex.
        wo: DVec3,
        /// The probability with which the surface is there: its opacity.
        opacity: f32,
        /// What the medium on the way let through.
        transmittance: Rgb,
        /// The product of `f cos / p` so far, and of what media let through.
        throughput: Rgb,
    },
    /// A ray meets nothing.
    Miss {
        /// Edges so far, counted from 1.
        depth: u32,
        /// Unit direction to the previous vertex.
        wo: DVec3,
        /// The product of `f cos / p` so far.
        throughput: Rgb,
    },
    /// Light found by chance: emission of the sphere just met, or background.
    Emission {
        /// Where it comes from.
        source: LightSource,
        /// `Le`, times the lamp's opacity.
        radiance: Rgb,
        /// The density with which chance drew the direction; `None` from the camera and after a
        /// delta lobe, which no light sample can replace.
        pdf: Option<f64>,
        /// The density with which light sampling would have drawn it.
        pdf_light: f64,
        /// The weight of chance against light sampling.
        weight: f32,
        /// Throughput times radiance times weight.
        contribution: Contribution,
    },
    /// The boundary just met is hidden in a medium of higher priority: the path goes straight through.
    HiddenBoundary,
    /// The surface just met is not there this time, since it is not opaque: the path goes straight
    /// through.
    Transparent,
    /// A light sample. It brings light if a later [`PathEvent::ShadowRay`] says so.
    LightSample {
        /// The light, the direction `wi`, its density and the radiance `Le`, times the lamp's opacity.
        sample: LightSample,
        /// What the medium on the way would let through.
        transmittance: Rgb,
        /// The BSDF for it.
        f: Rgb,
        /// `|cos wi|`.
        cos: f64,
        /// The density with which the BSDF would have drawn `wi`.
        pdf_bsdf: f64,
        /// The weight of light sampling against chance.
        weight: f64,
    },
    /// The answer to the shadow ray of the last light sample.
    ShadowRay {
        /// The share that what is in the way lets through: 0 for an opaque surface, 1 minus the opacity
        /// for each other one, 1 if there is nothing.
        visibility: f32,
        /// Throughput times `f cos Le weight / p`, times what passes.
        contribution: Contribution,
    },
    /// The BSDF draws a direction.
    BsdfSample {
        /// Which kind of lobe it came from.
        lobe: Lobe,
        /// The direction, leaving the surface.
        wi: DVec3,
        /// Its density, or for a delta lobe the probability of having chosen that.
        pdf: f64,
        /// `f cos / p`.
        weight: Rgb,
        /// Index of refraction beyond the interface over that before it; 1 without refraction.
        eta: f64,
        /// The product of `f cos / p` so far, this one included.
        throughput: Rgb,
    },
    /// Russian roulette.
    Roulette {
        /// The probability to go on.
        survival: f32,
        /// Whether the path goes on; its throughput is then divided by that probability.
        survives: bool,
        /// The throughput from here on.
        throughput: Rgb,
    },
    /// The path ends.
    End(Termination),
}

/// Why a path ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Termination {
    /// It met nothing.
    Escaped,
    /// `max_depth` is reached.
    MaxDepth,
    /// It is longer than any path may be.
    LengthLimit,
    /// The surface sends no light this way.
    Absorbed,
    /// The direction grazes the surface so closely that no ray leaves it.
    Grazing,
    /// It lost at roulette, or its weight fell below the threshold.
    LowThroughput,
    /// The integrator follows light through one scattering only.
    DirectOnly,
}

/// Listens to the stages.
pub(super) trait PathRecorder {
    /// Whether it is worth telling anything.
    const ENABLED: bool;

    /// Takes note of a step, which need not be computed where nobody listens.
    fn record(&mut self, step: impl FnOnce() -> PathEvent);
}

/// Listens to nothing.
pub(super) struct NullRecorder;

impl PathRecorder for NullRecorder {
    const ENABLED: bool = false;

    #[inline(always)]
    fn record(&mut self, _: impl FnOnce() -> PathEvent) {}
}

impl PathRecorder for Vec<PathEvent> {
    const ENABLED: bool = true;

    fn record(&mut self, step: impl FnOnce() -> PathEvent) {
        self.push(step());
    }
}

impl PathTrace {
    /// The light that the steps bring, added up in their order.
    pub fn sum(&self) -> PathRadiance {
        let mut sum = PathRadiance::default();
        for step in &self.events {
            if let PathEvent::Emission { contribution: added, .. }
            | PathEvent::ShadowRay { contribution: added, .. } = step
            {
                let layer = if added.is_direct { &mut sum.direct } else { &mut sum.indirect };
                *layer += added.radiance;
            }
        }
        sum
    }
}
