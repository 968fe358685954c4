//! `photosphere render`: renders a scene to picture files. `resume` uses this module, too.

mod finish;
mod report;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::accel::BackendChoice;
use crate::error::{Error, Result};
use crate::geometry::SphereSet;
use crate::image_io::AtomicFile;
use crate::job::{
    Checkpoint, CheckpointHeader, FilePath, Job, OutputSpec, Session, SessionOptions,
    UNLIMITED_SAMPLES,
};
use crate::scene::{Override, Scene, Settings, read_file};

use super::args::RenderArgs;
use super::exit::Exit;
use super::interrupt::Interrupt;
use super::memory::MemoryNeeds;
use super::outputs::{self, Outputs, is_part};
use super::progress::{self, ProgressDisplay};
use super::system::on_threads;
use super::watch::Viewers;
use super::{interrupt, memory, print, system};

use finish::RenderFinisher;
use report::Times;

/// A render to execute, as the options or a checkpoint specify it.
pub(super) struct RenderRequest {
    pub(super) scene: PathBuf,
    pub(super) overrides: Vec<Override>,
    pub(super) memory_limit: Option<u64>,
    /// What to render, and how.
    pub(super) job: Job,
    /// True if the settings come from the scene file, false if they come from `job`.
    pub(super) has_settings_of_file: bool,
    /// Samples per pixel, overriding the scene file.
    pub(super) samples_per_pixel: Option<u32>,
    /// True if `samples_per_pixel` exceeds the number of the original render.
    pub(super) is_extended: bool,
    pub(super) delivery: OutputSpec,
    pub(super) layers_given: bool,
    /// The checkpoint file.
    pub(super) checkpoint: Option<PathBuf>,
    /// True if the render continues without viewers that cannot be reached.
    pub(super) is_resumed: bool,
    pub(super) quiet: bool,
    pub(super) json: bool,
}

/// The checkpoint file, ready to be written.
struct CheckpointTarget {
    path: PathBuf,
    file: AtomicFile,
}

/// Runs the command.
///
/// # Errors
/// Any error between the scene and the picture. The output paths are checked first.
pub(super) fn run(args: &RenderArgs) -> Result<Exit> {
    execute(&args.request())
}

/// Executes a render.
///
/// # Errors
/// See [`run`].
pub(super) fn execute(request: &RenderRequest) -> Result<Exit> {
    outputs::refuse_duplicate_paths(&places(request))?;
    let outputs = Outputs::new(&request.delivery, &request.job.layers, request.layers_given)?;
    let keep = CheckpointTarget::new(request, &outputs)?;
    let name = outputs::in_words(&outputs::paths(&request.delivery.files));
    let viewers = Viewers::new(&request.delivery, name, request.is_resumed)?;
    let interrupt = interrupt::listen();
    let mut clock = Clock(Instant::now());
    let threads = (request.job.threads > 0).then_some(request.job.threads);
    let (scene, settings) = on_threads(threads, || load(request))?;
    let load_s = clock.lap();
    let about_spheres = about_spheres(scene.spheres());
    about_spheres.iter().for_each(print::warning);

    let session = open(request, &scene, settings, keep.as_ref(), &interrupt)?;
    let times = Times { load_s, build_s: session.build_seconds() };
    let progress = ProgressDisplay::new(request.quiet);
    interrupt.enable_saving();
    let finish = RenderFinisher {
        request,
        session: &session,
        outputs: &outputs,
        keep: keep.as_ref(),
        interrupt: &interrupt,
        progress: &progress,
        times,
        about_spheres,
    };
    viewers.run_alongside(&session, &interrupt, |last_look| {
        let began = Instant::now();
        let reached = session.run(&progress);
        progress.finish();
        finish.close(&reached?, began.elapsed().as_secs_f64(), last_look)
    })
}

/// Loads the scene and its settings, if they fit into memory.
fn load(request: &RenderRequest) -> Result<(Scene, Settings)> {
    let mut file = read_file(&request.scene, &request.overrides)?;
    if !request.has_settings_of_file {
        file.settings = request.job.settings;
    }
    // Duplicate spheres are still counted here.
    let chosen = request.job.accel.select_for_count(file.sphere_count() as usize);
    let needs = MemoryNeeds { backends: &[chosen.backend], kinds: &request.job.layers, besides: 0 };
    memory::check(&file, &needs, request.memory_limit)?;
    file.build()
}

