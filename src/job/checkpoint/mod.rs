//! Checkpoints: films stored as files, to be resumed or merged. A partial render is a checkpoint
//! too.
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
#[cfg(test)]
mod tests;
mod version;

use std::fs::File;
use std::io::{self, BufReader, Read, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::film::Film;
use crate::image_io::AtomicFile;
use crate::task::parallel;

pub use header::{CheckpointHeader, CumulativeStats, FilePath, OutputSpec, RenderStatus};

use hashing::HashingStream;
use read_error::ReadError;
use version::{MAGIC, VERSION};

/// Maximum tile length; 64 pixels of about 30 numbers take a tenth of it.
const MAX_TILE_BYTES: u32 = 1 << 20;

/// Tiles encoded per parallel task.
const TILES_PER_CHUNK: usize = 64;

/// A checkpoint being read, with a verified header.
#[derive(Debug)]
pub struct Checkpoint {
    path: PathBuf,
    header: CheckpointHeader,
    stream: HashingStream<BufReader<File>>,
    bytes: u64,
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
/// If writing fails; an existing file is then unchanged.
pub fn write_checkpoint(file: &AtomicFile, film: &Film, header: &CheckpointHeader) -> Result<()> {
    let head = serde_json::to_string(header);
    let head =
        head.map_err(|e| Error::input(format!("a checkpoint cannot say what it is: {e}")))?;
    file.write(|sink| {
        let mut to = HashingStream::new(sink);
        to.write_all(&MAGIC)?;
        to.write_all(&VERSION.to_le_bytes())?;
        to.write_all(&length_prefix(&head)?.to_le_bytes())?;
        to.write_all(head.as_bytes())?;
        to.write_hash()?;
        write_tiles(film, &mut to)?;
        to.write_hash()
    })
}

/// Writes every tile. While some are being written to disk, idle threads encode the next ones.
fn write_tiles<S: Write + Send>(film: &Film, to: &mut HashingStream<S>) -> io::Result<()> {
    let tiles = film.frame().tile_count();
    let at_once = 4 * TILES_PER_CHUNK * parallel::thread_count();
    let bytes_from = |first: usize| -> io::Result<Vec<Vec<u8>>> {
        let end = (first + at_once).min(tiles);
        let pieces = (first..end)
            .step_by(TILES_PER_CHUNK)
            .map(|begin| begin..(begin + TILES_PER_CHUNK).min(end));
        parallel::map(pieces.collect(), |tiles| encode_tiles(film, tiles)).into_iter().collect()
    };
    let mut bytes = bytes_from(0)?;
    let mut next = at_once;
    while !bytes.is_empty() {
        let write = || bytes.iter().try_for_each(|piece| to.write_all(piece));
        let (written, following) = parallel::join(write, || bytes_from(next));
        written?;
        bytes = following?;
        next += at_once;
    }
    Ok(())
}

/// Encodes tiles, each preceded by its length.
fn encode_tiles(film: &Film, tiles: Range<usize>) -> io::Result<Vec<u8>> {
    let mut all = Vec::new();
    for tile in tiles {
        let begin = all.len();
        all.extend([0; 4]);
        film.write_tile(tile, &mut all);
        let length = length_prefix(&all[begin + 4..])?;
        all[begin..begin + 4].copy_from_slice(&length.to_le_bytes());
    }
    Ok(all)
}

fn length_prefix(of: impl AsRef<[u8]>) -> io::Result<u32> {
    of.as_ref().len().try_into().map_err(io::Error::other)
}

impl Checkpoint {
    /// Opens a checkpoint and reads its header.
    ///
    /// # Errors
    /// If the file cannot be read, is not a checkpoint, is damaged, or has an unsupported version.
    pub fn open(path: &Path) -> Result<Self> {
        let trouble = |e: io::Error| Error::file("read", path, e);
        let metadata = path.metadata().map_err(trouble)?;
        match metadata {
            _ if metadata.is_dir() => return Err(Error::file("read", path, "it is a folder")),
            // Opening a pipe waits for a writer.
            _ if !metadata.is_file() => {
                return Err(Error::file("read", path, "it is not an ordinary file"));
            }
            _ => {}
        }
        let file = File::open(path).map_err(trouble)?;
        let bytes = metadata.len();
        let inner = BufReader::with_capacity(1 << 16, file);
        let mut from = HashingStream::new(inner);
        let header = header::read(&mut from, bytes).map_err(|bad| bad.into_error(path))?;
        Ok(Self { path: path.to_path_buf(), header, stream: from, bytes })
    }

    /// The header.
    pub fn header(&self) -> &CheckpointHeader {
        &self.header
    }

    /// Path of the checkpoint file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Reads the film.
    ///
    /// # Errors
    /// If the file cannot be read or is damaged.
    pub fn into_film(mut self) -> Result<Film> {
        self.read_film().map_err(|bad| bad.into_error(&self.path))
    }

    fn read_film(&mut self) -> std::result::Result<Film, ReadError> {
        let format = &self.header.film;
        let tiles = format.frame.tile_count();
        // A tile takes at least five bytes.
        if tiles as u64 > self.bytes / 5 {
            return Err(ReadError::Truncated(self.bytes));
        }
        let mut film = Film::new_lazy(format);
        let mut bytes = Vec::new();
        for tile in 0..tiles {
            let length = self.stream.read_u32()?;
            if length > MAX_TILE_BYTES {
                return Err(ReadError::Corrupt("a length makes no sense"));
            }
            bytes.resize(length as usize, 0);
            self.stream.read_exact(&mut bytes)?;
            if !film.read_tile(tile, &bytes) {
                return Err(ReadError::Corrupt("some sums make no sense"));
            }
        }
        self.stream.verify_hash()?;
        match self.stream.inner.read(&mut [0]) {
            Ok(0) => Ok(film),
            Ok(_) => Err(ReadError::Corrupt("something follows its end")),
            Err(e) => Err(ReadError::Io(e)),
        }
    }
}
