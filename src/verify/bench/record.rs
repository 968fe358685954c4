//! Generates the tables that `benches/record/` keeps: native against Embree, ray by ray and render
//! by render, in interleaved rounds of one run.
//!
//! Each ratio is followed by our target in brackets: a change that falls short of it is no
//! improvement.

use std::fmt::Write as _;
use std::fs::File;
use std::hint::black_box;
use std::io::BufWriter;
use std::path::Path;
use std::time::Instant;

use crate::accel::{Accel, Backend, BackendChoice, BuildOptions};
use crate::color::Rgb;
use crate::error::{Error, Result};
use crate::generate::{Arrangement, Recipe, scene_text, write_rows};
use crate::geometry::{PathRay, Sphere, SphereSet};
use crate::image_io::temp_folder;
use crate::math::{DVec3, Hit, NO_SPHERE, Ray};
use crate::scene::description::{
    BackgroundDescription, EnvironmentDescription, SceneDescription, SurfaceModel,
};
use crate::scene::{PreparedScene, Scene, Settings, read_text};
use crate::task::CancelToken;
use crate::verify::rays;

use super::{
    BackendSet, BenchOptions, CAMERA, Quartiles, QueryKind, RaySet, SECOND_BOUNCE, StandardScene,
    SweepPoint, bench, bench_renders, sweep,
};

const GAS: Arrangement = Arrangement::Gas;
const PACKED: Arrangement = Arrangement::Packed;

/// Traced scenes, with the target ratios for closest hit and occlusion.
const TRACED: [(Arrangement, u64, [f64; 2]); 5] = [
    (GAS, 100_000, [1.8, 2.3]),
    (GAS, 1_000_000, [2.4, 4.0]),
    (GAS, 10_000_000, [3.6, 4.4]),
    (PACKED, 1_000_000, [1.75, 2.6]),
    (PACKED, 10_000_000, [1.9, 3.5]),
];

/// Rendered scenes, diffuse spheres under a constant environment, with the target ratio.
const RENDERED: [(Arrangement, u64, f64); 3] =
    [(GAS, 1_000_000, 2.6), (GAS, 10_000_000, 3.3), (PACKED, 1_000_000, 1.7)];

/// Three spheres and an emitter.
const TINY: &str = include_str!("../../../scenes/paper/fig2.toml");
const TINY_RATIO: f64 = 3.5;

/// Resolution of the renders in pixels.
const SIZE: [u32; 2] = [320, 240];

const PAIR: [Backend; 2] = [Backend::Native, Backend::Embree];

/// Rays per call.
const BATCH: usize = 512;
const ROUND: BenchOptions = BenchOptions { rounds: 1, batch: BATCH };

/// Options for the record.
#[derive(Clone, Debug)]
pub struct Record {
    /// Largest number of spheres; larger scenes are skipped.
    pub largest: u64,
    /// Interleaved rounds behind each figure, at least one.
    pub rounds: usize,
    /// Set from another thread to cancel the measurement.
    pub cancel: CancelToken,
}

impl Record {
    /// Measures one table after another and passes each to `report` when it is finished.
    /// Single-thread tables use a pool of one thread, all others the current rayon pool.
    ///
    /// # Errors
    /// If this build has no Embree, if there is no room for the scenes, or on cancellation.
    pub fn measure(&self, report: &mut dyn FnMut(&str)) -> Result<()> {
        let one = rayon::ThreadPoolBuilder::new().num_threads(1).build();
        let one = one.map_err(|e| Error::input(format!("cannot start a thread: {e}")))?;
        report(&one.install(|| self.trace())?);
        report(&one.install(|| self.giants())?);
        report(&self.build()?);
        report(&self.scale()?);
        report(&one.install(|| self.render())?);
        Ok(())
    }

    fn field(
        &self,
        spheres: &StandardScene,
        backends: &[Backend],
        times: usize,
    ) -> Result<BackendSet> {
        BackendSet::build(&spheres.spheres, backends, &self.options(), times)
    }

    fn options(&self) -> BuildOptions {
        let threads = rayon::current_num_threads();
        BuildOptions { threads, cancel: self.cancel.clone(), ..BuildOptions::default() }
    }

