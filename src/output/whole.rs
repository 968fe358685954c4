//! A file that appears whole or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use crate::error::{Error, Result};

/// What a file's content is written to.
pub type Sink<'a> = BufWriter<&'a mut File>;

/// A place where a file can be written: the folder is there and lets us in. The content goes into a
/// temporary file beside it, which takes the name once every byte is on the disk.
#[derive(Debug)]
pub struct WholeFile {
    path: PathBuf,
    temporary: NamedTempFile,
}

impl WholeFile {
    /// Prepares to write `path`.
    ///
    /// # Errors
    /// When `path` is a folder or no regular file, or when its folder is missing or cannot be written
    /// to.
    pub fn new(path: &Path) -> Result<Self> {
        refuse_folder(path, "file")?;
        if path.exists() && !path.is_file() {
            return Err(Error::file("write", path, "it is not a regular file"));
        }
        let path = end_of_link(path)?;
        let temporary = create_beside(&path)?;
        Ok(Self { path, temporary })
    }

    /// The unfinished file, which disappears with this; a program that is about to die without
    /// cleaning up may remove it.
    pub fn temporary(&self) -> &Path {
        self.temporary.path()
    }

    /// Writes the content and gives the file its name.
    ///
    /// # Errors
    /// When the disk refuses; a file that was there before is then unchanged, and nothing else is
    /// left behind.
    pub fn write(mut self, content: impl FnOnce(&mut Sink<'_>) -> io::Result<()>) -> Result<()> {
        let failed = |e: io::Error| Error::file("write", &self.path, e);
        let mut sink = BufWriter::new(self.temporary.as_file_mut());
        content(&mut sink).map_err(failed)?;
        sink.into_inner().map_err(|e| failed(e.into_error()))?.sync_all().map_err(failed)?;
        self.temporary.persist(&self.path).map_err(|e| failed(e.error))?;
        Ok(())
    }
}

/// Refuses to write over a folder; `example` would be a file in it.
pub(super) fn refuse_folder(path: &Path, example: &str) -> Result<()> {
    if !path.is_dir() {
        return Ok(());
    }
    let example = path.join(example);
    Err(Error::file("write", path, "it is a folder")
        .with_help(format!("name a file in it, such as `{}`", example.display())))
}

/// The file that a symbolic link means, so that writing replaces that and keeps the link.
fn end_of_link(path: &Path) -> Result<PathBuf> {
    let Ok(link) = fs::read_link(path) else {
        return Ok(path.to_path_buf());
    };
    fs::canonicalize(path).map_err(|e| {
        let reason = format!("it is a link to `{}`, which cannot be reached ({e})", link.display());
        Error::file("write", path, reason).with_help("remove the link, or name another file")
    })
}

/// Creates the temporary file in the folder of `path`, with the permissions of any new file (by
/// default the library makes it private).
fn create_beside(path: &Path) -> Result<NamedTempFile> {
    let refused = |reason: String| Error::file("write", path, reason);
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let shown = folder.display();
    if !folder.exists() {
        return Err(refused(format!("the folder `{shown}` does not exist"))
            .with_help(format!("create it first: mkdir -p '{shown}'")));
    }
    let mut builder = tempfile::Builder::new();
    builder.prefix(".photosphere-").suffix(".tmp");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder
        .tempfile_in(folder)
        .map_err(|e| refused(format!("nothing can be created in `{shown}` ({})", system_words(&e))))
}

/// The system's own words, without the name of the temporary file that tempfile adds behind them.
fn system_words(error: &io::Error) -> String {
    let words = error.to_string();
    words.split(" at path ").next().unwrap_or_default().to_owned()
}
