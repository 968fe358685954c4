//! The outputs that a checkpoint records. A checkpoint may come from a stranger, so it is data and
//! never a program: what it names outside its own folder is not written unless the user types it.

use std::path::{Component, Path, PathBuf};

use crate::error::{Error, Result};
use crate::job::{FilePath, OutputSpec};

use super::outputs::{is_discarded, is_part, is_stdout, place};
use super::print;

/// Returns what a checkpoint records of the outputs: paths relative to its folder where they are
/// inside, and absolute ones elsewhere. Streams and viewers belong to one run.
pub(super) fn recorded(outputs: &OutputSpec, checkpoint: &Path) -> OutputSpec {
    let folder = folder_of(checkpoint);
    let named = |FilePath(file): &FilePath| {
        let absolute = || std::path::absolute(file).unwrap_or_else(|_| file.clone());
        FilePath(place(file).strip_prefix(&folder).map_or_else(|_| absolute(), Path::to_path_buf))
    };
    OutputSpec {
        files: outputs.files.iter().filter(is_file).map(named).collect(),
        preview: outputs.preview.as_ref().map(named),
        tev: None,
        ..outputs.clone()
    }
}

/// Returns the recorded outputs as paths from here. A preview elsewhere and a viewer are left out
/// with a warning.
///
/// # Errors
/// If a picture is outside the checkpoint's folder. The help is the command that allows it.
pub(super) fn trusted(recorded: OutputSpec, checkpoint: &Path) -> Result<OutputSpec> {
    let beside = |FilePath(file): &FilePath| {
        FilePath(checkpoint.parent().unwrap_or(Path::new("")).join(file))
    };
    let files = recorded.files.iter().filter(is_file).map(beside).collect();
    let mut outputs = OutputSpec { files, ..recorded };
    if let Some(FilePath(file)) = outputs.files.iter().find(|file| !is_inside(file, checkpoint)) {
        let (shown, file) = (checkpoint.display(), file.display());
        let message = format!("`{shown}` names a picture outside its folder: `{file}`");
        let help = format!("if you want it there: {}", command(&outputs.files, checkpoint));
        return Err(Error::input(message).with_help(help));
    }
    let preview = outputs.preview.take().map(|preview| beside(&preview));
    outputs.preview = preview.filter(|preview| {
        let is_inside = is_inside(preview, checkpoint);
        if !is_inside {
            let (shown, quoted) = (preview.0.display(), quoted(&preview.0));
            print::warning(format_args!(
                "the preview `{shown}` is outside the checkpoint's folder; the render goes on \
                 without it, unless you name it: --preview {quoted}"
            ));
        }
        is_inside
    });
    if let Some(viewer) = outputs.tev.take() {
        let viewer = quoted(Path::new(&viewer));
        print::warning(format_args!(
            "a checkpoint connects to no viewer; for tev, name it: --tev {viewer}"
        ));
    }
    Ok(outputs)
}

/// Returns false for the standard output and for no output, which no file stands for.
fn is_file(FilePath(file): &&FilePath) -> bool {
    !is_stdout(file) && !is_discarded(file)
}

/// Returns the command that resumes a render with these outputs.
pub(super) fn resume_command(outputs: &OutputSpec, checkpoint: &Path) -> String {
    let is_known = |file: &FilePath| is_file(&file) && is_inside(file, checkpoint);
    match outputs.files.iter().all(is_known) {
        true => format!("photosphere resume {}", quoted(checkpoint)),
        false => command(&outputs.files, checkpoint),
    }
}

fn command(files: &[FilePath], checkpoint: &Path) -> String {
    let mut words = format!("photosphere resume {}", quoted(checkpoint));
    // A part is the checkpoint itself.
    for FilePath(file) in files.iter().filter(|file| !is_part(&file.0)) {
        words += &format!(" -o {}", quoted(file));
    }
    words
}

/// Returns true if a file is in the checkpoint's folder or below, wherever links lead.
fn is_inside(FilePath(file): &FilePath, checkpoint: &Path) -> bool {
    let place = place(file);
    // Behind a missing folder, the path is as it was given.
    let climbs = place.components().any(|part| part == Component::ParentDir);
    !climbs && place.starts_with(folder_of(checkpoint))
}

/// Returns the absolute folder of the checkpoint, without links.
fn folder_of(checkpoint: &Path) -> PathBuf {
    let folder = match checkpoint.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    place(folder)
}

/// Quotes a path for a shell.
fn quoted(path: &Path) -> String {
    format!("'{}'", path.display().to_string().replace('\'', r"'\''"))
}
