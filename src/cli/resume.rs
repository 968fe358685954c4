//! `photosphere resume`: resumes a render from its checkpoint.

use std::path::PathBuf;
use std::time::Duration;

use crate::error::{Error, Result};
use crate::job::{Checkpoint, CheckpointHeader, FilePath, OutputSpec, StopCriteria};

use super::args::ResumeArgs;
use super::exit::Exit;
use super::outputs::is_part;
use super::print;
use super::recorded_outputs::trusted;
use super::render::{self, RenderRequest};

/// The most threads that a checkpoint may ask for. More were never started.
const MAX_THREADS: usize = 4096;

/// Runs the command.
///
/// # Errors
/// If the file cannot be resumed, and all errors of a render.
pub(super) fn run(args: &ResumeArgs) -> Result<Exit> {
    let header = Checkpoint::open(&args.file)?.header().clone();
    let outputs = outputs(args, header.output.clone())?;
    let mut request = RenderRequest::of_header(&header, scene(args, &header)?, outputs);
    // A `.part` file among the outputs is its own checkpoint.
    let keeps_itself = request.delivery.files.iter().any(|FilePath(file)| is_part(file));
    request.checkpoint = (!keeps_itself).then(|| args.file.clone());
    if let Some(samples) = args.extend_to {
        // A given number of samples replaces the stop criteria of the render.
        request.samples_per_pixel = Some(samples);
        request.is_extended = true;
        request.job.until = StopCriteria::default();
    }
    let threads = request.job.threads;
    let recorded = if threads > MAX_THREADS { 0 } else { threads };
    request.job.threads = args.threads.unwrap_or(recorded);
    request.stdout_format = args.stdout.format;
    request.memory_limit = args.memory.limit;
    (request.quiet, request.json) = (args.quiet, args.json);
    render::execute(&request)
}

/// Returns the scene file: the given one, or the one of the first command.
fn scene(args: &ResumeArgs, header: &CheckpointHeader) -> Result<PathBuf> {
    if let Some(scene) = &args.scene {
        return Ok(scene.clone());
    }
    if let Some(source) = render::scene_text(header) {
        return Ok(PathBuf::from(source.name));
    }
    let Some(scene) = header.source.as_ref().and_then(|source| source.file.clone()) else {
        let path = args.file.display();
        let message = format!("the scene of `{path}` was not read from a file");
        return Err(Error::input(message).with_help(
            "name a file of that scene with --scene, or resume it with the program that made it",
        ));
    };
    let refused = |why: String| {
        Error::file("read the scene", &scene, why).with_help("if it is elsewhere: --scene FILE")
    };
    match scene.metadata() {
        Ok(found) if found.is_file() => Ok(scene),
        Ok(_) => Err(refused("it is not a regular file".to_owned())),
        Err(e) => Err(refused(e.to_string())),
    }
}

/// Returns the outputs: as before, except for what the options change.
fn outputs(args: &ResumeArgs, recorded: Option<OutputSpec>) -> Result<OutputSpec> {
    if let Some(part) = args.outputs.iter().find(|file| is_part(file) && **file != args.file) {
        let (shown, kept) = (part.display(), args.file.display());
        let message =
            format!("the output `{shown}` is a part, but the samples are saved in `{kept}`");
        let [part, kept] = [part, &args.file].map(|file| print::shell_path(file));
        return Err(Error::input(message)
            .with_help(format!("name a picture instead; to copy the part: cp {kept} {part}")));
    }
    let mut outputs = recorded.unwrap_or_default();
    if !args.outputs.is_empty() {
        outputs.files.clear();
    }
    // The part may have been moved.
    let keeps_itself = outputs.files.iter().any(|FilePath(file)| is_part(file));
    outputs.files.retain(|FilePath(file)| !is_part(file));
    outputs.preview = outputs.preview.filter(|_| args.preview.is_none());
    let mut outputs = trusted(outputs, &args.file)?;
    outputs.files.extend(args.outputs.iter().cloned().map(FilePath));
    if keeps_itself {
        outputs.files.push(FilePath(args.file.clone()));
    }
    if outputs.files.is_empty() {
        let path = args.file.display();
        let message = format!("`{path}` does not record where its picture goes");
        return Err(Error::input(message).with_help("name the picture: -o picture.exr"));
    }
    outputs.preview = args.preview.clone().map(FilePath).or(outputs.preview);
    outputs.tev.clone_from(&args.tev);
    let shortest = Duration::from_millis(1);
    outputs.preview_every = outputs.preview_every.max(shortest);
    outputs.save_every = args.checkpoint_every.unwrap_or(outputs.save_every).max(shortest);
    Ok(outputs)
}
