//! Progress display: a bar on a terminal, a line every few seconds elsewhere.

use std::io::IsTerminal;
use std::ops::ControlFlow;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::task;

use crate::job::eta::{self, Eta};
use crate::job::{self, FirstEstimate, Observer};

use super::print;

/// The time between two lines at first. It grows with the time that has passed, so that the log of
/// a night stays short.
const BETWEEN_LINES: Duration = Duration::from_secs(3);
/// The part of the time that has passed after which another line is printed.
const PART_BETWEEN_LINES: u32 = 8;
/// The longest time between two lines.
const MOST_BETWEEN_LINES: Duration = Duration::from_secs(600);
const BAR: &str = "{bar:10} {percent:>3} %  {msg}";

/// The state to display.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct ProgressState {
    pub(super) samples_done: u64,
    /// Samples of the whole render; the upper bound if only an estimate is known.
    pub(super) samples_total: u64,
    /// Samples per second.
    pub(super) rate: f64,
    /// The error of the whole picture so far.
    pub(super) error: Option<f64>,
    /// That of the tile with the largest, with a noise target.
    pub(super) worst_error: Option<f64>,
    /// Tiles that have reached the noise target, and all tiles.
    pub(super) tiles: Option<[usize; 2]>,
    /// How far it is to the first estimate of the noise.
    pub(super) to_first_estimate: Option<FirstEstimate>,
    /// The estimated time left, as text.
    pub(super) left: Option<String>,
}

impl ProgressState {
    /// Returns the state of work that began at `began` and takes `samples_total` samples.
    pub(super) fn since(began: Instant, samples_done: u64, samples_total: u64) -> Self {
        let left = samples_total.saturating_sub(samples_done);
        let estimate =
            Eta { elapsed: began.elapsed(), samples: samples_done, samples_left: left..left };
        Self {
            samples_done,
            samples_total,
            rate: estimate.rate(),
            left: estimate.time_left().map(|left| eta::format_time_range(&left)),
            ..Self::default()
        }
    }

    fn of(progress: &job::RenderProgress) -> Self {
        Self {
            samples_done: progress.samples_done,
            samples_total: progress.samples_total,
            rate: progress.rate,
            error: progress.error,
            worst_error: progress.worst_error,
            tiles: progress.tiles_converged,
            to_first_estimate: progress.to_first_estimate,
            left: progress.time_left.as_ref().map(eta::format_time_range),
        }
    }
}

/// When lines are printed.
pub(super) struct LineClock {
    began: Instant,
    last: Instant,
    between: Duration,
}

impl LineClock {
    fn new(between: Duration) -> Mutex<Self> {
        let now = Instant::now();
        Mutex::new(Self { began: now, last: now, between })
    }

    /// Returns true if another line is due.
    fn is_time_for_a_line(&mut self, now: Instant) -> bool {
        let pause = ((now - self.began) / PART_BETWEEN_LINES).min(MOST_BETWEEN_LINES);
        let is_due = now - self.last >= pause.max(self.between);
        if is_due {
            self.last = now;
        }
        is_due
    }
}

/// A progress display on the standard error.
pub(super) enum ProgressDisplay {
    Quiet,
    Bar(ProgressBar),
    /// Without a terminal: a line from time to time.
    Lines(Mutex<LineClock>),
}

impl ProgressDisplay {
    /// Creates the display of a render.
    pub(super) fn new(quiet: bool) -> Self {
        Self::with(quiet, BAR, BETWEEN_LINES)
    }

    /// Creates a bar from the template, or prints a line every `between`.
    pub(super) fn with(quiet: bool, template: &str, between: Duration) -> Self {
        if quiet {
            Self::Quiet
        } else if std::io::stderr().is_terminal() {
            let style = ProgressStyle::with_template(template).expect("templates are constants");
            let bar = ProgressBar::no_length().with_style(style);
            // The elapsed time advances even if there is no progress.
            bar.enable_steady_tick(Duration::from_millis(200));
            Self::Bar(bar)
        } else {
            Self::Lines(LineClock::new(between))
        }
    }

