//! Fault injection, which tests the test suite. Each fault is enabled on its own, and the suite
//! must detect it (`tests/faults.rs`; docs/verification.md has the table).
//!
//! A fault is injected where the real mistake would occur, in one line: `if fault!(Name) { wrong }
//! else { right }`. Without the feature `faults`, which only that test uses, the condition is the
//! constant `false` and the fault is not compiled. With the feature, the condition is one atomic
//! load.

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
    CosinePdfUniform: "the density of cosine-weighted directions is that of uniform ones",
    AngleJacobianMissing: "the density of uniform angles lacks the sine of its Jacobian",
    PowerCosineNorm: "a power cosine is normalised with n + 2 instead of n + 1",
    PmfOffByOne: "a discrete choice tells its neighbour's probability",
    FilterNotNormalized: "a filter's density is per radius and not per pixel",
    // Geometry
    ConeSmallAngle: "the cone of a lamp is that of its small-angle limit",
    ConeUniformInAngle: "a lamp's cone is sampled with more weight on its middle",
    FarRootForNear: "the far root of a sphere is taken for the near one",
    NearRootForFar: "from inside a sphere, its near root is taken, which lies behind",
    ExitDistanceIgnored: "a ray going into a sphere forgets that sphere's far wall",
    ExclusionLost: "a ray may hit the sphere that it leaves",
    EmitterOccludesItself: "a shadow ray may hit the lamp that it aims at",
    NormalFacesAway: "inside a sphere the normal points outwards still",
    RayRoundedToF32: "the ray that a backend gets is rounded to f32",
    // Intersectors
    NotClosestHit: "whichever sphere is looked at last is the hit",
    PrunedTooEarly: "the tree is not searched up to the nearest hit so far",
    PacketConeTooNarrow: "rays that go through the tree together are thought to be closer together",
    // Materials
    LambertWithoutPi: "a matt surface's BRDF is the albedo, without 1 / pi",
    CosineTwice: "a matt surface's weight has the cosine once more",
    LobePdfsSwapped: "the density of Phong's lobes has their shares swapped",
    AlphaIsRoughness: "the width of the microfacets is the roughness, and not its square",
    HalfVectorJacobianLost: "the density of a reflection is that of its half vector",
    OnePolarization: "Fresnel's equations forget one polarisation",
    RefractionJacobianLost: "the density of a rough refraction is that of its half vector",
    HalfVectorEtaSwapped: "the half vector of a refraction weighs the wrong side with the index",
    MultiscatterSampledByCosine: "light lost among facets is drawn by the cosine, with the density of its lobe",
    MultiscatterWrongSide: "light lost among facets comes out as if lost on the other side",
    CoatWithoutBaseAttenuation: "what a coat reflects is not taken from what lies beneath",
    EtaSquaredDropped: "refraction leaves radiance as it is, without 1 / eta^2",
    IorSwapped: "the index of refraction is inverted at every boundary",
    AbsorbedTwice: "glass absorbs over twice the length of the way through it",
    MediumStackNotPopped: "a path that leaves glass believes to be in it still",
    // Lights
    LightPmfUniform: "the density of a lamp takes the choice among lamps to be uniform",
    LightTreePmfHalf: "the density of a lamp in a hierarchy takes both ways at a node to be as likely",
    InsideEmitterPdfWithoutCosine: "from inside a lamp, the density lacks the cosine",
    // Camera and film
    PixelCornerForCenter: "pixels are counted from their centre and not from their corner",
    FirstBlockDropped: "the first block of samples is counted but not added",
    DividedByWrongCount: "the sum of 4 N samples is divided by N (the paper's confusion, A3)",
    // Integrators
    DirectCosineMissing: "light from a lamp is not multiplied with the cosine",
    BsdfMisWeightMissing: "light found by chance is not weighted against aiming at it",
    MisWeightsSwapped: "light found by chance gets the weight of aiming at it, and not the rest",
    RouletteUncompensated: "paths that survive the roulette are not made up for the others",
    DepthOffByOne: "paths are one edge longer than allowed",
    RandomNumberReused: "polar angle and azimuth come from the same random number",
    ShadowRayOpacityLost: "a shadow ray is left what a translucent surface stops",
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
