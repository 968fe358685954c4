//! `photosphere import`: writes the scene that `render` makes of a particle file.

use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::image_io::AtomicFile;

use super::args::ImportArgs;
use super::exit::Exit;
use super::outputs::is_stdout;
use super::particle_file::{self, ParticleFile};
use super::system::on_threads;
use super::{interrupt, print};

/// Runs the command.
///
/// # Errors
/// If the particles cannot be read, an option is wrong for them, or the scene cannot be written.
pub(super) fn run(args: &ImportArgs) -> Result<Exit> {
    if args.output.as_os_str() != "-" && args.output.extension().is_none_or(|e| e != "toml") {
        let message = format!("`{}` is no name of a scene", args.output.display());
        return Err(Error::input(message).with_help("scenes end in .toml"));
    }
    interrupt::listen();
    let overrides = args.overrides();
    let file = ParticleFile { path: &args.path, overrides: &overrides };
    let options = args.studio.options();
    let folder = args.output.parent().unwrap_or(Path::new("")).to_path_buf();
    let reference = reference(&args.path, &folder);
    let import =
        on_threads(args.options.threads(), || file.import_from(&reference, &folder, &options))?;
    particle_file::tell(&import);
    import.scene.warnings().iter().for_each(print::warning);
    if is_stdout(&args.output) {
        print::result(&import.text)?;
        return Ok(Exit::Done);
    }
    let write = |to: &mut dyn std::io::Write| to.write_all(import.text.as_bytes());
    AtomicFile::with_extension(&args.output, "toml")?.write(|to| write(to))?;
    Ok(Exit::Done)
}

/// The path of a file as a scene in `folder` names it: relative if it is in or below the folder.
fn reference(path: &Path, folder: &Path) -> PathBuf {
    let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let (file, folder) = (absolute(path), absolute(folder));
    file.strip_prefix(&folder).map_or_else(|_| file.clone(), Path::to_path_buf)
}
