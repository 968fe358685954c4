//! A path as text, with the symbols of the rendering equation.

use crate::color::Rgb;
use crate::draw::text::count;
use crate::geometry::Side;
use crate::integrator::{PathEvent, PathTrace, Termination};
use crate::material::Lobe;
use crate::math::DVec3;
use crate::scene::settings::Estimator;
use crate::scene::{PreparedScene, Scene};

use super::fold::fold;
use super::lights::{
    connection_text, emission_text, estimator, light_sample_text, shadow_catcher_text, shadow_text,
    transmittance_text,
};
use super::numbers::{color, number, vector};
use super::spheres::{name, shadow_result, to_scene};

/// Describes the whole path.
pub fn text(prepared: &PreparedScene, trace: &PathTrace) -> String {
    let scene = prepared.scene();
    let address = trace.address;
    let render = prepared.render_settings();
    let estimator = estimator(render);
    let mut text = format!(
        "pixel {}, {}, sample {} of {}, seed {}, integrator {}, estimator {}, sampler {}, caustics {}\n\n",
        address.x,
        address.y,
        address.sample,
        render.samples_per_pixel,
        render.seed,
        render.integrator.kind().name(),
        estimator.name(),
        render.sampler.name(),
        render.caustics.name()
    );
    let mut vertex = 0;
    for (index, event) in trace.events.iter().enumerate() {
        if let PathEvent::Hit { .. } = event {
            vertex += 1;
        }
        text += &event_text(scene, estimator, trace, index, vertex);
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

fn event_text(
    scene: &Scene,
    estimator: Estimator,
    trace: &PathTrace,
    index: usize,
    vertex: usize,
) -> String {
    let event = &trace.events[index];
    match event {
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
        PathEvent::Emission { .. } => emission_text(scene, estimator, event),
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
        PathEvent::LightSample { transmittance, .. } => {
            let tau = if *transmittance == Rgb::ONE { "" } else { " tau" };
            light_sample_text(scene, estimator, event)
                + &shadow_text(tau, shadow_result(&trace.events, index, 0))
        }
        PathEvent::Connection { number, .. } => {
            let result = shadow_result(&trace.events, index, *number);
            connection_text(scene, estimator, event) + &shadow_text(" t_ball", result)
        }
        PathEvent::ShadowCatcher { behind, light } => {
            let result = shadow_result(&trace.events, index, 0);
            shadow_catcher_text(scene, (*behind, *light), result)
        }
        // Covered by the light sample, connection or shadow catcher.
        PathEvent::ShadowRay { .. } => String::new(),
        PathEvent::BsdfSample { lobe, wi, pdf, weight, eta, throughput } => {
            bsdf_sample_text(*lobe, *wi, *pdf, *weight, *eta)
                + &format!(", T = {}\n", color(*throughput))
        }
        PathEvent::Roulette { survival, survives, throughput } => {
            let survival = number(f64::from(*survival));
            match survives {
                true => format!(
                    "     roulette: survives with probability {survival}; T = {}\n",
                    color(*throughput)
                ),
                false => format!(
                    "     the path ends: {}, which it would have survived with probability {survival}\n",
                    reason(Termination::Roulette)
                ),
            }
        }
        // Covered by the roulette.
        PathEvent::End(Termination::Roulette) => String::new(),
        PathEvent::End(termination) => format!("     the path ends: {}\n", reason(*termination)),
    }
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
        Termination::Roulette => "Russian roulette terminates it",
        Termination::LowThroughput => "its throughput is zero or below the threshold",
        Termination::DirectOnly => "this integrator computes direct light only",
    }
}