    /// Displays the state of a render. Any thread may call this at any rate.
    pub(super) fn show(&self, state: &ProgressState) {
        let ProgressState { samples_done, samples_total, .. } = *state;
        self.grow(samples_done, samples_total, || details(state), || line(state));
    }

    /// Displays that `done` of `all` is done, with a text for the bar or for the line.
    pub(super) fn grow(
        &self,
        done: u64,
        all: u64,
        beside: impl FnOnce() -> String,
        line: impl FnOnce() -> String,
    ) {
        match self {
            Self::Quiet => {}
            Self::Bar(bar) => {
                // The whole may turn out to be more than was expected, but the bar does not go
                // back.
                let shown = bar.position() as f64 / bar.length().unwrap_or(0).max(1) as f64;
                bar.set_length(all);
                bar.set_message(beside());
                bar.set_position(done.max((shown * all as f64) as u64).min(all));
            }
            Self::Lines(clock) => {
                // If the lock is taken, another thread is printing a line.
                let Ok(mut clock) = clock.try_lock() else { return };
                if clock.is_time_for_a_line(Instant::now()) {
                    print::note(line());
                }
            }
        }
    }

    /// Hides the bar while `words` prints.
    pub(super) fn suspend(&self, words: impl FnOnce()) {
        match self {
            Self::Bar(bar) => bar.suspend(words),
            _ => words(),
        }
    }

    /// Removes the bar.
    pub(super) fn finish(&self) {
        if let Self::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}

impl Observer for ProgressDisplay {
    fn wants_progress(&self) -> bool {
        !matches!(self, Self::Quiet)
    }

    fn on_progress(&self, progress: &job::RenderProgress) -> ControlFlow<()> {
        self.show(&ProgressState::of(progress));
        ControlFlow::Continue(())
    }

