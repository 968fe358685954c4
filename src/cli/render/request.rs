//! What a render is asked for, by options or by a checkpoint.

use std::path::PathBuf;

use crate::accel::BackendChoice;
use crate::error::{Error, Result};
use crate::image_io::FileFormat;
use crate::job::{CheckpointHeader, FilePath, Job, OutputSpec};
use crate::scene::Override;

use super::super::args::RenderArgs;
use super::super::outputs::is_stdout;

/// A render to execute, as the options or a checkpoint specify it.
pub(in crate::cli) struct RenderRequest {
    pub(in crate::cli) scene: PathBuf,
    pub(in crate::cli) overrides: Vec<Override>,
    pub(in crate::cli) memory_limit: Option<u64>,
    /// What to render, and how.
    pub(in crate::cli) job: Job,
    /// True if the settings come from the scene file, false if they come from `job`.
    pub(in crate::cli) has_settings_of_file: bool,
    /// Samples per pixel, overriding the scene file.
    pub(in crate::cli) samples_per_pixel: Option<u32>,
    /// True if `samples_per_pixel` exceeds the number of the original render.
    pub(in crate::cli) is_extended: bool,
    pub(in crate::cli) delivery: OutputSpec,
    /// The requested format of the standard output.
    pub(in crate::cli) stdout_format: Option<FileFormat>,
    pub(in crate::cli) layers_given: bool,
    /// The checkpoint file.
    pub(in crate::cli) checkpoint: Option<PathBuf>,
    /// True if the render continues without viewers that cannot be reached.
    pub(in crate::cli) is_resumed: bool,
    pub(in crate::cli) quiet: bool,
    pub(in crate::cli) json: bool,
}

impl RenderArgs {
    /// Returns the render that the options ask for.
    pub(in crate::cli) fn request(&self) -> RenderRequest {
        let job = Job {
            samples: self.samples.clone(),
            until: self.stop.stop_criteria(),
            layers: self.output.kinds(),
            accel: self.accel.choice,
            quality: self.accel.build.quality,
            threads: self.scene.threads().unwrap_or(0),
            ..Job::default()
        };
        let delivery = OutputSpec {
            save_every: self.keep.checkpoint_every,
            preview: self.watch.preview.clone().map(FilePath),
            preview_every: self.watch.preview_every,
            tev: self.watch.tev.clone(),
            ..self.output.output_spec()
        };
        RenderRequest {
            scene: self.scene.path.clone(),
            overrides: self.overrides(),
            has_settings_of_file: true,
            memory_limit: self.memory.limit,
            job,
            samples_per_pixel: None,
            is_extended: false,
            delivery,
            stdout_format: self.stdout.format,
            layers_given: self.output.has_layers(),
            checkpoint: self.keep.checkpoint.clone(),
            is_resumed: false,
            quiet: self.quiet,
            json: self.json,
        }
    }
}

impl RenderRequest {
    /// Returns the render that a checkpoint belongs to, of this scene file.
    pub(in crate::cli) fn of_header(
        header: &CheckpointHeader,
        scene: PathBuf,
        delivery: OutputSpec,
    ) -> Self {
        let overrides = header.source.iter().flat_map(|source| &source.overrides);
        Self {
            scene,
            overrides: overrides.map(Override::from_pair).collect(),
            memory_limit: None,
            // Keep the intersector: on another machine the automatic choice may differ.
            job: Job {
                accel: BackendChoice::Only(header.metadata.intersector.backend),
                ..header.job.clone()
            },
            has_settings_of_file: false,
            samples_per_pixel: Some(header.job.settings.render.samples_per_pixel),
            is_extended: false,
            delivery,
            stdout_format: None,
            layers_given: false,
            checkpoint: None,
            is_resumed: true,
            quiet: false,
            json: false,
        }
    }

    /// Refuses a picture and the figures of its render in one stream.
    pub(in crate::cli) fn check_stdout(&self) -> Result<()> {
        let has_picture = self.delivery.files.iter().any(|FilePath(file)| is_stdout(file));
        if !(has_picture && self.json) {
            return Ok(());
        }
        Err(Error::input("`-o -` and `--json` both write to the standard output")
            .with_help("write the picture into a file"))
    }
}
