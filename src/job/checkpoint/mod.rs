//! Checkpoints: films stored as files or bytes, to be resumed or merged. A partial render is a
//! checkpoint too.
//!
//! All numbers are little-endian. A checkpoint consists of
//!
//! - the eight bytes `PHSPPART` and the format version, a u32;
//! - the length of the header, a u32, and the [`CheckpointHeader`] as JSON;
//! - the BLAKE3 hash of all bytes so far;
//! - every tile of the film, as its length, a u32, and its bytes (format: `film::bytes`);
//! - the BLAKE3 hash of all bytes so far. Nothing follows.
//!
//! The hashes detect truncated and corrupted files, and the header is verified before it is used.

mod hashing;
mod header;
mod read_error;
mod source;
#[cfg(test)]
mod tests;
mod version;

use std::fs::File;
use std::io::{self, Read, Write};
use std::ops::Range;
use std::path::Path;

use crate::error::{Error, Result};
use crate::film::Film;
use crate::image_io::AtomicFile;
use crate::task::parallel;

pub use header::{CheckpointHeader, CumulativeStats, FilePath, OutputSpec, RenderStatus};

use hashing::HashingStream;
use read_error::ReadError;
use source::Source;
use version::{MAGIC, VERSION};

/// Maximum tile length; 64 pixels of about 30 numbers take a tenth of it.
const MAX_TILE_BYTES: u32 = 1 << 20;

/// Tiles encoded per parallel task.
const TILES_PER_CHUNK: usize = 64;

/// A checkpoint being read, with a verified header.
#[derive(Debug)]
pub struct Checkpoint {
    header: CheckpointHeader,
    stream: HashingStream<Source>,
}

/// Returns true if a file starts with the checkpoint magic bytes.
pub fn is_checkpoint(path: &Path) -> bool {
    let mut magic = [0; 8];
    let read = |mut file: File| file.read_exact(&mut magic);
    // Only regular files are opened: reading from a pipe would consume its data.
    path.is_file() && File::open(path).and_then(read).is_ok() && magic == MAGIC
}

/// Writes a checkpoint. Samples may be added to the film meanwhile: each tile is written in its
/// state at that moment.
///
/// # Errors
/// If the header is too long, or writing fails; an existing file is then unchanged.
pub fn write_checkpoint(file: &AtomicFile, film: &Film, header: &CheckpointHeader) -> Result<()> {
    let head = header.encode()?;
    file.write(|sink| write(sink, film, &head))
}

/// Encodes a checkpoint in memory: the bytes that [`write_checkpoint`] writes to a file.
///
/// # Errors
/// If the header is too long, or a tile of the film is.
pub fn encode_checkpoint(film: &Film, header: &CheckpointHeader) -> Result<Vec<u8>> {
    let head = header.encode()?;
    let mut bytes = Vec::new();
    write(&mut bytes, film, &head)
        .map_err(|e| Error::input(format!("cannot encode the checkpoint: {e}")))?;
    Ok(bytes)
}

/// Writes all of a checkpoint. `head` is the encoded header.
fn write(sink: impl Write + Send, film: &Film, head: &str) -> io::Result<()> {
    let mut stream = HashingStream::new(sink);
    stream.write_all(&MAGIC)?;
    stream.write_all(&VERSION.to_le_bytes())?;
    stream.write_all(&length_prefix(head)?.to_le_bytes())?;
    stream.write_all(head.as_bytes())?;
    stream.write_hash()?;
    write_tiles(film, &mut stream)?;
    stream.write_hash()
}

