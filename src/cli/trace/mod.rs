//! `photosphere trace`: one path told step by step, and drawn.

mod drawing;
mod words;

use serde_json::{Value, json};

use crate::accel::BuildOptions;
use crate::error::{Error, Result};
use crate::image_io::WholeFile;
use crate::integrator::{self, SampleAddress, Step, Trace, World};
use crate::light::Source;
use crate::math::DVec3;
use crate::scene::{Scene, Shot, read_file};
use crate::task::Cancel;

use super::args::TraceArgs;
use super::exit::Exit;
use super::{interrupt, on_threads, print};

/// # Errors
/// When the scene cannot be had, has no such pixel or sample, or its integrator follows no paths.
pub(super) fn run(args: &TraceArgs) -> Result<Exit> {
    let svg = |path| WholeFile::ending_in(path, "svg");
    let file = args.svg.as_deref().map(svg).transpose()?;
    interrupt::listen();
    on_threads(args.scene.threads(), || trace(args, file))
}

fn trace(args: &TraceArgs, file: Option<WholeFile>) -> Result<Exit> {
    let (scene, settings) = read_file(&args.scene.path, &args.overrides())?.build()?;
    let shot = Shot::new(&scene, settings)?;
    let address = address(args, &shot)?;
    let (threads, quality) = (rayon::current_num_threads(), args.accel.build.quality);
    let build = BuildOptions { threads, quality, ..Default::default() };
    let accel = args.accel.choice.choose(scene.spheres()).backend.build(scene.spheres(), &build)?;
    let cancel = Cancel::default();
    let world = World::new(&shot, &*accel, &cancel);
    let trace = integrator::of_shot(&shot).trace(world, address).ok_or_else(|| {
        let name = shot.render().integrator.kind().name();
        Error::input(format!("the integrator `{name}` follows no paths"))
            .with_help("add --integrator path")
    })?;
    if args.json {
        print::json(&in_json(&shot, &trace))?;
    } else {
        print::result(&words::tell(&shot, &trace))?;
    }
    if let (Some(file), Some(path)) = (file, &args.svg) {
        let svg = drawing::svg(&shot, &trace);
        file.write(|to| std::io::Write::write_all(to, svg.as_bytes()))?;
        print::remark(format_args!("wrote {}", path.display()));
    }
    Ok(Exit::Done)
}

/// The sample, if the picture has it.
fn address(args: &TraceArgs, shot: &Shot) -> Result<SampleAddress> {
    let (x, y) = args.pixel;
    let image = shot.image();
    if x >= image.width || y >= image.height {
        let (width, height) = (image.width, image.height);
        return Err(Error::input(format!(
            "there is no pixel {x},{y}: the picture has {width} x {height}"
        ))
        .with_help(format!("pixels run from 0,0 to {},{}", width - 1, height - 1)));
    }
    let count = shot.render().samples_per_pixel;
    if args.sample >= count {
        return Err(Error::input(format!("each pixel has {count} samples, counted from 0"))
            .with_help(format!("the last is --sample {}", count - 1)));
    }
    Ok(SampleAddress { x, y, sample: args.sample })
}

/// What the scene calls a sphere, or its row.
fn name(scene: &Scene, id: u32) -> String {
    match scene.name(id) {
        Some(name) => format!("`{name}`"),
        None => format!("sphere {}", scene.spheres().row(id)),
    }
}

fn source_name(scene: &Scene, source: Source) -> String {
    match source {
        Source::Lamp(id) => name(scene, id),
        Source::Background => "the background".to_owned(),
    }
}

/// A point in the coordinates that the user wrote.
fn place(scene: &Scene, point: DVec3) -> DVec3 {
    point + scene.spheres().origin()
}

