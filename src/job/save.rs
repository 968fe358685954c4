//! Saves files at the end of a render. Failed writes are retried for a while and then go to another
//! place, so that the only copy of the samples is not lost.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::error::{Error, Result};
use crate::task::parallel;

/// How long to retry files whose content would otherwise be lost.
const RETRY_TIMEOUT: Duration = Duration::from_secs(60);
/// Time between two attempts.
const RETRY_INTERVAL: Duration = Duration::from_secs(1);
/// Time between checks of whether to skip further retries.
const POLL_INTERVAL: Duration = Duration::from_millis(20);

/// Maximum length of a file's own name in the name of its rescued copy.
const MAX_NAME_BYTES: usize = 200;

/// Writes a file to its own path (`None`) or to another one.
pub type WriteFn<'a> = dyn Fn(Option<&Path>) -> Result<()> + Send + Sync + 'a;

/// A file to save.
pub struct SaveTask<'a> {
    /// Path of the file.
    pub path: PathBuf,
    /// False for a stream, which is written once and never elsewhere.
    pub is_file: bool,
    /// Writes the file.
    pub write: Box<WriteFn<'a>>,
}

/// The files at the end of a render.
pub struct SaveTasks<'a> {
    /// The checkpoint. Without one, nothing but the pictures holds the samples.
    pub checkpoint: Option<SaveTask<'a>>,
    /// The pictures. They can be made again from the checkpoint.
    pub pictures: Vec<SaveTask<'a>>,
    /// Says how to make pictures again from a checkpoint, given its path and their names.
    pub remake: &'a (dyn Fn(&Path, &str) -> String + Sync),
}

/// How failed writes are retried.
pub struct RetryPolicy<'a> {
    /// Returns true if the user is waiting for the program to exit.
    pub skip_retries: &'a (dyn Fn() -> bool + Sync),
    /// Reports a warning.
    pub warn: &'a (dyn Fn(String) + Sync),
}

/// A task that failed, with its error.
struct FailedTask<'a> {
    task: &'a SaveTask<'a>,
    error: Error,
}

/// Saves all files concurrently. If a checkpoint cannot be written, or a picture without one, the
/// write is retried for a while and then goes to a rescue path.
///
/// # Errors
/// If a file could not be written to its path. The message says where its content is and which
/// files were written.
pub fn save_all(tasks: &SaveTasks<'_>, policy: &RetryPolicy<'_>) -> Result<()> {
    let checkpoint = tasks.checkpoint.as_slice();
    let (mut failed, more) =
        parallel::join(|| run_tasks(checkpoint), || run_tasks(&tasks.pictures));
    failed.extend(more);
    retry(&mut failed, tasks, policy);
    let all = || checkpoint.iter().chain(&tasks.pictures);
    let has_failed =
        |task: &SaveTask<'_>, failed: &[FailedTask<'_>]| failed.iter().any(|one| one.is(task));
    // A folder may vanish after a file was written to it.
    let vanished =
        |task: &&SaveTask<'_>| !has_failed(task, &failed) && task.is_file && !task.path.is_file();
    let vanished: Vec<_> = all().filter(vanished).map(FailedTask::vanished).collect();
    failed.extend(vanished);
    if failed.is_empty() {
        return Ok(());
    }
    failed.sort_by_key(|one| all().position(|task| one.is(task)));
    let mut help = tasks.rescue(&failed);
    let written: Vec<String> =
        all().filter(|task| !has_failed(task, &failed)).map(|task| quoted(&task.path)).collect();
    if !written.is_empty() {
        help.push(format!("written: {}", written.join(", ")));
    }
    Err(failed.swap_remove(0).error.with_help(help.join("; ")))
}

