//! Renders small scenes, and judges their means.
#![allow(dead_code, reason = "each test file uses its own part")]

use std::path::Path;

use photosphere::accel::{Backend, BuildOptions};
use photosphere::film::Picture;
use photosphere::render::{Outcome, RenderOptions, render};
use photosphere::scene::{Override, Scene, read_text};

/// Independent seeds behind every standard error.
pub(crate) const SEEDS: u64 = 32;
/// Standard errors that a mean may be off. With Student's t and 31 degrees of freedom a right
/// program fails a check with probability 4e-4.
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

/// A mean over seeds with its standard error.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Estimate {
    pub(crate) mean: f64,
    pub(crate) standard_error: f64,
}

impl Estimate {
    /// From one value per independent seed.
    pub(crate) fn of(values: &[f64]) -> Self {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
        Self { mean, standard_error: (variance / n).sqrt() }
    }

    /// The mean of the picture's green channel, over seeds.
    pub(crate) fn of_scene(text: &str, overrides: &[&str], backend: Backend) -> Self {
        let value = |seed: u64| {
            let seed = format!("render.seed={seed}");
            let overrides: Vec<&str> = overrides.iter().copied().chain([seed.as_str()]).collect();
            outcome(&scene(text, &overrides), backend).picture.mean().y
        };
        Self::of(&(0..SEEDS).map(value).collect::<Vec<_>>())
    }

    #[allow(clippy::print_stdout, reason = "the figures are worth reading with --nocapture")]
    /// Fails unless the mean is the expected value, within the standard errors allowed and 1e-5.
    pub(crate) fn must_be(self, expected: f64, what: &str) {
        let allowed = ALLOWED * self.standard_error + 1e-5 * expected.abs();
        let off = (self.mean - expected).abs();
        println!("{what}: {:.6} +- {:.6}, expected {expected:.6}", self.mean, self.standard_error);
        assert!(
            off <= allowed,
            "{what}: {self:?} is {off:.2e} from {expected}, allowed {allowed:.2e}"
        );
    }

    /// Fails unless both means agree, within the standard errors allowed and 1e-5.
    pub(crate) fn must_agree(self, other: Self, what: &str) {
        let joint = self.standard_error.hypot(other.standard_error);
        Self { mean: self.mean, standard_error: joint }.must_be(other.mean, what);
    }
}
