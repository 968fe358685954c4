//! `photosphere plan`: prints the commands that distribute a render over several machines.
//!
//! A plan only prints. Its commands rely on `render -o FILE.part`: the file is written atomically,
//! is its own checkpoint, and does not change once it is finished. Any shard can therefore be run
//! again, and two copies of one shard at the same time do no harm.

mod commands;
mod openjd;
mod script;
mod shards;

use std::path::PathBuf;

use crate::draw::printable::printable;
use crate::error::{Error, Result};
use crate::scene::SceneFile;

use super::args::{Division, OutputArgs, PlanArgs, PlanFormat, StopArgs};
use super::exit::Exit;
use super::outputs::{Outputs, refuse_columns, refuse_duplicate_paths, refuse_streams};
use super::particle_file::read_scene;
use super::print;
use super::system::on_threads;
use commands::ShardPlan;

/// Runs the command.
///
/// # Errors
/// If the scene has mistakes, if a file cannot be written or cannot hold the requested layers, if
/// there are more shards than work to divide, or if the parts could not be merged.
pub(super) fn run(args: &PlanArgs) -> Result<Exit> {
    let outputs = outputs(args);
    let files: Vec<_> = outputs.files.iter().map(|file| ("-o", file.as_path())).collect();
    refuse_duplicate_paths(&files)?;
    refuse_streams(&outputs.files)?;
    refuse_columns(&outputs.columns())?;
    Outputs::new(&outputs.output_spec(), &outputs.kinds(), outputs.has_layers(), None)?;
    let overrides = args.overrides();
    // Checks the tables without loading them: they may need more memory than this machine has.
    let file = on_threads(args.scene.threads(), || {
        read_scene(&args.scene.path, &overrides, Some(&args.studio))
    })?;
    print::result(&text(args, &outputs, &file)?)?;
    Ok(Exit::Done)
}

/// Returns the plan for a scene file as text.
pub(super) fn text(args: &PlanArgs, outputs: &OutputArgs, file: &SceneFile) -> Result<String> {
    let division = division(&args.stop, args.by)?;
    args.stop.stop_criteria(args.output.look()).validate(&file.settings.render)?;
    // Two machines might choose differently, and their parts could not be merged.
    let backend = args.accel.choice.select_for_count(file.size().spheres as usize).backend;
    let plan = ShardPlan::new(args, outputs, division, &file.settings, backend.name())?;
    let text = match args.format {
        PlanFormat::Shell => script::shell(&plan)?,
        PlanFormat::Slurm => script::slurm(&plan)?,
        PlanFormat::Openjd => openjd::template(&plan)?,
    };
    if printable(&text) != text {
        // They would be printed escaped, and the plan would mean other files.
        return Err(Error::input("the names or options of the plan have control characters")
            .with_help("a plan can only name files whose names have none; rename them"));
    }
    Ok(text)
}

/// Returns the requested output files, or one named after the scene.
pub(super) fn outputs(args: &PlanArgs) -> OutputArgs {
    let mut outputs = args.output.clone();
    if outputs.files.is_empty() {
        let stem = args.scene.path.file_stem().unwrap_or_default();
        let mut name = stem.to_owned();
        name.push(".exr");
        outputs.files.push(PathBuf::from(name));
    }
    outputs
}

/// Returns how to divide the work.
fn division(stop: &StopArgs, asked: Option<Division>) -> Result<Division> {
    let refused = |message: &str, help: &str| Err(Error::input(message).with_help(help));
    match (stop.has_target(), stop.limit_option(), asked) {
        (_, Some(limit), _) => refused(
            &format!(
                "{limit} stops each shard after as many samples as its machine gets done, so the \
                 picture cannot be reproduced"
            ),
            "use --spp N or --noise ERROR; set a time limit in sbatch or in the render farm",
        ),
        (true, None, Some(Division::Samples)) => refused(
            "--noise and --quality decide from all samples of a tile, so sample ranges cannot be separate shards",
            "divide the pixels: --by crop",
        ),
        (true, None, _) => Ok(Division::Crop),
        (false, None, asked) => Ok(asked.unwrap_or(Division::Samples)),
    }
}

#[cfg(test)]
mod tests;
