//! Renders, for whose threads Python waits without the GIL.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use photosphere::Error;
use photosphere::cli::keywords::{KeywordRender, SceneInput};
use photosphere::job::{Checkpoint, Job, Session, StopCriteria, StopReason, frame_crop};
use photosphere::scene::{LayerValues, ROW_LAYER};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde_json::json;

use crate::picture::Picture;
use crate::pool::SIGNAL_INTERVAL;
use crate::scene::{Changes, Scene, overrides, parse};
use crate::thread::{Layers, Loaded, Shared, Start, spawn, start_thread};
use crate::{arrays, error, pool};

/// A render, from the reading of its scene to its last sample.
#[pyclass(frozen, module = "photosphere._core")]
pub(crate) struct Render(Arc<Shared>);

#[pymethods]
impl Render {
    /// Starts a render and returns at once.
    #[staticmethod]
    fn start(
        py: Python<'_>,
        scene: Py<Scene>,
        words: Vec<String>,
        changes: Changes,
        columns: Option<Columns<'_>>,
    ) -> PyResult<Self> {
        let request = parse(py, &words)?;
        let columns = wanted_columns(&request, columns)?;
        let request = until_good(py, request, &scene.get().input)?.guided();
        let save_to = request.checkpoint().map(PathBuf::from);
        let checkpoint = match &save_to {
            Some(path) if path.exists() => {
                Some(Checkpoint::open(path).map_err(|e| error::raise(py, &e))?)
            }
            _ => None,
        };
        let start = Start {
            request,
            changes: overrides(&changes),
            opened: Box::new(move |request, changes| scene.get().open(request, changes)),
            checkpoint,
            job: None,
            save_to,
            columns,
        };
        Ok(Self(spawn(py, start)?))
    }

    /// Continues a render from a checkpoint: a file, or bytes. `scene` has the tables of a scene
    /// that was made of arrays.
    #[staticmethod]
    fn resume(
        py: Python<'_>,
        path: Option<PathBuf>,
        bytes: Option<Vec<u8>>,
        scene: Option<&Scene>,
        extend_to: Option<u32>,
        threads: usize,
        columns: Option<Columns<'_>>,
    ) -> PyResult<Self> {
        let checkpoint = match (&path, bytes) {
            (Some(path), _) => Checkpoint::open(path),
            (None, bytes) => Checkpoint::from_bytes(bytes.unwrap_or_default()),
        };
        let checkpoint = checkpoint.map_err(|e| error::raise(py, &e))?;
        let header = checkpoint.header();
        let (request, input) =
            KeywordRender::of_checkpoint(header).map_err(|e| error::raise(py, &e))?;
        let columns = wanted_columns(&request, columns)?;
        let mut job = Job { threads, ..request.job(header.job.settings) };
        if let Some(samples) = extend_to {
            extend_job(&mut job, samples);
        }
        let input = match (input, scene) {
            (Some(SceneInput::Text { name, text, folder, .. }), Some(scene)) => {
                SceneInput::Text { name, text, folder, tables: scene.tables() }
            }
            (None, Some(scene)) => scene.input.clone(),
            (Some(input), _) => input,
            (None, None) => {
                let error = Error::input("the scene of this checkpoint was not read from a file");
                return Err(error::raise(py, &error.with_help("pass it: scene=...")));
            }
        };
        let start = Start {
            request,
            changes: Vec::new(),
            opened: Box::new(move |request, changes| request.open(input, changes)),
            checkpoint: Some(checkpoint),
            job: Some(job),
            save_to: path,
            columns,
        };
        Ok(Self(spawn(py, start)?))
    }

    /// Waits until the render ends, or for this time; true if it has ended. Signals are looked for
    /// meanwhile: the exception of a handler ends the wait, and the render goes on.
    fn wait(&self, py: Python<'_>, seconds: Option<f64>) -> PyResult<bool> {
        self.check_process()?;
        // Times beyond those of the clock are no limit.
        let end = seconds.and_then(|seconds| {
            Instant::now().checked_add(Duration::try_from_secs_f64(seconds.max(0.0)).ok()?)
        });
        loop {
            py.check_signals()?;
            let now = Instant::now();
            let left = end.map_or(SIGNAL_INTERVAL, |end| end.saturating_duration_since(now));
            let has_ended = py.detach(|| self.0.wait_for_end(left.min(SIGNAL_INTERVAL)));
            if has_ended || end.is_some_and(|end| Instant::now() >= end) {
                return Ok(has_ended);
            }
        }
    }

