//! Renders small scenes, and judges their means.
#![allow(dead_code, reason = "each test file uses its own part")]

use std::path::Path;

use photosphere::accel::{Backend, BuildOptions};
use photosphere::film::Picture;
use photosphere::render::{Outcome, RenderOptions, render};
use photosphere::scene::{Override, Scene, read_text};
pub(crate) use photosphere::verify::statistics::Estimate;

/// Independent seeds behind every standard error.
pub(crate) const SEEDS: u64 = 32;
/// The probability with which a right program fails one comparison.
pub(crate) const SIGNIFICANCE: f64 = 4e-4;
/// Standard errors that a mean of so many seeds may be off: Student's t at that significance.
pub(crate) const ALLOWED: f64 = 4.0;

/// A scene from its text and `key=value` overrides.
pub(crate) fn scene(text: &str, overrides: &[&str]) -> Scene {
    let overrides: Vec<Override> = overrides.iter().map(|pair| set(pair)).collect();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/paper");
    let loaded = read_text("test.toml", text, &folder, &overrides);
    Scene::new(loaded.unwrap_or_else(|e| panic!("{e}"))).expect("few spheres")
}

/// The text of a scene file of the repository.
pub(crate) fn scene_file(path: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(path);
    std::fs::read_to_string(path).expect("a scene of the repository")
}

fn set(pair: &str) -> Override {
    let (key, value) = pair.split_once('=').expect("key=value");
    Override { option: format!("--set {pair}"), key: key.into(), value: value.into() }
}

/// Renders with a backend on the current thread pool.
pub(crate) fn outcome(scene: &Scene, backend: Backend) -> Outcome {
    let build = BuildOptions { threads: rayon::current_num_threads(), ..Default::default() };
    let accel = backend.build(scene.spheres(), &build).expect("builds");
    let options = RenderOptions { cancel: Default::default(), progress: &|_| {} };
    render(scene, &*accel, &options).expect("a small film")
}

/// Renders with the brute-force backend.
pub(crate) fn picture(text: &str, overrides: &[&str]) -> Picture {
    outcome(&scene(text, overrides), Backend::BruteForce).picture
}

/// An estimate from the renders of a scene, and what it must be.
pub(crate) trait Rendered: Sized {
    /// The mean of the picture's green channel, over seeds.
    fn of_scene(text: &str, overrides: &[&str], backend: Backend) -> Self;
    /// Fails unless the mean is the expected value, as far as can be told.
    fn must_be(self, expected: f64, what: &str);
    /// Fails unless both means agree, as far as can be told.
    fn must_agree(self, other: Self, what: &str);
}

impl Rendered for Estimate {
    fn of_scene(text: &str, overrides: &[&str], backend: Backend) -> Self {
        // One scene: what its materials prepare takes longer than a small picture.
        let mut scene = scene(text, overrides);
        let value = |seed: u64| {
            scene.set_seed(seed);
            outcome(&scene, backend).picture.mean().y
        };
        Self::of(&(0..SEEDS).map(value).collect::<Vec<_>>())
    }

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
