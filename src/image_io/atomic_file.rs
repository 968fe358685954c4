//! Atomic file writes: a file appears complete or not at all.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use tempfile::NamedTempFile;

use crate::error::{Error, Result};

/// The writer that receives a file's content.
pub type Sink<'a> = BufWriter<&'a mut File>;

/// A writable file path, checked when created. The content goes into a temporary file in the same
/// folder, which is renamed once all bytes are on the disk. An existing file keeps its permissions.
/// You can write repeatedly.
#[derive(Clone, Debug)]
pub struct AtomicFile {
    path: PathBuf,
}

/// Temporary files of this process.
static TEMP_FILES: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Suffix of temporary file names.
const SUFFIX: &str = ".photosphere-tmp";

/// A temporary file unmodified for this long belongs to a process that died.
const STALE_AFTER: Duration = Duration::from_secs(600);

impl AtomicFile {
    /// Prepares to write `path`, and removes stale temporary files of processes that died.
    ///
    /// # Errors
    /// When `path` is a folder, not a regular file or write-protected, when its folder is missing
    /// or not writable, or when the name is too long.
    pub fn new(path: &Path) -> Result<Self> {
        reject_folder(path, "file")?;
        if path.exists() && !path.is_file() {
            return Err(Error::file("write", path, "it is not a regular file"));
        }
        let path = resolve_symlink(path)?;
        reject_protected(&path)?;
        remove_stale(&path);
        drop(TempFile::create(&path)?);
        // The name of the temporary file is short; that of the file itself may be too long.
        match fs::symlink_metadata(&path) {
            Err(e) if e.kind() != io::ErrorKind::NotFound => {
                return Err(Error::file("write", &path, os_message(&e)));
            }
            _ => {}
        }
        Ok(Self { path })
    }

    /// Like [`Self::new`], and requires the given extension (case-insensitive).
    ///
    /// # Errors
    /// On another extension, and as [`Self::new`].
    pub fn with_extension(path: &Path, extension: &str) -> Result<Self> {
        if !path.extension().unwrap_or_default().eq_ignore_ascii_case(extension) {
            let (path, upper) = (path.display(), extension.to_ascii_uppercase());
            return Err(Error::input(format!("`{path}` does not end in .{extension}"))
                .with_help(format!("the output is {upper}; use the extension .{extension}")));
        }
        Self::new(path)
    }

