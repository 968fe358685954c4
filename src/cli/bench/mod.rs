//! `photosphere bench`: how fast every intersector answers, builds and renders.

mod report;
mod suite;

use std::io::Write;
use std::path::Path;
use std::sync::Arc;

use crate::accel::{Backend, BuildOptions};
use crate::error::{Error, Result};
use crate::film::Kind;
use crate::geometry::{PathRay, SphereSet};
use crate::image_io::WholeFile;
use crate::math::Ray;
use crate::scene::{SceneFile, Shot, read_file};
use crate::task::Cancel;
use crate::verify::bench::page::Measured;
use crate::verify::bench::{
    Field, KINDS, Rounds, SECOND_BOUNCE, Setting, bench, camera_rays, renders, sweep,
};

use super::args::BenchArgs;
use super::exit::Exit;
use super::memory::Needs;
use super::{interrupt, memory, on_threads, print, system};
use report::Report;

/// More camera rays than this only take memory.
const MOST_RAYS: usize = 1 << 20;

/// # Errors
/// When the scene cannot be had, an intersector not be built, or a file not be written.
pub(super) fn run(args: &BenchArgs) -> Result<Exit> {
    let interrupt = interrupt::listen();
    on_threads(args.scene.threads(), || match (&args.suite, &args.path) {
        (Some(page), _) => suite::run(args, page, &interrupt),
        (None, Some(scene)) => measure_file(args, scene),
        (None, None) => Err(Error::input("there is nothing to measure")
            .with_help("name a scene, or ask for --suite FILE.html")),
    })
}

fn measure_file(args: &BenchArgs, path: &Path) -> Result<Exit> {
    let svg = |path| WholeFile::ending_in(path, "svg");
    let drawing = args.svg.as_deref().map(svg).transpose()?;
    let scene_file = read_file(path, &args.scene.overrides())?;
    let backends = args.accels.backends();
    let besides = bytes_of_rays(&scene_file, backends.len());
    let kinds: &[Kind] = if args.render { &Kind::USUAL } else { &[] };
    memory::check(&scene_file, &Needs { backends, kinds, besides }, args.memory.limit)?;
    let (scene, settings) = scene_file.build()?;
    let shot = Shot::new(&scene, settings)?;
    let cancel = Cancel::default();
    let field = build(args, scene.spheres(), backends, &cancel)?;
    let image = settings.image;
    let camera = camera_rays(shot.camera(), [image.width, image.height], MOST_RAYS);
    let mut measured = measure(args, &field, camera, &cancel)?;
    if args.render {
        measured.renders = renders(&shot, &field, args.rounds.into(), &cancel)?;
    }
    let spheres = scene.spheres().len();
    if let Some(file) = drawing {
        let title = format!("{}: speed of the intersectors", path.display());
        let subtitle =
            format!("{}, {}", print::count(spheres, "sphere"), circumstances(rounds(args)));
        let svg = measured.drawing(&title, &subtitle)?;
        file.write(|to| to.write_all(svg.as_bytes()))?;
    }
    let report = Report { spheres, rounds: rounds(args), measured: &measured };
    if args.json {
        print::json(&report.in_json())?;
    } else {
        print::result(&report.in_words())?;
    }
    Ok(Exit::Done)
}

fn rounds(args: &BenchArgs) -> Rounds {
    let batch = args.batches.first().map_or(1, |&batch| batch as usize);
    Rounds { count: args.rounds.into(), batch }
}

fn build(
    args: &BenchArgs,
    spheres: &Arc<SphereSet>,
    backends: &[Backend],
    cancel: &Cancel,
) -> Result<Field> {
    let (threads, quality) = (rayon::current_num_threads(), args.build.quality);
    let options = BuildOptions { threads, quality, cancel: cancel.clone(), ..Default::default() };
    Field::build(spheres, backends, &options, args.builds.into())
}

/// Everything but whole renders.
fn measure(
    args: &BenchArgs,
    field: &Field,
    camera: Vec<PathRay>,
    cancel: &Cancel,
) -> Result<Measured> {
    let kinds = field.kinds_of_rays(camera);
    let rounds = rounds(args);
    let results = bench(field, &kinds, rounds, cancel)?;
    let bounced = kinds.iter().find(|kind| kind.name == SECOND_BOUNCE);
    let bounced = bounced.map_or(&[][..], |kind| &kind.rays);
    let threads = rayon::current_num_threads();
    let swept = |settings: &[Setting]| match settings {
        [] | [_] => Ok(Vec::new()),
        settings => sweep(field, bounced, settings, rounds.count, cancel),
    };
    let of_batch = |&batch: &u32| Setting { threads, batch: batch as usize };
    let batches = swept(&args.batches.iter().map(of_batch).collect::<Vec<_>>())?;
    let of_threads = |threads| Setting { threads, batch: rounds.batch };
    let most = if args.scaling { threads } else { 1 };
    let scaling = swept(&doubling(most).map(of_threads).collect::<Vec<_>>())?;
    let kinds = kinds.iter().map(|kind| kind.name).collect();
    Ok(Measured { kinds, results, batches, scaling, renders: Vec::new() })
}

/// 1, 2, 4 and so on, and the most.
fn doubling(most: usize) -> impl Iterator<Item = usize> {
    let powers = std::iter::successors(Some(1), |threads: &usize| Some(2 * threads));
    powers.take_while(move |&threads| threads < most).chain([most])
}

/// What all the rays take at most, and the copies that each intersector is asked with.
fn bytes_of_rays(file: &SceneFile, backends: usize) -> u64 {
    let image = file.settings.image;
    let rays = 16 * u64::from(image.width) * u64::from(image.height);
    let each = KINDS * (size_of::<PathRay>() + size_of::<Ray>() * (1 + 2 * backends));
    rays.min(MOST_RAYS as u64) * each as u64
}

/// On what, and how, was measured.
fn circumstances(rounds: Rounds) -> String {
    let threads = print::count(rayon::current_num_threads(), "thread");
    let processor = system::processor().map_or(String::new(), |name| format!(" of {name}"));
    let rays = print::count(rounds.batch, "ray");
    format!(
        "{threads}{processor}, {rays} a call, median of {}",
        print::count(rounds.count, "round")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_double_up_to_the_most() {
        let of = |most| doubling(most).collect::<Vec<_>>();
        assert_eq!(of(1), [1]);
        assert_eq!(of(2), [1, 2]);
        assert_eq!(of(6), [1, 2, 4, 6]);
        assert_eq!(of(8), [1, 2, 4, 8]);
    }
}