    /// Second-bounce rays on one thread, and the cost of exact hits.
    fn trace(&self) -> Result<String> {
        let mut text = format!(
            "One thread, millions of rays per second: rays of the second bounce, closest hit and\n\
             occlusion; rays of the camera, sixteen to a pixel, closest hit\n\
             {:<13}{:<10}{:>15}{:>17}{:>17}\n",
            "", "", "native", "embree", "ratio"
        );
        let mut costs = format!(
            "\nWhat exactness costs, native: the rate of rays that leave a sphere by its id against that of\n\
             the same rays started a thousandth of its radius further on, and the exact hit of a ray\n\
             {:<13}{:>10}{:>10}{:>14}\n",
            "", "closest", "occluded", "exact hit"
        );
        let traced = TRACED.into_iter().filter(|(_, spheres, _)| *spheres <= self.largest);
        for (arrangement, spheres, asked) in traced {
            let name = name(arrangement, spheres);
            let scene = StandardScene::new(arrangement, spheres)?;
            let field = self.field(&scene, &PAIR, 1)?;
            let (accel, bounced) = second_bounce(&field, &scene.camera_rays)?;
            let ask =
                |rays: &[PathRay]| rays.iter().map(|ray| scene.spheres.to_query(ray)).collect();
            let free: Vec<PathRay> = bounced.iter().map(|ray| freed(&scene.spheres, ray)).collect();
            let kinds = [
                RaySet { name: SECOND_BOUNCE, rays: ask(&bounced) },
                RaySet { name: "free", rays: ask(&free) },
                RaySet { name: CAMERA, rays: ask(&scene.camera_rays) },
            ];
            let rounds = BenchOptions { rounds: self.rounds, batch: BATCH };
            let measured = bench(&field, &kinds, rounds, &self.cancel)?;
            let rates = |kind: usize| {
                let [native, embree] = [0, 1].map(|backend: usize| measured[backend].rates[kind]);
                native.zip(embree).ok_or_else(no_ray)
            };
            let (ours, theirs) = rates(0)?;
            for (question, asked) in QueryKind::ALL.into_iter().zip(asked) {
                let asked = format!(" ({asked})");
                let (ours, theirs) = (ours.get(question), theirs.get(question));
                text +=
                    &rate_row(&name, &format!("{question:?}").to_lowercase(), ours, theirs, &asked);
            }
            let (camera, their_camera) = rates(2)?;
            text += &rate_row(&name, "camera", camera.closest, their_camera.closest, "");
            if theirs.differing_ids > 0 {
                let _ = writeln!(
                    text,
                    "{name:<13}{} of 4096 ids differ, as f32 allows",
                    theirs.differing_ids
                );
            }
            let (free, _) = rates(1)?;
            let [closest, occluded] = QueryKind::ALL
                .map(|question| ours.get(question).median / free.get(question).median);
            let _ = writeln!(
                costs,
                "{name:<13}{closest:10.2}{occluded:10.2}{:14.0} ns of {:.0}",
                1e9 * seconds_of_answers(&scene.spheres, accel, &bounced),
                1e9 / ours.closest.median
            );
        }
        Ok(text + &costs)
    }

    /// The cost per ray of one giant sphere outside the tree.
    fn giants(&self) -> Result<String> {
        let mut text = format!(
            "The rate of rays of the second bounce where a giant lies below, against that without it\n\
             {:<13}{:>10}{:>10}\n",
            "", "closest", "occluded"
        );
        let spheres = self.largest.min(1_000_000);
        let giant = Sphere { center: DVec3::NEG_Y * (1e7 + 0.55), radius: 1e7 };
        for arrangement in [GAS, PACKED] {
            let set_up = |giants: Vec<Sphere>| {
                let scene = StandardScene::with_extra_spheres(giants, arrangement, spheres)?;
                let field = self.field(&scene, &PAIR[..1], 1)?;
                let (_, bounced) = second_bounce(&field, &scene.camera_rays)?;
                let rays = bounced.iter().map(|ray| scene.spheres.to_query(ray)).collect();
                Ok((field, [RaySet { name: SECOND_BOUNCE, rays }]))
            };
            let (with, without) = (set_up(vec![giant])?, set_up(Vec::new())?);
            let mut ratios = [Vec::new(), Vec::new()];
            for _ in 0..self.rounds {
                let rates = |(field, kinds): &(BackendSet, [RaySet; 1])| {
                    bench(field, kinds, ROUND, &self.cancel)?[0].rates[0].ok_or_else(no_ray)
                };
                let (with, without) = (rates(&with)?, rates(&without)?);
                for (ratios, question) in ratios.iter_mut().zip(QueryKind::ALL) {
                    ratios.push(with.get(question).median / without.get(question).median);
                }
            }
            let [closest, occluded] = ratios.map(median);
            let name = name(arrangement, spheres);
            let _ = writeln!(text, "{name:<13}{closest:10.2}{occluded:10.2}");
        }
        Ok(text)
    }

