//! Saving at the end of a render. What cannot be written is tried again for a while, and then written
//! elsewhere, so that the only copy of the samples does not go with the program.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::error::{Error, Result};
use crate::task::parallel;

/// How long files are tried again whose content would be lost.
const RETRY_TIMEOUT: Duration = Duration::from_secs(60);
/// Between two tries.
const RETRY_INTERVAL: Duration = Duration::from_secs(1);
/// Between two looks at whether somebody waits for the end.
const POLL_INTERVAL: Duration = Duration::from_millis(20);

/// Writes a file in its own place, or in another.
pub type WriteFn<'a> = dyn Fn(Option<&Path>) -> Result<()> + Send + Sync + 'a;

/// A file that is to be written.
pub struct SaveTask<'a> {
    /// Its place.
    pub path: PathBuf,
    /// Whether its content is nowhere else.
    pub is_only_copy: bool,
    /// What to do about it where nothing is lost.
    pub help: String,
    /// How.
    pub write: Box<WriteFn<'a>>,
}

/// How to save.
pub struct RetryPolicy<'a> {
    /// Whether somebody waits for the end.
    pub skip_retries: &'a (dyn Fn() -> bool + Sync),
    /// Says a warning.
    pub warn: &'a (dyn Fn(String) + Sync),
}

/// An errand that failed, and why.
struct FailedTask<'a> {
    task: &'a SaveTask<'a>,
    error: Error,
}

/// Writes the first and the others at once.
///
/// # Errors
/// When something could not be written in its place, with where it is and what was written.
pub fn save_all(
    first: &[SaveTask<'_>],
    others: &[SaveTask<'_>],
    policy: &RetryPolicy<'_>,
) -> Result<()> {
    let (mut failed, more) = parallel::join(|| run_tasks(first), || run_tasks(others));
    failed.extend(more);
    retry(&mut failed, policy);
    if failed.is_empty() {
        return Ok(());
    }
    let is_written = |errand: &&SaveTask<'_>| failed.iter().all(|one| one.task.path != errand.path);
    let written: Vec<String> =
        first.iter().chain(others).filter(is_written).map(|errand| quoted(&errand.path)).collect();
    let mut help: Vec<String> = failed.iter().map(FailedTask::rescue).collect();
    help.dedup();
    if !written.is_empty() {
        help.push(format!("written: {}", written.join(", ")));
    }
    Err(failed.swap_remove(0).error.with_help(help.join("; ")))
}

fn run_tasks<'a>(errands: &'a [SaveTask<'a>]) -> Vec<FailedTask<'a>> {
    let failed = |errand: &'a SaveTask<'a>| {
        (errand.write)(None).err().map(|error| FailedTask { task: errand, error })
    };
    errands.iter().filter_map(failed).collect()
}

/// Tries again while something would be lost, unless somebody waits.
fn retry(failed: &mut Vec<FailedTask<'_>>, policy: &RetryPolicy<'_>) {
    let is_lost = |failed: &[FailedTask<'_>]| failed.iter().any(|one| one.task.is_only_copy);
    if !is_lost(failed) || (policy.skip_retries)() {
        return;
    }
    for one in failed.iter() {
        let (error, patience) = (&one.error, RETRY_TIMEOUT.as_secs());
        (policy.warn)(format!("{error}; it is tried again for {patience} s"));
    }
    let (until, mut next) = (Instant::now() + RETRY_TIMEOUT, Instant::now() + RETRY_INTERVAL);
    while is_lost(failed) && Instant::now() < until && !(policy.skip_retries)() {
        std::thread::sleep(POLL_INTERVAL);
        if Instant::now() < next {
            continue;
        }
        failed.retain_mut(|one| one.still_fails(policy));
        next = Instant::now() + RETRY_INTERVAL;
    }
}

impl FailedTask<'_> {
    fn still_fails(&mut self, manner: &RetryPolicy<'_>) -> bool {
        match (self.task.write)(None) {
            Ok(()) => {
                (manner.warn)(format!("can write {} again", quoted(&self.task.path)));
                false
            }
            Err(error) => {
                self.error = error;
                true
            }
        }
    }

    /// What to do about it; what would be lost is written elsewhere.
    fn rescue(&self) -> String {
        let SaveTask { path, is_only_copy: is_vital, help, write } = self.task;
        if !is_vital {
            return help.clone();
        }
        let places = rescue_paths(path);
        match places.iter().find(|place| write(Some(place)).is_ok()) {
            Some(place) => format!("it is in {} instead", quoted(place)),
            None => {
                let places: Vec<String> = places.iter().map(|place| quoted(place)).collect();
                format!("it is lost: it could not be written to {} either", places.join(" or "))
            }
        }
    }
}

/// Where a file may go that cannot go where it belongs: into the folder of the command, or into the
/// system's for temporary files. No other file has such a name.
fn rescue_paths(path: &Path) -> Vec<PathBuf> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let name = format!("rescued-{}-{name}", std::process::id());
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

    fn errand<'a>(
        name: &str,
        is_vital: bool,
        write: impl Fn(Option<&Path>) -> Result<()> + Send + Sync + 'a,
    ) -> SaveTask<'a> {
        let help = "write it again".to_owned();
        SaveTask { path: PathBuf::from(name), is_only_copy: is_vital, help, write: Box::new(write) }
    }

    fn full<T>() -> Result<T> {
        Err(Error::file("write", Path::new("a.part"), "no space left"))
    }

    #[test]
    fn what_would_be_lost_is_tried_again_until_it_is_written() {
        let (tries, told) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
        let write = |_: Option<&Path>| match tries.fetch_add(1, Ordering::SeqCst) {
            0..2 => full(),
            _ => Ok(()),
        };
        let manner =
            RetryPolicy { skip_retries: &|| false, warn: &|text| told.lock().unwrap().push(text) };
        save_all(&[errand("a.part", true, write)], &[], &manner).unwrap();
        let expected = [
            "cannot write `a.part`: no space left; it is tried again for 60 s",
            "can write `a.part` again",
        ];
        assert_eq!(*told.lock().unwrap(), expected);
    }

    #[test]
    fn in_haste_it_is_written_elsewhere_and_the_error_says_where() {
        let manner = RetryPolicy { skip_retries: &|| true, warn: &|text| panic!("{text}") };
        let elsewhere = |place: Option<&Path>| if place.is_some() { Ok(()) } else { full() };
        let part = [errand("kept/a.part", true, elsewhere)];
        let others = [errand("a.png", false, |_| Ok(())), errand("a.exr", false, |_| full())];
        let error = save_all(&part, &others, &manner).unwrap_err();
        let help = error.help().unwrap();
        let name = format!("rescued-{}-a.part", std::process::id());
        assert!(help.starts_with("it is in `") && help.contains(&name), "{help}");
        assert!(help.ends_with("` instead; write it again; written: `a.png`"), "{help}");

        let error = save_all(&[errand("a.part", true, |_| full())], &[], &manner).unwrap_err();
        assert!(error.help().unwrap().starts_with("it is lost: "), "{error:?}");
    }
}
