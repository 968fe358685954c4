//! Signal handling.
//!
//! Until there is something to save, Ctrl-C or SIGTERM ends the program at once. After that, either
//! asks the work to stop, and only a second Ctrl-C ends the program at once. A second SIGTERM does
//! not: a system that shuts down sends several signals in a row.

use std::fs;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGUSR1, SIGUSR2, SIGXCPU, SIGXFSZ};
use signal_hook::iterator::Signals;

use crate::image_io::remove_temp_files;
use crate::job::SaveRequest;
use crate::task::CancelToken;

use super::exit::{Exit, leave_with};
use super::print;

/// The requests that signals make.
#[derive(Clone, Default)]
pub(super) struct Interrupt {
    cancel: CancelToken,
    can_save: Arc<AtomicBool>,
    is_asked: Arc<AtomicBool>,
    save_request: SaveRequest,
}

/// The signals received so far.
#[derive(Default)]
struct Heard {
    any: bool,
    ctrl_c: bool,
}

/// The effect of a signal.
#[derive(Debug, PartialEq)]
enum Meaning {
    /// Stop, and save what there is.
    Stop,
    /// Save what there is, and continue.
    Save,
    /// Nothing beyond the earlier requests.
    Nothing,
    /// Exit at once.
    Die,
}

impl Heard {
    fn meaning(&mut self, signal: i32, can_save: bool) -> Meaning {
        if signal == SIGUSR1 {
            return Meaning::Save;
        }
        let is_ctrl_c = signal == SIGINT;
        let is_first = !std::mem::replace(&mut self.any, true);
        let is_repeated = is_ctrl_c && std::mem::replace(&mut self.ctrl_c, true);
        match (can_save, is_repeated) {
            (false, _) | (_, true) => Meaning::Die,
            _ if is_first || is_ctrl_c => Meaning::Stop,
            _ => Meaning::Nothing,
        }
    }
}

/// Listens for the signals that end a program, and for those by which batch systems announce an
/// end: SIGXCPU and SIGUSR2 stop as Ctrl-C does, SIGUSR1 saves and continues. Initially there is
/// nothing to save.
///
/// Ignored signals stay ignored, such as SIGHUP under `nohup` or SIGINT in a background job of a
/// script. Unfinished files are removed before the program exits at once.
pub(super) fn listen() -> Interrupt {
    let interrupt = Interrupt::default();
    let ours = interrupt.clone();
    let mut heard = Heard::default();
    let mut handler = move |signal| {
        let is_asked = ours.is_requested();
        match heard.meaning(signal, ours.can_save.load(Ordering::Relaxed)) {
            Meaning::Stop => {
                ours.is_asked.store(true, Ordering::Relaxed);
                ours.cancel.cancel();
                print::note("stopping; press Ctrl-C again to exit at once and write nothing");
            }
            Meaning::Save => ours.save_request.request(),
            Meaning::Nothing => {}
            Meaning::Die => {
                remove_temp_files();
                if !is_asked {
                    print::note("stopped; nothing was written");
                }
                leave_with(Exit::Stopped as u8);
            }
        }
    };
    // If this fails, signals keep their default effect.
    if let Ok(mut signals) = Signals::new(heeded()) {
        let listener = move || signals.forever().for_each(&mut handler);
        let _ = thread::Builder::new().name("signals".to_owned()).spawn(listener);
    }
    interrupt
}

/// Returns the signals to handle. Signals that the parent process set to be ignored stay so,
/// because the user asked for that.
fn heeded() -> Vec<i32> {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = mask.and_then(|hex| u64::from_str_radix(hex.trim(), 16).ok()).unwrap_or(0);
    [SIGINT, SIGTERM, SIGHUP, SIGXCPU, SIGUSR1, SIGUSR2]
        .into_iter()
        .filter(|signal| ignored >> (signal - 1) & 1 == 0)
        .collect()
}

/// Makes a write beyond the file size limit fail like a full disk, instead of ending the program.
pub(super) fn survive_file_size_limits() {
    // With any handler installed, the write returns an error.
    let _ = signal_hook::flag::register(SIGXFSZ, Arc::default());
}

impl Interrupt {
    /// The stop request that the first signal sets once there is something to save. Others may set
    /// it, too, for example when the time is up.
    pub(super) fn cancel(&self) -> CancelToken {
        self.cancel.clone()
    }

    /// The request that SIGUSR1 sets.
    pub(super) fn save_request(&self) -> SaveRequest {
        self.save_request.clone()
    }

    /// Returns true if a signal asked the program to stop.
    pub(super) fn is_requested(&self) -> bool {
        self.is_asked.load(Ordering::Relaxed)
    }

    /// Announces work that the first Ctrl-C must not throw away.
    pub(super) fn enable_saving(&self) {
        self.can_save.store(true, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_second_ctrl_c_ends_what_can_be_saved() {
        let meanings = |signals: &[i32], can_save: bool| -> Vec<Meaning> {
            let mut heard = Heard::default();
            signals.iter().map(|signal| heard.meaning(*signal, can_save)).collect()
        };
        use Meaning::{Die, Nothing, Save, Stop};
        assert_eq!(meanings(&[SIGTERM, SIGHUP, SIGTERM], true), [Stop, Nothing, Nothing]);
        assert_eq!(meanings(&[SIGINT, SIGHUP, SIGTERM], true), [Stop, Nothing, Nothing]);
        assert_eq!(meanings(&[SIGTERM, SIGINT, SIGINT], true), [Stop, Stop, Die]);
        assert_eq!(meanings(&[SIGINT, SIGINT], true), [Stop, Die]);
        assert_eq!(
            meanings(&[SIGUSR1, SIGUSR2, SIGUSR1, SIGXCPU], true),
            [Save, Stop, Save, Nothing]
        );
        assert_eq!(meanings(&[SIGUSR1, SIGINT], false), [Save, Die]);
        for signal in [SIGINT, SIGTERM, SIGHUP, SIGXCPU, SIGUSR2] {
            assert_eq!(meanings(&[signal], false), [Die]);
        }
    }
}
