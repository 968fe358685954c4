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

/// Writes a file to its own path (`None`) or to another one.
pub type WriteFn<'a> = dyn Fn(Option<&Path>) -> Result<()> + Send + Sync + 'a;

/// A file to save.
pub struct SaveTask<'a> {
    /// Path of the file.
    pub path: PathBuf,
    /// True if the content exists nowhere else.
    pub is_only_copy: bool,
    /// Help text for a failure that loses nothing.
    pub help: String,
    /// Writes the file.
    pub write: Box<WriteFn<'a>>,
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

/// Runs the tasks in `first` and in `others` concurrently.
///
/// # Errors
/// If a file could not be written to its path. The message says where its content is and which
/// files were written.
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
    let is_written =
        |task: &&SaveTask<'_>| failed.iter().all(|failed_task| failed_task.task.path != task.path);
    let written: Vec<String> =
        first.iter().chain(others).filter(is_written).map(|task| quoted(&task.path)).collect();
    let mut help: Vec<String> = failed.iter().map(FailedTask::rescue).collect();
    help.dedup();
    if !written.is_empty() {
        help.push(format!("written: {}", written.join(", ")));
    }
    Err(failed.swap_remove(0).error.with_help(help.join("; ")))
}

fn run_tasks<'a>(tasks: &'a [SaveTask<'a>]) -> Vec<FailedTask<'a>> {
    let failed =
        |task: &'a SaveTask<'a>| (task.write)(None).err().map(|error| FailedTask { task, error });
    tasks.iter().filter_map(failed).collect()
}

/// Retries failed tasks while content would be lost, unless the user is waiting for exit.
fn retry(failed: &mut Vec<FailedTask<'_>>, policy: &RetryPolicy<'_>) {
    let is_lost =
        |failed: &[FailedTask<'_>]| failed.iter().any(|failed_task| failed_task.task.is_only_copy);
    if !is_lost(failed) || (policy.skip_retries)() {
        return;
    }
    for failed_task in failed.iter() {
        let (error, seconds) = (&failed_task.error, RETRY_TIMEOUT.as_secs());
        (policy.warn)(format!("{error}; retrying for {seconds} s"));
    }
    let (deadline, mut next) = (Instant::now() + RETRY_TIMEOUT, Instant::now() + RETRY_INTERVAL);
    while is_lost(failed) && Instant::now() < deadline && !(policy.skip_retries)() {
        std::thread::sleep(POLL_INTERVAL);
        if Instant::now() < next {
            continue;
        }
        failed.retain_mut(|failed_task| failed_task.still_fails(policy));
        next = Instant::now() + RETRY_INTERVAL;
    }
}

impl FailedTask<'_> {
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

    /// Help text for the failure. Writes content that would be lost to a rescue path.
    fn rescue(&self) -> String {
        let SaveTask { path, is_only_copy, help, write } = self.task;
        if !is_only_copy {
            return help.clone();
        }
        let paths = rescue_paths(path);
        match paths.iter().find(|rescue_path| write(Some(rescue_path)).is_ok()) {
            Some(rescue_path) => format!("its content is in {} instead", quoted(rescue_path)),
            None => {
                let paths: Vec<String> =
                    paths.iter().map(|rescue_path| quoted(rescue_path)).collect();
                format!("it is lost: it could not be written to {} either", paths.join(" or "))
            }
        }
    }
}

/// Alternative paths for a file that cannot be written: in the current folder, then in the system's
/// temporary folder. The names are unique to this process.
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

    fn task<'a>(
        name: &str,
        is_only_copy: bool,
        write: impl Fn(Option<&Path>) -> Result<()> + Send + Sync + 'a,
    ) -> SaveTask<'a> {
        let help = "write it again".to_owned();
        SaveTask { path: PathBuf::from(name), is_only_copy, help, write: Box::new(write) }
    }

    fn full<T>() -> Result<T> {
        Err(Error::file("write", Path::new("a.part"), "no space left"))
    }

    #[test]
    fn what_would_be_lost_is_tried_again_until_it_is_written() {
        let (tries, warnings) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
        let write = |_: Option<&Path>| match tries.fetch_add(1, Ordering::SeqCst) {
            0..2 => full(),
            _ => Ok(()),
        };
        let policy = RetryPolicy {
            skip_retries: &|| false,
            warn: &|text| warnings.lock().unwrap().push(text),
        };
        save_all(&[task("a.part", true, write)], &[], &policy).unwrap();
        let expected = [
            "cannot write `a.part`: no space left; retrying for 60 s",
            "writing `a.part` works again",
        ];
        assert_eq!(*warnings.lock().unwrap(), expected);
    }

    #[test]
    fn in_haste_it_is_written_elsewhere_and_the_error_says_where() {
        let policy = RetryPolicy { skip_retries: &|| true, warn: &|text| panic!("{text}") };
        let elsewhere =
            |rescue_path: Option<&Path>| if rescue_path.is_some() { Ok(()) } else { full() };
        let part = [task("kept/a.part", true, elsewhere)];
        let others = [task("a.png", false, |_| Ok(())), task("a.exr", false, |_| full())];
        let error = save_all(&part, &others, &policy).unwrap_err();
        let help = error.help().unwrap();
        let name = format!("rescued-{}-a.part", std::process::id());
        assert!(help.starts_with("its content is in `") && help.contains(&name), "{help}");
        assert!(help.ends_with("` instead; write it again; written: `a.png`"), "{help}");

        let error = save_all(&[task("a.part", true, |_| full())], &[], &policy).unwrap_err();
        assert!(error.help().unwrap().starts_with("it is lost: "), "{error:?}");
    }
}
