//! The threads of renders, and what they share with Python.

use std::path::PathBuf;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use photosphere::cli::keywords::{KeywordRender, OpenedScene};
use photosphere::image_io::AtomicFile;
use photosphere::job::scene_warnings;
use photosphere::job::{Checkpoint, Job, OutputSpec, RunOutcome, Session, SessionOptions};
use photosphere::overlay::OverlaySpec;
use photosphere::scene::{ColumnLayers, LayerValues, Override, SceneFile};
use photosphere::task::CancelToken;
use photosphere::{Error, Result};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::ThreadPool;

use crate::pool;

/// What the thread of a render shares with Python.
pub(crate) struct Shared {
    pub(crate) state: Mutex<State>,
    pub(crate) changed: Condvar,
    pub(crate) cancel: CancelToken,
    pub(crate) process: u32,
}

#[derive(Default)]
pub(crate) struct State {
    pub(crate) is_running: bool,
    pub(crate) session: Option<Arc<Session>>,
    pub(crate) loaded: Loaded,
    pub(crate) outcome: Option<RunOutcome>,
    pub(crate) failure: Option<Error>,
}

/// What is known of the scene and its picture files.
#[derive(Clone, Default)]
pub(crate) struct Loaded {
    pub(crate) overlay: Option<OverlaySpec>,
    pub(crate) output: OutputSpec,
    pub(crate) checkpoint: Option<AtomicFile>,
    pub(crate) text: Option<String>,
    /// Columns of the particles that are layers.
    pub(crate) columns: Option<Arc<ColumnLayers>>,
    pub(crate) warnings: Vec<String>,
    pub(crate) choices: Vec<(&'static str, String)>,
}

/// Opens the scene of a render.
pub(crate) type OpenScene = dyn FnOnce(&KeywordRender, &[Override]) -> Result<OpenedScene> + Send;

/// What a render starts from.
pub(crate) struct Start {
    pub(crate) request: KeywordRender,
    pub(crate) changes: Vec<Override>,
    pub(crate) opened: Box<OpenScene>,
    pub(crate) checkpoint: Option<Checkpoint>,
    /// The job of a checkpoint, which replaces the settings of the scene.
    pub(crate) job: Option<Job>,
    /// Where the samples are saved.
    pub(crate) save_to: Option<PathBuf>,
    /// The columns that are layers, of particles in memory.
    pub(crate) columns: Option<Layers>,
}

/// Columns with their values.
pub(crate) type Layers = Vec<(String, LayerValues)>;

/// Starts the thread of a render.
pub(crate) fn spawn(py: Python<'_>, start: Start) -> PyResult<Arc<Shared>> {
    let shared = Arc::new(Shared {
        state: Mutex::new(State { is_running: true, ..State::default() }),
        changed: Condvar::new(),
        cancel: CancelToken::default(),
        process: std::process::id(),
    });
    let pool = pool::get(py)?;
    let own = Arc::clone(&shared);
    start_thread(move || {
        own.finish_with(|| {
            own.open(start, &pool)?;
            own.run()
        });
    })?;
    Ok(shared)
}

pub(crate) fn start_thread(work: impl FnOnce() + Send + 'static) -> PyResult<()> {
    let thread = thread::Builder::new().name("photosphere".to_owned()).spawn(work);
    let failed = |e| PyRuntimeError::new_err(format!("cannot start a thread: {e}"));
    thread.map(drop).map_err(failed)
}

impl Shared {
    pub(crate) fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(crate) fn wait_for_end(&self, at_most: Duration) -> bool {
        let running = |state: &mut State| state.is_running;
        let waited = self.changed.wait_timeout_while(self.lock(), at_most, running);
        !waited.unwrap_or_else(PoisonError::into_inner).0.is_running
    }

    /// Does the work of a thread and tells those who wait.
    pub(crate) fn finish_with(&self, work: impl FnOnce() -> Result<()>) {
        let done = std::panic::catch_unwind(std::panic::AssertUnwindSafe(work));
        let broken = |_| Err(Error::input("a bug in photosphere; please report it"));
        let done = done.unwrap_or_else(broken);
        let mut state = self.lock();
        state.is_running = false;
        state.failure = done.err();
        self.changed.notify_all();
    }

    /// Reads the scene and opens the session.
    fn open(&self, start: Start, pool: &ThreadPool) -> Result<()> {
        let Start { request, changes, opened, checkpoint, job, save_to, columns } = start;
        let keep = save_to.as_deref().map(AtomicFile::new).transpose()?;
        let mut loaded =
            Loaded { output: request.output().clone(), checkpoint: keep, ..Loaded::default() };
        let (scene, settings) = pool.install(|| {
            let OpenedScene { file, text, notes, choices } = opened(&request, &changes)?;
            self.cancel.check()?;
            request.check_memory(&file)?;
            loaded.overlay = request.overlay(&file);
            loaded.columns = column_layers(&file, &request.output().columns, columns)?;
            (loaded.text, loaded.warnings, loaded.choices) = (text, notes, choices);
            file.build()
        })?;
        self.cancel.check()?;
        let job = job.unwrap_or_else(|| request.job(settings));
        loaded.warnings.extend(pool.install(|| scene_warnings(&scene, &job.settings)));
        let recorded =
            || OutputSpec { files: Vec::new(), preview: None, tev: None, ..loaded.output.clone() };
        let options = SessionOptions {
            cancel: self.cancel.clone(),
            output: loaded.checkpoint.as_ref().map(|_| recorded()),
            ..SessionOptions::default()
        };
        let mut session = pool.install(|| match checkpoint {
            Some(checkpoint) => Session::resume(&scene, job, checkpoint, options),
            None => Session::new(&scene, job, options),
        })?;
        if let Some(file) = &loaded.checkpoint {
            session.autosave(file.clone(), loaded.output.save_every)?;
        }
        let mut state = self.lock();
        (state.session, state.loaded) = (Some(Arc::new(session)), loaded);
        Ok(())
    }

    /// Renders.
    pub(crate) fn run(&self) -> Result<()> {
        let (session, keep) = {
            let state = self.lock();
            (state.session.clone(), state.loaded.checkpoint.clone())
        };
        let Some(session) = session else { return Ok(()) };
        // What is done around the samples runs on this one thread, not on rayon's global ones.
        let around = rayon::ThreadPoolBuilder::new().num_threads(1).build();
        let around = around.map_err(|e| Error::input(format!("cannot start a thread: {e}")))?;
        let outcome = around.install(|| session.run(&()))?;
        if let Some(file) = keep {
            session.install(|| session.write_checkpoint(&file, Some(&outcome)))?;
        }
        drop(session);
        self.lock().outcome = Some(outcome);
        Ok(())
    }
}

/// Finds the columns that are layers: in memory, or else in the particle file of the scene.
fn column_layers(
    file: &SceneFile,
    wanted: &[String],
    in_memory: Option<Layers>,
) -> Result<Option<Arc<ColumnLayers>>> {
    let Some(layers) = in_memory.filter(|_| !wanted.is_empty()) else {
        let from_file = || ColumnLayers::of_scene_file(file, wanted).map(|all| Some(Arc::new(all)));
        return if wanted.is_empty() { Ok(None) } else { from_file() };
    };
    let is_missing = |name: &&String| layers.iter().all(|(known, _)| known != *name);
    if let Some(name) = wanted.iter().find(is_missing) {
        return Err(Error::input(format!("there is no layer `{name}`"))
            .with_help("a layer is an AOV, or a column of numbers of the particles"));
    }
    Ok(Some(Arc::new(ColumnLayers::of_values(file, layers)?)))
}
