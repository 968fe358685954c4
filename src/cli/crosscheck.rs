//! `photosphere crosscheck`: tests every intersector against exact arithmetic, on rays of a scene.

use std::fs::File;
use std::io::{BufWriter, Write};

use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};

use crate::accel::{Accel, Backend, BuildOptions};
use crate::error::{Error, Result};
use crate::geometry::{PathRay, SphereSet};
use crate::math::{DVec3, NO_SPHERE};
use crate::scene::{PreparedScene, Scene};
use crate::verify::crosscheck::{self, CrosscheckResult, Disagreement, TestedBackend};
use crate::verify::rays;

use super::args::CrosscheckArgs;
use super::exit::Exit;
use super::interrupt;
use super::particle_file::read_scene;
use super::print::{self, row};
use super::system::on_threads;

/// Up to this many spheres, brute force is fast enough for a few thousand rays.
const FEW_SPHERES: usize = 1000;

/// Runs the command.
///
/// # Errors
/// If the scene cannot be loaded, an intersector cannot be built, or the dump cannot be written.
pub(super) fn run(args: &CrosscheckArgs) -> Result<Exit> {
    interrupt::listen();
    on_threads(args.scene.threads(), || check(args))
}

fn check(args: &CrosscheckArgs) -> Result<Exit> {
    // Created first, because the check takes a while.
    let create = |path| Ok((path, File::create(path).map_err(|e| Error::file("write", path, e))?));
    let dump = args.dump.as_deref().map(create).transpose()?;
    let (scene, settings) = read_scene(&args.scene.path, &args.scene.overrides(), None)?.build()?;
    let prepared = PreparedScene::new(&scene, settings)?;
    let spheres = scene.spheres();
    let build = BuildOptions { threads: rayon::current_num_threads(), ..Default::default() };
    let backends: Vec<(&str, Box<dyn Accel>)> = args
        .accels
        .backends()
        .iter()
        .map(|backend| Ok((backend.name(), backend.build(spheres, &build)?)))
        .collect::<Result<_>>()?;
    let contenders: Vec<TestedBackend<'_>> = backends
        .iter()
        .map(|(name, accel)| TestedBackend { name, accel: accel.as_ref() })
        .collect();

    let of_scene = rays_of_shot(&prepared, bouncer(spheres).build(spheres, &build)?.as_ref(), args);
    let left = args.rays as usize - of_scene.len();
    let mut random = rays::coherent(spheres, left / 4, args.seed);
    random.extend(rays::random(spheres, left - random.len(), args.seed));
    let mut results = crosscheck::compare(spheres, &contenders, &of_scene, &build.cancel)?;
    let about_random = crosscheck::compare(spheres, &contenders, &random, &build.cancel)?;
    results.iter_mut().zip(about_random).for_each(|(result, random)| result.merge(random));
    print::result(&table(&results))?;
    if let Some((path, file)) = dump {
        write_dump(file, &results, &scene).map_err(|e| Error::file("write", path, e))?;
    }
    let failures: usize = results.iter().map(CrosscheckResult::failures).sum();
    Ok(if failures == 0 { Exit::Done } else { Exit::CheckFailed })
}

/// Returns the intersector that finds the bounces of camera rays. It does not depend on the
/// intersectors under test, so neither do the rays.
fn bouncer(spheres: &SphereSet) -> Backend {
    if spheres.len() <= FEW_SPHERES { Backend::BruteForce } else { Backend::Native }
}

/// Returns camera rays and their bounces, each a third of all rays. Random rays replace the bounces
/// of camera rays that miss.
fn rays_of_shot(
    prepared: &PreparedScene,
    accel: &dyn Accel,
    args: &CrosscheckArgs,
) -> Vec<PathRay> {
    let spheres = prepared.scene().spheres();
    let mut rays = camera_rays(prepared, args.rays as usize / 3, args.seed);
    rays.extend(rays::secondary(spheres, accel, &rays, args.seed));
    rays.retain(|ray| rays::is_traceable(spheres, ray));
    rays
}

