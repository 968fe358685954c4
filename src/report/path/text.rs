//! A path as text, with the symbols of the rendering equation.

use crate::color::Rgb;
use crate::draw::text::count;
use crate::geometry::Side;
use crate::integrator::{Contribution, PathEvent, PathTrace, Rival, Termination};
use crate::light::LightSample;
use crate::material::Lobe;
use crate::math::DVec3;
use crate::scene::{PreparedScene, Scene};

use super::fold::fold;
use super::spheres::{name, shadow_result, source_name, to_scene, way_over_ball};

/// Describes the whole path.
pub fn text(prepared: &PreparedScene, trace: &PathTrace) -> String {
    let scene = prepared.scene();
    let address = trace.address;
    let render = prepared.render_settings();
    let mut text = format!(
        "pixel {}, {}, sample {} of {}, seed {}, integrator {}, estimator {}, sampler {}, caustics {}\n\n",
        address.x,
        address.y,
        address.sample,
        render.samples_per_pixel,
        render.seed,
        render.integrator.kind().name(),
        render.estimator.name(),
        render.sampler.name(),
        render.caustics.name()
    );
    let mut vertex = 0;
    for (index, event) in trace.events.iter().enumerate() {
        if let PathEvent::Hit { .. } = event {
            vertex += 1;
        }
        text += &event_text(scene, trace, index, vertex);
    }
    let radiance = trace.radiance;
    text += &format!(
        "\nL_o at the camera = {} direct + {} indirect = {}; {} traced\n",
        color(radiance.direct),
        color(radiance.indirect),
        color(radiance.direct + radiance.indirect),
        count(trace.stats.rays as usize, "ray"),
    );
    fold(&text)
}

fn event_text(scene: &Scene, trace: &PathTrace, index: usize, vertex: usize) -> String {
    match &trace.events[index] {
        PathEvent::CameraRay { ray, redraws } => {
            let redraw_note = match redraws {
                0 => String::new(),
                n => format!("; redrawn {n} times after misses"),
            };
            let origin = vector(to_scene(scene, ray.origin));
            let direction = vector(ray.direction);
            format!("x_0  the camera at {origin} looks along {direction}{redraw_note}\n")
        }
        PathEvent::Hit { hit, wo, opacity, transmittance, throughput, .. } => {
            let side = match hit.side {
                Side::Outside => "outside",
                Side::Inside => "inside",
            };
            let opacity = match opacity {
                1.0 => String::new(),
                o => format!("; opacity {}", number(f64::from(*o))),
            };
            format!(
                "\nx_{vertex}  {} hit from {side} at {}, distance {}{}{opacity}\n     \
                 n = {}, w_o = {}, T = {}\n",
                name(scene, hit.id),
                vector(to_scene(scene, hit.point)),
                number(hit.t),
                transmittance_text(*transmittance),
                vector(hit.normal),
                vector(*wo),
                color(*throughput),
            )
        }
        PathEvent::Miss { throughput, .. } => {
            format!("\n     the ray misses; T = {}\n", color(*throughput))
        }
        PathEvent::Emission { source, radiance, pdf, rival, weight, contribution } => {
            let emitter = source_name(scene, *source);
            let mis_text = match pdf {
                None => "not reachable by light sampling: w = 1".to_owned(),
                Some(pdf) => format!(
                    "p = {} by BSDF sampling, {}: w = {}",
                    number(*pdf),
                    rival_text(*rival),
                    number(f64::from(*weight))
                ),
            };
            let light = color(*radiance);
            format!("     {emitter} emits: L_e = {light}; {mis_text}\n")
                + &contribution_text("T L_e w", *contribution)
        }
        PathEvent::HiddenBoundary => {
            "     boundary hidden by a medium of higher priority: passes straight through\n"
                .to_owned()
        }
        PathEvent::MatchedBoundary => {
            "     boundary between media of the same index: passes straight through\n".to_owned()
        }
        PathEvent::Transparent => {
            "     transparent for this path: passes straight through\n".to_owned()
        }
        PathEvent::LightSample { sample, transmittance, f, cos, pdf_bsdf, weight } => {
            let text =
                light_sample_text(scene, sample, *transmittance, *f, *cos, *pdf_bsdf, *weight);
            let tau = if *transmittance == Rgb::ONE { "" } else { " tau" };
            text + &shadow_text(tau, shadow_result(&trace.events, index, 0))
        }
        PathEvent::Connection { number, .. } => {
            let result = shadow_result(&trace.events, index, *number);
            connection_text(scene, &trace.events[index]) + &shadow_text(" tau", result)
        }
        // Covered by the light sample or connection.
        PathEvent::ShadowRay { .. } => String::new(),
        PathEvent::BsdfSample { lobe, wi, pdf, weight, eta, throughput } => {
            bsdf_sample_text(*lobe, *wi, *pdf, *weight, *eta)
                + &format!(", T = {}\n", color(*throughput))
        }
        PathEvent::Roulette { survival, survives, throughput } => {
            let survival = number(f64::from(*survival));
            if *survives {
                format!(
                    "     roulette: survives with probability {survival}; T = {}\n",
                    color(*throughput)
                )
            } else {
                format!("     roulette: terminated, survival probability {survival}\n")
            }
        }
        PathEvent::End(termination) => format!("     the path ends: {}\n", reason(*termination)),
    }
}

