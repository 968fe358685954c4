//! `photosphere bench`: rays per second of every intersector, on the rays of a scene.

use serde_json::{Value, json};

use crate::accel::{Accel, BuildOptions, Choice, Chosen};
use crate::error::Result;
use crate::geometry::PathRay;
use crate::math::Ray;
use crate::scene::{Opened, Scene, open_file};
use crate::verify::bench::{BackendBench, Rate, Rates, RayKind, Rounds, bench};
use crate::verify::rays;

use super::args::BenchArgs;
use super::exit::Exit;
use super::memory::Needs;
use super::{interrupt, memory, on_threads, print};

/// Kinds of rays.
const KINDS: usize = 4;
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
    let (threads, quality) = (rayon::current_num_threads(), args.build.quality);
    let build = BuildOptions { threads, quality, ..Default::default() };
    let kinds = rays_of(&scene, &*backends[0].build(spheres, &build)?);
    let rounds = Rounds { count: args.rounds.into(), batch: args.batch as usize };
    let results = bench(spheres, backends, &kinds, &build, rounds)?;
    let report = Report { scene: &scene, rounds, kinds: &kinds, results: &results };
    if args.json {
        print::json(&report.in_json())?;
    } else {
        print::result(&report.table())?;
    }
    Ok(Exit::Done)
}

/// What all the rays take at most, and the copies that each intersector is asked with.
fn bytes_of_rays(opened: &Opened, backends: usize) -> u64 {
    let image = opened.description().image;
    let rays = (image.width as usize * image.height as usize).min(MOST_RAYS);
    let each = KINDS * (size_of::<PathRay>() + size_of::<Ray>() * (1 + 2 * backends));
    (rays * each) as u64
}

/// Rays of the camera, what becomes of them at diffuse surfaces, and shadow rays.
fn rays_of(scene: &Scene, accel: &dyn Accel) -> Vec<RayKind> {
    let spheres = scene.spheres();
    let camera = camera_rays(scene);
    let first = rays::bounces(spheres, accel, &camera, SEED);
    let second = rays::bounces(spheres, accel, &first, SEED + 1);
    let shadow = rays::shadows(spheres, accel, &camera, SEED + 2);
    let kinds: [_; KINDS] = [
        ("camera", camera),
        ("first bounce", first),
        ("second bounce", second),
        ("shadow", shadow),
    ];
    let ask = |(name, rays): (_, Vec<PathRay>)| RayKind {
        name,
        rays: rays.iter().map(|ray| spheres.ask(ray)).collect(),
    };
    kinds.into_iter().map(ask).collect()
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

/// What was measured.
struct Report<'a> {
    scene: &'a Scene,
    rounds: Rounds,
    kinds: &'a [RayKind],
    results: &'a [BackendBench],
}

impl Report<'_> {
    fn choice(&self) -> Chosen {
        Choice::Auto.choose(self.scene.spheres())
    }

    fn table(&self) -> String {
        let spheres = print::count(self.scene.spheres().len(), "sphere");
        let threads = print::count(rayon::current_num_threads(), "thread");
        let Rounds { count, batch } = self.rounds;
        let Chosen { backend, reason } = self.choice();
        let mut text = format!(
            "{spheres}, {threads}, {}; --accel auto takes {} ({reason})\n\n\
             {:<12}{:>10}{:>18}\n",
            print::count(batch, "ray") + " a call",
            backend.name(),
            "",
            "build (s)",
            "bytes per sphere",
        );
        for result in self.results {
            text += &format!(
                "{:<12}{:>10.3}{:>18.1}   {}\n",
                result.backend.name(),
                result.build_s,
                result.bytes_per_sphere,
                result.details
            );
        }
        text += &format!(
            "\nrays per second of all threads: median of {}, and the spread of half of them\n",
            print::count(count, "round")
        );
        for (kind, RayKind { name, .. }) in self.kinds.iter().enumerate() {
            text += &format!(
                "\n{name:<14}{:>10}{:>8}{:>8}{:>12}{:>8}{:>8}{:>12}\n",
                "closest", "+-", "ratio", "occluded", "+-", "ratio", "other ids"
            );
            for result in self.results {
                text += &self.row(result, kind);
            }
        }
        text
    }

    /// One backend's rates for one kind of rays, and how they compare with the first backend's.
    fn row(&self, result: &BackendBench, kind: usize) -> String {
        let name = result.backend.name();
        let Some(rates) = result.rates[kind] else {
            return format!("{name:<14}{:>10}\n", "-");
        };
        let first = self.results[0].rates[kind].unwrap_or(rates);
        let figures = |rate: Rate, first: Rate| {
            let percent = format!("{:.0} %", 100.0 * rate.spread);
            (print::si(rate.median), percent, rate.median / first.median)
        };
        let closest = figures(rates.closest, first.closest);
        let occluded = figures(rates.occluded, first.occluded);
        format!(
            "{name:<14}{:>10}{:>8}{:>8.2}{:>12}{:>8}{:>8.2}{:>12}\n",
            closest.0, closest.1, closest.2, occluded.0, occluded.1, occluded.2, rates.other_ids
        )
    }

    fn in_json(&self) -> Value {
        let rate = |rate: Rate| json!({ "rays_per_s": rate.median, "spread": rate.spread });
        let rates = |result: &BackendBench, kind: usize| {
            result.rates[kind].map(|Rates { closest, occluded, other_ids }| {
                let (closest, occluded) = (rate(closest), rate(occluded));
                json!({ "closest": closest, "occluded": occluded, "other_ids": other_ids })
            })
        };
        let backend = |result: &BackendBench| {
            let kinds = self.kinds.iter().enumerate();
            let rates: serde_json::Map<String, Value> = kinds
                .map(|(kind, RayKind { name, .. })| {
                    (name.replace(' ', "_"), json!(rates(result, kind)))
                })
                .collect();
            json!({
                "accel": result.backend.name(),
                "details": result.details,
                "build_s": result.build_s,
                "bytes_per_sphere": result.bytes_per_sphere,
                "rays": rates,
            })
        };
        let Chosen { backend: auto, reason } = self.choice();
        json!({
            "spheres": self.scene.spheres().len(),
            "threads": rayon::current_num_threads(),
            "rounds": self.rounds.count,
            "batch": self.rounds.batch,
            "auto": { "accel": auto.name(), "reason": reason },
            "backends": self.results.iter().map(backend).collect::<Vec<_>>(),
        })
    }
}
