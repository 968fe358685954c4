//! Several files, each to a picture of its name in one folder.

use std::fs;
use std::path::{Path, PathBuf};

use crate::cli::args::RenderArgs;
use crate::cli::exit::Exit;
use crate::cli::print;
use crate::error::{Error, Result};
use crate::job::FilePath;

use super::request::RenderRequest;

/// Returns the folder for the pictures, if a folder is the output.
///
/// # Errors
/// If there are several files and no folder, or a checkpoint for several files.
pub(super) fn folder(args: &RenderArgs) -> Result<Option<PathBuf>> {
    let is_folder = |path: &PathBuf| {
        path.to_string_lossy().ends_with('/') || (!args.more.is_empty() && path.is_dir())
    };
    match &args.output.files[..] {
        [only] if is_folder(only) => {}
        _ if args.more.is_empty() => return Ok(None),
        _ => {
            let message = "several files are rendered into a folder";
            return Err(Error::input(message).with_help("name a folder: -o pictures/"));
        }
    }
    if args.keep.checkpoint.is_some() || args.watch.preview.is_some() {
        let message = "a checkpoint or preview is of one picture, but the output is a folder";
        return Err(Error::input(message).with_help("render the files one by one"));
    }
    Ok(Some(args.output.files[0].clone()))
}

/// Renders all files with `render`, each to a .png file of its name. A file that fails does not
/// keep the others from being rendered.
///
/// # Errors
/// If the folder cannot be made, two pictures would have one name, or no file can be rendered.
pub(super) fn run(
    args: &RenderArgs,
    folder: &Path,
    render: impl Fn(RenderRequest) -> Result<Exit>,
) -> Result<Exit> {
    fs::create_dir_all(folder).map_err(|error| Error::file("make the folder", folder, error))?;
    let scenes: Vec<&PathBuf> = [&args.scene.path].into_iter().chain(&args.more).collect();
    let pictures: Vec<PathBuf> = scenes.iter().map(|scene| picture(scene, folder)).collect();
    for (index, picture) in pictures.iter().enumerate() {
        if let Some(earlier) = pictures[..index].iter().position(|other| other == picture) {
            let (first, second) = (scenes[earlier].display(), scenes[index].display());
            let message = format!("`{first}` and `{second}` would both be `{}`", picture.display());
            return Err(Error::input(message).with_help("rename one of them"));
        }
    }
    let mut last = Ok(Exit::Done);
    for (scene, picture) in scenes.into_iter().zip(pictures) {
        let mut request = RenderRequest::of_args(args);
        request.scene.clone_from(scene);
        request.delivery.files = vec![FilePath(picture)];
        match render(request) {
            Ok(Exit::Done) => {}
            Ok(Exit::Stopped) => return Ok(Exit::Stopped),
            Ok(other) => last = Ok(other),
            Err(error) => {
                print::warning(format_args!("`{}` is not rendered: {error}", scene.display()));
                last = Err(error);
            }
        }
    }
    last
}

/// The picture of a file, without the endings of the format and its compression.
fn picture(scene: &Path, folder: &Path) -> PathBuf {
    let name = scene.file_name().map_or_else(String::new, |name| name.to_string_lossy().into());
    let name = name.trim_end_matches(".gz").trim_end_matches(".zst");
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    folder.join(format!("{stem}.png"))
}
