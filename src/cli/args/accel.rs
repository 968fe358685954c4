//! Options that choose intersectors.

use clap::Args;
use clap::builder::{PossibleValue, TypedValueParser};

use crate::accel::{Backend, BackendChoice, BuildQuality};

use super::values::{explained, one_of};

/// Which intersector, and how it is built.
#[derive(Args, Debug)]
pub struct AccelArg {
    /// The intersector
    #[arg(long = "accel", value_name = "NAME", default_value = BackendChoice::Auto.name())]
    #[arg(value_parser = choices())]
    pub choice: BackendChoice,

    #[command(flatten)]
    pub build: BuildArg,
}

/// How an intersector is built.
#[derive(Args, Debug)]
pub struct BuildArg {
    /// How to build the tree of the native intersector
    #[arg(id = "build", long, value_name = "HOW", default_value = BuildQuality::default().name())]
    #[arg(value_parser = one_of(explained(care)))]
    pub quality: BuildQuality,
}

/// Which intersectors.
#[derive(Args, Debug)]
pub struct AccelsArg {
    /// Use only this intersector; may be repeated [default: all]
    #[arg(long = "accel", value_name = "NAME", value_parser = backends())]
    chosen: Vec<Backend>,
}

impl AccelsArg {
    /// Returns the requested intersectors, or all of this build.
    pub fn backends(&self) -> &[Backend] {
        if self.chosen.is_empty() { Backend::AVAILABLE } else { &self.chosen }
    }
}

/// Parses the name of one intersector.
pub fn backends() -> impl TypedValueParser<Value = Backend> {
    one_of(named_backends())
}

fn choices() -> impl TypedValueParser<Value = BackendChoice> {
    let auto = PossibleValue::new(BackendChoice::Auto.name())
        .help("the fastest for this scene and processor");
    let others = named_backends().map(|(name, backend)| (name, BackendChoice::Only(backend)));
    one_of([(auto, BackendChoice::Auto)].into_iter().chain(others))
}

/// Lists the intersectors that can be named. Those missing from this build are hidden in `--help`.
fn named_backends() -> impl Iterator<Item = (PossibleValue, Backend)> {
    let hidden = |backend| !Backend::AVAILABLE.contains(&backend);
    explained(meaning).map(move |(name, backend)| (name.hide(hidden(backend)), backend))
}

fn care(quality: BuildQuality) -> &'static str {
    match quality {
        BuildQuality::Best => "fastest to trace",
        BuildQuality::Fast => "fastest to build, for previews of very many spheres",
    }
}

fn meaning(backend: Backend) -> &'static str {
    match backend {
        Backend::Embree => "Embree, with its sphere points",
        Backend::EmbreeUser => "Embree, with spheres as user geometry",
        Backend::Native => "photosphere's own bounding volume hierarchy",
        Backend::BruteForce => "every ray against every sphere, in f64; for tiny scenes",
    }
}
