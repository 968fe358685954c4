//! The command line without its printing, for tests and fuzzing. This is no interface: it may
//! change with any version.

use std::cell::RefCell;
use std::ffi::OsString;
use std::io;
use std::path::Path;

use crate::draw::printable::printable;
use crate::error::{Error, Result};
use crate::image_io::Picture;
use crate::job::Job;
use crate::scene::{Override, read_text};

use super::args::{self, Command};
use super::render::RenderRequest;
use super::watch::Tev;
use super::{error, outputs, plan, usage};

/// The most shards that are planned here.
const MAX_SHARDS: u32 = 16;

/// Returns what the program prints of an error, as text and as JSON.
pub fn error_text(e: &Error) -> String {
    error::text(e)
}

/// Reads a command line, without the name of the program, and does what needs no file but a scene,
/// whose text is given. Returns the plan or the job; the error is what the program would print.
///
/// # Errors
/// If the command line or the scene is refused. Help pages are errors, too.
pub fn evaluate_arguments(words: &[String], scene: &str) -> std::result::Result<String, String> {
    // The definition takes longer to build than most command lines to read.
    thread_local!(static PROGRAM: RefCell<clap::Command> = RefCell::new(args::help::program()));
    let name = std::iter::once("photosphere").map(OsString::from);
    let line = name.chain(words.iter().map(OsString::from));
    let cli = PROGRAM.with_borrow_mut(|program| super::parse(program, line));
    let cli = cli.map_err(|mut answer| {
        usage::advise(&mut answer, words);
        printable(&answer.render().to_string()).into_owned()
    })?;
    evaluate(&cli.command, scene).map_err(|e| error_text(&e))
}

fn evaluate(command: &Command, scene: &str) -> Result<String> {
    let read = |overrides: &[Override]| read_text("scene.toml", scene, Path::new(""), overrides);
    match command {
        Command::Render(args) => {
            let request = RenderRequest::of_args(args);
            outputs::refuse_duplicate_paths(&request.output_paths())?;
            request.check_stdout()?;
            let settings = read(&request.overrides)?.settings;
            let job = Job { settings, ..request.job };
            job.until.validate(&job.settings.render)?;
            let samples = job.sample_range()?;
            Ok(format!("{job:?} {samples:?} {:?}", request.delivery))
        }
        Command::Plan(args) => {
            let file = read(&args.overrides())?;
            match args.shards {
                0..=MAX_SHARDS => plan::text(args, &plan::outputs(args), &file),
                _ => Ok(String::new()),
            }
        }
        Command::Trace(args) => read(&args.overrides()).map(|file| format!("{file:?}")),
        Command::Info(args) => read(&args.scene.overrides()).map(|file| format!("{file:?}")),
        Command::Bench(args) => read(&args.scene.overrides()).map(|file| format!("{file:?}")),
        Command::Crosscheck(args) => read(&args.scene.overrides()).map(|file| format!("{file:?}")),
        Command::Converge(args) => {
            let samples = args.samples(1);
            let most = samples.last().copied().unwrap_or_default();
            Ok(format!("{samples:?} {}", args.reference_half(most)))
        }
        Command::Compare(args) => Ok(format!("{:?}", args.options())),
        other => Ok(format!("{other:?}")),
    }
}

/// Shows a picture twice in a viewer that listens at this address.
///
/// # Errors
/// If the viewer cannot be reached, or hangs up.
pub fn show_in_tev(address: &str, name: &str, picture: &Picture) -> io::Result<()> {
    let mut viewer = Tev::connect(address, name.to_owned()).map_err(io::Error::other)?;
    viewer.show(picture)?;
    viewer.show(picture)
}
