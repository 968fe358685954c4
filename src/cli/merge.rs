//! `photosphere merge`: merges parts into a picture.

use crate::error::Result;
use crate::image_io::AtomicFile;
use crate::job::merge::{MergeOptions, MergedRender, merge};

use super::args::MergeArgs;
use super::exit::Exit;
use super::outputs::{self, Outputs};
use super::system::{self, on_threads};
use super::{interrupt, print};

/// Runs the command.
///
/// # Errors
/// If a part is damaged or belongs to another render, if parts overlap or leave a gap, or if the
/// result cannot be written.
pub(super) fn run(args: &MergeArgs) -> Result<Exit> {
    let files: Vec<_> = args.output.files.iter().map(|file| ("-o", file.as_path())).collect();
    outputs::refuse_duplicate_paths(&files)?;
    outputs::refuse_columns(&args.output.columns())?;
    let layers = args.output.has_layers().then(|| args.output.kinds());
    let given = layers.as_deref().unwrap_or_default();
    let (spec, format) = (args.output.output_spec(), args.stdout.format);
    let mut outputs = Outputs::new(&spec, given, layers.is_some(), format)?;
    let part = outputs.part().map(AtomicFile::new).transpose()?;
    interrupt::listen();
    let plan = MergeOptions {
        layers,
        crop: args.crop,
        allow_gaps: args.allow_gaps,
        writes_picture: outputs.has_pictures(),
        writes_checkpoint: part.is_some(),
        command: Some(system::command_line()),
    };
    on_threads(None, || {
        let merged = merge(&args.parts, &plan)?;
        write(args, &merged, &mut outputs, part.as_ref())?;
        Ok(tell_missed(&merged))
    })
}

fn write(
    args: &MergeArgs,
    merged: &MergedRender,
    outputs: &mut Outputs,
    part: Option<&AtomicFile>,
) -> Result<()> {
    outputs.set_layers(&merged.layers);
    if let Some(part) = part {
        merged.write_checkpoint(part)?;
    }
    write_pictures(merged, outputs)?;
    if !args.quiet {
        let parts = print::count(args.parts.len(), "part");
        let files = outputs::in_words(&args.output.files);
        let samples = merged.metadata.samples_to_string();
        print::note(format_args!("wrote {files}, samples {samples} from {parts}"));
    }
    Ok(())
}

fn write_pictures(merged: &MergedRender, outputs: &mut Outputs) -> Result<()> {
    if !outputs.has_pictures() {
        return Ok(());
    }
    let picture = merged.picture()?;
    outputs.set_overlay(merged.metadata.overlay.clone());
    let notes = outputs.notes(merged.film.frame(), &merged.metadata, false);
    outputs.pictures().iter().try_for_each(|file| file.write(None, &picture, &notes))
}

/// Reports the parts that ended before they reached their noise target.
fn tell_missed(merged: &MergedRender) -> Exit {
    for (path, missed) in &merged.missed_targets {
        for status in missed {
            print::warning(format_args!("`{}`: {status}", path.display()));
        }
    }
    if merged.missed_targets.is_empty() { Exit::Done } else { Exit::CheckFailed }
}
