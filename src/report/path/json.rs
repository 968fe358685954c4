//! A path as JSON, in the user's coordinates.

use serde_json::{Value, json};

use crate::color::Rgb;
use crate::integrator::{PathEvent, PathTrace, Rival};
use crate::scene::{PreparedScene, Scene};

use super::spheres::{source_name, to_scene, way_over_ball};
use super::text::reason;

/// Returns the whole path as JSON.
pub fn json(prepared: &PreparedScene, trace: &PathTrace) -> Value {
    let scene = prepared.scene();
    let address = trace.address;
    let events: Vec<Value> = trace.events.iter().map(|event| event_json(scene, event)).collect();
    let render = prepared.render_settings();
    json!({
        "pixel": [address.x, address.y],
        "sample": address.sample,
        "seed": render.seed,
        "integrator": render.integrator.kind().name(),
        "events": events,
        "direct": trace.radiance.direct,
        "indirect": trace.radiance.indirect,
        "radiance": (trace.radiance.direct + trace.radiance.indirect),
        "rays": trace.stats.rays,
    })
}

fn event_json(scene: &Scene, event: &PathEvent) -> Value {
    match event {
        PathEvent::CameraRay { ray, redraws } => json!({
            "event": "camera_ray",
            "origin": to_scene(scene, ray.origin),
            "direction": ray.direction,
            "redraws": redraws,
        }),
        PathEvent::Hit { depth, hit, wo, opacity, transmittance, throughput } => json!({
            "event": "hit",
            "depth": depth,
            "sphere": scene.spheres().row(hit.id),
            "name": scene.name(hit.id),
            "point": to_scene(scene, hit.point),
            "distance": hit.t,
            "normal": hit.normal,
            "side": format!("{:?}", hit.side).to_lowercase(),
            "wo": wo,
            "opacity": opacity,
            "transmittance": transmittance,
            "throughput": throughput,
        }),
        PathEvent::Miss { depth, wo, throughput } => json!({
            "event": "miss",
            "depth": depth,
            "wo": wo,
            "throughput": throughput,
        }),
        PathEvent::Emission { source, radiance, pdf, rival, weight, contribution } => {
            let (pdf_light, pdf_connection) = match rival {
                Rival::LightSample(pdf) => (*pdf, 0.0),
                Rival::Connection(pdf) => (0.0, *pdf),
            };
            json!({
                "event": "emission",
                "source": source_name(scene, *source),
                "L_e": radiance,
                "p": pdf,
                "p_light": pdf_light,
                "p_connection": pdf_connection,
                "weight": weight,
                "clamp": contribution.clamp,
                "contribution": contribution.radiance,
                "is_direct": contribution.is_direct,
            })
        }
        PathEvent::HiddenBoundary => json!({ "event": "hidden_boundary" }),
        PathEvent::MatchedBoundary => json!({ "event": "matched_boundary" }),
        PathEvent::Transparent => json!({ "event": "transparent" }),
        PathEvent::LightSample { sample, transmittance, f, cos, pdf_bsdf, weight } => json!({
            "event": "light_sample",
            "source": source_name(scene, sample.source),
            "wi": sample.direction,
            "distance": sample.distance,
            "L_e": sample.radiance,
            "transmittance": transmittance,
            "p": sample.pdf,
            "f_r": f,
            "cos": cos,
            "p_bsdf": pdf_bsdf,
            "weight": weight,
        }),
        PathEvent::Connection {
            number,
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
        } => json!({
            "event": "connection",
            "number": number,
            "ball": scene.spheres().row(*caster),
            "ball_name": scene.name(*caster),
            "way": way_over_ball(*kind).trim_end_matches(','),
            "source": source_name(scene, *source),
            "points": connection.points().iter().map(|&p| to_scene(scene, p)).collect::<Vec<_>>(),
            "wi": connection.direction_at_x,
            "spread": connection.spread,
            "L_e": radiance,
            "transmittance": transmittance,
            "p_pair": pmf,
            "p": pdf,
            "f_r": f,
            "cos": cos,
            "p_bsdf": pdf_chance,
            "weight": weight,
        }),
        PathEvent::ShadowCatcher { behind, light } => json!({
            "event": "shadow_catcher",
            "L": behind,
            "source": light.map(|light| source_name(scene, light.sample.source)),
            "wi": light.map(|light| light.sample.direction),
            "distance": light.map(|light| light.sample.distance),
            "L_e": light.map(|light| light.sample.radiance),
            "probability": light.map(|light| light.probability),
            "candidates": light.map(|light| light.count),
        }),
        PathEvent::ShadowRay { connection, visibility, contribution } => json!({
            "event": "shadow_ray",
            "connection": connection,
            "is_occluded": *visibility == Rgb::ZERO,
            "V": visibility,
            "clamp": contribution.clamp,
            "contribution": contribution.radiance,
            "is_direct": contribution.is_direct,
        }),
        PathEvent::BsdfSample { lobe, wi, pdf, weight, eta, throughput } => json!({
            "event": "bsdf_sample",
            "lobe": format!("{lobe:?}").to_lowercase(),
            "wi": wi,
            "p": pdf,
            "f_cos_over_p": weight,
            "eta": eta,
            "throughput": throughput,
        }),
        PathEvent::Roulette { survival, survives, throughput } => json!({
            "event": "roulette",
            "survival": survival,
            "survives": survives,
            "throughput": throughput,
        }),
        PathEvent::End(end) => json!({ "event": "end", "reason": reason(*end) }),
    }
}
