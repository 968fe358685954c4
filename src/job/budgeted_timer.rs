//! Periodic work during a render, limited to a fraction of the processor time.

use std::time::{Duration, Instant};

/// A timer for one kind of periodic work.
pub struct BudgetedTimer {
    start: Instant,
    /// Desired time between two runs.
    interval: Duration,
    /// Maximum fraction of the time of all threads that the work may use.
    budget: f64,
    threads: usize,
    /// Cost of one run: a guess at first, then the measured cost of the last run.
    cost: Duration,
    spent: Duration,
    due: Instant,
}

impl BudgetedTimer {
    /// Starts a timer for work that runs once per `interval` and may use the fraction `budget` of
    /// the time of `threads` threads. `initial_cost` is the estimated cost of the first run.
    pub fn new(interval: Duration, budget: f64, threads: usize, initial_cost: Duration) -> Self {
        let start = Instant::now();
        let (cost, spent) = (initial_cost, Duration::ZERO);
        let mut timer = Self { start, interval, budget, threads, cost, spent, due: start };
        timer.due = timer.next_due(start);
        timer
    }

    /// Runs the work if it is due.
    pub fn run_if_due(&mut self, work: impl FnOnce()) {
        if Instant::now() >= self.due {
            self.run_now(work);
        }
    }

    /// Runs the work, due or not. Its cost counts.
    pub fn run_now(&mut self, work: impl FnOnce()) {
        let now = Instant::now();
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
        let mut timer = BudgetedTimer::new(2 * second, 0.02, 2, second / 100);
        // Two hundredths of a second are 2 % of half a second on two threads.
        assert_eq!(timer.next_due(timer.start), timer.start + 2 * second);
        timer.cost = second / 10;
        assert_eq!(timer.next_due(timer.start), timer.start + 5 * second);
        timer.spent = 3 * second / 10;
        let last = timer.start + 10 * second;
        assert_eq!(timer.next_due(last), timer.start + 25 * second / 2);
        assert_eq!(timer.next_due(last + 10 * second), last + 12 * second);
    }

    #[test]
    fn a_turn_that_is_not_due_is_left_out() {
        let mut timer = BudgetedTimer::new(Duration::from_secs(1000), 1.0, 1, Duration::ZERO);
        timer.run_if_due(|| panic!("it is too early"));
        timer.due = timer.start;
        let mut done = false;
        timer.run_if_due(|| done = true);
        assert!(done && timer.due > timer.start);
    }
}
