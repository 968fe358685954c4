//! Decompresses Zstandard: any number of frames, one after the other.

use std::io::{self, BufReader, Read};

use ruzstd::decoding::errors::{FrameDecoderError, ReadFrameHeaderError};
use ruzstd::decoding::{BlockDecodingStrategy, FrameDecoder};

/// Bytes that a step decompresses, about.
const STEP: usize = 1 << 20;

/// The decompressed bytes.
pub(super) struct ZstdReader {
    compressed: BufReader<Box<dyn Read + Send>>,
    decoder: FrameDecoder,
    is_within_frame: bool,
}

impl ZstdReader {
    /// Reads compressed bytes.
    pub(super) fn new(compressed: Box<dyn Read + Send>) -> Self {
        let compressed = BufReader::with_capacity(1 << 16, compressed);
        Self { compressed, decoder: FrameDecoder::new(), is_within_frame: false }
    }

    /// Begins the next frame; false at the end.
    fn next_frame(&mut self) -> io::Result<bool> {
        loop {
            if io::BufRead::fill_buf(&mut self.compressed)?.is_empty() {
                return Ok(false);
            }
            match self.decoder.reset(&mut self.compressed) {
                Ok(()) => return Ok(true),
                Err(FrameDecoderError::ReadFrameHeaderError(ReadFrameHeaderError::SkipFrame {
                    length,
                    ..
                })) => {
                    let mut skipped = self.compressed.by_ref().take(u64::from(length));
                    io::copy(&mut skipped, &mut io::sink())?;
                }
                Err(error) => return Err(damaged(error)),
            }
        }
    }
}

impl Read for ZstdReader {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        loop {
            let read = self.decoder.read(to)?;
            if read > 0 || to.is_empty() {
                return Ok(read);
            }
            if self.is_within_frame && !self.decoder.is_finished() {
                let strategy = BlockDecodingStrategy::UptoBytes(STEP);
                self.decoder.decode_blocks(&mut self.compressed, strategy).map_err(damaged)?;
                continue;
            }
            self.is_within_frame = self.next_frame()?;
            if !self.is_within_frame {
                return Ok(0);
            }
        }
    }
}

/// What the decoder says, with a truncated file told from a damaged one.
fn damaged(error: FrameDecoderError) -> io::Error {
    let mut cause: Option<&(dyn std::error::Error + 'static)> = Some(&error);
    while let Some(inner) = cause {
        if let Some(io) = inner.downcast_ref::<io::Error>() {
            return io::Error::from(io.kind());
        }
        cause = inner.source();
    }
    io::Error::other(format!("the Zstandard data are damaged: {error}"))
}
