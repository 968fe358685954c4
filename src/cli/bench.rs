//! `photosphere bench`: rays per second of every intersector, on the rays of a scene.

use std::io::Write;
use std::path::Path;

use serde_json::{Value, json};

use crate::accel::{BuildOptions, Choice, Chosen};
use crate::error::{Error, Result};
use crate::geometry::PathRay;
use crate::math::Ray;
use crate::output::WholeFile;
use crate::scene::{Opened, Scene, open_file};
use crate::verify::bench::{
    BackendBench, KINDS, Rate, Rates, RayKind, Rounds, bench, kinds_of_rays,
};
use crate::verify::bench_page::drawing as drawing_of;

use super::args::BenchArgs;
use super::exit::Exit;
use super::memory::Needs;
use super::{interrupt, memory, on_threads, print, suite, system};

/// More camera rays than this only take memory.
const MOST_RAYS: usize = 1 << 20;

/// # Errors
/// When the scene cannot be had or an intersector not be built.
pub(super) fn run(args: &BenchArgs) -> Result<Exit> {
    interrupt::listen();
    on_threads(args.scene.threads(), || match (&args.suite, &args.path) {
        (Some(page), _) => suite::run(args, page),
        (None, Some(scene)) => measure(args, scene),
        (None, None) => Err(Error::input("there is nothing to measure")
            .with_help("name a scene, or ask for --suite FILE.html")),
    })
}

fn measure(args: &BenchArgs, path: &Path) -> Result<Exit> {
    let drawing = args.svg.as_deref().map(WholeFile::new).transpose()?;
    let opened = open_file(path, &args.scene.overrides())?;
    let backends = args.accels.backends();
    let besides = bytes_of_rays(&opened, backends.len());
    memory::check(&opened, &Needs { backends, kinds: &[], besides }, args.memory.limit)?;
    let scene = Scene::new(opened.read()?)?;
    let spheres = scene.spheres();
    let (threads, quality) = (rayon::current_num_threads(), args.build.quality);
    let build = BuildOptions { threads, quality, ..Default::default() };
    let camera = camera_rays(&scene);
    let kinds = kinds_of_rays(spheres, &*backends[0].build(spheres, &build)?, camera);
    let rounds = Rounds { count: args.rounds.into(), batch: args.batch as usize };
    let results = bench(spheres, backends, &kinds, &build, rounds)?;
    if let Some(file) = drawing {
        let title = format!("{}: rays per second", path.display());
        let spheres = print::count(spheres.len(), "sphere");
        let subtitle = format!("{spheres}, {}", circumstances(rounds));
        let svg = drawing_of(&title, &subtitle, &kinds, &results)?;
        file.write(|to| to.write_all(svg.as_bytes()))?;
    }
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

/// On what, and how, was measured.
pub(super) fn circumstances(rounds: Rounds) -> String {
    let threads = print::count(rayon::current_num_threads(), "thread");
    let processor = system::processor().map_or(String::new(), |name| format!(" of {name}"));
    let rays = print::count(rounds.batch, "ray");
    format!(
        "{threads}{processor}, {rays} a call, median of {}",
        print::count(rounds.count, "round")
    )
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
