//! A path as JSON, in the user's coordinates.

use serde_json::{Value, json};

use crate::integrator::{Step, Trace};
use crate::scene::{Scene, Shot};

use super::spheres::{place, source_name};
use super::words::why;

/// The whole path, for programs.
pub fn json(shot: &Shot, trace: &Trace) -> Value {
    let scene = shot.scene();
    let address = trace.address;
    let steps: Vec<Value> = trace.steps.iter().map(|step| step_json(scene, step)).collect();
    let render = shot.render();
    json!({
        "pixel": [address.x, address.y],
        "sample": address.sample,
        "seed": render.seed,
        "integrator": render.integrator.kind().name(),
        "steps": steps,
        "direct": trace.radiance.direct,
        "indirect": trace.radiance.indirect,
        "radiance": (trace.radiance.direct + trace.radiance.indirect),
        "rays": trace.tally.rays,
    })
}

fn step_json(scene: &Scene, step: &Step) -> Value {
    match step {
        Step::Camera { ray, redraws } => json!({
            "step": "camera",
            "origin": place(scene, ray.origin),
            "direction": ray.direction,
            "redraws": redraws,
        }),
        Step::Meet { depth, hit, wo, presence, transmittance, throughput } => json!({
            "step": "meet",
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
        Step::Miss { depth, wo, throughput } => json!({
            "step": "miss",
            "depth": depth,
            "wo": wo,
            "throughput": throughput,
        }),
        Step::Light { source, radiance, pdf, pdf_light, weight, added } => json!({
            "step": "light",
            "source": source_name(scene, *source),
            "L_e": radiance,
            "p": pdf,
            "p_light": pdf_light,
            "weight": weight,
            "clamp": added.clamp,
            "added": added.light,
            "is_direct": added.is_direct,
        }),
        Step::Hidden => json!({ "step": "hidden" }),
        Step::Absent => json!({ "step": "absent" }),
        Step::Aim { sample, transmittance, f, cos, pdf_bsdf, weight } => json!({
            "step": "aim",
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
        Step::Shadow { passed, added } => json!({
            "step": "shadow",
            "is_blocked": *passed == 0.0,
            "V": passed,
            "clamp": added.clamp,
            "added": added.light,
            "is_direct": added.is_direct,
        }),
        Step::Scatter { lobe, wi, pdf, weight, eta, throughput } => json!({
            "step": "scatter",
            "lobe": format!("{lobe:?}").to_lowercase(),
            "wi": wi,
            "p": pdf,
            "f_cos_over_p": weight,
            "eta": eta,
            "throughput": throughput,
        }),
        Step::Roulette { survival, survives, throughput } => json!({
            "step": "roulette",
            "survival": survival,
            "survives": survives,
            "throughput": throughput,
        }),
        Step::End(end) => json!({ "step": "end", "why": why(*end) }),
    }
}
