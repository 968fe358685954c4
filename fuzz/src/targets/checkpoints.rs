//! Checkpoints and parts: as bytes, and with a header whose hashes and identities are right, which
//! reaches what random bytes never do.

use std::fs;

use photosphere::job::merge::{MergeOptions, merge};
use photosphere::job::{
    Checkpoint, CheckpointHeader, Job, Session, SessionOptions, develop_without_scene,
};
use photosphere::report::FileRecords;
use photosphere::scene::Scene;

use super::{accepted, first_line};

/// Larger films are read but neither developed nor merged.
const MAX_PIXELS: u64 = 1 << 16;
/// Larger renders are not resumed.
const MAX_WORK: u64 = 1 << 12;
const MAX_SPHERES: usize = 64;
const MAX_DEPTH: u32 = 12;

/// The input is the file.
pub(super) fn raw(input: &[u8]) -> bool {
    read(input)
}

/// The first line of the input is the header as JSON, the rest are the tiles. Magic bytes, version,
/// lengths and hashes are added, and the identities of the scene and job are made right.
pub(super) fn shaped(input: &[u8]) -> bool {
    let (text, tiles) = first_line(input);
    let header = serde_json::from_slice::<CheckpointHeader>(text).ok();
    let Some(header) = header else { return read(&wrapped(text, tiles)) };
    let resumed = with_identities(header);
    let Some((header, job)) = resumed else { return read(&wrapped(text, tiles)) };
    let text = serde_json::to_vec(&header).expect("it was read from JSON");
    let bytes = wrapped(&text, tiles);
    let is_read = read(&bytes);
    if let Some((scene, job)) = job {
        resume(&scene, job, bytes);
    }
    is_read
}

/// A checkpoint of this header and these tiles.
fn wrapped(header: &[u8], tiles: &[u8]) -> Vec<u8> {
    let mut bytes = b"PHSPPART\x03\0\0\0".to_vec();
    bytes.extend((header.len() as u32).to_le_bytes());
    bytes.extend(header);
    bytes.extend(blake3::hash(&bytes).as_bytes());
    bytes.extend(tiles);
    bytes.extend(blake3::hash(&bytes).as_bytes());
    bytes
}

/// Reads a checkpoint as `info` and `merge` do.
fn read(bytes: &[u8]) -> bool {
    let Some(checkpoint) = accepted(Checkpoint::from_bytes(bytes.to_vec())) else { return false };
    let header = checkpoint.header().clone();
    let Some(film) = accepted(checkpoint.into_film()) else { return false };
    let pixels = film.frame().pixel_count() as u64;
    if pixels > MAX_PIXELS {
        return true;
    }
    develop_without_scene(&film, &[], header.transparent);
    let folder = tempfile::tempdir().expect("a folder for temporary files");
    let path = folder.path().join("a.part");
    fs::write(&path, bytes).expect("a file in it");
    let records = accepted(FileRecords::read(&path)).expect("it was read before");
    accepted(records.to_text());
    accepted(records.json());
    for allow_gaps in [false, true] {
        let options = MergeOptions { allow_gaps, writes_picture: true, ..MergeOptions::default() };
        let merged = accepted(merge(std::slice::from_ref(&path), &options));
        let Some(merged) = merged else { continue };
        assert_eq!(merged.film.sample_count(), film.sample_count());
        // The scene of a stranger's part may be any file.
        if header.source.is_none() {
            accepted(merged.picture());
        }
    }
    true
}

/// The header with the identities that a render of its scene and job has. With the scene and the
/// job, if they are small enough to be resumed; `None` if there is no such scene.
fn with_identities(
    mut header: CheckpointHeader,
) -> Option<(CheckpointHeader, Option<(Scene, Job)>)> {
    let mut description = header.metadata.scene.clone()?;
    // Files of this machine have no part in it.
    description.tables.clear();
    if description.spheres.len() > MAX_SPHERES {
        return None;
    }
    let scene = accepted(Scene::build(description))?;
    header.metadata.scene_identity = scene.content_hash();
    let mut job = Job { threads: 1, ..header.job.clone() };
    let image = &mut job.settings.image;
    let pixels = u64::from(image.width).saturating_mul(image.height.into());
    let samples = job.settings.render.samples_per_pixel;
    if pixels.saturating_mul(samples.into()) > MAX_WORK {
        return Some((header, None));
    }
    let render = &mut job.settings.render;
    render.max_depth = Some(render.max_depth.unwrap_or(MAX_DEPTH).min(MAX_DEPTH));
    header.job.settings = job.settings;
    let fresh = accepted(Session::new(&scene, job.clone(), SessionOptions::default()));
    let Some(fresh) = fresh else { return Some((header, None)) };
    header.metadata.job_identity = fresh.metadata().job_identity;
    Some((header, Some((scene, job))))
}

/// Resumes a checkpoint, and saves the result.
fn resume(scene: &Scene, job: Job, bytes: Vec<u8>) {
    let Ok(checkpoint) = Checkpoint::from_bytes(bytes) else { return };
    let session = Session::resume(scene, job, checkpoint, SessionOptions::default());
    let Some(session) = accepted(session) else { return };
    let Some(outcome) = accepted(session.run(&())) else { return };
    let saved = accepted(session.checkpoint_bytes(Some(&outcome))).expect("a small header");
    let saved = Checkpoint::from_bytes(saved).and_then(Checkpoint::into_film);
    let film = accepted(saved).expect("what was written can be read");
    assert_eq!(film.sample_count(), session.film().sample_count());
    session.result(outcome);
}