    fn on_warning(&self, text: &str) {
        self.suspend(|| print::warning(text));
    }
}

/// Returns a callback that reports the progress of a build every few seconds. Shorter builds print
/// nothing.
pub(super) fn build_progress(quiet: bool) -> task::ProgressCallback {
    if quiet {
        return task::ProgressCallback::default();
    }
    let lines = ProgressDisplay::Lines(LineClock::new(BETWEEN_LINES));
    task::ProgressCallback::new(move |done| {
        let line = || format!("{:.0} % of the intersector built", 100.0 * done);
        if done < 1.0 {
            lines.grow(0, 0, String::new, line);
        }
    })
}

fn line(state: &ProgressState) -> String {
    if state.to_first_estimate.is_some() {
        return details(state);
    }
    let share = state.samples_done as f64 / state.samples_total.max(1) as f64;
    let total = print::si(state.samples_total as f64);
    format!("{:.0} % of {total}samples, {}", 100.0 * share.min(1.0), details(state))
}

/// Tells how far it is to the first estimate; the time left where a limit sets it.
fn to_first_estimate(way: &FirstEstimate, left: Option<&str>) -> String {
    let FirstEstimate { samples, needed, time_per_sample, time_left } = way;
    let time = |time: Duration| eta::format_time_range(&(time..time));
    let each = match time_per_sample.as_secs_f64() {
        seconds if seconds < 0.95 => format!("{:.0} ms", 1e3 * seconds),
        _ => time(*time_per_sample),
    };
    let then = match left {
        Some(left) => format!("{left} left"),
        None => format!("estimate in {}", time(*time_left)),
    };
    format!("{samples:.1} of {needed} samples per pixel, {each} each, {then}")
}

/// Two digits suffice for what changes while one reads it.
fn short_percent(fraction: f64) -> String {
    let percent = 100.0 * fraction;
    if percent < 9.95 { format!("{percent:.1} %") } else { format!("{percent:.0} %") }
}

/// Formats everything but the fraction done, in at most 62 columns: with the bar, 80.
fn details(state: &ProgressState) -> String {
    if let Some(way) = &state.to_first_estimate {
        return to_first_estimate(way, state.left.as_deref());
    }
    // With a noise target, what is left to do says more than the rate.
    let rate = state.tiles.is_none().then(|| format!("{}samples/s", print::si(state.rate)));
    let error = state.error.map(|error| format!("error {}", short_percent(error)));
    let worst = state.worst_error.map(|error| format!("worst {}", short_percent(error)));
    let tiles = state.tiles.map(|[done, all]| format!("{done}/{all} tiles"));
    let left = match &state.left {
        Some(left) => format!("{left} left"),
        None => "estimating".to_owned(),
    };
    let words = [rate, error, worst, tiles, Some(left)];
    let words: Vec<String> = words.into_iter().flatten().collect();
    words.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_tells_share_rate_error_and_time_left() {
        let state = ProgressState {
            samples_done: 1_000_000,
            samples_total: 4_000_000,
            rate: 1e5,
            left: Some("30 s".to_owned()),
            ..ProgressState::default()
        };
        assert_eq!(line(&state), "25 % of 4.00 Msamples, 100 ksamples/s, 30 s left");
        let noise = ProgressState {
            error: Some(0.0234),
            worst_error: Some(0.179),
            tiles: Some([3, 40]),
            ..state.clone()
        };
        let expected = "25 % of 4.00 Msamples, error 2.3 %, worst 18 %, 3/40 tiles, 30 s left";
        assert_eq!(line(&noise), expected);
        let begun = ProgressState { samples_total: 4_000_000, ..ProgressState::default() };
        assert_eq!(line(&begun), "0 % of 4.00 Msamples, 0.00 samples/s, estimating");
    }

    #[test]
    fn a_bar_fits_a_terminal_and_does_not_go_back() {
        let longest = ProgressState {
            error: Some(0.0987),
            worst_error: Some(1.234),
            tiles: Some([10_000, 10_000]),
            left: Some("10 to 99 min".to_owned()),
            ..ProgressState::default()
        };
        assert!(details(&longest).len() <= 62, "{}", details(&longest));
        let bar = ProgressBar::hidden();
        let display = ProgressDisplay::Bar(bar.clone());
        for (done, total, shown) in [(50, 100, 0.5), (60, 1200, 0.5), (900, 1200, 0.75)] {
            let state =
                ProgressState { samples_done: done, samples_total: total, ..longest.clone() };
            display.show(&state);
            assert_eq!(bar.position() as f64 / bar.length().unwrap() as f64, shown);
        }
    }

    #[test]
    fn before_the_first_estimate_the_way_there_is_told() {
        let way = FirstEstimate {
            samples: 12.3,
            needed: 64,
            time_per_sample: Duration::from_millis(850),
            time_left: Duration::from_secs(44),
        };
        let state = ProgressState {
            tiles: Some([0, 12_000]),
            to_first_estimate: Some(way),
            ..ProgressState::default()
        };
        let expected = "12.3 of 64 samples per pixel, 850 ms each, estimate in 44 s";
        assert_eq!((details(&state), line(&state)), (expected.to_owned(), expected.to_owned()));
        let limited = ProgressState { left: Some("10 s".to_owned()), ..state.clone() };
        assert!(details(&limited).ends_with(" 850 ms each, 10 s left"), "{}", details(&limited));
        let slow = FirstEstimate {
            time_per_sample: Duration::from_secs(300),
            time_left: Duration::from_secs(19_000),
            ..way
        };
        let state = ProgressState { to_first_estimate: Some(slow), ..state };
        assert!(details(&state).ends_with("5 min each, estimate in 5.3 h"), "{}", details(&state));
        assert!(details(&state).len() <= 62, "{}", details(&state));
    }

    /// A night of ten hours, looked at ten times per second.
    #[test]
    fn lines_become_rarer() {
        let clock = LineClock::new(BETWEEN_LINES);
        let mut clock = clock.into_inner().unwrap();
        let begin = clock.began;
        let at = |tenths: u64| begin + Duration::from_millis(100 * tenths);
        let lines: Vec<u64> =
            (0..360_000).filter(|tenths| clock.is_time_for_a_line(at(*tenths))).collect();
        assert_eq!(lines[..3], [30, 60, 90]);
        assert!((60..130).contains(&lines.len()), "{}", lines.len());
        let longest = lines.windows(2).map(|two| two[1] - two[0]).max().unwrap();
        assert_eq!(longest, 6000);
    }

    #[test]
    fn the_bar_template_is_valid() {
        assert!(ProgressStyle::with_template(BAR).is_ok());
    }
}
