//! Ctrl-C. While there is nothing to save, it ends the program at once; once there is, the first asks
//! the work to stop, and the second ends the program at once.

use std::fs;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::iterator::Signals;

use crate::accel::Cancel;
use crate::output::remove_unfinished;

use super::exit::Exit;
use super::print;

/// What Ctrl-C, or being told to terminate, means at the moment.
#[derive(Clone, Default)]
pub(super) struct Interrupt {
    cancel: Cancel,
    can_save: Arc<AtomicBool>,
}

/// Listens for Ctrl-C and for being told to terminate, with nothing to save so far.
///
/// A signal that the program was started to ignore, as SIGHUP under `nohup` or SIGINT in the background
/// of a script, stays ignored. Unfinished files are removed before the program dies at once.
pub(super) fn listen() -> Interrupt {
    let interrupt = Interrupt::default();
    let ours = interrupt.clone();
    let handler = move || {
        let is_second = ours.cancel.is_cancelled();
        if ours.can_save.load(Ordering::Relaxed) && !is_second {
            ours.cancel.cancel();
            print::remark("stopping; press Ctrl-C again to stop at once and write nothing");
            return;
        }
        remove_unfinished();
        if !is_second {
            print::remark("stopped; nothing was written");
        }
        std::process::exit(i32::from(Exit::Stopped as u8));
    };
    // Without them, signals do what they do to any program.
    if let Ok(mut signals) = Signals::new(heeded()) {
        let listener = move || signals.forever().for_each(|_| handler());
        let _ = thread::Builder::new().name("signals".to_owned()).spawn(listener);
    }
    interrupt
}

/// The signals to end, but for those that the parent process made this one ignore: its wish is the
/// user's.
fn heeded() -> Vec<i32> {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = mask.and_then(|hex| u64::from_str_radix(hex.trim(), 16).ok()).unwrap_or(0);
    [SIGINT, SIGTERM, SIGHUP]
        .into_iter()
        .filter(|signal| ignored >> (signal - 1) & 1 == 0)
        .collect()
}

impl Interrupt {
    /// The request that the first Ctrl-C sets, once there is something to save.
    pub(super) fn cancel(&self) -> Cancel {
        self.cancel.clone()
    }

    /// From here on there is work that the first Ctrl-C should not throw away.
    pub(super) fn save_from_now_on(&self) {
        self.can_save.store(true, Ordering::Relaxed);
    }
}