    /// Raises the error that ended the render, if one did.
    fn check(&self, py: Python<'_>) -> PyResult<()> {
        match &self.0.lock().failure {
            Some(failure) => Err(error::raise(py, failure)),
            None => Ok(()),
        }
    }

    /// Asks the render to stop soon. Before its first sample, there will be no picture.
    fn stop(&self) -> PyResult<()> {
        self.check_process()?;
        let session = self.0.lock().session.clone();
        match session {
            Some(session) => session.stop(),
            None => self.0.cancel.cancel(),
        }
        Ok(())
    }

    /// True while the thread of the render runs.
    fn is_running(&self) -> PyResult<bool> {
        self.check_process()?;
        Ok(self.0.lock().is_running)
    }

    /// Goes on until every pixel has this number of samples.
    fn extend_to(&self, py: Python<'_>, samples: u32) -> PyResult<()> {
        self.check_process()?;
        pool::run(py, || {
            let mut state = self.0.lock();
            if state.is_running {
                return Err(Error::input("the render is still running")
                    .with_help("wait for it, or stop it first"));
            }
            let Some(session) = state.session.as_mut() else {
                return Err(Error::input("the render has no samples to go on from"));
            };
            let Some(session) = Arc::get_mut(session) else {
                return Err(Error::input("another thread is using the render"));
            };
            let mut job = session.job().clone();
            extend_job(&mut job, samples);
            session.extend(job)?;
            (state.is_running, state.outcome) = (true, None);
            Ok(())
        })?;
        let shared = Arc::clone(&self.0);
        start_thread(move || shared.finish_with(|| shared.run()))
    }

    /// The picture so far.
    fn picture(&self, py: Python<'_>) -> PyResult<Picture> {
        let (session, loaded) = self.session(py)?;
        // Not on the threads of the render, which would finish their samples first.
        pool::run(py, || {
            if session.film().sample_count() == 0 {
                return Err(Error::input("the render has no samples yet"));
            }
            let (mut picture, mut metadata) = session.snapshot();
            if let Some(columns) = &loaded.columns {
                columns.add_to(&mut picture, session.prepared().scene());
                metadata.column_layers = columns.names();
            }
            let crop = frame_crop(session.film().frame());
            let layers = session.job().layers.clone();
            Ok(Picture::new(picture, metadata, layers, crop, loaded.overlay, loaded.output))
        })
    }

    /// True if the finished picture is to be denoised.
    fn denoises(&self) -> PyResult<bool> {
        self.check_process()?;
        Ok(self.0.lock().loaded.output.denoise)
    }

    /// Progress, as JSON.
    fn progress(&self, py: Python<'_>, with_error: bool) -> PyResult<String> {
        self.check_process()?;
        let (session, outcome) = {
            let state = self.0.lock();
            let error = state.outcome.as_ref().and_then(|outcome| outcome.error);
            (state.session.clone(), error)
        };
        let Some(session) = session else { return Ok("null".to_owned()) };
        let estimate = match (outcome, with_error) {
            (Some(error), _) => Some(error),
            (None, true) => pool::run(py, || Ok(session.estimate_error()))?,
            (None, false) => None,
        };
        Ok(py.detach(|| {
            let progress = session.progress();
            let pixels = session.film().frame().pixel_count() as f64;
            json!({
                "samples": progress.samples_done,
                "samples_total": progress.samples_total,
                "spp": progress.samples_done as f64 / pixels,
                "rate": progress.rate,
                "error": estimate,
                "left": progress.time_left.map(|left| left.end.as_secs_f64()),
                "threads": session.threads(),
                "accel": session.accel_summary(),
            })
            .to_string()
        }))
    }

