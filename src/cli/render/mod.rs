//! `photosphere render`: renders a scene to picture files. `resume` uses this module, too.

mod batch;
mod checkpoint;
mod finish;
mod idle;
mod report;
mod request;

use std::path::Path;
use std::time::{Duration, Instant};

use crate::denoise::Denoiser;
use crate::error::{Error, Result};
use crate::job::{
    Checkpoint, Job, OutputSpec, Session, SessionOptions, UNLIMITED_SAMPLES, scene_warnings,
};
use crate::overlay::OverlaySpec;
use crate::scene::{ColumnLayers, Scene, SceneFile, SceneSource, Settings, read_text};

use crate::studio::{overlay_spec, overlay_warnings};

use super::args::RenderArgs;
use super::exit::Exit;
use super::interrupt::Interrupt;
use super::memory::MemoryNeeds;
use super::outputs::{self, Outputs};
use super::particle_file::{self, ParticleFile};
use super::progress::{self, ProgressDisplay};
use super::recorded_outputs::recorded;
use super::system::on_threads;
use super::watch::Viewers;
use super::{interrupt, memory, print, scene_file, system};

use checkpoint::CheckpointTarget;
use finish::RenderFinisher;
use idle::idle_options;
use report::Times;

pub(super) use request::{RenderRequest, scene_text};

/// Runs the command.
///
/// # Errors
/// Any error between the scene and the picture. The output paths are checked first.
pub(super) fn run(args: &RenderArgs) -> Result<Exit> {
    if scene_file::is_stdin(&args.scene.path) && args.keep.checkpoint.is_some() {
        let message =
            "a scene on the standard input cannot be read again, to resume its checkpoint";
        return Err(Error::input(message).with_help("write the scene into a file, and render that"));
    }
    if let Some(folder) = batch::folder(args)? {
        return batch::run(args, &folder, |request| run_one(&request, args));
    }
    run_one(&RenderRequest::of_args(args), args)
}

/// Renders one scene or particle file.
fn run_one(request: &RenderRequest, args: &RenderArgs) -> Result<Exit> {
    if ParticleFile::is_one(&request.scene, &request.overrides) {
        return execute(&request.clone().until_good());
    }
    particle_file::refuse_options(&request.scene, args.studio.first_given())?;
    execute(request)
}

/// Executes a render.
///
/// # Errors
/// See [`run`].
pub(super) fn execute(request: &RenderRequest) -> Result<Exit> {
    outputs::refuse_duplicate_paths(&request.output_paths())?;
    request.check_stdout()?;
    let (layers, format) = (&request.job.layers, request.stdout_format);
    let mut outputs = Outputs::new(&request.delivery, layers, request.layers_given, format)?;
    let guided;
    let request = match request.delivery.denoise {
        true => {
            guided = request.clone().guided();
            outputs.set_layers(&guided.job.layers);
            &guided
        }
        false => request,
    };
    if request.delivery.denoise && outputs.has_pictures() {
        match Denoiser::load() {
            Ok(denoiser) => outputs.set_denoiser(denoiser),
            // The samples are more than the library.
            Err(error) if request.is_resumed => print::warning(format_args!(
                "{error}; the pictures are written as rendered, for `photosphere denoise`"
            )),
            Err(error) => return Err(error),
        }
    }
    let keep = CheckpointTarget::new(request.checkpoint.as_deref(), &outputs)?;
    let name = outputs::in_words(&outputs::paths(&request.delivery.files));
    let mut viewers = Viewers::new(&request.delivery, name, request.is_resumed)?;
    let interrupt = interrupt::listen();
    let mut clock = Clock(Instant::now());
    let threads = (request.job.threads > 0).then_some(request.job.threads);
    let Loaded { scene, settings, overlay, columns, mut warnings } =
        on_threads(threads, || load(request))?;
    viewers.set_overlay(overlay.as_ref());
    outputs.set_overlay(overlay.clone());
    outputs.set_columns(columns);
    let load_s = clock.lap();
    warnings.extend(scene_warnings(&scene, &settings));
    warnings.extend(idle_options(request, &scene, &outputs, keep.is_some()));
    warnings.iter().for_each(print::warning);

    let session = open(request, &scene, settings, overlay, keep.as_ref(), &interrupt)?;
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
        about_scene: warnings,
    };
    viewers.run_alongside(&session, &interrupt, |last_look| {
        let began = Instant::now();
        let reached = session.run(&progress);
        progress.finish();
        finish.close(&reached?, began.elapsed().as_secs_f64(), last_look)
    })
}

/// A scene that has been loaded.
struct Loaded {
    scene: Scene,
    settings: Settings,
    /// What is drawn over its picture.
    overlay: Option<OverlaySpec>,
    /// Columns of its particle file that are layers.
    columns: Option<ColumnLayers>,
    /// What is probably a mistake in its files.
    warnings: Vec<String>,
}

/// Loads the scene and its settings, if they fit into memory.
fn load(request: &RenderRequest) -> Result<Loaded> {
    let mut file = read_scene(request)?;
    if !request.has_settings_of_file {
        file.settings = request.job.settings;
    }
    // Duplicate spheres are still counted here.
    let chosen = request.job.accel.select_for_count(file.size().spheres as usize);
    let needs = MemoryNeeds { backends: &[chosen.backend], kinds: &request.job.layers, besides: 0 };
    memory::check(&file, &needs, request.memory_limit)?;
    let OutputSpec { overlay, dpi, .. } = &request.delivery;
    let warnings = [file.warnings(), overlay_warnings(overlay, &file)].concat();
    let overlay = overlay_spec(overlay, &file, *dpi);
    let columns = match &request.delivery.columns[..] {
        [] => None,
        names => Some(ColumnLayers::of_scene_file(&file, names)?),
    };
    let (scene, settings) = file.build()?;
    Ok(Loaded { scene, settings, overlay, columns, warnings })
}

/// Reads the scene, or makes one of a particle file.
fn read_scene(request: &RenderRequest) -> Result<SceneFile> {
    let (path, overrides) = (&request.scene, &request.overrides);
    if let Some(SceneSource { name, folder, text: Some(text), .. }) = &request.scene_text {
        return read_text(name, text, folder, overrides);
    }
    if !ParticleFile::is_one(path, overrides) {
        return scene_file::read(path, overrides);
    }
    let file = ParticleFile { path, overrides };
    let mut import = file.import(&request.studio)?;
    import.choices.extend(request.default_choices());
    if !request.quiet {
        particle_file::tell(&import);
    }
    Ok(import.scene)
}

/// Opens the render session, with the samples of the checkpoint if there are any.
fn open(
    request: &RenderRequest,
    scene: &Scene,
    settings: Settings,
    overlay: Option<OverlaySpec>,
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
        output: keep.map(|keep| recorded(&request.delivery, &keep.path)),
        command: Some(system::command_line()),
        overlay,
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
    session.autosave(keep.file.clone(), keep_every)?;
    Ok(session)
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

/// Measures lap times.
struct Clock(Instant);

impl Clock {
    fn lap(&mut self) -> f64 {
        let last = std::mem::replace(&mut self.0, Instant::now());
        Duration::as_secs_f64(&(self.0 - last))
    }
}
