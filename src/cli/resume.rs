//! `photosphere resume`: resumes a render from its checkpoint.

use crate::error::{Error, Result};
use crate::job::{Checkpoint, FilePath, OutputSpec, StopCriteria};

use super::args::ResumeArgs;
use super::exit::Exit;
use super::outputs::is_part;
use super::render::{self, RenderRequest};

/// Runs the command.
///
/// # Errors
/// If the file cannot be resumed, and all errors of a render.
pub(super) fn run(args: &ResumeArgs) -> Result<Exit> {
    let header = Checkpoint::open(&args.file)?.header().clone();
    let unknown = || {
        let path = args.file.display();
        Error::input(format!("`{path}` does not record where its picture goes"))
            .with_help("name the picture: -o picture.exr")
    };
    let is_named = !args.outputs.is_empty();
    let named = || is_named.then(OutputSpec::default);
    let delivery = header.delivery.clone().or_else(named).ok_or_else(unknown)?;
    let no_scene = || {
        let path = args.file.display();
        Error::input(format!("the scene of `{path}` was not read from a file"))
            .with_help("resume it with the program that made it")
    };
    let mut request =
        RenderRequest::of_header(&header, delivered(args, delivery)?).ok_or_else(no_scene)?;
    // A `.part` file among the outputs is its own checkpoint.
    let keeps_itself = request.delivery.files.iter().any(|FilePath(file)| is_part(file));
    request.checkpoint = (!keeps_itself).then(|| args.file.clone());
    if let Some(scene) = &args.scene {
        request.scene.clone_from(scene);
    }
    if let Some(samples) = args.extend_to {
        // A given number of samples replaces the stop criteria of the render.
        request.samples_per_pixel = Some(samples);
        request.is_extended = true;
        request.job.until = StopCriteria::default();
    }
    request.job.threads = args.threads.unwrap_or(request.job.threads);
    request.memory_limit = args.memory.limit;
    (request.quiet, request.json) = (args.quiet, args.json);
    render::execute(&request)
}

/// Returns the outputs: as before, except for what the options change.
fn delivered(args: &ResumeArgs, mut delivery: OutputSpec) -> Result<OutputSpec> {
    if let Some(part) = args.outputs.iter().find(|file| is_part(file) && **file != args.file) {
        let (part, kept) = (part.display(), args.file.display());
        let message =
            format!("the output `{part}` is a part, but the samples are saved in `{kept}`");
        return Err(Error::input(message)
            .with_help(format!("name a picture instead; to copy the part: cp '{kept}' '{part}'")));
    }
    if !args.outputs.is_empty() {
        delivery.files = args.outputs.iter().cloned().map(FilePath).collect();
    }
    // The part may have been moved.
    let own = |FilePath(file): &mut FilePath| {
        if is_part(file) {
            file.clone_from(&args.file);
        }
    };
    delivery.files.iter_mut().for_each(own);
    delivery.save_every = args.checkpoint_every.unwrap_or(delivery.save_every);
    Ok(delivery)
}
