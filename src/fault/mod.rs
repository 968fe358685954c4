//! Fault injection, which tests the test suite. Each fault is enabled on its own, and the suite
//! must detect it (`tests/faults.rs`; docs/verification.md has the table).
//!
//! A fault is injected where the real mistake would occur, in one line: `if fault!(Name) { wrong }
//! else { right }`. Without the feature `faults`, which only that test uses, the condition is the
//! constant `false` and the fault is not compiled. With the feature, the condition is one atomic
//! load.
//!
//! A test build can also leave out vector instructions that the processor has
//! ([`VectorWidth`]; `tests/instruction_sets.rs`).

mod vector_width;

#[cfg_attr(not(feature = "faults"), allow(unreachable_pub, reason = "one list for both"))]
pub use vector_width::VectorWidth;
pub(crate) use vector_width::allows;
#[cfg(feature = "faults")]
pub use vector_width::limit_vectors;

/// Returns true if a fault is enabled.
macro_rules! fault {
    ($name:ident) => {
        $crate::fault::is_on($crate::fault::Fault::$name)
    };
}
pub(crate) use fault;

/// Defines the list of faults, each with a description of what it breaks.
macro_rules! registry {
    ($($name:ident: $breaks:literal,)*) => {
        /// A fault to inject.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[cfg_attr(feature = "faults", allow(missing_docs, reason = "`breaks` tells"))]
        #[cfg_attr(not(feature = "faults"), allow(unreachable_pub, reason = "one list for both"))]
        pub enum Fault {
            $($name,)*
        }

        #[cfg(feature = "faults")]
        impl Fault {
            /// All faults.
            pub const ALL: &[Self] = &[$(Self::$name,)*];

            /// What is wrong while this fault is enabled.
            pub fn breaks(self) -> &'static str {
                match self {
                    $(Self::$name => $breaks,)*
                }
            }
        }
    };
}

