//! What a render is asked to do, by options or by a checkpoint.

use std::path::{Path, PathBuf};

use crate::accel::BackendChoice;
use crate::cli::args::RenderArgs;
use crate::cli::outputs::{is_part, is_stdout};
use crate::cli::scene_file::STANDARD_INPUT;
use crate::error::{Error, Result};
use crate::film::Aov;
use crate::image_io::FileFormat;
use crate::job::{CheckpointHeader, FilePath, Job, OutputSpec, Quality};
use crate::scene::{Override, SceneSource};
use crate::studio::StudioOptions;

/// The quality of a picture of a particle file.
const USUAL_QUALITY: Quality = Quality::Good;

/// The most samples per pixel that a good picture may take.
const GOOD_SAMPLES: u32 = 1024;

/// A render to execute, as the options or a checkpoint specify it.
#[derive(Clone)]
pub(in crate::cli) struct RenderRequest {
    pub(in crate::cli) scene: PathBuf,
    pub(in crate::cli) overrides: Vec<Override>,
    /// How a particle file is framed and lit.
    pub(in crate::cli) studio: StudioOptions,
    /// The text of a scene that no file holds, of a particle file.
    pub(in crate::cli) scene_text: Option<SceneSource>,
    pub(in crate::cli) memory_limit: Option<u64>,
    /// What to render, and how.
    pub(in crate::cli) job: Job,
    /// True if the noise target is that of particle files, which nobody asked for.
    pub(in crate::cli) has_default_noise: bool,
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

impl RenderRequest {
    /// Returns the render that the options of `photosphere render` ask for.
    pub(in crate::cli) fn of_args(args: &RenderArgs) -> Self {
        let job = Job {
            samples: args.samples.clone(),
            until: args.stop.stop_criteria(args.output.look()),
            layers: args.output.kinds(),
            accel: args.accel.choice,
            quality: args.accel.build.quality,
            threads: args.scene.threads().unwrap_or(0),
            ..Job::default()
        };
        let delivery = OutputSpec {
            save_every: args.keep.checkpoint_every,
            preview: args.watch.preview.clone().map(FilePath),
            preview_every: args.watch.preview_every,
            tev: args.watch.tev.clone(),
            overlay: args.overlay.choice(),
            denoise: args.denoise,
            ..args.output.output_spec()
        };
        Self {
            scene: args.scene.path.clone(),
            overrides: args.overrides(),
            studio: args.studio.options(),
            scene_text: None,
            has_default_noise: false,
            has_settings_of_file: true,
            memory_limit: args.memory.limit,
            job,
            samples_per_pixel: None,
            is_extended: false,
            delivery,
            stdout_format: args.stdout.format,
            layers_given: args.output.has_layers(),
            checkpoint: args.keep.checkpoint.clone(),
            is_resumed: false,
            quiet: args.quiet,
            json: args.json,
        }
    }

    /// Renders until the picture is good, if no option says when to stop and nothing else decides.
    #[must_use]
    pub(in crate::cli) fn until_good(mut self) -> Self {
        const DECIDING: [&str; 3] =
            ["render.samples_per_pixel", "render.integrator", "render.sampler"];
        let is_deciding = |given: &Override| DECIDING.contains(&&*given.key);
        let until = &mut self.job.until;
        if until.noise.is_some()
            || until.time.is_some()
            || self.job.samples.is_some()
            || self.overrides.iter().any(is_deciding)
        {
            return self;
        }
        until.noise = Some(USUAL_QUALITY.target(self.delivery.look));
        self.has_default_noise = true;
        self.overrides.push(Override::new(DECIDING[0], GOOD_SAMPLES.to_string()));
        self
    }

    /// Renders the layers that guide a denoiser, too.
    #[must_use]
    pub(in crate::cli) fn guided(mut self) -> Self {
        let layers = &mut self.job.layers;
        let missing = Aov::DENOISING.into_iter().filter(|aov| !layers.contains(aov));
        let missing: Vec<Aov> = missing.collect();
        layers.extend(missing);
        self
    }

    /// The options that would say what [`Self::until_good`] chose.
    pub(in crate::cli) fn default_choices(&self) -> Vec<(&'static str, String)> {
        match self.has_default_noise {
            true => {
                let quality = USUAL_QUALITY.name().to_owned();
                vec![("quality", quality), ("max-spp", GOOD_SAMPLES.to_string())]
            }
            false => Vec::new(),
        }
    }

    /// Returns the render that a checkpoint belongs to, of this scene file.
    pub(in crate::cli) fn of_header(
        header: &CheckpointHeader,
        scene: PathBuf,
        delivery: OutputSpec,
    ) -> Self {
        let overrides = header.source.iter().flat_map(|source| &source.overrides);
        let overrides = overrides.map(|(key, value)| Override::new(key, value));
        Self {
            scene,
            overrides: overrides.collect(),
            studio: StudioOptions::default(),
            scene_text: scene_text(header),
            memory_limit: None,
            // Keep the intersector: on another machine the automatic choice may differ.
            job: Job {
                accel: BackendChoice::Only(header.metadata.intersector),
                ..header.job.clone()
            },
            has_default_noise: false,
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

    /// Returns the output paths, each with its option. A `.part` file named by both `-o` and
    /// `--checkpoint` counts once.
    pub(in crate::cli) fn output_paths(&self) -> Vec<(&'static str, &Path)> {
        let OutputSpec { files, preview, .. } = &self.delivery;
        let named = files.iter().map(|FilePath(file)| ("-o", file.as_path()));
        let checkpoint = self.checkpoint.as_deref().map(|file| ("--checkpoint", file));
        let is_part =
            |file: &&Path| files.iter().any(|FilePath(part)| part == file && is_part(part));
        let checkpoint = checkpoint.filter(|(_, file)| !is_part(file));
        let preview = preview.as_ref().map(|FilePath(file)| ("--preview", file.as_path()));
        named.chain(checkpoint).chain(preview).collect()
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

/// The scene of a checkpoint of a particle file: its text is in the checkpoint. One from the
/// standard input has to be named, because the files that it names may be anywhere.
pub(in crate::cli) fn scene_text(header: &CheckpointHeader) -> Option<SceneSource> {
    let is_composed =
        |source: &&SceneSource| source.file.is_none() && source.name != STANDARD_INPUT;
    let source = header.source.as_ref().filter(is_composed)?;
    let text = header.metadata.run.as_ref()?.scene_text.clone()?;
    Some(SceneSource { text: Some(text), ..source.clone() })
}
