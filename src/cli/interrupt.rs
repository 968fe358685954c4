//! Ctrl-C: the first asks the work to stop, the second ends the program at once.

use std::path::Path;

use crate::accel::Cancel;

use super::exit::Exit;
use super::print;

/// Listens for Ctrl-C (and for being told to terminate) and returns the request that it sets.
///
/// A signal that the program was started to ignore, as under `nohup`, stays ignored, and then none
/// is listened for. `unfinished` is removed before the program dies at once.
pub(super) fn listen(unfinished: Option<&Path>) -> Cancel {
    let cancel = Cancel::default();
    let ours = cancel.clone();
    let unfinished = unfinished.map(Path::to_path_buf);
    let handler = move || {
        if ours.is_cancelled() {
            // It may be gone already: the picture is then complete under its own name.
            let _ = unfinished.as_ref().map(std::fs::remove_file);
            std::process::exit(i32::from(Exit::Stopped as u8));
        }
        ours.cancel();
        print::remark("stopping; press Ctrl-C again to stop at once and write nothing");
    };
    // Refused where the parent process ignores one of the signals; its wish is the user's.
    let _ = ctrlc::try_set_handler(handler);
    cancel
}