    /// Why the render ended, what the user should know, and what was chosen automatically, as JSON.
    fn report(&self, py: Python<'_>) -> PyResult<String> {
        self.check_process()?;
        let ended = {
            let state = self.0.lock();
            state.session.clone().filter(|_| !state.is_running)
        };
        let about_picture = match ended {
            Some(session) => pool::run(py, || Ok(session.statistics().2))?,
            None => Vec::new(),
        };
        let state = self.0.lock();
        let reason = state.outcome.as_ref().map(|outcome| match outcome.stop_reason {
            StopReason::Finished => "finished",
            StopReason::TimeLimit => "time",
            StopReason::NoiseTargetMissed => "noise target missed",
            StopReason::Stopped => "stopped",
            StopReason::Failed => "failed",
        });
        let mut warnings = state.loaded.warnings.clone();
        warnings.extend(about_picture);
        let noise = state.outcome.as_ref().and_then(|outcome| outcome.noise);
        warnings.extend(noise.filter(|noise| !noise.is_met()).map(|noise| noise.to_string()));
        let report = json!({
            "reason": reason,
            "warnings": warnings,
            "choices": state.loaded.choices,
            "text": state.loaded.text,
        });
        Ok(report.to_string())
    }

    /// The samples so far, as the bytes of a checkpoint.
    fn checkpoint<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let (session, _) = self.session(py)?;
        let outcome = self.0.lock().outcome.clone();
        let bytes = pool::run(py, || session.checkpoint_bytes(outcome.as_ref()))?;
        Ok(PyBytes::new(py, &bytes))
    }
}

impl Render {
    fn session(&self, py: Python<'_>) -> PyResult<(Arc<Session>, Loaded)> {
        self.check_process()?;
        self.check(py)?;
        let state = self.0.lock();
        let session = state
            .session
            .clone()
            .ok_or_else(|| error::raise(py, &Error::input("the render has no samples yet")))?;
        Ok((session, state.loaded.clone()))
    }

    /// Refuses a render of the parent process, whose threads are not here.
    fn check_process(&self) -> PyResult<()> {
        if self.0.process == std::process::id() {
            return Ok(());
        }
        let message = "this render belongs to the process that started it: start it anew here";
        Err(PyRuntimeError::new_err(message))
    }
}

/// A render that nobody can ask any more ends. In a forked process it stays: its threads are not
/// there, and they may have held its locks.
impl Drop for Render {
    fn drop(&mut self) {
        if self.stop().is_err() {
            std::mem::forget(Arc::clone(&self.0));
        }
    }
}

/// Gives a render of particles the noise target of the command line, if no option says when to
/// stop.
fn until_good(
    py: Python<'_>,
    request: KeywordRender,
    input: &SceneInput,
) -> PyResult<KeywordRender> {
    match input {
        SceneInput::Particles { .. } => Ok(request.until_good()),
        SceneInput::Text { .. } => Ok(request),
        SceneInput::File(path) => {
            let path = path.clone();
            pool::run_interruptible(py, move || {
                let is_particles = request.is_particle_file(&path);
                Ok(if is_particles { request.until_good() } else { request })
            })
        }
    }
}

/// Columns of particles in memory: names and arrays; the rows that the particles stand for, or
/// `None` for their own, are the layer `row`.
type Columns<'py> = Vec<(String, Option<Bound<'py, PyAny>>)>;

/// Copies the columns that are wanted as layers.
fn wanted_columns(
    request: &KeywordRender,
    columns: Option<Columns<'_>>,
) -> PyResult<Option<Layers>> {
    let wanted = &request.output().columns;
    let copied = |columns: Columns<'_>| {
        let wanted = columns.into_iter().filter(|(name, _)| wanted.contains(name));
        wanted.map(|(name, array)| layer(name, array.as_ref())).collect()
    };
    columns.map(copied).transpose()
}

fn layer(name: String, array: Option<&Bound<'_, PyAny>>) -> PyResult<(String, LayerValues)> {
    let values = match array {
        Some(array) if name != ROW_LAYER => LayerValues::Numbers(arrays::values(array)?),
        rows => LayerValues::Rows(rows.map(arrays::values).transpose()?),
    };
    Ok((name, values))
}

fn extend_job(job: &mut Job, samples: u32) {
    job.until = StopCriteria::default();
    job.set_samples_per_pixel(samples);
    let last = job.settings.render.samples_per_pixel;
    job.samples = job.samples.take().map(|range| range.start..last);
}
