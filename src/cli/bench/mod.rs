//! `photosphere bench`: measures how fast every intersector traces, builds and renders.

mod plan;
mod suite;

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

use crate::accel::{KernelIsa, embree_info};
use crate::error::{Error, Result};
use crate::film::Aov;
use crate::geometry::PathRay;
use crate::image_io::AtomicFile;
use crate::job::{COMMIT, VERSION};
use crate::math::Ray;
use crate::report::speed::SpeedReport;
use crate::scene::{PreparedScene, SceneFile};
use crate::verify::bench::{RAY_SETS, Record, bench_renders, bench_stages, camera_rays};

use super::args::BenchArgs;
use super::exit::Exit;
use super::interrupt::{self, Interrupt};
use super::memory::{self, MemoryNeeds};
use super::particle_file::read_scene;
use super::print;
use super::system::{self, on_threads};
use plan::{bench_plan, circumstances};

/// Maximum number of camera rays. More would only take memory.
const MOST_RAYS: usize = 1 << 20;
/// Sphere count of the largest scenes of a record, unless `--largest` is given.
const LARGEST_OF_RECORD: u64 = 10_000_000;

/// Runs the command.
///
/// # Errors
/// If the scene cannot be loaded, an intersector cannot be built, or a file cannot be written.
pub(super) fn run(args: &BenchArgs) -> Result<Exit> {
    let interrupt = interrupt::listen();
    on_threads(args.scene.threads(), || match (&args.suite, &args.record, &args.path) {
        (Some(page), _, _) => suite::run(args, page, &interrupt),
        (None, Some(tables), _) => record(args, tables, &interrupt),
        (None, None, Some(scene)) => measure_file(args, scene, &interrupt),
        (None, None, None) => Err(Error::input("there is nothing to measure")
            .with_help("name a scene, or ask for --suite FILE.html or --record FILE.txt")),
    })
}

fn measure_file(args: &BenchArgs, path: &Path, interrupt: &Interrupt) -> Result<Exit> {
    let svg = |path| AtomicFile::with_extension(path, "svg");
    let drawing = args.svg.as_deref().map(svg).transpose()?;
    let scene_file = read_scene(path, &args.scene.overrides(), None)?;
    let backends = args.accels.backends();
    let besides = bytes_of_rays(&scene_file, backends.len());
    let kinds: &[Aov] = if args.render { &Aov::DEFAULT } else { &[] };
    memory::check(&scene_file, &MemoryNeeds { backends, kinds, besides }, args.memory.limit)?;
    let (scene, settings) = scene_file.build()?;
    let prepared = PreparedScene::new(&scene, settings)?;
    let plan = bench_plan(args, interrupt);
    let backend_set = plan.backend_set(scene.spheres(), backends)?;
    let image = settings.image;
    let camera = camera_rays(prepared.camera(), [image.width, image.height], MOST_RAYS);
    let mut measured = plan.measure(&backend_set, camera)?;
    if args.render {
        measured.renders =
            bench_renders(&prepared, &backend_set, args.rounds.into(), &plan.cancel)?;
        if args.stages {
            measured.stages = bench_stages(&prepared, &backend_set, &plan.cancel);
        }
    }
    let (spheres, rounds) = (scene.spheres().len(), plan.rounds());
    if let Some(file) = drawing {
        let title = format!("{}: speed of the intersectors", path.display());
        let subtitle = format!("{}, {}", print::count(spheres, "sphere"), circumstances(rounds));
        let svg = measured.to_svg(&title, &subtitle)?;
        file.write(|to| to.write_all(svg.as_bytes()))?;
    }
    let report = SpeedReport { spheres, rounds, measured: &measured };
    if args.json {
        print::json(&report.json())?
    } else {
        print::result(&report.to_string())?
    }
    Ok(Exit::Done)
}

/// Measures native against Embree, and prints each table as soon as it is complete.
fn record(args: &BenchArgs, path: &Path, interrupt: &Interrupt) -> Result<Exit> {
    let file = AtomicFile::new(path)?;
    let embree = embree_info().ok_or_else(|| {
        Error::backend("this build has no Embree to compare with")
            .with_help("`photosphere doctor` says how to get it")
    })??;
    let machine = system::processor().unwrap_or_else(|| "unknown".to_owned());
    let rounds = usize::from(args.rounds);
    let mut text = String::new();
    let _ = writeln!(text, "photosphere {VERSION}, commit {COMMIT}; {machine}, {}", system::load());
    let _ = writeln!(
        text,
        "Embree {}, {}, tasks by {}; native with {}",
        embree.runtime_version,
        embree.instruction_set,
        embree.tasking,
        KernelIsa::best().name()
    );
    let _ = writeln!(text, "command: {}", system::command_line());
    let _ =
        writeln!(text, "medians of {rounds} interleaved rounds, +- half the interquartile range;");
    let _ = writeln!(text, "ratio: rate relative to Embree, with our target in brackets");
    print::note(text.trim_end());
    let largest = args.largest.unwrap_or(LARGEST_OF_RECORD);
    Record { max_spheres: largest, rounds, cancel: interrupt.cancel() }.measure(&mut |table| {
        print::note(format_args!("\n{}", table.trim_end()));
        text += "\n";
        text += table;
    })?;
    file.write(|to| to.write_all(text.as_bytes()))?;
    print::note(format_args!("wrote {}", path.display()));
    Ok(Exit::Done)
}

/// Returns the maximum memory in bytes of all rays and of the copies that the intersectors receive.
fn bytes_of_rays(file: &SceneFile, backends: usize) -> u64 {
    let image = file.settings.image;
    let rays = 16 * u64::from(image.width) * u64::from(image.height);
    let each = RAY_SETS * (size_of::<PathRay>() + size_of::<Ray>() * (1 + 2 * backends));
    rays.min(MOST_RAYS as u64) * each as u64
}
