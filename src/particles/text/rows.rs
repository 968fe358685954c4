//! Parses lines in parallel: each thread takes the next block, parses it, and adds its rows to those
//! of the blocks before. No thread waits for the others after each block.

use std::collections::BTreeMap;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;

use rayon::prelude::*;

use crate::particles::budget::Budget;
use crate::particles::trouble::{Failure, Outcome, Trouble};

use super::batch::Batch;
use super::input::{Input, Lines};
use super::line_parser::LineParser;
use super::marks::Marks;
use super::piece::parse_piece;

/// Which lines are read.
#[derive(Clone, Copy)]
pub(in crate::particles) enum Section {
    /// This many, or as many as there are.
    Lines(u64),
    /// All up to where a function finds the end, in text that begins with a line. The line there
    /// stays the next one.
    Until(fn(&[u8]) -> Option<usize>),
}

impl Section {
    /// How many rows follow, about, if the first ones take so many bytes of a file. No more than
    /// the budget allows: a header may promise any number.
    fn rows_left(&self, first: &Batch, bytes: u64, length: u64, budget: Budget) -> usize {
        let (rows, held) = (first.positions.len() as u64, first.bytes());
        let all = rows.saturating_mul(length) / bytes.max(1);
        let all = match self {
            Self::Lines(count) => all.saturating_add(all / 64).min(*count),
            Self::Until(_) => all,
        };
        let fits = budget.check(held.saturating_mul(all) / rows.max(1)).is_ok();
        if fits { all.saturating_sub(rows) as usize } else { 0 }
    }

    /// Takes the next lines of the section; true if there may be more.
    fn take(&self, input: &mut Input, done: u64, to: &mut Lines) -> Outcome<bool> {
        let (text, count, has_more) = self.next(input, done)?;
        let bytes = text.len();
        input.take_lines(bytes, count, to);
        Ok(has_more)
    }

    /// The next lines of the section, with their number, and true if there may be more.
    fn next<'i>(&self, input: &'i mut Input, done: u64) -> Outcome<(&'i [u8], u64, bool)> {
        match self {
            Self::Lines(count) => {
                let (text, lines) = input.peek_lines(count - done)?;
                Ok((text, lines, lines > 0))
            }
            Self::Until(end) => {
                let (text, lines) = input.peek_lines(u64::MAX)?;
                match end(text) {
                    Some(at) => {
                        let text = &text[..at];
                        Ok((text, memchr::memchr_iter(b'\n', text).count() as u64, false))
                    }
                    None => Ok((text, lines, lines > 0)),
                }
            }
        }
    }
}

/// Moves past a section; returns its number of lines.
pub(in crate::particles) fn skip_section(input: &mut Input, section: Section) -> Outcome<u64> {
    let mut done = 0;
    loop {
        let (text, lines, has_more) = section.next(input, done)?;
        let bytes = text.len();
        input.consume_lines(bytes, lines);
        done += lines;
        if !has_more {
            return Ok(done);
        }
    }
}

/// Appends the rows of a section to `all`. Returns its number of lines.
pub(in crate::particles) fn read_rows(
    input: &mut Input,
    parser: &dyn LineParser,
    section: Section,
    budget: Budget,
    all: &mut Batch,
) -> Outcome<u64> {
    let threads = rayon::current_num_threads();
    let length = input.length().unwrap_or(0);
    let taking = Mutex::new(Taking { input, section, done: 0, index: 0, has_more: true });
    let progress = Progress { like: all.empty_like(), ..Progress::default() };
    let joined =
        Joined { all: Mutex::new(all), progress: Mutex::new(progress), turn: Condvar::new() };
    let rows_left = |first: &Batch, bytes: u64| section.rows_left(first, bytes, length, budget);
    let join = |all: &mut Batch, batch: &mut Batch, bytes: usize| {
        let is_first = all.positions.is_empty();
        all.append(batch);
        budget.check(all.bytes())?;
        if is_first {
            all.reserve(rows_left(all, bytes as u64));
        }
        Ok(())
    };
    let work = |_| {
        let _alarm = Alarm(&joined);
        let (mut lines, mut marks) = (Lines::default(), Marks::default());
        while let Some((index, first_line)) = take(&taking, &joined, &mut lines) {
            let mut batch = joined.batch(index, threads);
            let parsed = parse_piece(lines.text(), parser, &mut batch, &mut marks);
            let parsed = parsed
                .map_err(|(before, message)| Trouble::at(first_line + before, message).into());
            joined.put(index, parsed.map(|_| (batch, lines.text().len())), &join);
        }
    };
    (0..threads).into_par_iter().with_max_len(1).for_each(work);
    let progress = joined.progress.into_inner().unwrap_or_else(PoisonError::into_inner);
    match progress.failure {
        Some((_, failure)) => Err(failure),
        None => Ok(taking.into_inner().unwrap_or_else(PoisonError::into_inner).done),
    }
}

