//! Blocks of a text, each of whole lines, so that they are parsed where they lie.
//!
//! A plain file is read by the thread that asks for the next block, which then has it in its cache.
//! What must be decompressed first is read ahead by a thread of its own.

use std::io::{self, Read};
use std::sync::mpsc::{Receiver, Sender, channel, sync_channel};
use std::thread;

/// Bytes of a block, which a thread parses. Small blocks, used again and again, stay in the cache.
const BLOCK_BYTES: usize = 1 << 18;

/// Longest line of rows.
pub(super) const MAX_ROW_BYTES: usize = 8 << 20;

/// Where the blocks of a text come from.
pub(super) enum Blocks {
    /// Read when they are asked for.
    Here(Reader),
    /// Read ahead, into memory that is used again.
    Ahead(Receiver<io::Result<Vec<u8>>>, Sender<Vec<u8>>),
    /// There are no more.
    Over,
}

impl Blocks {
    /// Blocks of a text, of which `begun` was read before; ahead, if it takes long to read.
    pub(super) fn new(begun: Vec<u8>, from: Box<dyn Read + Send>, is_slow: bool) -> Self {
        let reader = Reader { begun, from, failure: None, is_over: false };
        match is_slow {
            true => read_ahead(reader),
            false => Self::Here(reader),
        }
    }

    /// The next block; `None` after the last one. `spare` is memory to be used again, and what is
    /// not used of it stays there.
    pub(super) fn next(&mut self, spare: &mut Vec<u8>) -> Option<io::Result<Vec<u8>>> {
        let block = match self {
            Self::Here(reader) => reader.next(std::mem::take(spare)),
            Self::Ahead(blocks, used) => {
                // Nobody reads on after the last block.
                let _ = used.send(std::mem::take(spare));
                blocks.recv().ok()
            }
            Self::Over => None,
        };
        if block.is_none() {
            *self = Self::Over;
        }
        block
    }
}

/// Reads blocks.
pub(super) struct Reader {
    /// The beginning of the next line.
    begun: Vec<u8>,
    from: Box<dyn Read + Send>,
    /// Why no more can be read, after what could.
    failure: Option<io::Error>,
    is_over: bool,
}

impl Reader {
    fn next(&mut self, mut block: Vec<u8>) -> Option<io::Result<Vec<u8>>> {
        if let Some(failure) = self.failure.take() {
            self.is_over = true;
            return Some(Err(failure));
        }
        if self.is_over {
            return None;
        }
        block.clear();
        block.append(&mut self.begun);
        match self.read_lines(&mut block) {
            Ok(is_last) => self.is_over = is_last,
            Err(failure) => self.failure = Some(failure),
        }
        if block.is_empty() { self.next(block) } else { Some(Ok(block)) }
    }

    /// Reads until there is a whole line; true at the end of the text.
    fn read_lines(&mut self, block: &mut Vec<u8>) -> io::Result<bool> {
        loop {
            block.reserve(BLOCK_BYTES);
            let read = self.from.by_ref().take(BLOCK_BYTES as u64).read_to_end(block);
            let is_last = !matches!(read, Ok(count) if count == BLOCK_BYTES);
            let end = end_of_lines(block);
            if is_last || end == 0 && block.len() > MAX_ROW_BYTES {
                return read.map(|_| is_last);
            }
            if end > 0 {
                self.begun.extend_from_slice(&block[end..]);
                block.truncate(end);
                return Ok(false);
            }
        }
    }
}

/// Where the last whole line ends.
pub(super) fn end_of_lines(text: &[u8]) -> usize {
    memchr::memrchr(b'\n', text).map_or(0, |last| last + 1)
}

/// Reads in a thread of its own.
fn read_ahead(mut reader: Reader) -> Blocks {
    let (used, spare) = channel();
    let (sender, receiver) = sync_channel(rayon::current_num_threads().max(2));
    let work = move || {
        while let Some(block) = reader.next(spare.try_recv().unwrap_or_default()) {
            // Nobody may listen any more.
            if sender.send(block).is_err() {
                return;
            }
        }
    };
    thread::spawn(work);
    Blocks::Ahead(receiver, used)
}