    /// Build times of the largest scenes on all threads.
    fn build(&self) -> Result<String> {
        let mut text = format!(
            "Build on {} threads, seconds\n{:<13}{:>10}{:>16}{:>10}{:>18}\n",
            rayon::current_num_threads(),
            "",
            "native",
            "embree",
            "ratio",
            "bytes per sphere"
        );
        for arrangement in [GAS, PACKED] {
            let scene = StandardScene::new(arrangement, self.largest)?;
            let field = self.field(&scene, &PAIR, self.rounds.min(5))?;
            let measured = bench(&field, &[], ROUND, &self.cancel)?;
            let (native, embree) = (&measured[0], &measured[1]);
            let _ = writeln!(
                text,
                "{:<13}{}  {}  {:6.2} (1){:10.1} {:.1}",
                name(arrangement, self.largest),
                with_spread(native.build_s),
                with_spread(embree.build_s),
                embree.build_s.median / native.build_s.median,
                native.bytes_per_sphere,
                embree.bytes_per_sphere
            );
        }
        Ok(text)
    }

    /// Thread scaling, compared with that of pure arithmetic.
    fn scale(&self) -> Result<String> {
        let threads = rayon::current_num_threads();
        let mut text = format!(
            "{threads} threads against one, native, rays of the second bounce\n\
             {:<13}{:>10}{:>10}{:>12}{:>26}\n",
            "", "closest", "occluded", "arithmetic", "of arithmetic"
        );
        let spheres = self.largest.min(1_000_000);
        for arrangement in [GAS, PACKED] {
            let scene = StandardScene::new(arrangement, spheres)?;
            let field = self.field(&scene, &PAIR[..1], 1)?;
            let (_, bounced) = second_bounce(&field, &scene.camera_rays)?;
            let asked: Vec<Ray> = bounced.iter().map(|ray| scene.spheres.to_query(ray)).collect();
            let settings = [1, threads].map(|threads| SweepPoint { threads, batch: BATCH });
            let swept = sweep(&field, &asked, &settings, self.rounds, &self.cancel)?;
            let [one, all] = &swept[..] else { return Err(no_ray()) };
            let [closest, occluded] = [0, 1]
                .map(|question| all.rates[0][question].median / one.rates[0][question].median);
            let arithmetic = all.arithmetic.median / one.arithmetic.median;
            let _ = writeln!(
                text,
                "{:<13}{closest:10.2}{occluded:10.2}{arithmetic:12.2}{:14.2} and {:.2} (0.95)",
                name(arrangement, spheres),
                closest / arithmetic,
                occluded / arithmetic,
            );
        }
        Ok(text)
    }

    /// Whole renders on one thread.
    fn render(&self) -> Result<String> {
        let [width, height] = SIZE;
        let mut text = format!(
            "Renders on one thread, path integrator, {width} x {height} pixels\n\
             {:<18}{:>8}{:>16}{:>16}{:>19}{:>14}{:>16}{:>14}\n",
            "",
            "samples",
            "ours (s)",
            "embree (s)",
            "ratio",
            "ours",
            "outside (15 %)",
            "other pixels"
        );
        let folder = temp_folder()?;
        let (scene, settings) = read_text("fig2.toml", TINY, folder.path(), &[])?.build()?;
        text += &self.one_render("three and an emitter", &scene, settings, 64, Some(TINY_RATIO))?;
        let rendered = RENDERED.into_iter().filter(|(_, spheres, _)| *spheres <= self.largest);
        for (arrangement, spheres, asked) in rendered {
            let (mut description, _) = generated(folder.path(), arrangement, spheres)?;
            let dome = EnvironmentDescription::Constant { radiance: Rgb::ONE };
            description.background =
                BackgroundDescription { dome, ..BackgroundDescription::default() };
            let albedo = Rgb::splat(0.7);
            description.materials[0].surface = SurfaceModel::Diffuse { albedo, roughness: 0.0 };
            let mut settings = Settings::default();
            settings.render.max_depth = Some(6);
            let scene = Scene::build(description)?;
            let name = name(arrangement, spheres);
            text += &self.one_render(&name, &scene, settings, 16, Some(asked))?;
        }
        if self.largest >= 1_000_000 {
            // Uses the lighting that `photosphere generate` writes.
            let (description, settings) = generated(folder.path(), GAS, 1_000_000)?;
            let scene = Scene::build(description)?;
            text += &self.one_render("... sun and sky", &scene, settings, 16, None)?;
        }
        Ok(text)
    }