registry! {
    // Sampling
    CosinePdfUniform: "the pdf of cosine-weighted directions is the uniform one",
    AngleJacobianMissing: "the pdf of uniform angles lacks the sine of its Jacobian",
    PowerCosineNorm: "a power cosine is normalised with n + 2 instead of n + 1",
    PmfOffByOne: "a discrete distribution reports its neighbour's probability",
    FilterNotNormalized: "a filter's pdf is per radius instead of per pixel",
    // Geometry
    ConeSmallAngle: "the cone of an emitter is its small-angle limit",
    ConeUniformInAngle: "an emitter's cone is sampled with more weight on its middle",
    CapComplement: "the hidden cap of an emitter is sampled",
    CapPdfWithoutCosine: "the pdf of a cap lacks the cosine",
    ProjectedCapUniform: "the pdf of a projected cap lacks the cosine",
    FarRootForNear: "the far root of a sphere is used instead of the near one",
    NearRootForFar: "inside a sphere, its near root is used, which lies behind the ray",
    ExitDistanceIgnored: "a ray that enters a sphere ignores the exit distance",
    ExclusionLost: "a ray may hit the sphere that it leaves",
    EmitterOccludesItself: "a shadow ray may hit its target emitter",
    NormalFacesAway: "inside a sphere the normal still points outwards",
    SpheresRoundedToF32: "spheres are rounded to f32, relative to the origin",
    RayRoundedToF32: "the ray passed to an intersector is rounded to f32",
    // Intersectors
    NotClosestHit: "the last sphere tested is the hit, instead of the closest",
    PrunedTooEarly: "the tree is pruned before the closest hit so far",
    PacketConeTooNarrow: "the bounding cone of a ray packet is too narrow",
    // Materials
    LambertWithoutPi: "a diffuse BRDF is the albedo, without 1 / pi",
    CosineTwice: "the weight of a diffuse sample has the cosine twice",
    LobePdfsSwapped: "the pdf of Phong's lobes has their weights swapped",
    AlphaIsRoughness: "the microfacet width is the roughness instead of its square",
    HalfVectorJacobianLost: "the pdf of a reflection is that of its half vector",
    OnePolarization: "the Fresnel equations lack one polarisation",
    RefractionJacobianLost: "the pdf of a rough refraction is that of its half vector",
    HalfVectorEtaSwapped: "the half vector of a refraction scales the wrong side by the index",
    MultiscatterSampledByCosine: "the multiscatter lobe is sampled by the cosine, with its own pdf",
    MultiscatterWrongSide: "multiscatter compensation leaves on the wrong side",
    CoatWithoutBaseAttenuation: "a coat's reflection does not attenuate the base",
    EtaSquaredDropped: "refraction does not scale radiance by 1 / eta^2",
    IorSwapped: "the index of refraction is inverted at every boundary",
    AbsorbedTwice: "glass absorbs over twice the path length",
    MediumStackNotPopped: "a path that leaves glass stays in its medium",
    // Lights
    LightPmfUniform: "the pdf of an emitter takes light selection to be uniform",
    LightTreePmfHalf: "the pmf of the light tree takes both children to be equally likely",
    InsideEmitterPdfWithoutCosine: "inside an emitter, the pdf lacks the cosine",
    ConnectionSideSwapped: "a specular connection bends around the wrong side of the ball",
    ConnectionRootMissing: "only the first root of a specular connection is found",
    ConnectionEtaSquaredMissing: "a connection into or out of glass keeps its radiance",
    ConnectionFresnelMissing: "a connection over glass loses nothing to Fresnel's equations",
    ConnectionMisForgotten: "light found by chance over a ball has the MIS weight 1",
    ConnectionWeightMissing: "connections over a ball have the MIS weight 1",
    // Camera and film
    PixelCornerForCenter: "pixel coordinates start at the centre instead of the corner",
    FirstBlockDropped: "the first block of samples is counted but not added",
    DividedByWrongCount: "the sum of 4 N samples is divided by N (the paper's confusion, A3)",
    // Integrators
    DirectCosineMissing: "direct light is not multiplied by the cosine",
    BsdfMisWeightMissing: "BSDF-sampled light has no MIS weight",
    MisWeightsSwapped: "BSDF-sampled light gets the MIS weight of light sampling",
    RouletteUncompensated: "surviving paths are not divided by the survival probability",
    DepthOffByOne: "paths are one edge longer than allowed",
    RandomNumberReused: "polar angle and azimuth share one random number",
    ShadowRayOpacityLost: "a shadow ray carries what a translucent surface absorbs",
    PassedMediumLost: "a shadow ray is not dimmed by the media that it enters",
    MisRecordLost: "a path that passes an index-matched boundary forgets its MIS record",
    TrapEverywhere: "totally reflected light counts as trapped whatever reaches its ring",
    CatcherVisibilityLost: "a shadow catcher forgets whether its light is blocked",
    CatcherWithoutCosine: "a shadow catcher weighs the light of the sky without the cosine",
    BackgroundCameraOnly: "the background lights nothing; only the camera sees it",
}

/// Returns true if a fault is enabled: never, in this build.
#[cfg(not(feature = "faults"))]
pub(crate) const fn is_on(_: Fault) -> bool {
    false
}

/// Returns true if a fault is enabled.
#[cfg(feature = "faults")]
pub(crate) fn is_on(fault: Fault) -> bool {
    ON.load(std::sync::atomic::Ordering::Relaxed) == fault as u32
}

/// Enables this fault for the whole process and disables all others.
#[cfg(feature = "faults")]
pub fn switch_to(fault: Option<Fault>) {
    let number = fault.map_or(NONE, |fault| fault as u32);
    ON.store(number, std::sync::atomic::Ordering::Relaxed);
}

#[cfg(feature = "faults")]
const NONE: u32 = u32::MAX;

/// Number of the enabled fault.
#[cfg(feature = "faults")]
static ON: std::sync::atomic::AtomicU32 = std::sync::atomic::AtomicU32::new(NONE);
