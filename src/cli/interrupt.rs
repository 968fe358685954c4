//! Ctrl-C. While there is nothing to save, it ends the program at once; once there is, the first asks
//! the work to stop, and the second ends the program at once.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

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
/// A signal that the program was started to ignore, as under `nohup`, stays ignored, and then none
/// is listened for. Unfinished files are removed before the program dies at once.
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
    // Refused where the parent process ignores one of the signals; its wish is the user's.
    let _ = ctrlc::try_set_handler(handler);
    interrupt
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
