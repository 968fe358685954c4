//! `photosphere crosscheck`: every intersector against exact arithmetic, on rays of a scene.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};

use crate::accel::{Accel, BuildOptions, Cancel};
use crate::error::{Error, Result};
use crate::geometry::PathRay;
use crate::scene::Scene;
use crate::verify::crosscheck::{self, Contender, Tally};
use crate::verify::rays;

use super::args::CrosscheckArgs;
use super::exit::Exit;
use super::{interrupt, on_threads, print};

/// # Errors
/// When the scene cannot be had, an intersector not be built, or the dump not be written.
pub(super) fn run(args: &CrosscheckArgs) -> Result<Exit> {
    let cancel = interrupt::listen(None);
    on_threads(args.scene.threads(), || check(args, &cancel))
}

fn check(args: &CrosscheckArgs, cancel: &Cancel) -> Result<Exit> {
    let dump = args.dump.as_deref().map(Dump::create).transpose()?;
    let scene = Scene::load(&args.scene.path, &args.scene.overrides())?;
    let build = BuildOptions { threads: rayon::current_num_threads(), cancel: cancel.clone() };
    let backends: Vec<(&str, Box<dyn Accel>)> = args
        .accels
        .backends()
        .iter()
        .map(|backend| Ok((backend.name(), backend.build(scene.spheres(), &build)?)))
        .collect::<Result<_>>()?;
    let contenders: Vec<Contender<'_>> =
        backends.iter().map(|(name, accel)| Contender { name, accel: accel.as_ref() }).collect();

    let rays = rays_of(&scene, contenders[0].accel, args);
    let tallies = crosscheck::compare(scene.spheres(), &contenders, &rays, cancel)?;
    print::result(&table(&tallies))?;
    if let Some(dump) = dump {
        dump.write(&tallies)?;
    }
    let failures: usize = tallies.iter().map(Tally::failures).sum();
    Ok(if failures == 0 { Exit::Done } else { Exit::CheckFailed })
}

/// A third each: rays of the camera, their bounces, random rays. Camera rays that hit nothing have
/// no bounce; random rays take those places.
fn rays_of(scene: &Scene, accel: &dyn Accel, args: &CrosscheckArgs) -> Vec<PathRay> {
    let total = args.rays as usize;
    let mut rays = camera_rays(scene, total / 3, args.seed);
    rays.extend(rays::bounces(scene.spheres(), accel, &rays, args.seed));
    rays.extend(rays::random(scene.spheres(), total - rays.len(), args.seed));
    rays
}

fn camera_rays(scene: &Scene, count: usize, seed: u64) -> Vec<PathRay> {
    let mut rng = StdRng::seed_from_u64(seed);
    let image = scene.description().image;
    let mut place = |pixels: u32| f64::from(pixels) * rng.random::<f64>();
    let mut ray = || scene.camera().ray(place(image.width), place(image.height));
    std::iter::repeat_with(&mut ray).take(count).collect()
}

fn table(tallies: &[Tally]) -> String {
    let mut text = format!(
        "{:<12}{:>10}{:>10}{:>10}{:>8}{:>8}{:>8}{:>10}{:>10}{:>12}\n",
        "",
        "rays",
        "equal",
        "ambiguous",
        "wrong",
        "lost",
        "ghosts",
        "distance",
        "occlusion",
        "t error"
    );
    for tally in tallies {
        text += &format!(
            "{:<12}{:>10}{:>10}{:>10}{:>8}{:>8}{:>8}{:>10}{:>10}{:>12.3}\n",
            tally.name,
            tally.rays,
            tally.equal,
            tally.ambiguous,
            tally.wrong,
            tally.lost,
            tally.ghosts,
            tally.wrong_distances,
            tally.wrong_occlusions,
            tally.largest_distance_error,
        );
    }
    let failures: usize = tallies.iter().map(Tally::failures).sum();
    text += "t error: the largest error of a distance, in units of what is allowed\n";
    text += &match failures {
        0 => "every answer is within the stated tolerance\n".to_owned(),
        _ => format!("{} beyond the stated tolerance\n", print::count(failures, "answer")),
    };
    text
}

/// The file for the rays that were answered wrongly; made first, because the check takes a while.
struct Dump<'a> {
    path: &'a Path,
    file: File,
}

impl<'a> Dump<'a> {
    fn create(path: &'a Path) -> Result<Self> {
        let file = File::create(path).map_err(|e| Error::file("write", path, e))?;
        Ok(Self { path, file })
    }

    fn write(self, tallies: &[Tally]) -> Result<()> {
        let write = || {
            let mut file = BufWriter::new(self.file);
            writeln!(file, "# rays relative to the spheres' origin, spheres by their ids")?;
            for disagreement in tallies.iter().flat_map(|tally| &tally.disagreements) {
                writeln!(file, "{disagreement}")?;
            }
            file.into_inner()?.sync_all()
        };
        write().map_err(|e| Error::file("write", self.path, e))
    }
}
