//! The light of a path as text: what is found, what is sampled, and what arrives.

use crate::color::Rgb;
use crate::integrator::{ChosenLight, Contribution, PathEvent, Rival};
use crate::light::LightSample;
use crate::scene::Scene;
use crate::scene::settings::{Estimator, IntegratorSettings, RenderSettings};

use super::numbers::{color, number, vector};
use super::spheres::{name, source_name, to_scene, way_over_ball};

/// The estimator that an integrator uses, whatever the settings ask for.
pub(super) fn estimator(render: &RenderSettings) -> Estimator {
    match render.integrator {
        IntegratorSettings::Paper(_) => Estimator::Bsdf,
        _ => render.estimator,
    }
}

/// Describes emission that a path finds.
pub(super) fn emission_text(scene: &Scene, estimator: Estimator, event: &PathEvent) -> String {
    let PathEvent::Emission { source, radiance, pdf, rival, weight, contribution } = event else {
        return String::new();
    };
    let w = number(f64::from(*weight));
    let (rival_pdf, technique) = match rival {
        Rival::LightSample(pdf) => (*pdf, "light sampling"),
        Rival::Connection(pdf) => (*pdf, "connections"),
    };
    let mis_text = match (pdf, estimator) {
        (_, Estimator::Bsdf) => format!("nothing else looks for it: w = {w}"),
        (None, _) => format!("not reachable by light sampling: w = {w}"),
        (Some(_), Estimator::Light) if *weight == 0.0 => format!("left to {technique}: w = 0"),
        (Some(_), Estimator::Light) => format!("{technique} cannot find it: w = {w}"),
        // Power heuristics are above 0.
        (Some(_), Estimator::Mis) if *weight == 0.0 => {
            format!("left to {technique}, which has no noise here: w = 0")
        }
        (Some(pdf), Estimator::Mis) => {
            let [pdf, rival] = [*pdf, rival_pdf].map(number);
            format!("p = {pdf} by BSDF sampling, {rival} by {technique}: w = {w}")
        }
    };
    let (emitter, light) = (source_name(scene, *source), color(*radiance));
    format!("     {emitter} emits: L_e = {light}; {mis_text}\n")
        + &contribution_text("T L_e w", *contribution)
}

/// Describes the result of a light sample or connection; `factors` are those of its formula that
/// may be 1.
pub(super) fn shadow_text(factors: &str, shadow_result: Option<(Rgb, Contribution)>) -> String {
    arrival_text(&|v| format!("T f_r |cos| L_e{factors}{v} w / p"), shadow_result)
}

/// Describes what the camera sees of a shadow catcher.
pub(super) fn shadow_catcher_text(
    scene: &Scene,
    (behind, light): (Rgb, Option<ChosenLight>),
    shadow_result: Option<(Rgb, Contribution)>,
) -> String {
    let looks = match light {
        None => "     no light can arrive, so that none is missing\n".to_owned(),
        Some(ChosenLight { sample, probability, count }) => format!(
            "     asks for {}{}: w_i = {}, chosen of {count} with probability {}\n",
            source_name(scene, sample.source),
            distance_text(sample.distance),
            vector(sample.direction),
            number(probability)
        ),
    };
    format!("     catches shadows: behind it the camera sees L = {}\n{looks}", color(behind))
        + &arrival_text(&|v| format!("T L{v}"), shadow_result)
}

/// Describes the light of a shadow ray; `formula` takes the symbol of the visibility, if that is
/// not 1.
fn arrival_text(
    formula: &dyn Fn(&str) -> String,
    shadow_result: Option<(Rgb, Contribution)>,
) -> String {
    match shadow_result {
        None => "     grazing: no shadow ray leaves the surface\n".to_owned(),
        Some((Rgb::ZERO, _)) => "     occluded\n".to_owned(),
        Some((Rgb::ONE, contribution)) => contribution_text(&formula(""), contribution),
        Some((visibility, contribution)) => {
            format!("     partly occluded: V = {}\n", color(visibility))
                + &contribution_text(&formula(" V"), contribution)
        }
    }
}

/// Describes a transmittance below 1.
pub(super) fn transmittance_text(transmittance: Rgb) -> String {
    match transmittance {
        Rgb::ONE => String::new(),
        tau => format!(" through a medium, tau = {}", color(tau)),
    }
}

fn distance_text(distance: f64) -> String {
    match distance.is_finite() {
        true => format!(" at distance {}", number(distance)),
        false => String::new(),
    }
}

/// Describes a light sample.
pub(super) fn light_sample_text(scene: &Scene, estimator: Estimator, event: &PathEvent) -> String {
    let PathEvent::LightSample { sample, transmittance, f, cos, pdf_bsdf, weight } = event else {
        return String::new();
    };
    let LightSample { source, direction, distance, radiance, pdf, is_exact } = *sample;
    let w = number(*weight);
    let mis_text = match estimator {
        Estimator::Mis if is_exact => {
            format!("by light sampling, which has no noise here: w = {w}")
        }
        Estimator::Mis => format!("{} by BSDF sampling: w = {w}", number(*pdf_bsdf)),
        Estimator::Light | Estimator::Bsdf => format!("by light sampling alone: w = {w}"),
    };
    format!(
        "     samples {}{}{}: w_i = {}, L_e = {}\n     \
         f_r = {}, |cos| = {}, p = {}, {mis_text}\n",
        source_name(scene, source),
        distance_text(distance),
        transmittance_text(*transmittance),
        vector(direction),
        color(radiance),
        color(*f),
        number(*cos),
        number(pdf),
    )
}

/// Describes a connection over a polished ball.
pub(super) fn connection_text(scene: &Scene, estimator: Estimator, event: &PathEvent) -> String {
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
    let mis_text = match estimator {
        Estimator::Mis => {
            format!("{} by BSDF sampling: w = {}", number(*pdf_chance), number(*weight))
        }
        Estimator::Light | Estimator::Bsdf => {
            format!("by connections alone: w = {}", number(*weight))
        }
    };
    format!(
        "     connects {} {} to {}, at {}\n     \
         w_i = {}, |dA / dw| = {}, L_e = {}, t_ball = {}\n     \
         f_r = {}, |cos| = {}, P(pair) = {}, p(y) / cos_y = {}\n     \
         p = {}, {mis_text}\n",
        way_over_ball(*kind),
        name(scene, *caster),
        source_name(scene, *source),
        points.join(", then "),
        vector(connection.direction_at_x),
        number(connection.spread),
        color(*radiance),
        color(*transmittance),
        color(*f),
        number(*cos),
        number(*pmf),
        number(pdf / (pmf * connection.spread)),
        number(*pdf),
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
