//! Sampling of BSDFs and microfacet normals.

use std::sync::Arc;

use crate::material::{Bsdf, Dielectric, EnergyCompensation, Ggx, Lobe};
use crate::math::{DVec3, Frame};
use crate::sampling::{Sampler, sin_cos};

use super::super::check::Effort;
use super::super::materials::{MaterialCase, material_cases};
use super::SamplingTest;

/// Angles of `wo` from the normal in degrees.
const DEGREES: [f64; 3] = [0.0, 45.0, 85.0];

pub(super) fn tests() -> Vec<SamplingTest> {
    let cases = material_cases(Effort::Quick)
        .into_iter()
        .filter(|s| s.in_chi2_suite && !s.bsdf().is_delta());
    let tests_for = |case: Arc<MaterialCase>| DEGREES.map(|degrees| bsdf(case.clone(), degrees));
    let microfacets =
        [(0.4, 0.0), (0.4, 60.0), (0.4, 88.0), (1.0, 30.0), (1.0, 89.9)].map(|(r, at)| ggx(r, at));
    cases
        .map(Arc::new)
        .flat_map(tests_for)
        .chain(microfacets.into_iter().flatten())
        .chain([0.2, 0.5, 1.0].map(broad_lobe))
        .chain([ggx_formula(0.6), nearly_matched(0.3, 0.0, 0.03), nearly_matched(1.0, 85.0, 0.5)])
        .collect()
}

fn direction(degrees: f64) -> DVec3 {
    let (sin, cos) = sin_cos(degrees.to_radians());
    DVec3::new(sin, 0.0, cos)
}

/// Returns two more random numbers, derived from the last one.
fn extra_uniforms(u: [f64; 4]) -> impl Fn() -> [f64; 2] {
    move || Sampler::independent(u[3].to_bits(), 0, 0).get_2d(0)
}

/// Directions of a BSDF without its delta lobes, for `wo` at this angle in degrees. Covers the
/// hemisphere, or the sphere for a transmissive material.
fn bsdf(case: Arc<MaterialCase>, degrees: f64) -> SamplingTest {
    let wo = direction(degrees);
    let name = format!("bsdf {}, wo at {degrees} degrees", case.name);
    let (is_transmissive, is_glass) =
        (case.bsdf().is_rough_transmissive(), matches!(case.bsdf(), Bsdf::Dielectric(_)));
    let sampled_case = case.clone();
    let sample = move |u: [f64; 4]| {
        let sample = sampled_case.bsdf().sample(wo, u[2], [u[0], u[1]], &extra_uniforms(u))?;
        (sample.lobe != Lobe::Delta).then_some(sample.wi)
    };
    let pdf = move |wi| case.bsdf().pdf(wo, wi);
    if !is_transmissive {
        return SamplingTest::over_hemisphere(name, sample, pdf);
    }
    let test = SamplingTest::over_sphere(name, sample, pdf);
    // The refracted lobe ends at an edge, where facets would have to face away.
    if is_glass && degrees > 80.0 { test.with_discontinuities() } else { test }
}

/// Rough glass in a medium of nearly its index bends light so little that the cells lie close
/// around the straight-through direction.
fn nearly_matched(roughness: f64, degrees: f64, up_to: f64) -> SamplingTest {
    let eta = 1.05;
    let glass = Arc::new(Dielectric::new(eta, 0, roughness, &[1.0]));
    let sampled_glass = glass.clone();
    let wo = direction(degrees);
    let frame = Frame::from_z(-wo);
    SamplingTest::over_cap(
        format!("bsdf glass, eta {eta}, roughness {roughness}, wo at {degrees} degrees"),
        up_to,
        move |u| {
            let interface = Bsdf::Dielectric(sampled_glass.bsdf(eta));
            Some(frame.to_local(interface.sample(wo, u[2], [u[0], u[1]], &extra_uniforms(u))?.wi))
        },
        move |w| Bsdf::Dielectric(glass.bsdf(eta)).pdf(wo, frame.to_world(w)),
    )
    .with_discontinuities()
}

/// Visible normals, and the directions reflected off them.
fn ggx(roughness: f64, degrees: f64) -> [SamplingTest; 2] {
    let ggx = Ggx::new(roughness).expect("rough");
    let wo = direction(degrees);
    let parameters = format!("roughness {roughness}, wo at {degrees} degrees");
    let normals = SamplingTest::over_hemisphere(
        format!("ggx normals, {parameters}"),
        move |u| Some(ggx.sample_visible_normal(wo, [u[0], u[1]])),
        move |m| ggx.visible_normal_pdf(wo, m),
    );
    let reflections = SamplingTest::over_hemisphere(
        format!("ggx reflection, {parameters}"),
        move |u| ggx.sample_reflection(wo, [u[0], u[1]]).map(|(wi, _)| wi),
        move |wi| ggx.reflection_pdf(wo, wi),
    );
    [normals, reflections]
}

/// Multiple scattering between facets.
fn broad_lobe(roughness: f64) -> SamplingTest {
    let missing = Arc::new(EnergyCompensation::for_reflection(Ggx::new(roughness).expect("rough")));
    let sampled = missing.clone();
    SamplingTest::over_hemisphere(
        format!("light between facets, roughness {roughness}"),
        move |u| Some(sampled.sample([u[0], u[1]])),
        move |w| missing.pdf(w.z),
    )
    .with_discontinuities()
}

/// Normals seen at normal incidence, against an explicit `D(m) cos`, which pins down the meaning of
/// roughness.
fn ggx_formula(roughness: f64) -> SamplingTest {
    let ggx = Ggx::new(roughness).expect("rough");
    let alpha_squared = roughness * roughness * roughness * roughness;
    SamplingTest::over_hemisphere(
        format!("ggx normals, roughness {roughness}, against the formula"),
        move |u| Some(ggx.sample_visible_normal(DVec3::Z, [u[0], u[1]])),
        move |m| {
            let spread = m.z * m.z * (alpha_squared - 1.0) + 1.0;
            alpha_squared * m.z / (std::f64::consts::PI * spread * spread)
        },
    )
}
