//! Exit codes of the program. Scripts rely on them, and `--help` lists them.

use std::process::ExitCode;
use std::sync::OnceLock;
use std::sync::mpsc::{self, Receiver, Sender};

use crate::error::{Category, Error};

/// Exit code of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum Exit {
    Done = 0,
    CheckFailed = 1,
    Usage = 2,
    Input = 3,
    File = 4,
    Backend = 5,
    /// Rust's own exit code for a panic.
    Fault = 101,
    /// 128 plus the number of SIGINT, as in shells.
    Stopped = 130,
}

/// Sends the exit code to the main thread.
static LEAVE: OnceLock<Sender<u8>> = OnceLock::new();

/// Creates the channel on which the main thread receives the exit code.
pub(super) fn last_word() -> Receiver<u8> {
    let (leave, left) = mpsc::channel();
    LEAVE.get_or_init(|| leave);
    left
}

/// Asks the main thread to end the program at once with this exit code, whatever its threads do.
pub(super) fn leave_with(code: u8) {
    if let Some(leave) = LEAVE.get() {
        // Fails only if the program is ending already.
        let _ = leave.send(code);
    }
}

/// Ends the program without the destructors of C and C++ libraries: other threads may still be
/// inside Embree, and its destructors abort the process if a lock is held. Everything printed has
/// been flushed.
pub(super) fn end(code: u8) -> ! {
    signal_hook::low_level::exit(code.into())
}

/// The table of exit codes for `--help` and the manual page.
pub(super) const EXIT_CODES: &str = "\
Exit codes:
  0    done
  1    a check failed (crosscheck, verify, reproduce, or compare with a limit),
       or render or merge did not reach --noise (the picture is written)
  2    the command line is invalid: an unknown option, or a missing or invalid
       value
  3    the scene, a table or the value of an option is invalid, a table cannot
       be read, or pictures cannot be compared
  4    another file could not be read or written
  5    the intersector is missing or failed
  101  a bug in photosphere; please report it. render has written the samples so
       far, if any
  130  stopped by Ctrl-C, SIGTERM, SIGHUP, SIGXCPU or SIGUSR2; render has
       written the samples so far, if any

With --json, an error is also printed on the standard output, as one value:
{\"error\": {...}} with exit_code, category, message, help and diagnostics, the
errors in a scene, each with message, help, file, line and column.";

impl Exit {
    pub(super) fn of(error: &Error) -> Self {
        match error.category() {
            Category::Input => Self::Input,
            Category::File => Self::File,
            Category::Backend => Self::Backend,
            Category::Cancelled => Self::Stopped,
        }
    }
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit as u8)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_exit_code_is_in_the_help() {
        use Exit::{Backend, CheckFailed, Done, Fault, File, Input, Stopped, Usage};
        let codes: Vec<u8> = EXIT_CODES
            .lines()
            .filter_map(|line| line.split_whitespace().next()?.parse().ok())
            .collect();
        let exits = [Done, CheckFailed, Usage, Input, File, Backend, Fault, Stopped];
        assert_eq!(codes, exits.map(|exit| exit as u8));
    }
}
