//! A path as text, with the symbols of the rendering equation.

use crate::color::Rgb;
use crate::draw::text::count;
use crate::geometry::Side;
use crate::integrator::{Contribution, PathEvent, PathTrace, Termination};
use crate::light::LightSample;
use crate::material::Lobe;
use crate::math::DVec3;
use crate::scene::{PreparedScene, Scene};

use super::spheres::{answer, name, place, source_name};

/// Describes the whole path.
pub fn words(prepared: &PreparedScene, trace: &PathTrace) -> String {
    let scene = prepared.scene();
    let address = trace.address;
    let render = prepared.render_settings();
    let mut text = format!(
        "pixel {}, {}, sample {} of {}, seed {}, integrator {}\n\n",
        address.x,
        address.y,
        address.sample,
        render.samples_per_pixel,
        render.seed,
        render.integrator.kind().name()
    );
    let mut vertex = 0;
    for (at, step) in trace.events.iter().enumerate() {
        if let PathEvent::Hit { .. } = step {
            vertex += 1;
        }
        text += &one(scene, trace, at, vertex);
    }
    let radiance = trace.radiance;
    text + &format!(
        "\nL_o at the camera = {} direct + {} indirect = {}; {} traced\n",
        color(radiance.direct),
        color(radiance.indirect),
        color(radiance.direct + radiance.indirect),
        count(trace.stats.rays as usize, "ray"),
    )
}

fn one(scene: &Scene, trace: &PathTrace, at: usize, vertex: usize) -> String {
    match &trace.events[at] {
        PathEvent::CameraRay { ray, redraws } => {
            let again = match redraws {
                0 => String::new(),
                n => format!(", drawn again {n} times because it met nothing"),
            };
            let origin = vector(place(scene, ray.origin));
            format!("x_0  the camera at {origin} looks along {}{again}\n", vector(ray.direction))
        }
        PathEvent::Hit { hit, wo, opacity: presence, transmittance, throughput, .. } => {
            let side = match hit.side {
                Side::Outside => "outside",
                Side::Inside => "inside",
            };
            let opacity = match presence {
                1.0 => String::new(),
                o => format!("; opacity {}", number(f64::from(*o))),
            };
            format!(
                "\nx_{vertex}  {} met from {side} at {}, after {}{}{opacity}\n     n = {}, w_o = {}, \
                 T = {}\n",
                name(scene, hit.id),
                vector(place(scene, hit.point)),
                number(hit.t),
                absorbed(*transmittance),
                vector(hit.normal),
                vector(*wo),
                color(*throughput),
            )
        }
        PathEvent::Miss { throughput, .. } => {
            format!("\n     nothing is met; T = {}\n", color(*throughput))
        }
        PathEvent::Emission { source, radiance, pdf, pdf_light, weight, contribution: added } => {
            let of = source_name(scene, *source);
            let weighed = match pdf {
                None => "no light sample could have found it: w = 1".to_owned(),
                Some(pdf) => format!(
                    "p = {} by chance, {} by light sampling: w = {}",
                    number(*pdf),
                    number(*pdf_light),
                    number(f64::from(*weight))
                ),
            };
            let light = color(*radiance);
            format!("     {of} shines: L_e = {light}; {weighed}\n{}", plus("T L_e w", *added))
        }
        PathEvent::HiddenBoundary => {
            "     a boundary inside a medium of higher priority: straight through\n".to_owned()
        }
        PathEvent::Transparent => {
            "     it is not there for this path: straight through\n".to_owned()
        }
        PathEvent::LightSample { sample, transmittance, f, cos, pdf_bsdf, weight } => {
            let text =
                light_sample_text(scene, sample, *transmittance, *f, *cos, *pdf_bsdf, *weight);
            let tau = if *transmittance == Rgb::ONE { "" } else { " tau" };
            text + &arrival(tau, answer(&trace.events, at))
        }
        PathEvent::ShadowRay { .. } => String::new(), // covered by the light sample
        PathEvent::BsdfSample { lobe, wi, pdf, weight, eta, throughput } => {
            scatter(*lobe, *wi, *pdf, *weight, *eta) + &format!(", T = {}\n", color(*throughput))
        }
        PathEvent::Roulette { survival, survives, throughput } => {
            let survival = number(f64::from(*survival));
            if *survives {
                format!(
                    "     roulette: goes on, probability {survival}; T = {}\n",
                    color(*throughput)
                )
            } else {
                format!("     roulette: stops; the probability to go on was {survival}\n")
            }
        }
        PathEvent::End(end) => format!("     the path ends: {}\n", why(*end)),
    }
}

