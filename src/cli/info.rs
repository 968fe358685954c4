//! `photosphere info`: summarises a scene, or how a picture was made.

use crate::error::{Error, Result};
use crate::film::Aov;
use crate::job::scene_warnings;
use crate::particles::ReadRequest;
use crate::report::{FileRecords, SceneSummary, is_picture};

use super::args::InfoArgs;
use super::exit::Exit;
use super::memory::MemoryNeeds;
use super::particle_file::ParticleFile;
use super::system::on_threads;
use super::{memory, particle_info, print, scene_file};

/// Runs the command.
///
/// # Errors
/// If the scene or picture cannot be read, or the scene has mistakes.
pub(super) fn run(args: &InfoArgs) -> Result<Exit> {
    if is_picture(&args.scene.path) {
        refuse_columns(args, "a picture")?;
        if let Some(option) = args.scene.overrides().first() {
            let message = format!(
                "`{}` changes scenes, but `{}` is a picture",
                option.option().join(" "),
                args.scene.path.display()
            );
            return Err(Error::input(message).with_help("remove the option"));
        }
        let records = FileRecords::read(&args.scene.path)?;
        match args.json {
            true => print::json(&records.json()?)?,
            false => print::result(&records.to_text()?)?,
        }
        return Ok(Exit::Done);
    }
    let path = &args.scene.path;
    if ParticleFile::is_one(path, &args.scene.overrides()) {
        let request = ReadRequest::default();
        on_threads(args.scene.threads(), || {
            particle_info::run(path, &request, args.columns, args.json)
        })?;
        return Ok(Exit::Done);
    }
    refuse_columns(args, "a scene")?;
    on_threads(args.scene.threads(), || {
        let file = scene_file::read(&args.scene.path, &args.scene.overrides())?;
        let plan = memory::json(&file);
        if !args.json {
            // Printed before loading, for which there may not be enough memory.
            print::result(&memory::table(&file))?;
        }
        let backends = [args.accel.choice.select_for_count(file.size().spheres as usize).backend];
        let needs = MemoryNeeds { backends: &backends, kinds: &Aov::DEFAULT, besides: 0 };
        memory::check(&file, &needs, args.memory.limit)?;
        let (scene, settings) = file.build()?;
        scene_warnings(&scene, &settings).iter().for_each(print::warning);
        let summary = SceneSummary::of(&scene, &settings);
        match args.json {
            true => print::json(&summary.with_memory_plan(plan))?,
            false => print::result(&summary.to_string())?,
        }
        Ok(Exit::Done)
    })
}

/// Refuses the option for particle files.
fn refuse_columns(args: &InfoArgs, what: &str) -> Result<()> {
    let path = args.scene.path.display();
    match args.columns {
        false => Ok(()),
        true => {
            Err(Error::input(format!("`--columns` reads particle files, but `{path}` is {what}"))
                .with_help("leave it out"))
        }
    }
}
