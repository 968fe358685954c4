//! Periodic work during a render, limited to a share of the processor time.

use std::time::{Duration, Instant};

/// A timer for one kind of periodic work.
pub struct BudgetedTimer {
    start: Instant,
    /// Desired time between two runs.
    interval: Duration,
    /// Largest share of the time of all threads that the work may use.
    budget: f64,
    threads: usize,
    /// Cost of one run: a guess at first, then the measured cost of the last run.
    cost: Duration,
    spent: Duration,
    due: Instant,
}

impl BudgetedTimer {
    /// Starts a timer for work that runs once per `every` and may use the fraction `share` of the
    /// time of `threads` threads. `guess` is its estimated cost.
    pub fn new(every: Duration, share: f64, threads: usize, guess: Duration) -> Self {
        let began = Instant::now();
        let (cost, spent) = (guess, Duration::ZERO);
        let mut turns =
            Self { start: began, interval: every, budget: share, threads, cost, spent, due: began };
        turns.due = turns.next_due(began);
        turns
    }

    /// Runs the work if it is due.
    pub fn run_if_due(&mut self, work: impl FnOnce()) {
        let now = Instant::now();
        if now < self.due {
            return;
        }
        work();
        self.cost = now.elapsed();
        self.spent += self.cost;
        self.due = self.next_due(now);
    }

    /// When the next run is due. The budget must cover it and one more run, which may happen at the
    /// end of the render at any time.
    fn next_due(&self, last: Instant) -> Instant {
        let needed = self.spent + 2 * self.cost;
        let affordable = needed.div_f64(self.budget * self.threads as f64);
        (last + self.interval).max(self.start + affordable)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_come_as_wished_or_when_they_are_paid_for() {
        let second = Duration::from_secs(1);
        let mut turns = BudgetedTimer::new(2 * second, 0.02, 2, second / 100);
        // Two hundredths of a second are 2 % of half a second on two threads.
        assert_eq!(turns.next_due(turns.start), turns.start + 2 * second);
        turns.cost = second / 10;
        assert_eq!(turns.next_due(turns.start), turns.start + 5 * second);
        turns.spent = 3 * second / 10;
        let last = turns.start + 10 * second;
        assert_eq!(turns.next_due(last), turns.start + 25 * second / 2);
        assert_eq!(turns.next_due(last + 10 * second), last + 12 * second);
    }

    #[test]
    fn a_turn_that_is_not_due_is_left_out() {
        let mut turns = BudgetedTimer::new(Duration::from_secs(1000), 1.0, 1, Duration::ZERO);
        turns.run_if_due(|| panic!("it is too early"));
        turns.due = turns.start;
        let mut done = false;
        turns.run_if_due(|| done = true);
        assert!(done && turns.due > turns.start);
    }
}
