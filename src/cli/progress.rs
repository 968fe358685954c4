//! How far a render has come: a bar on a terminal, a line every few seconds elsewhere.

use std::io::IsTerminal;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::job::pace::{self, Pace};
use crate::job::{self, Observer};
use crate::task;

use super::print;

const BETWEEN_LINES: Duration = Duration::from_secs(3);
const BAR: &str = "{bar:24} {percent:>3} %  {msg}";

/// What there is to tell.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct State {
    pub(super) samples_done: u64,
    /// Samples of the whole render; the most where only an estimate is known.
    pub(super) samples_total: u64,
    /// Samples per second.
    pub(super) rate: f64,
    /// The error of the picture so far, as a share of the brightness of its pixels.
    pub(super) error: Option<f64>,
    /// Squares that are good enough, and all of them.
    pub(super) squares: Option<[usize; 2]>,
    /// The time left, in words.
    pub(super) left: Option<String>,
}

impl State {
    /// The state of work that began at some time, and takes so many samples.
    pub(super) fn since(began: Instant, samples_done: u64, samples_total: u64) -> Self {
        let left = samples_total.saturating_sub(samples_done);
        let pace = Pace { elapsed: began.elapsed(), samples: samples_done, left: left..left };
        Self {
            samples_done,
            samples_total,
            rate: pace.rate(),
            left: pace.time_left().map(|left| pace::in_words(&left)),
            ..Self::default()
        }
    }

    fn of(progress: &job::Progress) -> Self {
        Self {
            samples_done: progress.samples_done,
            samples_total: progress.samples_total,
            rate: progress.rate,
            error: progress.error,
            squares: progress.squares,
            left: progress.left.as_ref().map(pace::in_words),
        }
    }
}

/// Shows the progress of one render on the standard error.
pub(super) enum Progress {
    Quiet,
    Bar(ProgressBar),
    Lines { last: Mutex<Instant> },
}

impl Progress {
    pub(super) fn new(quiet: bool) -> Self {
        if quiet {
            Self::Quiet
        } else if std::io::stderr().is_terminal() {
            Self::Bar(bar())
        } else {
            Self::Lines { last: Mutex::new(Instant::now()) }
        }
    }

    /// Whether anybody sees it.
    pub(super) fn is_shown(&self) -> bool {
        !matches!(self, Self::Quiet)
    }

    /// Shows the state; called from any thread, as often as it likes.
    pub(super) fn show(&self, state: &State) {
        match self {
            Self::Quiet => {}
            Self::Bar(bar) => {
                bar.set_length(state.samples_total);
                bar.set_message(details(state));
                bar.set_position(state.samples_done);
            }
            Self::Lines { last } => {
                // Another thread that holds the lock is printing a line just now.
                let Ok(mut last) = last.try_lock() else { return };
                if last.elapsed() >= BETWEEN_LINES {
                    *last = Instant::now();
                    print::remark(line(state));
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

impl Observer for Progress {
    fn wants_progress(&self) -> bool {
        self.is_shown()
    }

    fn progress(&self, progress: &job::Progress) {
        self.show(&State::of(progress));
    }

    fn warning(&self, text: &str) {
        self.say(|| print::warning(text));
    }
}

/// Says how far a build is, every few seconds: nothing for builds that are over by then.
pub(super) fn of_a_build(quiet: bool) -> task::Progress {
    if quiet {
        return task::Progress::default();
    }
    let last = Mutex::new(Instant::now());
    task::Progress::new(move |done| {
        let Ok(mut last) = last.try_lock() else { return };
        if last.elapsed() >= BETWEEN_LINES && done < 1.0 {
            *last = Instant::now();
            print::remark(format_args!("{:.0} % of the intersector built", 100.0 * done));
        }
    })
}

fn bar() -> ProgressBar {
    let style = ProgressStyle::with_template(BAR).expect("the template is a constant");
    ProgressBar::no_length().with_style(style)
}

fn line(state: &State) -> String {
    let share = state.samples_done as f64 / state.samples_total.max(1) as f64;
    let total = print::si(state.samples_total as f64);
    format!("{:.0} % of {total}samples, {}", 100.0 * share.min(1.0), details(state))
}

/// All but the share that is done.
fn details(state: &State) -> String {
    let rate = format!("{}samples/s", print::si(state.rate));
    let error = state.error.map(|error| format!("error {}", print::percent(error)));
    let squares = state.squares.map(|[done, all]| format!("{done} of {all} squares done"));
    let left = match &state.left {
        Some(left) => format!("{left} left"),
        None => "just begun".to_owned(),
    };
    let words: Vec<String> =
        [Some(rate), error, squares, Some(left)].into_iter().flatten().collect();
    words.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_tells_share_rate_error_and_time_left() {
        let state = State {
            samples_done: 1_000_000,
            samples_total: 4_000_000,
            rate: 1e5,
            left: Some("30 s".to_owned()),
            ..State::default()
        };
        assert_eq!(line(&state), "25 % of 4.00 Msamples, 100 ksamples/s, 30 s left");
        let state = State { error: Some(0.0234), squares: Some([3, 40]), ..state };
        let told =
            "25 % of 4.00 Msamples, 100 ksamples/s, error 2.34 %, 3 of 40 squares done, 30 s left";
        assert_eq!(line(&state), told);
        let begun = State { samples_total: 4_000_000, ..State::default() };
        assert_eq!(line(&begun), "0 % of 4.00 Msamples, 0.00 samples/s, just begun");
    }

    #[test]
    fn the_bar_template_is_valid() {
        bar().finish_and_clear();
    }
}
