//! Options for the scene file, its overrides and the machine's resources.

use std::path::PathBuf;

use clap::Args;

use crate::scene::Override;

use super::values::threads;

/// Which scene, and how much of the machine.
#[derive(Args, Debug)]
pub struct SceneArgs {
    /// The scene file; for render, trace and crosscheck, - is the standard input
    #[arg(value_name = "SCENE")]
    pub path: PathBuf,

    #[command(flatten)]
    pub options: SceneOptions,
}

/// What is changed in the scene, and how much of the machine is used.
#[derive(Args, Debug)]
pub struct SceneOptions {
    /// Set any key of the scene, such as materials.grass.albedo=[0.1,0.5,0.1]; may be repeated
    #[arg(long, value_name = "KEY=VALUE", value_parser = setting)]
    set: Vec<Override>,

    /// Threads to use [default: all cores that affinity and CPU quota allow];
    /// pictures do not depend on it
    #[arg(long, value_name = "T", value_parser = threads())]
    threads: Option<usize>,
}

impl SceneArgs {
    /// Returns the requested number of threads.
    pub fn threads(&self) -> Option<usize> {
        self.options.threads()
    }

    /// Returns the overrides from `--set`.
    pub fn overrides(&self) -> Vec<Override> {
        self.options.overrides()
    }
}

impl SceneOptions {
    /// Returns the requested number of threads.
    pub fn threads(&self) -> Option<usize> {
        self.threads
    }

    /// Returns the overrides from `--set`.
    pub fn overrides(&self) -> Vec<Override> {
        self.set.clone()
    }
}

/// Parses `KEY=VALUE`.
fn setting(text: &str) -> Result<Override, String> {
    match text.split_once('=').map(|(key, value)| (key.trim(), value.trim())) {
        Some((key, value)) if !key.is_empty() => {
            Ok(Override::new(key, value).with_option(["--set", &format!("{key}={value}")]))
        }
        _ => Err("expected KEY=VALUE, such as render.seed=7".to_owned()),
    }
}