/// The answer to the light sample that is step number `aim`: the share that passes, and the light.
/// `None` where no ray could be sent.
fn answer(steps: &[Step], aim: usize) -> Option<(f32, integrator::Added)> {
    let after = &steps[aim + 1..];
    let until_next = after.iter().take_while(|step| !matches!(step, Step::Aim { .. }));
    until_next.into_iter().find_map(|step| match step {
        Step::Shadow { passed, added } => Some((*passed, *added)),
        _ => None,
    })
}

fn in_json(shot: &Shot, trace: &Trace) -> Value {
    let scene = shot.scene();
    let address = trace.address;
    let steps: Vec<Value> = trace.steps.iter().map(|step| step_in_json(scene, step)).collect();
    let render = shot.render();
    json!({
        "pixel": [address.x, address.y],
        "sample": address.sample,
        "seed": render.seed,
        "integrator": render.integrator.kind().name(),
        "steps": steps,
        "direct": trace.radiance.direct.to_array(),
        "indirect": trace.radiance.indirect.to_array(),
        "radiance": (trace.radiance.direct + trace.radiance.indirect).to_array(),
        "rays": trace.tally.rays,
    })
}

fn step_in_json(scene: &Scene, step: &Step) -> Value {
    match step {
        Step::Camera { ray, redraws } => json!({
            "step": "camera",
            "origin": place(scene, ray.origin).to_array(),
            "direction": ray.direction.to_array(),
            "redraws": redraws,
        }),
        Step::Meet { depth, hit, wo, presence, transmittance, throughput } => json!({
            "step": "meet",
            "depth": depth,
            "sphere": scene.spheres().row(hit.id),
            "name": scene.name(hit.id),
            "point": place(scene, hit.point).to_array(),
            "distance": hit.t,
            "normal": hit.normal.to_array(),
            "side": format!("{:?}", hit.side).to_lowercase(),
            "wo": wo.to_array(),
            "opacity": presence,
            "transmittance": transmittance.to_array(),
            "throughput": throughput.to_array(),
        }),
        Step::Miss { depth, wo, throughput } => json!({
            "step": "miss",
            "depth": depth,
            "wo": wo.to_array(),
            "throughput": throughput.to_array(),
        }),
        Step::Light { source, radiance, pdf, pdf_light, weight, added } => json!({
            "step": "light",
            "source": source_name(scene, *source),
            "L_e": radiance.to_array(),
            "p": pdf,
            "p_light": pdf_light,
            "weight": weight,
            "clamp": added.clamp,
            "added": added.light.to_array(),
            "is_direct": added.is_direct,
        }),
        Step::Hidden => json!({ "step": "hidden" }),
        Step::Absent => json!({ "step": "absent" }),
        Step::Aim { sample, transmittance, f, cos, pdf_bsdf, weight } => json!({
            "step": "aim",
            "source": source_name(scene, sample.source),
            "wi": sample.direction.to_array(),
            "distance": sample.distance,
            "L_e": sample.radiance.to_array(),
            "transmittance": transmittance.to_array(),
            "p": sample.pdf,
            "f_r": f.to_array(),
            "cos": cos,
            "p_bsdf": pdf_bsdf,
            "weight": weight,
        }),
        Step::Shadow { passed, added } => json!({
            "step": "shadow",
            "is_blocked": *passed == 0.0,
            "V": passed,
            "clamp": added.clamp,
            "added": added.light.to_array(),
            "is_direct": added.is_direct,
        }),
        Step::Scatter { lobe, wi, pdf, weight, eta, throughput } => json!({
            "step": "scatter",
            "lobe": format!("{lobe:?}").to_lowercase(),
            "wi": wi.to_array(),
            "p": pdf,
            "f_cos_over_p": weight.to_array(),
            "eta": eta,
            "throughput": throughput.to_array(),
        }),
        Step::Roulette { survival, survives, throughput } => json!({
            "step": "roulette",
            "survival": survival,
            "survives": survives,
            "throughput": throughput.to_array(),
        }),
        Step::End(why) => json!({ "step": "end", "why": words::why(*why) }),
    }
}
