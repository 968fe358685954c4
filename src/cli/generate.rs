//! `photosphere generate`: writes a table of spheres for tests and benchmarks.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use indicatif::ProgressBar;

use crate::error::{Error, Result};
use crate::generate::{Recipe, scene_text, write_rows};
use crate::image_io::AtomicFile;

use super::args::GenerateArgs;
use super::exit::Exit;
use super::system::on_threads;
use super::{interrupt, print};

/// Runs the command.
///
/// # Errors
/// If the number of spheres is impossible, or a file cannot be written.
pub(super) fn run(args: &GenerateArgs) -> Result<Exit> {
    let recipe = Recipe::new(args.arrangement, args.count, args.seed, args.colors)?;
    if args.scene.as_ref() == Some(&args.output) {
        return Err(Error::input("the table and the scene cannot be the same file")
            .with_help("name another file with --scene"));
    }
    let table = AtomicFile::new(&args.output)?;
    let scene = args.scene.as_deref().map(AtomicFile::new).transpose()?;
    interrupt::listen();
    on_threads(args.threads, || write_table(&recipe, table, &args.output))?;
    if let (Some(file), Some(path)) = (scene, &args.scene) {
        let text = scene_text(&recipe, &table_as_seen_from(path, &args.output), args.floor);
        file.write(|to| to.write_all(text.as_bytes()))?;
        let path = path.display();
        print::note(format_args!("wrote {path}; try: photosphere render {path} -o picture.png"));
    }
    Ok(Exit::Done)
}

fn write_table(recipe: &Recipe, file: AtomicFile, path: &Path) -> Result<()> {
    let start = Instant::now();
    // Hidden unless the standard error is a terminal.
    let bar = ProgressBar::new(recipe.count());
    let written = file.write(|to| write_rows(recipe, to, &|rows| bar.set_position(rows)));
    bar.finish_and_clear();
    written?;
    let spheres = print::count(recipe.count() as usize, "sphere");
    let seconds = start.elapsed().as_secs_f64();
    print::note(format_args!("wrote {}: {spheres} in {seconds:.2} s", path.display()));
    Ok(())
}

/// Returns the path by which the scene refers to its table: just the file name if both are in one
/// folder.
fn table_as_seen_from(scene: &Path, table: &Path) -> PathBuf {
    let name = table.file_name().map(PathBuf::from);
    match name {
        Some(name) if scene.parent() == table.parent() => name,
        _ => std::path::absolute(table).unwrap_or_else(|_| table.to_path_buf()),
    }
}
