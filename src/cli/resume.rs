//! `photosphere resume`: the interrupted command again, from where it was.

use std::path::{Path, PathBuf};

use clap::Parser;
use serde_json::Value;

use crate::error::{Error, Result};
use crate::output::{PartFile, Record};

use super::args::{Cli, Command, RenderArgs, ResumeArgs, Resumed};
use super::exit::Exit;
use super::outputs::is_part;
use super::render::{self, RESUME};

/// # Errors
/// When the file cannot be gone on with, and whatever a render meets.
pub(super) fn run(args: &ResumeArgs) -> Result<Exit> {
    let part = PartFile::open(&args.file)?;
    let mut render = interrupted(args, &part.head().records)?;
    drop(part);
    // The file may have been moved.
    let is_kept = |file: &&mut PathBuf| is_part(file);
    match render.output.files.iter_mut().find(is_kept) {
        Some(part) => part.clone_from(&args.file),
        None => render.keep.checkpoint = Some(args.file.clone()),
    }
    if let Some(part) = args.outputs.iter().find(|file| is_part(file) && **file != args.file) {
        let (part, kept) = (part.display(), args.file.display());
        let message = format!("`{part}` is a part, but the samples stay in `{kept}`");
        return Err(Error::input(message).with_help(format!(
            "name a picture; for another file with the samples, copy it: cp '{kept}' '{part}'"
        )));
    }
    if !args.outputs.is_empty() {
        render.output.files.clone_from(&args.outputs);
        render.keep.checkpoint = Some(args.file.clone());
    }
    if let Some(scene) = &args.scene {
        render.scene.path.clone_from(scene);
    }
    if let Some(every) = args.checkpoint_every {
        render.keep.checkpoint_every = every;
    }
    if args.threads.is_some() {
        render.scene.set_threads(args.threads);
    }
    render.quiet |= args.quiet;
    render.json |= args.json;
    render::run(&render)
}

/// The command that a file says it is of.
fn interrupted(args: &ResumeArgs, records: &[Record]) -> Result<RenderArgs> {
    let unknown = || {
        let path = args.file.display();
        Error::input(format!("`{path}` does not say which command made it")).with_help(format!(
            "a part that was merged has none; name it in a whole one, and it goes on from there: \
                 photosphere render SCENE -o picture.exr --checkpoint '{path}'"
        ))
    };
    let record = records.iter().find(|record| record.name == RESUME).ok_or_else(unknown)?;
    let value: Value = serde_json::from_str(&record.text).map_err(|_| unknown())?;
    let texts = |key: &str| -> Option<Vec<String>> {
        let list = value.get(key)?.as_array()?.iter();
        list.map(|word| word.as_str().map(str::to_owned)).collect()
    };
    let arguments = texts("arguments").ok_or_else(unknown)?;
    let words = std::iter::once("photosphere".to_owned()).chain(arguments.iter().cloned());
    let Ok(Cli { command: Command::Render(mut render) }) = Cli::try_parse_from(words) else {
        return Err(unknown());
    };
    let scene = value.get("scene").and_then(Value::as_str).ok_or_else(unknown)?;
    render.scene.path = Path::new(scene).to_path_buf();
    render.output.files =
        texts("files").ok_or_else(unknown)?.into_iter().map(PathBuf::from).collect();
    let preview = value.get("preview").and_then(Value::as_str);
    render.watch.preview = preview.map(PathBuf::from).or(render.watch.preview);
    let extended_before = value.get("extended_to").and_then(Value::as_u64);
    let preview = value.get("preview").and_then(Value::as_str);
    render.watch.preview = preview.map(PathBuf::from).or(render.watch.preview);
    let extended_before = extended_before.and_then(|samples| u32::try_from(samples).ok());
    let extended_to = args.extend_to.or(extended_before);
    if extended_to.is_some() {
        // A number of samples was asked for since, in place of what ended the render.
        render.stop.noise = None;
        render.stop.time = None;
    }
    render.resumed = Some(Resumed { arguments, extended_to });
    Ok(*render)
}