/// Describes the result of a light sample; `tau` is the symbol of the medium's transmittance.
fn arrival(tau: &str, answer: Option<(f32, Contribution)>) -> String {
    match answer {
        None => "     no ray leaves the surface so flat\n".to_owned(),
        Some((0.0, _)) => "     something is in the way\n".to_owned(),
        Some((1.0, added)) => plus(&format!("T f_r |cos| L_e{tau} w / p"), added),
        Some((passed, added)) => {
            let share = number(f64::from(passed));
            format!("     surfaces that are not opaque are in the way and let pass V = {share}\n")
                + &plus(&format!("T f_r |cos| L_e{tau} V w / p"), added)
        }
    }
}

/// Describes a transmittance below 1.
fn absorbed(transmittance: Rgb) -> String {
    match transmittance {
        Rgb::ONE => String::new(),
        tau => format!(" through a medium, tau = {}", color(tau)),
    }
}

fn light_sample_text(
    scene: &Scene,
    sample: &LightSample,
    transmittance: Rgb,
    f: Rgb,
    cos: f64,
    pdf_bsdf: f64,
    weight: f64,
) -> String {
    let to = source_name(scene, sample.source);
    let distance = match sample.distance.is_finite() {
        true => format!(" at distance {}", number(sample.distance)),
        false => String::new(),
    };
    format!(
        "     samples {to}{distance}{}: w_i = {}, L_e = {}\n     f_r = {}, |cos| = {}, p = {}, by \
         chance {}: w = {}\n",
        absorbed(transmittance),
        vector(sample.direction),
        color(sample.radiance),
        color(f),
        number(cos),
        number(sample.pdf),
        number(pdf_bsdf),
        number(weight)
    )
}

fn scatter(lobe: Lobe, wi: DVec3, pdf: f64, weight: Rgb, eta: f64) -> String {
    let (kind, density) = match lobe {
        Lobe::Diffuse => ("diffuse", "p ="),
        Lobe::Glossy => ("glossy", "p ="),
        Lobe::Delta => ("a single direction", "chosen with probability"),
    };
    let refracted = match eta {
        1.0 => String::new(),
        eta => format!(", refracted by eta = {}", number(eta)),
    };
    format!(
        "     scatters ({kind}): w_i = {}{refracted}, {density} {}, f_r |cos| / p = {}",
        vector(wi),
        number(pdf),
        color(weight)
    )
}

fn plus(formula: &str, added: Contribution) -> String {
    let layer = if added.is_direct { "direct" } else { "indirect" };
    let clamped = match added.clamp {
        1.0 => String::new(),
        share => format!(", of which clamp_indirect left {}", number(f64::from(share))),
    };
    format!("   + {formula} = {} ({layer}{clamped})\n", color(added.radiance))
}

/// Explains why a path ends.
pub(super) fn why(end: Termination) -> &'static str {
    match end {
        Termination::Escaped => "it met nothing",
        Termination::MaxDepth => "max_depth is reached",
        Termination::LengthLimit => "it is longer than any path may be",
        Termination::Absorbed => "the surface sends no light this way",
        Termination::Grazing => "it leaves the surface too flat to go anywhere",
        Termination::LowThroughput => "its weight has become too small, or roulette ended it",
        Termination::DirectOnly => "this integrator follows light through one scattering only",
    }
}

fn vector(v: DVec3) -> String {
    format!("({}, {}, {})", number(v.x), number(v.y), number(v.z))
}

fn color(color: Rgb) -> String {
    vector(color.as_dvec3())
}

/// Formats four significant digits, as short as possible.
pub(super) fn number(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        return "0".to_owned();
    }
    if !(1e-4..1e6).contains(&size) {
        return format!("{value:.3e}");
    }
    let decimals = (3 - libm::log10(size).floor() as i32).max(0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let shown =
            [0.0, 1.0, -0.5, 12.3456, 123456.7, 1e-7, 0.00123456, f64::INFINITY].map(number);
        assert_eq!(shown, ["0", "1", "-0.5", "12.35", "123457", "1.000e-7", "0.001235", "inf"]);
    }
}
