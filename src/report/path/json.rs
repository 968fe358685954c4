//! A path as JSON, in the user's coordinates.

use serde_json::{Value, json};

use crate::integrator::{PathEvent, PathTrace};
use crate::scene::{PreparedScene, Scene};

use super::spheres::{place, source_name};
use super::words::why;

/// Returns the whole path as JSON.
pub fn json(prepared: &PreparedScene, trace: &PathTrace) -> Value {
    let scene = prepared.scene();
    let address = trace.address;
    let steps: Vec<Value> = trace.events.iter().map(|step| step_json(scene, step)).collect();
    let render = prepared.render_settings();
    json!({
        "pixel": [address.x, address.y],
        "sample": address.sample,
        "seed": render.seed,
        "integrator": render.integrator.kind().name(),
        "steps": steps,
        "direct": trace.radiance.direct,
        "indirect": trace.radiance.indirect,
        "radiance": (trace.radiance.direct + trace.radiance.indirect),
        "rays": trace.stats.rays,
    })
}

fn step_json(scene: &Scene, step: &PathEvent) -> Value {
    match step {
        PathEvent::CameraRay { ray, redraws } => json!({
            "step": "camera",
            "origin": place(scene, ray.origin),
            "direction": ray.direction,
            "redraws": redraws,
        }),
        PathEvent::Hit { depth, hit, wo, opacity: presence, transmittance, throughput } => json!({
            "step": "hit",
            "depth": depth,
            "sphere": scene.spheres().row(hit.id),
            "name": scene.name(hit.id),
            "point": place(scene, hit.point),
            "distance": hit.t,
            "normal": hit.normal,
            "side": format!("{:?}", hit.side).to_lowercase(),
            "wo": wo,
            "opacity": presence,
            "transmittance": transmittance,
            "throughput": throughput,
        }),
        PathEvent::Miss { depth, wo, throughput } => json!({
            "step": "miss",
            "depth": depth,
            "wo": wo,
            "throughput": throughput,
        }),
        PathEvent::Emission { source, radiance, pdf, pdf_light, weight, contribution: added } => {
            json!({
                "step": "light",
                "source": source_name(scene, *source),
                "L_e": radiance,
                "p": pdf,
                "p_light": pdf_light,
                "weight": weight,
                "clamp": added.clamp,
                "added": added.radiance,
                "is_direct": added.is_direct,
            })
        }
        PathEvent::HiddenBoundary => json!({ "step": "hidden" }),
        PathEvent::Transparent => json!({ "step": "absent" }),
        PathEvent::LightSample { sample, transmittance, f, cos, pdf_bsdf, weight } => json!({
            "step": "light_sample",
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
        PathEvent::ShadowRay { visibility: passed, contribution: added } => json!({
            "step": "shadow",
            "is_blocked": *passed == 0.0,
            "V": passed,
            "clamp": added.clamp,
            "added": added.radiance,
            "is_direct": added.is_direct,
        }),
        PathEvent::BsdfSample { lobe, wi, pdf, weight, eta, throughput } => json!({
            "step": "scatter",
            "lobe": format!("{lobe:?}").to_lowercase(),
            "wi": wi,
            "p": pdf,
            "f_cos_over_p": weight,
            "eta": eta,
            "throughput": throughput,
        }),
        PathEvent::Roulette { survival, survives, throughput } => json!({
            "step": "roulette",
            "survival": survival,
            "survives": survives,
            "throughput": throughput,
        }),
        PathEvent::End(end) => json!({ "step": "end", "why": why(*end) }),
    }
}