/// Describes the result of a light sample; `tau` is the symbol of the medium's transmittance.
fn shadow_text(tau: &str, shadow_result: Option<(Rgb, Contribution)>) -> String {
    match shadow_result {
        None => "     grazing: no shadow ray leaves the surface\n".to_owned(),
        Some((Rgb::ZERO, _)) => "     occluded\n".to_owned(),
        Some((Rgb::ONE, contribution)) => {
            contribution_text(&format!("T f_r |cos| L_e{tau} w / p"), contribution)
        }
        Some((visibility, contribution)) => {
            let visibility_text = color(visibility);
            format!("     partly occluded: V = {visibility_text}\n")
                + &contribution_text(&format!("T f_r |cos| L_e{tau} V w / p"), contribution)
        }
    }
}

/// Describes a transmittance below 1.
fn transmittance_text(transmittance: Rgb) -> String {
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
    let light = source_name(scene, sample.source);
    let distance = match sample.distance.is_finite() {
        true => format!(" at distance {}", number(sample.distance)),
        false => String::new(),
    };
    format!(
        "     samples {light}{distance}{}: w_i = {}, L_e = {}\n     \
         f_r = {}, |cos| = {}, p = {}, {} by BSDF sampling: w = {}\n",
        transmittance_text(transmittance),
        vector(sample.direction),
        color(sample.radiance),
        color(f),
        number(cos),
        number(sample.pdf),
        number(pdf_bsdf),
        number(weight)
    )
}

/// Describes the pdf of what else could have found a light.
fn rival_text(rival: Rival) -> String {
    match rival {
        Rival::LightSample(pdf) => format!("{} by light sampling", number(pdf)),
        Rival::Connection(pdf) => format!("{} by connections", number(pdf)),
    }
}

fn connection_text(scene: &Scene, event: &PathEvent) -> String {
    let PathEvent::Connection {
        caster,
        kind,
        source,
        connection,
        radiance,
        transmittance,
        f,
        cos,
        pmf,
        pdf,
        pdf_chance,
        weight,
        ..
    } = event
    else {
        return String::new();
    };
    let points: Vec<String> =
        connection.points().iter().map(|&point| vector(to_scene(scene, point))).collect();
    format!(
        "     connects {} {} to {}, at {}\n     \
         w_i = {}, |dA / dw| = {}, L_e = {}, tau = {}\n     \
         P(pair) = {}, p(y) / cos_y = {}, p = {}, {} by BSDF sampling\n     \
         f_r = {}, |cos| = {}, w = {}\n",
        way_over_ball(*kind),
        name(scene, *caster),
        source_name(scene, *source),
        points.join(", then "),
        vector(connection.direction_at_x),
        number(connection.spread),
        color(*radiance),
        color(*transmittance),
        number(*pmf),
        number(pdf / (pmf * connection.spread)),
        number(*pdf),
        number(*pdf_chance),
        color(*f),
        number(*cos),
        number(*weight)
    )
}

fn bsdf_sample_text(lobe: Lobe, wi: DVec3, pdf: f64, weight: Rgb, eta: f64) -> String {
    let (kind, density) = match lobe {
        Lobe::Diffuse => ("diffuse", "p ="),
        Lobe::Glossy => ("glossy", "p ="),
        Lobe::Delta => ("delta", "probability"),
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

fn contribution_text(formula: &str, contribution: Contribution) -> String {
    let layer = if contribution.is_direct { "direct" } else { "indirect" };
    let clamp_note = match contribution.clamp {
        1.0 => String::new(),
        clamp => format!("; scaled by {} by clamp_indirect", number(f64::from(clamp))),
    };
    format!("   + {formula} = {} ({layer}{clamp_note})\n", color(contribution.radiance))
}

/// Explains why a path ends.
pub(super) fn reason(termination: Termination) -> &'static str {
    match termination {
        Termination::Escaped => "the ray escapes",
        Termination::MaxDepth => "max_depth is reached",
        Termination::LengthLimit => "the hard limit on the path length is reached",
        Termination::ShadowCatcher => "the camera sees only the shadow on this surface",
        Termination::Trapped => "total reflection keeps it in a sphere where it finds no light",
        Termination::Absorbed => "the surface scatters no light in the sampled direction",
        Termination::Grazing => "the sampled direction grazes the surface",
        Termination::LowThroughput => {
            "its throughput is too small, or Russian roulette terminated it"
        }
        Termination::DirectOnly => "this integrator computes direct light only",
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
