//! Blocks of rows that threads parse at once, joined in their order.

use std::collections::BTreeMap;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;

use crate::particles::trouble::{Failure, Outcome};

use super::batch::Batch;

/// A block of rows.
pub(super) trait Block {
    /// Appends the rows.
    fn parse(&self, to: &mut Batch) -> Outcome<()>;

    /// Length of the text.
    fn bytes(&self) -> usize;

    /// Looks at all rows after those of a text of this length, perhaps the first, were joined.
    fn joined(&self, all: &mut Batch, bytes: usize, is_first: bool) -> Outcome<()>;
}

/// All rows so far, and the blocks that were parsed before those in front of them.
pub(super) struct Joined<'a> {
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
    fn take_next(&mut self) -> Option<(Batch, usize)> {
        self.ready.remove(&self.next)
    }

    fn fail(&mut self, index: usize, failure: Failure) {
        self.is_over = true;
        if self.failure.as_ref().is_none_or(|(first, _)| index < *first) {
            self.failure = Some((index, failure));
        }
    }
}

impl<'a> Joined<'a> {
    /// Begins with what is in a batch.
    pub(super) fn new(all: &'a mut Batch) -> Self {
        let progress = Progress { like: all.empty_like(), ..Progress::default() };
        Self { all: Mutex::new(all), progress: Mutex::new(progress), turn: Condvar::new() }
    }

    /// Says that a block cannot be had.
    pub(super) fn fail(&self, index: usize, failure: Failure) {
        lock(&self.progress).fail(index, failure);
    }

    /// Returns true if no other block is needed.
    pub(super) fn is_over(&self) -> bool {
        lock(&self.progress).is_over
    }

    /// Ends with the failure of the first block that has one.
    pub(super) fn finish(self) -> Outcome<()> {
        let progress = self.progress.into_inner().unwrap_or_else(PoisonError::into_inner);
        progress.failure.map_or(Ok(()), |(_, failure)| Err(failure))
    }

    /// Parses a block, once it is near the ones that are joined, and joins it and those behind it
    /// whose turn it is, unless another thread does. Where its turn has come before, it is parsed
    /// into its place.
    pub(super) fn parse(&self, index: usize, most_ahead: usize, block: &dyn Block) {
        let mut progress = lock(&self.progress);
        while index > progress.next + most_ahead && !progress.is_over {
            progress = self.turn.wait(progress).unwrap_or_else(PoisonError::into_inner);
        }
        if progress.is_joining || progress.next != index {
            let mut batch = progress.spare.pop().unwrap_or_default();
            batch.clear_like(&progress.like);
            drop(progress);
            let parsed = block.parse(&mut batch);
            progress = lock(&self.progress);
            match parsed {
                Ok(()) => drop(progress.ready.insert(index, (batch, block.bytes()))),
                Err(failure) => progress.fail(index, failure),
            }
            if progress.is_joining {
                return;
            }
            progress.is_joining = true;
        } else {
            progress.is_joining = true;
            progress = self.join(progress, block, block.bytes(), |all| block.parse(all));
        }
        while let Some((mut batch, bytes)) = progress.take_next() {
            progress = self.join(progress, block, bytes, |all| {
                all.append(&mut batch);
                Ok(())
            });
            progress.spare.push(batch);
        }
        progress.is_joining = false;
        if progress.is_over {
            self.turn.notify_all();
        }
    }

    /// Adds the next block, which has so many bytes.
    fn join<'p>(
        &'p self,
        progress: MutexGuard<'p, Progress>,
        any: &dyn Block,
        bytes: usize,
        add: impl FnOnce(&mut Batch) -> Outcome<()>,
    ) -> MutexGuard<'p, Progress> {
        drop(progress);
        let mut all = lock(&self.all);
        let is_first = all.positions.is_empty();
        let outcome = add(&mut all).and_then(|()| any.joined(&mut all, bytes, is_first));
        let mut progress = lock(&self.progress);
        progress.like = all.empty_like();
        match outcome {
            Ok(()) => progress.next += 1,
            Err(failure) => {
                let next = progress.next;
                progress.fail(next, failure);
            }
        }
        self.turn.notify_all();
        progress
    }
}

/// Lets no thread wait for one that panics.
pub(super) struct Alarm<'j, 'a>(pub(super) &'j Joined<'a>);

impl Drop for Alarm<'_, '_> {
    fn drop(&mut self) {
        if thread::panicking() {
            lock(&self.0.progress).is_over = true;
            self.0.turn.notify_all();
        }
    }
}

/// Locks what no panic leaves half done.
pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
