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
    pub max_spheres: u64,
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

    fn backend_set(
        &self,
        spheres: &StandardScene,
        backends: &[Backend],
        builds: usize,
    ) -> Result<BackendSet> {
        BackendSet::build(&spheres.spheres, backends, &self.options(), builds)
    }

    fn options(&self) -> BuildOptions {
        let threads = rayon::current_num_threads();
        BuildOptions { threads, cancel: self.cancel.clone(), ..BuildOptions::default() }
    }

    /// Second-bounce rays on one thread, and the cost of exact hits.
    fn trace(&self) -> Result<String> {
        let mut text = format!(
            "One thread, millions of rays per second: second-bounce rays, closest hit and occlusion;\n\
             camera rays, sixteen per pixel, closest hit\n\
             {:<13}{:<10}{:>15}{:>17}{:>17}\n",
            "", "", "native", "embree", "ratio"
        );
        let mut costs = format!(
            "\nCost of exactness, native: rate of rays that exclude their origin sphere by id, relative to\n\
             rays started a thousandth of its radius further on; time to resolve a hit in f64\n\
             {:<13}{:>10}{:>10}{:>14}\n",
            "", "closest", "occluded", "exact hit"
        );
        let traced = TRACED.into_iter().filter(|(_, spheres, _)| *spheres <= self.max_spheres);
        for (arrangement, spheres, targets) in traced {
            let name = name(arrangement, spheres);
            let scene = StandardScene::new(arrangement, spheres)?;
            let backend_set = self.backend_set(&scene, &PAIR, 1)?;
            let (accel, second_bounce_rays) = second_bounce(&backend_set, &scene.camera_rays)?;
            let to_queries =
                |rays: &[PathRay]| rays.iter().map(|ray| scene.spheres.to_query(ray)).collect();
            let free: Vec<PathRay> = second_bounce_rays
                .iter()
                .map(|ray| without_origin_sphere(&scene.spheres, ray))
                .collect();
            let ray_sets = [
                RaySet { name: SECOND_BOUNCE, rays: to_queries(&second_bounce_rays) },
                RaySet { name: "free", rays: to_queries(&free) },
                RaySet { name: CAMERA, rays: to_queries(&scene.camera_rays) },
            ];
            let rounds = BenchOptions { rounds: self.rounds, batch: BATCH };
            let measured = bench(&backend_set, &ray_sets, rounds, &self.cancel)?;
            let rates = |set: usize| {
                let [native, embree] = [0, 1].map(|backend: usize| measured[backend].rates[set]);
                native.zip(embree).ok_or_else(no_ray)
            };
            let (native, embree) = rates(0)?;
            for (query, target) in QueryKind::ALL.into_iter().zip(targets) {
                let target = format!(" ({target})");
                let (native, embree) = (native.get(query), embree.get(query));
                text +=
                    &rate_row(&name, &format!("{query:?}").to_lowercase(), native, embree, &target);
            }
            let (camera, their_camera) = rates(2)?;
            text += &rate_row(&name, "camera", camera.closest, their_camera.closest, "");
            if embree.differing_ids > 0 {
                let _ = writeln!(
                    text,
                    "{name:<13}{} of 4096 ids differ, as f32 allows",
                    embree.differing_ids
                );
            }
            let (free, _) = rates(1)?;
            let [closest, occluded] =
                QueryKind::ALL.map(|query| native.get(query).median / free.get(query).median);
            let _ = writeln!(
                costs,
                "{name:<13}{closest:10.2}{occluded:10.2}{:14.0} ns of {:.0}",
                1e9 * seconds_per_hit(&scene.spheres, accel, &second_bounce_rays),
                1e9 / native.closest.median
            );
        }
        Ok(text + &costs)
    }

    /// The cost per ray of one giant sphere outside the tree.
    fn giants(&self) -> Result<String> {
        let mut text = format!(
            "Rate of second-bounce rays with one giant below, relative to the rate without it\n\
             {:<13}{:>10}{:>10}\n",
            "", "closest", "occluded"
        );
        let spheres = self.max_spheres.min(1_000_000);
        let giant = Sphere { center: DVec3::NEG_Y * (1e7 + 0.55), radius: 1e7 };
        for arrangement in [GAS, PACKED] {
            let build_set = |giants: Vec<Sphere>| {
                let scene = StandardScene::with_extra_spheres(giants, arrangement, spheres)?;
                let backend_set = self.backend_set(&scene, &PAIR[..1], 1)?;
                let (_, second_bounce_rays) = second_bounce(&backend_set, &scene.camera_rays)?;
                let rays =
                    second_bounce_rays.iter().map(|ray| scene.spheres.to_query(ray)).collect();
                Ok((backend_set, [RaySet { name: SECOND_BOUNCE, rays }]))
            };
            let (with, without) = (build_set(vec![giant])?, build_set(Vec::new())?);
            let mut ratios = [Vec::new(), Vec::new()];
            for _ in 0..self.rounds {
                let rates = |(backend_set, ray_sets): &(BackendSet, [RaySet; 1])| {
                    bench(backend_set, ray_sets, ROUND, &self.cancel)?[0].rates[0]
                        .ok_or_else(no_ray)
                };
                let (with, without) = (rates(&with)?, rates(&without)?);
                for (ratios, query) in ratios.iter_mut().zip(QueryKind::ALL) {
                    ratios.push(with.get(query).median / without.get(query).median);
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
            let scene = StandardScene::new(arrangement, self.max_spheres)?;
            let backend_set = self.backend_set(&scene, &PAIR, self.rounds.min(5))?;
            let measured = bench(&backend_set, &[], ROUND, &self.cancel)?;
            let (native, embree) = (&measured[0], &measured[1]);
            let _ = writeln!(
                text,
                "{:<13}{}  {}  {:6.2} (1){:10.1} {:.1}",
                name(arrangement, self.max_spheres),
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
            "{threads} threads relative to one, native, second-bounce rays\n\
             {:<13}{:>10}{:>10}{:>12}{:>26}\n",
            "", "closest", "occluded", "arithmetic", "of arithmetic"
        );
        let spheres = self.max_spheres.min(1_000_000);
        for arrangement in [GAS, PACKED] {
            let scene = StandardScene::new(arrangement, spheres)?;
            let backend_set = self.backend_set(&scene, &PAIR[..1], 1)?;
            let (_, second_bounce_rays) = second_bounce(&backend_set, &scene.camera_rays)?;
            let queries: Vec<Ray> =
                second_bounce_rays.iter().map(|ray| scene.spheres.to_query(ray)).collect();
            let settings = [1, threads].map(|threads| SweepPoint { threads, batch: BATCH });
            let results = sweep(&backend_set, &queries, &settings, self.rounds, &self.cancel)?;
            let [one, all] = &results[..] else { return Err(no_ray()) };
            let [closest, occluded] =
                [0, 1].map(|query| all.rates[0][query].median / one.rates[0][query].median);
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
        let rendered = RENDERED.into_iter().filter(|(_, spheres, _)| *spheres <= self.max_spheres);
        for (arrangement, spheres, target) in rendered {
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
            text += &self.one_render(&name, &scene, settings, 16, Some(target))?;
        }
        if self.max_spheres >= 1_000_000 {
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
        target: Option<f64>,
    ) -> Result<String> {
        [settings.image.width, settings.image.height] = SIZE;
        settings.render.samples_per_pixel = samples;
        let prepared = PreparedScene::new(scene, settings)?;
        let backends = [BackendChoice::Auto.select(scene.spheres()).backend, Backend::Embree];
        let backend_set = BackendSet::build(scene.spheres(), &backends, &self.options(), 1)?;
        let measured = bench_renders(&prepared, &backend_set, self.rounds, &self.cancel)?;
        let (native, embree) = (&measured[0], &measured[1]);
        Ok(format!(
            "{name:<18}{samples:8}{:>16}{:>16}{:10.2} {:<6}{:>16}{:14.1} %{:>14}\n",
            with_spread(native.seconds),
            with_spread(embree.seconds),
            embree.seconds.median / native.seconds.median,
            target.map_or(String::new(), |target| format!("({target:.2})")),
            native.backend.name(),
            100.0 * (1.0 - native.intersector_fraction.median),
            embree.differing_pixels
        ))
    }
}

fn name(arrangement: Arrangement, spheres: u64) -> String {
    format!("{} {:e}", arrangement.name(), spheres as f64)
}

fn no_ray() -> Error {
    Error::input("no ray of a standard scene reaches a second bounce")
}

fn with_spread(figure: Quartiles) -> String {
    format!("{:8.3} +-{:2.0} %", figure.median, 100.0 * figure.relative_spread())
}

fn median(values: Vec<f64>) -> f64 {
    Quartiles::from_samples(values).map_or(f64::NAN, |figure| figure.median)
}

/// Formats rates in millions, their ratio and the target.
fn rate_row(name: &str, query: &str, native: Quartiles, embree: Quartiles, target: &str) -> String {
    let ratio = native.median / embree.median;
    let [native, embree] = [native, embree].map(|rate| with_spread(rate.scaled(1e-6)));
    format!("{name:<13}{query:<10}{native}  {embree}   {ratio:5.2}{target}\n")
}

/// Second-bounce rays, and the intersector that found their origins.
fn second_bounce<'a>(
    backend_set: &'a BackendSet,
    camera: &[PathRay],
) -> Result<(&'a dyn Accel, Vec<PathRay>)> {
    let (_, accel) = backend_set.backends().next().ok_or_else(no_ray)?;
    let first = rays::secondary(backend_set.spheres(), accel, camera, 0);
    Ok((accel, rays::secondary(backend_set.spheres(), accel, &first, 1)))
}

/// Moves a ray's origin a little forward, so that it has no origin sphere to skip.
fn without_origin_sphere(spheres: &SphereSet, ray: &PathRay) -> PathRay {
    let step = if ray.origin_sphere == NO_SPHERE {
        0.0
    } else {
        1e-3 * spheres.sphere(ray.origin_sphere).radius
    };
    PathRay::new(ray.at(step), ray.direction)
}

/// Seconds taken to resolve all hits exactly: the median of several passes.
fn seconds_per_hit(spheres: &SphereSet, accel: &dyn Accel, second_bounce_rays: &[PathRay]) -> f64 {
    let queries: Vec<Ray> = second_bounce_rays.iter().map(|ray| spheres.to_query(ray)).collect();
    let mut hits = vec![Hit::MISS; queries.len()];
    accel.closest(&queries, &mut hits);
    let pass = |_| {
        let start = Instant::now();
        for (ray, hit) in second_bounce_rays.iter().zip(&hits) {
            black_box(spheres.resolve_hit(ray, *hit));
        }
        start.elapsed().as_secs_f64() / second_bounce_rays.len() as f64
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
    let file = read_text("generated.toml", &scene_text(&recipe, &table, false), folder, &[])?;
    Ok((file.description, file.settings))
}