/// Writes every tile. While some are being written to disk, idle threads encode the next ones.
fn write_tiles<S: Write + Send>(film: &Film, stream: &mut HashingStream<S>) -> io::Result<()> {
    let tiles = film.frame().tile_count();
    let tiles_per_write = 4 * TILES_PER_CHUNK * parallel::thread_count();
    let encode_from = |first: usize| -> io::Result<Vec<Vec<u8>>> {
        let end = (first + tiles_per_write).min(tiles);
        let chunks = (first..end)
            .step_by(TILES_PER_CHUNK)
            .map(|begin| begin..(begin + TILES_PER_CHUNK).min(end));
        parallel::map(chunks.collect(), |tiles| encode_tiles(film, tiles)).into_iter().collect()
    };
    let mut bytes = encode_from(0)?;
    let mut next = tiles_per_write;
    while !bytes.is_empty() {
        let write = || bytes.iter().try_for_each(|chunk| stream.write_all(chunk));
        let (written, encoded) = parallel::join(write, || encode_from(next));
        written?;
        bytes = encoded?;
        next += tiles_per_write;
    }
    Ok(())
}

/// Encodes tiles, each preceded by its length.
fn encode_tiles(film: &Film, tiles: Range<usize>) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    for tile in tiles {
        let begin = bytes.len();
        bytes.extend([0; 4]);
        film.write_tile(tile, &mut bytes);
        let length = length_prefix(&bytes[begin + 4..])?;
        bytes[begin..begin + 4].copy_from_slice(&length.to_le_bytes());
    }
    Ok(bytes)
}

fn length_prefix(bytes: impl AsRef<[u8]>) -> io::Result<u32> {
    bytes.as_ref().len().try_into().map_err(io::Error::other)
}

impl Checkpoint {
    /// Opens a checkpoint and reads its header.
    ///
    /// # Errors
    /// If the file cannot be read, is not a checkpoint, is damaged, or has an unsupported version.
    pub fn open(path: &Path) -> Result<Self> {
        Self::read(Source::open(path)?)
    }

    /// Opens a checkpoint in memory: the bytes of a file, or of
    /// [`Session::checkpoint_bytes`](crate::job::Session::checkpoint_bytes).
    ///
    /// # Errors
    /// If the bytes are not a checkpoint, are damaged, or have an unsupported version.
    pub fn from_bytes(bytes: Vec<u8>) -> Result<Self> {
        Self::read(Source::from_bytes(bytes))
    }

    fn read(source: Source) -> Result<Self> {
        let mut stream = HashingStream::new(source);
        match header::read(&mut stream) {
            Ok(header) => Ok(Self { header, stream }),
            Err(error) => Err(error.into_error(stream.inner.path())),
        }
    }

    /// The header.
    pub fn header(&self) -> &CheckpointHeader {
        &self.header
    }

    /// Path of the checkpoint file; `None` if it was read from memory.
    pub fn path(&self) -> Option<&Path> {
        self.stream.inner.path()
    }

    /// Reads the film.
    ///
    /// # Errors
    /// If the file cannot be read or is damaged.
    pub fn into_film(mut self) -> Result<Film> {
        self.read_film().map_err(|error| error.into_error(self.path()))
    }

    fn read_film(&mut self) -> std::result::Result<Film, ReadError> {
        let format = &self.header.film;
        let tiles = format.frame.tile_count();
        // A tile takes at least five bytes.
        let bytes = self.stream.inner.length();
        if tiles as u64 > bytes / 5 {
            return Err(ReadError::Truncated(bytes));
        }
        let mut film = Film::new_lazy(format);
        let mut bytes = Vec::new();
        for tile in 0..tiles {
            let length = self.stream.read_u32()?;
            if length > MAX_TILE_BYTES {
                return Err(ReadError::Corrupt("the length of a tile is invalid"));
            }
            bytes.resize(length as usize, 0);
            self.stream.read_exact(&mut bytes)?;
            if !film.read_tile(tile, &bytes) {
                return Err(ReadError::Corrupt("the data of a tile is invalid"));
            }
        }
        self.stream.verify_hash()?;
        match self.stream.inner.read(&mut [0]) {
            Ok(0) => Ok(film),
            Ok(_) => Err(ReadError::Corrupt("data follows its end")),
            Err(e) => Err(ReadError::Io(e)),
        }
    }
}
