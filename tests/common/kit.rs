//! Scenes for tests, built from values.
#![allow(dead_code, reason = "each test file uses its own part")]

use std::path::Path;

use photosphere::accel::{Accel, Backend, BuildOptions};
use photosphere::color::Rgb;
use photosphere::film::Aov;
use photosphere::image_io::Picture;
use photosphere::job::{RenderedImage, render_with_accel};
use photosphere::scene::description::{MaterialDescription, SurfaceModel};
use photosphere::scene::settings::{IntegratorSettings, PaperSettings, SamplerKind};
use photosphere::scene::{Override, PreparedScene, SceneBuilder, Settings, read_file};
use photosphere::task::CancelToken;
pub(crate) use photosphere::verify::statistics::MeanEstimate;

/// Independent seeds behind every standard error.
pub(crate) const SEEDS: u64 = 32;
/// The probability with which a right program fails one comparison.
pub(crate) const SIGNIFICANCE: f64 = 4e-4;
/// Standard errors that a mean of so many seeds may be off: Student's t at that significance.
pub(crate) const ALLOWED: f64 = 4.0;

/// A scene and how it is rendered, both open to be changed.
#[derive(Clone, Debug, Default)]
pub(crate) struct Kit {
    pub(crate) scene: SceneBuilder,
    pub(crate) settings: Settings,
}

impl Kit {
    /// Nothing to be seen, in a picture of this size with this many samples of each pixel.
    pub(crate) fn new(width: u32, height: u32, samples: u32) -> Self {
        let mut kit = Self::default();
        (kit.settings.image.width, kit.settings.image.height) = (width, height);
        kit.settings.render.samples_per_pixel = samples;
        kit
    }

    /// A scene file of the repository with `key=value` overrides; its tables become a part of it.
    pub(crate) fn of_file(path: &str, overrides: &[&str]) -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(path);
        let overrides: Vec<Override> = overrides
            .iter()
            .map(|pair| pair.split_once('=').expect("key=value"))
            .map(|(key, value)| Override::new(key, value))
            .collect();
        let file = read_file(&path, &overrides).unwrap_or_else(|e| panic!("{e}"));
        Self { scene: SceneBuilder::from(file.description), settings: file.settings }
    }

    /// With something changed.
    pub(crate) fn with(mut self, change: impl FnOnce(&mut Self)) -> Self {
        change(&mut self);
        self
    }

    /// With another integrator.
    pub(crate) fn integrator(mut self, integrator: IntegratorSettings) -> Self {
        self.settings.render.integrator = integrator;
        self
    }

    /// With the paper's integrator, fed with independent numbers as in its figures. The samples of
    /// a pixel stay, and its sub-pixels share them.
    pub(crate) fn paper(mut self, paper: PaperSettings) -> Self {
        self.settings.render.sampler = SamplerKind::Independent;
        let samples = self.settings.render.samples_per_pixel;
        self.integrator(IntegratorSettings::Paper(paper)).samples(samples)
    }

    /// With so many samples of each pixel.
    pub(crate) fn samples(mut self, samples: u32) -> Self {
        let render = &mut self.settings.render;
        render.samples_per_pixel = samples;
        if let IntegratorSettings::Paper(paper) = &mut render.integrator {
            paper.samples = samples / paper.subpixels.pow(2);
        }
        self
    }

    /// With the longest path so long.
    pub(crate) fn depth(mut self, edges: u32) -> Self {
        self.settings.render.max_depth = Some(edges);
        self
    }

    /// With paths traced by the two integrators that solve the whole equation: `path` and `paper`.
    pub(crate) fn both_ways(self) -> [Self; 2] {
        [self.clone().integrator(IntegratorSettings::Path), self.paper(PaperSettings::default())]
    }

    /// Adds a sphere with a material of its own.
    pub(crate) fn ball(
        &mut self,
        center: [f64; 3],
        radius: f64,
        surface: SurfaceModel,
    ) -> &mut Self {
        self.glowing_ball(center, radius, surface, 0.0)
    }

    /// Adds a sphere with a material of its own, which sends out this radiance.
    pub(crate) fn glowing_ball(
        &mut self,
        center: [f64; 3],
        radius: f64,
        surface: SurfaceModel,
        emission: f32,
    ) -> &mut Self {
        let emission = Rgb::splat(emission);
        let material = self.scene.material(MaterialDescription {
            surface,
            emission,
            ..MaterialDescription::default()
        });
        self.scene.sphere(material, center, radius);
        self
    }

    /// The material of the ball that was added as the n-th, counted from 0.
    pub(crate) fn material(&mut self, ball: usize) -> &mut MaterialDescription {
        let description = &mut self.scene.description;
        &mut description.materials[description.spheres[ball].material]
    }

    /// What it is rendered by, for messages.
    pub(crate) fn how(&self) -> String {
        format!("{:?}", self.settings.render.integrator)
    }

    pub(crate) fn prepared(&self) -> PreparedScene {
        let scene = self.scene.build().unwrap_or_else(|e| panic!("{e}"));
        PreparedScene::new(&scene, self.settings).unwrap_or_else(|e| panic!("{e}"))
    }

    /// Renders with the brute-force backend.
    pub(crate) fn picture(&self) -> Picture {
        rendered(&self.prepared(), Backend::BruteForce).picture
    }

    /// The picture with each of the seeds.
    pub(crate) fn pictures(&self, backend: Backend) -> impl Iterator<Item = Picture> {
        // One shot: what its materials prepare takes longer than a small picture.
        let mut prepared = self.prepared();
        (0..SEEDS).map(move |seed| {
            prepared.set_seed(seed);
            rendered(&prepared, backend).picture
        })
    }

    /// The mean of the picture's green channel, over seeds.
    pub(crate) fn estimate(&self, backend: Backend) -> MeanEstimate {
        let means = self.pictures(backend).map(|picture| picture.mean().y);
        MeanEstimate::from_values(&means.collect::<Vec<_>>())
    }

    /// The mean of the picture's green channel by brute force, for scenes of few spheres.
    pub(crate) fn mean(&self) -> MeanEstimate {
        self.estimate(Backend::BruteForce)
    }
}