/// Where the next block comes from.
struct Taking<'i> {
    input: &'i mut Input,
    section: Section,
    /// Number of lines so far.
    done: u64,
    /// Number of blocks so far.
    index: usize,
    has_more: bool,
}

/// Takes the next block: its index, and the number of its first line.
fn take(taking: &Mutex<Taking<'_>>, joined: &Joined<'_>, to: &mut Lines) -> Option<(usize, u64)> {
    let mut taking = lock(taking);
    if !taking.has_more || lock(&joined.progress).is_over {
        return None;
    }
    let Taking { input, section, done, index, has_more } = &mut *taking;
    let first_line = input.line_number();
    match section.take(input, *done, to) {
        Ok(more) => *has_more = more,
        Err(failure) => {
            *has_more = false;
            lock(&joined.progress).fail(*index, failure);
        }
    }
    if to.count() == 0 || lock(&joined.progress).is_over {
        return None;
    }
    *done += to.count();
    *index += 1;
    Some((*index - 1, first_line))
}

/// All rows so far, and the blocks that were parsed before those in front of them.
struct Joined<'a> {
    all: Mutex<&'a mut Batch>,
    progress: Mutex<Progress>,
    turn: Condvar,
}

#[derive(Default)]
struct Progress {
    /// The next block to be joined.
    next: usize,
    /// Blocks that wait, with the length of their text.
    ready: BTreeMap<usize, (Batch, usize)>,
    is_joining: bool,
    /// Memory to be used again.
    spare: Vec<Batch>,
    /// No rows, with the kinds of the columns so far.
    like: Batch,
    /// The first block that failed, and why.
    failure: Option<(usize, Failure)>,
    is_over: bool,
}

impl Progress {
    fn fail(&mut self, index: usize, failure: Failure) {
        self.is_over = true;
        if self.failure.as_ref().is_none_or(|(first, _)| index < *first) {
            self.failure = Some((index, failure));
        }
    }
}

impl Joined<'_> {
    /// An empty batch for a block, once it is near the ones that are joined.
    fn batch(&self, index: usize, most_ahead: usize) -> Batch {
        let mut progress = lock(&self.progress);
        while index > progress.next + most_ahead && !progress.is_over {
            progress = self.turn.wait(progress).unwrap_or_else(PoisonError::into_inner);
        }
        let mut batch = progress.spare.pop().unwrap_or_default();
        batch.clear_like(&progress.like);
        batch
    }

    /// Takes a block that was parsed, and joins all whose turn it is, unless another thread does.
    fn put(
        &self,
        index: usize,
        parsed: Outcome<(Batch, usize)>,
        join: &dyn Fn(&mut Batch, &mut Batch, usize) -> Result<(), Trouble>,
    ) {
        let mut progress = lock(&self.progress);
        match parsed {
            Ok(batch) => drop(progress.ready.insert(index, batch)),
            Err(failure) => progress.fail(index, failure),
        }
        if progress.is_joining {
            return;
        }
        progress.is_joining = true;
        loop {
            let next = progress.next;
            let Some((mut batch, bytes)) = progress.ready.remove(&next) else { break };
            drop(progress);
            let mut all = lock(&self.all);
            let outcome = join(&mut all, &mut batch, bytes);
            progress = lock(&self.progress);
            progress.like = all.empty_like();
            progress.spare.push(batch);
            match outcome {
                Ok(()) => progress.next += 1,
                Err(trouble) => progress.fail(next, trouble.into()),
            }
            self.turn.notify_all();
        }
        progress.is_joining = false;
        if progress.is_over {
            self.turn.notify_all();
        }
    }
}

/// Lets no thread wait for one that panics.
struct Alarm<'j, 'a>(&'j Joined<'a>);

impl Drop for Alarm<'_, '_> {
    fn drop(&mut self) {
        if thread::panicking() {
            lock(&self.0.progress).is_over = true;
            self.0.turn.notify_all();
        }
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