fn camera_rays(prepared: &PreparedScene, count: usize, seed: u64) -> Vec<PathRay> {
    let mut rng = StdRng::seed_from_u64(seed);
    let image = prepared.image_settings();
    let mut place = |pixels: u32| f64::from(pixels) * rng.random::<f64>();
    let mut ray = || {
        let (x, y) = (place(image.width), place(image.height));
        prepared.camera().generate_ray(x, y, [place(1), place(1)])
    };
    std::iter::repeat_with(&mut ray).take(count).collect()
}

fn table(results: &[CrosscheckResult]) -> String {
    const COLUMNS: [i32; 11] = [-11, 9, 7, 7, 6, 5, 7, 6, 6, 6, 8];
    const HEADINGS: [&str; COLUMNS.len()] = [
        "", "equal", "ambig.", "passed", "wrong", "lost", "ghosts", "dist.", "sides", "occl.",
        "t error",
    ];
    let rays = results.first().map_or(0, |result| result.rays);
    let mut text = format!("{} by each intersector\n", print::count(rays, "ray"));
    text += &row(COLUMNS, HEADINGS);
    for result in results {
        let counts = [
            result.exact,
            result.ambiguous,
            result.hidden_hits,
            result.wrong_ids,
            result.false_misses,
            result.false_hits,
            result.wrong_distances,
            result.wrong_sides,
            result.wrong_occlusions,
        ];
        let [a, b, c, d, e, f, g, h, i] = &counts.map(|count| count.to_string());
        let error = format!("{:.3}", result.max_distance_error);
        text += &row(COLUMNS, [&result.name, a, b, c, d, e, f, g, h, i, &error]);
    }
    let failures: usize = results.iter().map(CrosscheckResult::failures).sum();
    text += "ambig.: answers that rounding leaves open; passed: of these, the ones that were\n\
             passed over for another sphere; dist., sides, occl.: wrong distances, sides and\n\
             occlusions; t error: the largest error of a distance, relative to the tolerance\n";
    text += &match failures {
        0 => "every answer is within the stated tolerance\n".to_owned(),
        _ => format!("{} beyond the stated tolerance\n", print::count(failures, "answer")),
    };
    text
}

/// Names the spheres of a disagreement as the user knows them: ` 7 = `ball``.
fn in_the_scene(disagreement: &Disagreement, scene: &Scene) -> String {
    let Disagreement { ray, backend_hit: answered, exact_hit: judged, .. } = disagreement;
    let hits = [answered, judged].map(|hit| hit.map_or(NO_SPHERE, |(id, _)| id));
    let mut ids = [hits[0], hits[1], ray.origin_sphere, ray.target_sphere].to_vec();
    ids.sort_unstable();
    ids.dedup();
    // A broken intersector may return a sphere that does not exist.
    ids.retain(|&id| (id as usize) < scene.spheres().len());
    let name = |id: u32| format!(" {id} = `{}`", scene.name_of_row(scene.spheres().row(id)));
    if ids.is_empty() {
        return String::new();
    }
    format!(" spheres{}", ids.into_iter().map(name).collect::<Vec<_>>().join(","))
}

/// Explanation at the head of a dump.
const ABOUT_DUMP: &str = "spheres by id, followed by their rows in the scene, counted from 0 through \
    [[spheres]] and then the tables";

fn write_dump(to: File, results: &[CrosscheckResult], scene: &Scene) -> std::io::Result<()> {
    let mut to = BufWriter::new(to);
    let DVec3 { x, y, z } = scene.spheres().origin();
    writeln!(to, "# rays relative to {x:?} {y:?} {z:?}; {ABOUT_DUMP}")?;
    for disagreement in results.iter().flat_map(|result| &result.disagreements) {
        writeln!(to, "{disagreement}{}", in_the_scene(disagreement, scene))?;
    }
    to.into_inner()?.sync_all()
}