impl SaveTasks<'_> {
    /// Returns true if the failures would lose samples.
    fn is_at_risk(&self, failed: &[FailedTask<'_>]) -> bool {
        match &self.checkpoint {
            Some(checkpoint) => failed.iter().any(|one| one.is(checkpoint)),
            None => failed.iter().any(|one| one.task.is_file),
        }
    }

    /// Saves elsewhere what the failures would lose, and says where everything is.
    fn rescue(&self, failed: &[FailedTask<'_>]) -> Vec<String> {
        let is_checkpoint =
            |one: &&FailedTask<'_>| self.checkpoint.as_ref().is_some_and(|task| one.is(task));
        let mut help = Vec::new();
        let mut samples = self.checkpoint.as_ref().map(|task| task.path.clone());
        if let Some(checkpoint) = failed.iter().find(is_checkpoint) {
            let (place, words) = checkpoint.rescue();
            samples = place;
            help.push(words);
        }
        let pictures: Vec<_> = failed.iter().filter(|one| !is_checkpoint(one)).collect();
        match samples {
            Some(samples) if !pictures.is_empty() => {
                let names: Vec<String> =
                    pictures.iter().map(|one| quoted(&one.task.path)).collect();
                help.push((self.remake)(&samples, &names.join(" and ")));
            }
            Some(_) => {}
            None => help.extend(pictures.iter().map(|one| one.rescue().1)),
        }
        help
    }
}

fn run_tasks<'a>(errands: &'a [SaveTask<'a>]) -> Vec<FailedTask<'a>> {
    let failed = |errand: &'a SaveTask<'a>| {
        (errand.write)(None).err().map(|error| FailedTask { task: errand, error })
    };
    errands.iter().filter_map(failed).collect()
}

/// Retries failed tasks while samples would be lost, unless the user is waiting for exit.
fn retry(failed: &mut Vec<FailedTask<'_>>, tasks: &SaveTasks<'_>, policy: &RetryPolicy<'_>) {
    if !tasks.is_at_risk(failed) || (policy.skip_retries)() {
        return;
    }
    for one in failed.iter() {
        let (error, patience) = (&one.error, RETRY_TIMEOUT.as_secs());
        (policy.warn)(format!("{error}; retrying for {patience} s"));
    }
    let (until, mut next) = (Instant::now() + RETRY_TIMEOUT, Instant::now() + RETRY_INTERVAL);
    while tasks.is_at_risk(failed) && Instant::now() < until && !(policy.skip_retries)() {
        std::thread::sleep(POLL_INTERVAL);
        if Instant::now() < next {
            continue;
        }
        failed.retain_mut(|failed_task| failed_task.still_fails(policy));
        next = Instant::now() + RETRY_INTERVAL;
    }
}

impl<'a> FailedTask<'a> {
    /// The failure of a task whose file was written and is there no more.
    fn vanished(task: &'a SaveTask<'a>) -> Self {
        let error = Error::file("write", &task.path, "it was written, and has vanished since");
        Self { task, error }
    }

    fn is(&self, task: &SaveTask<'_>) -> bool {
        self.task.path == task.path
    }

    fn still_fails(&mut self, policy: &RetryPolicy<'_>) -> bool {
        match (self.task.write)(None) {
            Ok(()) => {
                (policy.warn)(format!("writing {} works again", quoted(&self.task.path)));
                false
            }
            Err(error) => {
                self.error = error;
                true
            }
        }
    }

    /// Writes the content to a rescue path, and returns that path and what to tell the user.
    fn rescue(&self) -> (Option<PathBuf>, String) {
        let SaveTask { path, is_file, write } = self.task;
        if !is_file {
            return (None, "write the picture into a file".to_owned());
        }
        let (name, places) = (quoted(path), rescue_paths(path));
        if let Some(place) = places.iter().find(|place| write(Some(place)).is_ok()) {
            return (Some(place.clone()), format!("{name} is in {} instead", quoted(place)));
        }
        let places: Vec<String> = places.iter().map(|place| quoted(place)).collect();
        let mut words = format!(
            "the content of {name} is lost: it could not be written to {} either",
            places.join(" or ")
        );
        if path.is_file() {
            words += "; the file of that name is an older one";
        }
        (None, words)
    }
}

/// Alternative paths for a file that cannot be written: in the current folder, then in the system's
/// temporary folder. The names are unique to this process. A long name loses its beginning, because
/// its end tells the format.
fn rescue_paths(path: &Path) -> Vec<PathBuf> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let excess = name.len().saturating_sub(MAX_NAME_BYTES);
    let start = (excess..name.len()).find(|&at| name.is_char_boundary(at)).unwrap_or(0);
    let name = format!("rescued-{}-{}", std::process::id(), &name[start..]);
    let folders = [std::env::current_dir().ok(), Some(std::env::temp_dir())];
    folders.into_iter().flatten().map(|folder| folder.join(&name)).collect()
}

fn quoted(path: &Path) -> String {
    format!("`{}`", path.display())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// A file in `folder` that `write` agrees to write, given the rescue path if it is one.
    fn task<'a>(
        folder: &'a Path,
        name: &str,
        agree: impl Fn(Option<&Path>) -> bool + Send + Sync + 'a,
    ) -> SaveTask<'a> {
        let path = folder.join(name);
        let own = path.clone();
        let write = move |place: Option<&Path>| {
            let path = place.unwrap_or(&own);
            let file = |e: std::io::Error| Error::file("write", path, e);
            match agree(place) {
                true => std::fs::write(path, "").map_err(file),
                false => Err(Error::file("write", path, "no space left")),
            }
        };
        SaveTask { path, is_file: true, write: Box::new(write) }
    }

    fn tasks<'a>(checkpoint: Option<SaveTask<'a>>, pictures: Vec<SaveTask<'a>>) -> SaveTasks<'a> {
        let remake = &|samples: &Path, pictures: &str| {
            assert!(samples.is_file(), "the samples are where the message says");
            format!("make {pictures} from {}", samples.display())
        };
        SaveTasks { checkpoint, pictures, remake }
    }

    /// Saves in haste; returns the message and the help, and removes the rescued files.
    fn told(tasks: &SaveTasks<'_>) -> (String, String) {
        let policy = RetryPolicy { skip_retries: &|| true, warn: &|text| panic!("{text}") };
        let error = save_all(tasks, &policy).unwrap_err();
        for task in tasks.checkpoint.iter().chain(&tasks.pictures) {
            rescue_paths(&task.path).iter().for_each(|path| drop(std::fs::remove_file(path)));
        }
        (error.to_string(), error.help().unwrap().to_owned())
    }

    #[test]
    fn what_would_be_lost_is_tried_again_until_it_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let (tries, warnings) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
        let agree = |_: Option<&Path>| tries.fetch_add(1, Ordering::SeqCst) >= 2;
        let policy = RetryPolicy {
            skip_retries: &|| false,
            warn: &|text| warnings.lock().unwrap().push(text),
        };
        let part = task(folder.path(), "a.part", agree);
        let name = part.path.display().to_string();
        save_all(&tasks(Some(part), Vec::new()), &policy).unwrap();
        let expected = [
            format!("cannot write `{name}`: no space left; retrying for 60 s"),
            format!("writing `{name}` works again"),
        ];
        assert_eq!(*warnings.lock().unwrap(), expected);
    }

    #[test]
    fn a_rescued_checkpoint_is_named_wherever_the_samples_are() {
        let folder = tempfile::tempdir().unwrap();
        let of = |name, agree: fn(Option<&Path>) -> bool| task(folder.path(), name, agree);
        let pictures = vec![of("a.png", |_| true), of("a.exr", |_| false), of("b.exr", |_| false)];
        let (message, help) = told(&tasks(Some(of("a.part", |place| place.is_some())), pictures));
        let at = |name: &str| folder.path().join(name).display().to_string();
        let rescued = rescue_paths(&folder.path().join("a.part"))[0].display().to_string();
        assert_eq!(message, format!("cannot write `{}`: no space left", at("a.part")));
        let expected = format!(
            "`{}` is in `{rescued}` instead; make `{}` and `{}` from {rescued}; written: `{}`",
            at("a.part"),
            at("a.exr"),
            at("b.exr"),
            at("a.png")
        );
        assert_eq!(help, expected);
    }

    #[test]
    fn where_the_samples_are_lost_the_pictures_are_rescued() {
        let folder = tempfile::tempdir().unwrap();
        let of = |name, agree: fn(Option<&Path>) -> bool| task(folder.path(), name, agree);
        std::fs::write(folder.path().join("a.part"), "older").unwrap();
        let part = of("a.part", |_| false);
        let picture = of("c.png", |place| place.is_some());
        let (_, help) = told(&tasks(Some(part), vec![picture]));
        assert!(help.contains("a.part` is lost: it could not be written to `"), "{help}");
        assert!(help.contains(" either; the file of that name is an older one; `"), "{help}");
        let rescued = rescue_paths(Path::new("c.png"))[0].display().to_string();
        assert!(help.ends_with(&format!("c.png` is in `{rescued}` instead")), "{help}");
    }

    #[test]
    fn a_file_that_vanishes_after_it_was_written_is_not_called_written() {
        let folder = tempfile::tempdir().unwrap();
        let gone = folder.path().join("gone");
        std::fs::create_dir(&gone).unwrap();
        let part = task(&gone, "d.part", |_| true);
        // The pictures come after the checkpoint on this thread, which is of no pool.
        let picture = task(folder.path(), "d.png", |_| {
            std::fs::remove_dir_all(&gone).unwrap();
            true
        });
        let (message, help) = told(&tasks(Some(part), vec![picture]));
        assert!(message.ends_with("d.part`: it was written, and has vanished since"), "{message}");
        assert!(
            help.contains("d.part` is in `") && help.contains("` instead; written: `"),
            "{help}"
        );
        assert!(help.ends_with("d.png`"), "{help}");
    }

    #[test]
    fn a_rescued_name_is_never_too_long() {
        let long = format!("{}.part", "ü".repeat(125));
        let path = &rescue_paths(Path::new(&long))[0];
        let name = path.file_name().unwrap().to_str().unwrap();
        assert!(name.len() < 230 && name.ends_with("üü.part"), "{name}");
        assert!(name.starts_with(&format!("rescued-{}-ü", std::process::id())));
    }
}
