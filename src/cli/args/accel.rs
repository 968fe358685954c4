//! Options about intersectors.

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use crate::accel::{Backend, Choice, Quality};

/// Which intersector, and how it is built.
#[derive(Args, Debug)]
pub(in crate::cli) struct AccelArg {
    /// The intersector
    #[arg(long = "accel", value_name = "NAME", default_value = Choice::Auto.name())]
    #[arg(value_parser = choices())]
    pub(in crate::cli) choice: Choice,

    #[command(flatten)]
    pub(in crate::cli) build: BuildArg,
}

/// How an intersector is built.
#[derive(Args, Debug)]
pub(in crate::cli) struct BuildArg {
    /// How much care the native intersector takes
    #[arg(long = "build", value_name = "HOW", default_value = Quality::default().name())]
    #[arg(value_parser = qualities())]
    pub(in crate::cli) quality: Quality,
}

/// Which intersectors.
#[derive(Args, Debug)]
pub(in crate::cli) struct AccelsArg {
    /// This intersector only; may be repeated. All by default
    #[arg(long = "accel", value_name = "NAME", value_parser = backends())]
    chosen: Vec<Backend>,
}

impl AccelsArg {
    /// Those asked for, or all of this build.
    pub(in crate::cli) fn backends(&self) -> &[Backend] {
        if self.chosen.is_empty() { Backend::AVAILABLE } else { &self.chosen }
    }
}

/// The name of one intersector.
pub(in crate::cli) fn backends() -> impl TypedValueParser<Value = Backend> {
    let possible = Backend::ALL.iter().copied().map(value_of);
    PossibleValuesParser::new(possible).try_map(|name| name.parse::<Backend>())
}

fn choices() -> impl TypedValueParser<Value = Choice> {
    let auto = PossibleValue::new(Choice::Auto.name())
        .help("whatever is fastest for the scene on this processor");
    let possible = Backend::ALL.iter().copied().map(value_of);
    PossibleValuesParser::new([auto].into_iter().chain(possible))
        .try_map(|name| name.parse::<Choice>())
}

fn qualities() -> impl TypedValueParser<Value = Quality> {
    let possible = Quality::ALL.iter().map(|quality| {
        PossibleValue::new(quality.name()).help(match quality {
            Quality::Best => "fastest to trace",
            Quality::Fast => "fastest to build, for previews of very many spheres",
        })
    });
    PossibleValuesParser::new(possible).try_map(|name| name.parse::<Quality>())
}

fn value_of(backend: Backend) -> PossibleValue {
    let meaning = match backend {
        Backend::Embree => "Embree, with spheres as points",
        Backend::EmbreeUser => "Embree, with our own arithmetic for every sphere",
        Backend::Native => "our own bounding volume hierarchy",
        Backend::BruteForce => "every ray against every sphere, in f64; for tiny scenes",
    };
    let is_there = Backend::AVAILABLE.contains(&backend);
    PossibleValue::new(backend.name()).help(meaning).hide(!is_there)
}