/// Opens the render session, with the samples of the checkpoint if there are any.
fn open(
    request: &RenderRequest,
    scene: &Scene,
    settings: Settings,
    keep: Option<&CheckpointTarget>,
    interrupt: &Interrupt,
) -> Result<Session> {
    let mut job = Job { settings, ..request.job.clone() };
    if let Some(samples) = request.samples_per_pixel {
        job.set_samples_per_pixel(samples);
        if request.is_extended {
            job.samples =
                job.samples.map(|samples| samples.start..job.settings.render.samples_per_pixel);
        }
    }
    let opening = SessionOptions {
        cancel: interrupt.cancel(),
        save_request: interrupt.save_request(),
        build_progress: progress::build_progress(request.quiet),
        output: Some(from_the_root(&request.delivery)),
        command: Some(system::command_line()),
    };
    let keep_every = request.delivery.save_every;
    let Some(keep) = keep else { return Session::new(scene, job, opening) };
    let mut session = match keep.path.exists() {
        false => Session::new(scene, job, opening)?,
        true => {
            let session = Session::resume(scene, job, Checkpoint::open(&keep.path)?, opening)?;
            if !request.quiet {
                tell_of_samples(&session, &keep.path);
            }
            session
        }
    };
    session.autosave(keep.file.clone(), keep_every);
    Ok(session)
}

/// Returns the outputs with absolute paths: a checkpoint may be resumed in another folder.
fn from_the_root(delivery: &OutputSpec) -> OutputSpec {
    let absolute = |FilePath(file): &FilePath| {
        FilePath(std::path::absolute(file).unwrap_or_else(|_| file.clone()))
    };
    OutputSpec {
        files: delivery.files.iter().map(absolute).collect(),
        preview: delivery.preview.as_ref().map(absolute),
        ..delivery.clone()
    }
}

fn tell_of_samples(session: &Session, path: &Path) {
    let film = session.film();
    let each = film.sample_count() as f64 / film.frame().pixel_count() as f64;
    let all = match session.job().settings.render.samples_per_pixel {
        UNLIMITED_SAMPLES => String::new(),
        _ => format!(" of {}", session.samples().len()),
    };
    let path = path.display();
    print::note(format_args!("resuming `{path}`: {each:.1}{all} samples per pixel"));
}

impl RenderArgs {
    fn request(&self) -> RenderRequest {
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
            layers_given: self.output.has_layers(),
            checkpoint: self.keep.checkpoint.clone(),
            is_resumed: false,
            quiet: self.quiet,
            json: self.json,
        }
    }
}

impl RenderRequest {
    /// Returns the render that a checkpoint belongs to, or `None` if the checkpoint names no scene.
    pub(super) fn of_header(header: &CheckpointHeader, delivery: OutputSpec) -> Option<Self> {
        let source = header.source.as_ref()?;
        Some(Self {
            scene: source.file.clone()?,
            overrides: source.overrides.iter().map(Override::from_pair).collect(),
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
            layers_given: false,
            checkpoint: None,
            is_resumed: true,
            quiet: false,
            json: false,
        })
    }
}

impl CheckpointTarget {
    /// Returns the checkpoint or the requested `.part` file, if there is one.
    fn new(request: &RenderRequest, outputs: &Outputs) -> Result<Option<Self>> {
        let path = match (&request.checkpoint, outputs.part()) {
            (Some(checkpoint), Some(part)) if checkpoint != part => {
                let message = format!(
                    "`{}` is its own checkpoint, so `{}` is not needed",
                    part.display(),
                    checkpoint.display()
                );
                return Err(Error::input(message).with_help("remove --checkpoint"));
            }
            (Some(path), _) => path.clone(),
            (None, Some(path)) => path.to_path_buf(),
            (None, None) => return Ok(None),
        };
        let file = AtomicFile::new(&path)?;
        Ok(Some(Self { path, file }))
    }
}

/// Returns the output paths, each with its option. A `.part` file named by both `-o` and
/// `--checkpoint` counts once.
fn places(request: &RenderRequest) -> Vec<(&'static str, &Path)> {
    let OutputSpec { files, preview, .. } = &request.delivery;
    let named = files.iter().map(|FilePath(file)| ("-o", file.as_path()));
    let checkpoint = request.checkpoint.as_deref().map(|file| ("--checkpoint", file));
    let is_part = |file: &&Path| files.iter().any(|FilePath(part)| part == file && is_part(part));
    let checkpoint = checkpoint.filter(|(_, file)| !is_part(file));
    let preview = preview.as_ref().map(|FilePath(file)| ("--preview", file.as_path()));
    named.chain(checkpoint).chain(preview).collect()
}

/// Returns warnings about duplicate spheres and spheres that f32 cannot represent well.
pub(super) fn about_spheres(spheres: &SphereSet) -> Vec<String> {
    let mut warnings = Vec::new();
    if spheres.duplicates() > 0 {
        warnings.push(format!(
            "{} left out: after rounding to f32 each equals an earlier row",
            print::count(spheres.duplicates(), "sphere"),
        ));
    }
    if spheres.displaced() > 0 {
        warnings.push(format!(
            "rounding to f32 moved {} by more than 1 % of the radius; they are small and far from \
             most others",
            print::count(spheres.displaced(), "sphere"),
        ));
    }
    warnings
}

/// Measures lap times.
struct Clock(Instant);

impl Clock {
    fn lap(&mut self) -> f64 {
        let last = std::mem::replace(&mut self.0, Instant::now());
        Duration::as_secs_f64(&(self.0 - last))
    }
}
