//! How far a render has come: a bar on a terminal, a line every few seconds elsewhere.

use std::io::IsTerminal;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressStyle};

use crate::render;

use super::print;

const BETWEEN_LINES: Duration = Duration::from_secs(3);
const BAR: &str = "{bar:32} {percent:>3} %  {rate}  {eta} left";

/// Shows the progress of one render on the standard error.
pub(super) enum Progress {
    Quiet,
    Bar(ProgressBar),
    Lines { started: Instant, last: Mutex<Instant> },
}

impl Progress {
    pub(super) fn new(quiet: bool) -> Self {
        let now = Instant::now();
        if quiet {
            Self::Quiet
        } else if std::io::stderr().is_terminal() {
            Self::Bar(bar())
        } else {
            Self::Lines { started: now, last: Mutex::new(now) }
        }
    }

    /// Shows the state; called from any thread, as often as it likes.
    pub(super) fn show(&self, state: render::Progress) {
        match self {
            Self::Quiet => {}
            Self::Bar(bar) => {
                bar.set_length(state.samples_total);
                bar.set_position(state.samples_done);
            }
            Self::Lines { started, last } => {
                // Another thread that holds the lock is printing a line just now.
                let Ok(mut last) = last.try_lock() else { return };
                if last.elapsed() >= BETWEEN_LINES {
                    *last = Instant::now();
                    print::remark(line(state, started.elapsed()));
                }
            }
        }
    }

    /// Lets something be said without a bar in the way.
    pub(super) fn say(&self, words: impl FnOnce()) {
        match self {
            Self::Bar(bar) => bar.suspend(words),
            _ => words(),
        }
    }

    /// Takes the bar away.
    pub(super) fn finish(&self) {
        if let Self::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}

fn bar() -> ProgressBar {
    let style = ProgressStyle::with_template(BAR).expect("the template is a constant");
    let rate = |state: &indicatif::ProgressState, f: &mut dyn std::fmt::Write| {
        // A bar that cannot be drawn is not worth an error.
        let _ = write!(f, "{}samples/s", print::si(state.per_sec()));
    };
    let bar = ProgressBar::no_length().with_style(style.with_key("rate", rate));
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}

fn line(state: render::Progress, elapsed: Duration) -> String {
    let render::Progress { samples_done: done, samples_total: total } = state;
    let share = done as f64 / total.max(1) as f64;
    let rate = done as f64 / elapsed.as_secs_f64();
    let left = if share > 0.0 {
        let seconds = elapsed.as_secs_f64() * (1.0 - share) / share;
        format!("{} left", HumanDuration(Duration::from_secs_f64(seconds.min(1e9))))
    } else {
        "just begun".to_owned()
    };
    format!(
        "{:.0} % of {}samples, {}samples/s, {left}",
        100.0 * share,
        print::si(total as f64),
        print::si(rate)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_tells_share_rate_and_time_left() {
        let at = |samples_done| {
            let state = render::Progress { samples_done, samples_total: 4_000_000 };
            line(state, Duration::from_secs(10))
        };
        assert_eq!(at(1_000_000), "25 % of 4.00 Msamples, 100 ksamples/s, 30 seconds left");
        assert_eq!(at(0), "0 % of 4.00 Msamples, 0.00 samples/s, just begun");
    }

    #[test]
    fn the_bar_template_is_valid() {
        bar().finish_and_clear();
    }
}
