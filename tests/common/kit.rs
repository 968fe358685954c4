//! Scenes for tests, built from values.
#![allow(dead_code, reason = "each test file uses its own part")]

use std::path::Path;

use photosphere::accel::{Backend, BuildOptions, Cancel};
use photosphere::film::{Kind, Picture};
use photosphere::job::{Rendered, render};
use photosphere::scene::settings::Integrator;
use photosphere::scene::{Builder, Override, Settings, Shot, read_file};
pub(crate) use photosphere::verify::statistics::Estimate;

/// Independent seeds behind every standard error.
pub(crate) const SEEDS: u64 = 32;
/// The probability with which a right program fails one comparison.
pub(crate) const SIGNIFICANCE: f64 = 4e-4;
/// Standard errors that a mean of so many seeds may be off: Student's t at that significance.
pub(crate) const ALLOWED: f64 = 4.0;

/// A scene and how it is rendered, both open to be changed.
#[derive(Clone, Debug, Default)]
pub(crate) struct Kit {
    pub(crate) scene: Builder,
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
            .map(|(key, value)| Override::of(&(key.to_owned(), value.to_owned())))
            .collect();
        let file = read_file(&path, &overrides).unwrap_or_else(|e| panic!("{e}"));
        Self { scene: Builder { description: file.description }, settings: file.settings }
    }

    /// With something changed.
    pub(crate) fn with(mut self, change: impl FnOnce(&mut Self)) -> Self {
        change(&mut self);
        self
    }

    /// With another integrator.
    pub(crate) fn integrator(mut self, integrator: Integrator) -> Self {
        self.settings.render.integrator = integrator;
        self
    }

    pub(crate) fn shot(&self) -> Shot {
        let scene = self.scene.build().unwrap_or_else(|e| panic!("{e}"));
        Shot::new(&scene, self.settings).unwrap_or_else(|e| panic!("{e}"))
    }

    /// Renders with the brute-force backend.
    pub(crate) fn picture(&self) -> Picture {
        rendered(&self.shot(), Backend::BruteForce).picture
    }

    /// The mean of the picture's green channel, over seeds.
    pub(crate) fn estimate(&self, backend: Backend) -> Estimate {
        // One shot: what its materials prepare takes longer than a small picture.
        let mut shot = self.shot();
        let value = |seed: u64| {
            shot.set_seed(seed);
            rendered(&shot, backend).picture.mean().y
        };
        Estimate::of(&(0..SEEDS).map(value).collect::<Vec<_>>())
    }
}

/// Renders with a backend on the current thread pool.
pub(crate) fn rendered(shot: &Shot, backend: Backend) -> Rendered {
    let build = BuildOptions { threads: rayon::current_num_threads(), ..Default::default() };
    let accel = backend.build(shot.scene().spheres(), &build).expect("builds");
    render(shot, &*accel, &Kind::USUAL, &Cancel::default()).expect("a small film")
}

/// An estimate, and what it must be.
pub(crate) trait Judged {
    /// Fails unless the mean is the expected value, as far as can be told.
    fn must_be(self, expected: f64, what: &str);
    /// Fails unless both means agree, as far as can be told.
    fn must_agree(self, other: Self, what: &str);
}

impl Judged for Estimate {
    #[allow(clippy::print_stdout, reason = "the figures are worth reading with --nocapture")]
    fn must_be(self, expected: f64, what: &str) {
        let p = self.p_value(expected);
        println!("{what}: {:.6} +- {:.6}, expected {expected:.6}", self.mean, self.standard_error);
        assert!(p >= SIGNIFICANCE, "{what}: {self:?} is not {expected}, p = {p:.1e}");
    }

    fn must_agree(self, other: Self, what: &str) {
        let p = self.p_value_against(&other);
        assert!(p >= SIGNIFICANCE, "{what}: {self:?} is not {other:?}, p = {p:.1e}");
    }
}