/// Lambert's surface, grey.
pub(crate) const fn diffuse(albedo: f32) -> SurfaceModel {
    SurfaceModel::Diffuse { albedo: Rgb::splat(albedo), roughness: 0.0 }
}

/// A grey mirror.
pub(crate) const fn mirror(reflectance: f32) -> SurfaceModel {
    SurfaceModel::Mirror { reflectance: Rgb::splat(reflectance) }
}

/// Clear glass.
pub(crate) const fn glass(ior: f64) -> SurfaceModel {
    rough_glass(ior, 0.0)
}

/// Clear glass, smooth at 0 and rough at 1.
pub(crate) const fn rough_glass(ior: f64, roughness: f64) -> SurfaceModel {
    SurfaceModel::Dielectric { ior, roughness, priority: 0, absorption: Rgb::ZERO }
}

/// Phong's surface, scaled to conserve energy or as Phong wrote it, grey.
pub(crate) const fn phong(
    [albedo, specular]: [f32; 2],
    exponent: f64,
    normalized: bool,
) -> SurfaceModel {
    let [albedo, specular] = [Rgb::splat(albedo), Rgb::splat(specular)];
    SurfaceModel::Phong { albedo, specular, exponent, normalized }
}

/// A backend over the spheres of a shot, built on the current thread pool.
pub(crate) fn built(prepared: &PreparedScene, backend: Backend) -> Box<dyn Accel> {
    let options = BuildOptions { threads: rayon::current_num_threads(), ..Default::default() };
    backend.build(prepared.scene().spheres(), &options).expect("builds")
}

/// Renders with a backend on the current thread pool.
pub(crate) fn rendered(prepared: &PreparedScene, backend: Backend) -> RenderedImage {
    let accel = built(prepared, backend);
    render_with_accel(prepared, &*accel, &Aov::DEFAULT, &CancelToken::default())
        .expect("a small film")
}

/// An estimate, and what it must be.
pub(crate) trait Judged {
    /// Fails unless the mean is the expected value, as far as can be told.
    fn must_be(self, expected: f64, what: &str);
    /// Fails unless both means agree, as far as can be told.
    fn must_agree(self, other: Self, what: &str);
}

impl Judged for MeanEstimate {
    #[allow(clippy::print_stdout, reason = "the figures are worth reading with --nocapture")]
    fn must_be(self, expected: f64, what: &str) {
        let p = self.p_value(expected);
        println!("{what}: {:.6} +- {:.6}, expected {expected:.6}", self.mean, self.standard_error);
        assert!(p >= SIGNIFICANCE, "{what}: {self:?} is not {expected}, p = {p:.1e}");
    }

    fn must_agree(self, other: Self, what: &str) {
        let p = self.welch_p_value(&other);
        assert!(p >= SIGNIFICANCE, "{what}: {self:?} is not {other:?}, p = {p:.1e}");
    }
}