    /// Path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes the content to a temporary file and renames it.
    ///
    /// # Errors
    /// On I/O errors. An existing file is then unchanged, and no temporary file remains.
    pub fn write(&self, content: impl FnOnce(&mut Sink<'_>) -> io::Result<()>) -> Result<()> {
        self.write_impl(content, true)
    }

    /// Like [`Self::write`], but does not sync to the disk. The file is still either complete or
    /// unchanged, unless the power fails before the system has written it.
    ///
    /// # Errors
    /// As [`Self::write`].
    pub fn write_unsynced(
        &self,
        content: impl FnOnce(&mut Sink<'_>) -> io::Result<()>,
    ) -> Result<()> {
        self.write_impl(content, false)
    }

    fn write_impl(
        &self,
        content: impl FnOnce(&mut Sink<'_>) -> io::Result<()>,
        is_synced: bool,
    ) -> Result<()> {
        let failed = |e: io::Error| Error::file("write", &self.path, os_message(&e));
        let mut unfinished = TempFile::create(&self.path)?;
        let mut sink = BufWriter::with_capacity(1 << 16, unfinished.file.as_file_mut());
        content(&mut sink).map_err(failed)?;
        let file = sink.into_inner().map_err(|e| failed(e.into_error()))?;
        if is_synced {
            file.sync_all().map_err(failed)?;
        }
        let TempFile { file, registration: known_as } = unfinished;
        keep_permissions(&self.path, file.as_file()).map_err(failed)?;
        file.persist(&self.path).map_err(|e| failed(e.error))?;
        drop(known_as);
        if is_synced {
            sync_folder(&self.path);
        }
        Ok(())
    }
}

/// Removes all temporary files of this process, before it exits.
pub fn remove_temp_files() {
    let unfinished = TEMP_FILES.lock().unwrap_or_else(PoisonError::into_inner);
    for path in unfinished.iter() {
        // Ignores errors: the file may already be renamed.
        let _ = fs::remove_file(path);
    }
}

/// A temporary file registered for [`remove_temp_files`].
struct TempFile {
    file: NamedTempFile,
    registration: Registration,
}

/// Entry of a temporary file in `TEMP_FILES`; removed on drop.
struct Registration(PathBuf);

impl Drop for Registration {
    fn drop(&mut self) {
        let mut unfinished = TEMP_FILES.lock().unwrap_or_else(PoisonError::into_inner);
        unfinished.retain(|path| *path != self.0);
    }
}

impl TempFile {
    fn create(path: &Path) -> Result<Self> {
        // Hold the lock until the file is registered, so that `remove_temp_files` misses none.
        let mut unfinished = TEMP_FILES.lock().unwrap_or_else(PoisonError::into_inner);
        let file = create_temp_file(path)?;
        unfinished.push(file.path().to_path_buf());
        let known_as = Registration(file.path().to_path_buf());
        Ok(Self { file, registration: known_as })
    }
}

/// Prefix of a file's temporary names. Long names are truncated to leave room for the rest.
fn prefix(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    format!(".{}.", name.chars().take(48).collect::<String>())
}

/// Removes temporary files of `path` left by processes that died.
fn remove_stale(path: &Path) {
    let prefix = prefix(path);
    let Ok(entries) = fs::read_dir(parent_folder(path)) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let is_unfinished = name.starts_with(&prefix) && name.ends_with(SUFFIX);
        let modified = || entry.metadata().ok()?.modified().ok()?.elapsed().ok();
        if is_unfinished && modified().is_some_and(|age| age > STALE_AFTER) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Syncs a renamed file's folder to the disk, where the system supports it.
fn sync_folder(path: &Path) {
    #[cfg(unix)]
    let _ = File::open(parent_folder(path)).and_then(|folder| folder.sync_all());
    #[cfg(not(unix))]
    let _ = path;
}

fn parent_folder(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Returns an error if `path` is a folder; the help suggests the file `example` in it.
pub(super) fn reject_folder(path: &Path, example: &str) -> Result<()> {
    if !path.is_dir() {
        return Ok(());
    }
    let example = path.join(example);
    Err(Error::file("write", path, "it is a folder")
        .with_help(format!("name a file in it, such as `{}`", example.display())))
}

/// Returns an error if an existing file is write-protected: renaming would replace it all the same,
/// because only the permissions of the folder matter to that.
fn reject_protected(path: &Path) -> Result<()> {
    let Ok(metadata) = fs::metadata(path) else { return Ok(()) };
    let reason = match OpenOptions::new().write(true).open(path) {
        Ok(_) if !metadata.permissions().readonly() => return Ok(()),
        // The system may let the administrator write it.
        Ok(_) => "it is write-protected".to_owned(),
        Err(e) => os_message(&e),
    };
    Err(Error::file("write", path, reason).with_help("make it writable, or name another file"))
}

/// Gives a new file the permissions and, where possible, the group of the file that it replaces.
#[cfg(unix)]
fn keep_permissions(old: &Path, new: &File) -> io::Result<()> {
    use std::os::unix::fs::{MetadataExt, PermissionsExt, fchown};
    let Ok(metadata) = fs::metadata(old) else { return Ok(()) };
    let mut mode = metadata.mode() & 0o777;
    let has_group =
        new.metadata()?.gid() == metadata.gid() || fchown(new, None, Some(metadata.gid())).is_ok();
    if !has_group {
        // Another group gets no more than everybody.
        mode = mode & 0o707 | (mode & 0o7) << 3;
    }
    new.set_permissions(fs::Permissions::from_mode(mode))
}

/// On other systems, new files inherit their permissions from the folder.
#[cfg(not(unix))]
fn keep_permissions(_: &Path, _: &File) -> io::Result<()> {
    Ok(())
}

/// Resolves a symbolic link, so that writing replaces its target and keeps the link.
fn resolve_symlink(path: &Path) -> Result<PathBuf> {
    let Ok(link) = fs::read_link(path) else {
        return Ok(path.to_path_buf());
    };
    fs::canonicalize(path).map_err(|e| {
        let reason = format!("it is a link to `{}`, which cannot be reached ({e})", link.display());
        Error::file("write", path, reason).with_help("remove the link, or name another file")
    })
}

/// Creates the temporary file in the folder of `path`, with default file permissions (tempfile
/// makes files private by default).
fn create_temp_file(path: &Path) -> Result<NamedTempFile> {
    let refused = |reason: String| Error::file("write", path, reason);
    let folder = parent_folder(path);
    let shown = folder.display();
    if !folder.exists() {
        return Err(refused(format!("the folder `{shown}` does not exist"))
            .with_help(format!("create it first: mkdir -p '{shown}'")));
    }
    let mut builder = tempfile::Builder::new();
    let prefix = prefix(path);
    builder.prefix(&prefix).suffix(SUFFIX);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder
        .tempfile_in(folder)
        .map_err(|e| refused(format!("nothing can be created in `{shown}` ({})", os_message(&e))))
}

/// The system's error message, without the temporary file name that tempfile appends.
fn os_message(error: &io::Error) -> String {
    let words = error.to_string();
    words.split(" at path ").next().unwrap_or_default().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    #[test]
    fn what_a_dead_process_left_is_removed_once_it_is_old() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.part");
        let at = |name: &str| folder.path().join(name);
        let old = File::create(at(".a.part.x1y2.photosphere-tmp")).unwrap();
        old.set_modified(std::time::SystemTime::now() - 2 * STALE_AFTER).unwrap();
        for name in [".a.part.new.photosphere-tmp", ".b.part.old.photosphere-tmp", "a.part.tmp"] {
            let file = File::create(at(name)).unwrap();
            if !name.contains("new") {
                file.set_modified(std::time::SystemTime::now() - 2 * STALE_AFTER).unwrap();
            }
        }
        let file = AtomicFile::new(&path).unwrap();
        assert!(!at(".a.part.x1y2.photosphere-tmp").exists());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 3);
        for text in ["first", "second"] {
            file.write(|to| to.write_all(text.as_bytes())).unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), text);
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 4);
    }

    #[cfg(unix)]
    #[test]
    fn a_file_keeps_its_permissions_and_a_protected_one_its_content() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.part");
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
        fs::write(&path, "old").unwrap();
        for bits in [0o660, 0o600, 0o606, 0o777] {
            fs::set_permissions(&path, fs::Permissions::from_mode(bits)).unwrap();
            let file = AtomicFile::new(&path).unwrap();
            file.write(|to| to.write_all(b"new")).unwrap();
            assert_eq!(mode(&path), bits);
        }
        fs::set_permissions(&path, fs::Permissions::from_mode(0o444)).unwrap();
        let error = AtomicFile::new(&path).unwrap_err();
        assert!(error.to_string().starts_with("cannot write `"), "{error}");
        assert_eq!(error.help(), Some("make it writable, or name another file"));
        assert_eq!((fs::read(&path).unwrap(), mode(&path)), (b"new".to_vec(), 0o444));
    }

    #[test]
    fn a_failed_write_tells_why_and_leaves_the_old_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.part");
        let file = AtomicFile::new(&path).unwrap();
        file.write(|to| to.write_all(b"old")).unwrap();
        let full = || io::Error::new(io::ErrorKind::StorageFull, "no space left");
        let error = file.write(|_| Err(full())).unwrap_err().to_string();
        assert!(error.ends_with("a.part`: no space left"), "{error}");
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        // Remove the folder, then create it again.
        fs::remove_dir_all(folder.path()).unwrap();
        let error = file.write(|to| to.write_all(b"new")).unwrap_err().to_string();
        assert!(error.ends_with("does not exist"), "{error}");
        fs::create_dir(folder.path()).unwrap();
        file.write(|to| to.write_all(b"new")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
    }
}