    fn one_render(
        &self,
        name: &str,
        scene: &Scene,
        mut settings: Settings,
        samples: u32,
        asked: Option<f64>,
    ) -> Result<String> {
        [settings.image.width, settings.image.height] = SIZE;
        settings.render.samples_per_pixel = samples;
        let prepared = PreparedScene::new(scene, settings)?;
        let backends = [BackendChoice::Auto.select(scene.spheres()).backend, Backend::Embree];
        let field = BackendSet::build(scene.spheres(), &backends, &self.options(), 1)?;
        let measured = bench_renders(&prepared, &field, self.rounds, &self.cancel)?;
        let (ours, embree) = (&measured[0], &measured[1]);
        Ok(format!(
            "{name:<18}{samples:8}{:>16}{:>16}{:10.2} {:<6}{:>16}{:14.1} %{:>14}\n",
            with_spread(ours.seconds),
            with_spread(embree.seconds),
            embree.seconds.median / ours.seconds.median,
            asked.map_or(String::new(), |asked| format!("({asked:.2})")),
            ours.backend.name(),
            100.0 * (1.0 - ours.intersector_share.median),
            embree.differing_pixels
        ))
    }
}

fn name(arrangement: Arrangement, spheres: u64) -> String {
    format!("{} {:e}", arrangement.name(), spheres as f64)
}

fn no_ray() -> Error {
    Error::input("no ray of a standard scene gets as far as a second bounce")
}

fn with_spread(figure: Quartiles) -> String {
    format!("{:8.3} +-{:2.0} %", figure.median, 100.0 * figure.relative_spread())
}

fn median(values: Vec<f64>) -> f64 {
    Quartiles::from_samples(values).map_or(f64::NAN, |figure| figure.median)
}

/// Formats rates in millions, their ratio and the target.
fn rate_row(name: &str, question: &str, ours: Quartiles, theirs: Quartiles, asked: &str) -> String {
    let ratio = ours.median / theirs.median;
    let [ours, theirs] = [ours, theirs].map(|rate| with_spread(rate.scaled(1e-6)));
    format!("{name:<13}{question:<10}{ours}  {theirs}   {ratio:5.2}{asked}\n")
}

/// Second-bounce rays, and the intersector that found their origins.
fn second_bounce<'a>(
    field: &'a BackendSet,
    camera: &[PathRay],
) -> Result<(&'a dyn Accel, Vec<PathRay>)> {
    let (_, accel) = field.backends().next().ok_or_else(no_ray)?;
    let first = rays::secondary(field.spheres(), accel, camera, 0);
    Ok((accel, rays::secondary(field.spheres(), accel, &first, 1)))
}

/// Moves a ray's origin a little forward, so that it has no origin sphere to skip.
fn freed(spheres: &SphereSet, ray: &PathRay) -> PathRay {
    let step = if ray.origin_sphere == NO_SPHERE {
        0.0
    } else {
        1e-3 * spheres.sphere(ray.origin_sphere).radius
    };
    PathRay::new(ray.at(step), ray.direction)
}

/// Seconds taken to resolve all hits exactly: the median of several passes.
fn seconds_of_answers(spheres: &SphereSet, accel: &dyn Accel, bounced: &[PathRay]) -> f64 {
    let asked: Vec<Ray> = bounced.iter().map(|ray| spheres.to_query(ray)).collect();
    let mut hits = vec![Hit::MISS; asked.len()];
    accel.closest(&asked, &mut hits);
    let pass = |_| {
        let start = Instant::now();
        for (ray, hit) in bounced.iter().zip(&hits) {
            black_box(spheres.resolve_hit(ray, *hit));
        }
        start.elapsed().as_secs_f64() / bounced.len() as f64
    };
    median((0..9).map(pass).collect())
}

/// Builds the scene that `photosphere generate` writes, with its table in `folder`.
fn generated(
    folder: &Path,
    arrangement: Arrangement,
    spheres: u64,
) -> Result<(SceneDescription, Settings)> {
    let recipe = Recipe::new(arrangement, spheres, 0, false)?;
    let table = folder.join(format!("{}-{spheres}.f32", arrangement.name()));
    let write = || {
        let mut file = BufWriter::new(File::create(&table)?);
        write_rows(&recipe, &mut file, &|_| {})?;
        file.into_inner()?.sync_all()
    };
    write().map_err(|e: std::io::Error| Error::file("write", &table, e))?;
    let file = read_text("generated.toml", &scene_text(&recipe, &table), folder, &[])?;
    Ok((file.description, file.settings))
}
