//! `photosphere bench`: rays per second of every intersector, on the rays of a scene.

use serde_json::{Value, json};

use crate::accel::BuildOptions;
use crate::error::Result;
use crate::geometry::PathRay;
use crate::math::Ray;
use crate::scene::{Opened, Scene, open_file};
use crate::verify::bench::{BackendBench, BenchRays, Rates, bench};
use crate::verify::rays;

use super::args::BenchArgs;
use super::exit::Exit;
use super::memory::Needs;
use super::{interrupt, memory, on_threads, print};

/// Rounds of measurement; each figure is their median.
const ROUNDS: usize = 5;
/// Chooses the directions of the bounces.
const SEED: u64 = 0;
/// More camera rays than this only take memory.
const MOST_RAYS: usize = 1 << 20;

/// # Errors
/// When the scene cannot be had or an intersector not be built.
pub(super) fn run(args: &BenchArgs) -> Result<Exit> {
    interrupt::listen();
    on_threads(args.scene.threads(), || measure(args))
}

fn measure(args: &BenchArgs) -> Result<Exit> {
    let opened = open_file(&args.scene.path, &args.scene.overrides())?;
    let backends = args.accels.backends();
    let besides = bytes_of_rays(&opened, backends.len());
    memory::check(&opened, &Needs { backends, kinds: &[], besides }, args.memory.limit)?;
    let scene = Scene::new(opened.read()?)?;
    let spheres = scene.spheres();
    let build = BuildOptions { threads: rayon::current_num_threads(), ..Default::default() };

    let camera = camera_rays(&scene);
    let bounced = {
        let accel = backends[0].build(spheres, &build)?;
        rays::bounces(spheres, accel.as_ref(), &camera, SEED)
    };
    let ask = |rays: &[PathRay]| -> Vec<Ray> { rays.iter().map(|ray| spheres.ask(ray)).collect() };
    let (camera, bounced) = (ask(&camera), ask(&bounced));
    let rays = BenchRays { camera: &camera, bounced: &bounced };
    let results = bench(spheres, backends, rays, &build, ROUNDS)?;
    if args.json {
        print::json(&in_json(&results, &scene))?;
    } else {
        print::result(&table(&results, &scene))?;
    }
    Ok(Exit::Done)
}

/// What all the rays take at most, and the copies that each intersector is asked with.
fn bytes_of_rays(opened: &Opened, backends: usize) -> u64 {
    let image = opened.description().image;
    let rays = (image.width as usize * image.height as usize).min(MOST_RAYS);
    let each = 2 * (size_of::<PathRay>() + size_of::<Ray>()) + 4 * backends * size_of::<Ray>();
    (rays * each) as u64
}

/// Which two numbers give the middle of a lens, or nearly so where it has blades.
const MIDDLE_OF_THE_LENS: [f64; 2] = [0.5; 2];

/// One ray through the middle of every pixel, row by row.
fn camera_rays(scene: &Scene) -> Vec<PathRay> {
    let image = scene.description().image;
    let width = image.width as usize;
    let count = (width * image.height as usize).min(MOST_RAYS);
    let ray = |pixel: usize| {
        let (x, y) = ((pixel % width) as f64 + 0.5, (pixel / width) as f64 + 0.5);
        scene.camera().ray(x, y, MIDDLE_OF_THE_LENS)
    };
    (0..count).map(ray).collect()
}

fn table(results: &[BackendBench], scene: &Scene) -> String {
    let spheres = print::count(scene.spheres().len(), "sphere");
    let threads = print::count(rayon::current_num_threads(), "thread");
    let mut text = format!(
        "{spheres}, {threads}; rays per second of all threads, median of {ROUNDS}\n\
         {:<12}{:>10}{:>14}{:>13}{:>13}{:>13}{:>13}\n{:<12}{:>10}{:>14}{:>13}{:>13}{:>13}{:>13}\n",
        "",
        "",
        "bytes per",
        "camera",
        "camera",
        "bounced",
        "bounced",
        "",
        "build (s)",
        "sphere",
        "closest",
        "occluded",
        "closest",
        "occluded",
    );
    for result in results {
        let rate = |rates: Option<Rates>, which: fn(Rates) -> f64| {
            rates.map_or_else(|| "-".to_owned(), |rates| print::si(which(rates)))
        };
        text += &format!(
            "{:<12}{:>10.3}{:>14.1}{:>13}{:>13}{:>13}{:>13}\n",
            result.backend.name(),
            result.build_s,
            result.bytes_per_sphere,
            rate(result.camera, |rates| rates.closest),
            rate(result.camera, |rates| rates.occluded),
            rate(result.bounced, |rates| rates.closest),
            rate(result.bounced, |rates| rates.occluded),
        );
    }
    text
}

fn in_json(results: &[BackendBench], scene: &Scene) -> Value {
    let rates = |rates: Option<Rates>| {
        rates.map(|Rates { closest, occluded }| {
            json!({ "closest_rays_per_s": closest, "occluded_rays_per_s": occluded })
        })
    };
    let backend = |result: &BackendBench| {
        json!({
            "accel": result.backend.name(),
            "build_s": result.build_s,
            "bytes_per_sphere": result.bytes_per_sphere,
            "camera": rates(result.camera),
            "bounced": rates(result.bounced),
        })
    };
    json!({
        "spheres": scene.spheres().len(),
        "threads": rayon::current_num_threads(),
        "backends": results.iter().map(backend).collect::<Vec<_>>(),
    })
}
