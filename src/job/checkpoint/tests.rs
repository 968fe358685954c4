//! Checkpoints round-trip, or are rejected.

use serde_json::{Value, json};

use super::version::MIN_VERSION;
use super::*;
use std::time::Duration;

use crate::accel::Backend;
use crate::color::{PathRadiance, Rgb, ViewTransform, VisibleSurface};
use crate::film::{FilmFormat, FilmFrame, Layer, RadianceScale, SampleRun};
use crate::job::{Job, Metadata};
use crate::math::Rect;
use crate::scene::description::{MaterialDescription, SphereDescription};
use crate::scene::{PreparedScene, Scene, SceneDescription, SceneSource};
use rand::{RngExt, SeedableRng, rngs::StdRng};

/// A checkpoint with finished and unfinished blocks and an empty tile, and its bytes.
fn part() -> (Film, CheckpointHeader, Vec<u8>) {
    let window = Rect { x: 3, y: 2, width: 20, height: 7 };
    let format = FilmFormat {
        frame: FilmFrame { full_size: [31, 17], window },
        first_sample: 32,
        scale: RadianceScale::from_max_radiance(5.0),
        layers: Layer::ALL.to_vec(),
        squares: true,
    };
    let film = Film::new(&format).unwrap();
    for tile in 1..film.frame().tile_count() {
        let count = 9 * tile as u32;
        let counts = vec![count; film.frame().tile(tile).pixel_count()];
        let samples: Vec<PathRadiance> = (0..counts.len() as u32 * count)
            .map(|i| PathRadiance {
                direct: Rgb::splat((i % 97) as f32 * 0.013),
                ..Default::default()
            })
            .collect();
        let seen = vec![VisibleSurface { row: 7, ..VisibleSurface::NONE }; samples.len()];
        film.add(tile, &counts, SampleRun { radiance: &samples, visible_surfaces: &seen }).unwrap();
    }
    let header = header(&format);
    let (_folder, path) = written(&film, &header);
    let bytes = std::fs::read(path).unwrap();
    (film, header, bytes)
}

/// A header with a value in every field.
fn header(film: &FilmFormat) -> CheckpointHeader {
    let ball = SphereDescription {
        name: Some("\"x\"\n".to_owned()),
        radius: 1.0,
        ..SphereDescription::default()
    };
    let materials = vec![MaterialDescription::default()];
    let description =
        SceneDescription { materials, spheres: vec![ball], ..SceneDescription::default() };
    let scene = Scene::build(description).unwrap();
    let job = Job::with_size(31, 17).noise_target(0.02);
    let prepared = PreparedScene::new(&scene, job.settings).unwrap();
    let path = || FilePath(PathBuf::from("/pictures/a.exr"));
    let delivery = OutputSpec {
        files: vec![path()],
        look: ViewTransform::default(),
        dpi: Some(300),
        with_run: true,
        save_every: Duration::from_secs(60),
        preview: Some(path()),
        preview_every: Duration::from_millis(1500),
        tev: Some("localhost:14158".to_owned()),
    };
    CheckpointHeader {
        film: film.clone(),
        samples: 32..64,
        metadata: Metadata::new(&prepared, Backend::BruteForce),
        job,
        status: RenderStatus::Ended { missed: Vec::new() },
        statistics: CumulativeStats { rays: 1 << 60, seconds: 0.1, media_overflows: 1, cut_off: 2 },
        transparent: true,
        source: Some(SceneSource { name: "a.toml".to_owned(), ..SceneSource::default() }),
        delivery: Some(delivery),
    }
}

fn written(film: &Film, header: &CheckpointHeader) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.part");
    write_checkpoint(&AtomicFile::new(&path).unwrap(), film, header).unwrap();
    (folder, path)
}

fn read(path: &Path) -> Result<(CheckpointHeader, Film)> {
    let checkpoint = Checkpoint::open(path)?;
    Ok((checkpoint.header().clone(), checkpoint.into_film()?))
}

/// Reads a checkpoint from bytes.
fn read_bytes(bytes: &[u8]) -> Result<(CheckpointHeader, Film)> {
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), bytes).unwrap();
    read(file.path())
}

#[test]
fn a_part_comes_back_as_it_was() {
    let (film, header, bytes) = part();
    let (head, back) = read_bytes(&bytes).unwrap();
    let format = film.format();
    assert_eq!(head, header);
    assert_eq!(back.format(), format);
    assert_eq!((back.counts(), back.picture()), (film.counts(), film.picture()));
    // Writing the film again produces the same bytes.
    let (_folder, path) = written(&back, &head);
    assert!(std::fs::read(path).unwrap() == bytes);
}

#[test]
fn cut_off_at_any_byte_a_part_is_refused() {
    let (_, _, bytes) = part();
    let lengths = (0..200).chain((200..bytes.len()).step_by(37)).chain([bytes.len() - 1]);
    for length in lengths {
        let error = read_bytes(&bytes[..length]).unwrap_err().to_string();
        let words = if length < 8 { "it is no part" } else { "it is cut off after" };
        assert!(error.contains(words), "{length}: {error}");
    }
    let error = read_bytes(&[&bytes[..], b"x"].concat()).unwrap_err().to_string();
    assert!(error.ends_with("it is damaged: something follows its end"), "{error}");
}

#[test]
fn thousands_of_random_changes_are_all_refused() {
    let (_, _, bytes) = part();
    let mut rng = StdRng::seed_from_u64(5);
    for round in 0..3000 {
        let mut changed = bytes.clone();
        for _ in 0..rng.random_range(1..4) {
            let at = match round % 3 {
                // The start of the header holds the numbers that the reader uses first.
                0 => rng.random_range(0..16),
                _ => rng.random_range(0..bytes.len()),
            };
            changed[at] = rng.random();
        }
        if changed == bytes {
            continue;
        }
        let error = read_bytes(&changed).unwrap_err().to_string();
        let reasons = ["no part", "version", "cut off", "damaged"];
        assert!(reasons.iter().any(|reason| error.contains(reason)), "{error}");
    }
}

#[test]
fn a_part_with_good_checksums_and_impossible_numbers_is_refused() {
    let (_, _, bytes) = part();
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let head: Value = serde_json::from_slice(&bytes[16..16 + length]).unwrap();
    let forged = |place: &str, value: Value| {
        let mut head = head.clone();
        let forged = head.pointer_mut(place).unwrap_or_else(|| panic!("there is no {place}"));
        assert_ne!(*forged, value);
        *forged = value;
        let head = head.to_string();
        let mut bytes = MAGIC.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend((head.len() as u32).to_le_bytes());
        bytes.extend(head.as_bytes());
        bytes.extend(blake3::hash(&bytes).as_bytes());
        read_bytes(&bytes).unwrap_err().to_string()
    };
    let huge = u32::MAX;
    for (place, value, words) in [
        ("/film/frame/full_size", json!([huge, huge]), "impossible"),
        ("/film/frame/window/width", json!(40), "impossible"),
        ("/film/frame/window/width", json!(0), "impossible"),
        ("/film/frame/window/x", json!(huge), "impossible"),
        ("/film/first_sample", json!(33), "impossible"),
        ("/film/first_sample", json!(48), "impossible"),
        ("/samples/start", json!(33), "impossible"),
        ("/samples/start", json!(80), "impossible"),
        ("/samples/end", json!(16), "impossible"),
        ("/samples", json!([32]), "its header says: "),
        ("/film/scale", json!(1000), "its header says: no radiance has this exponent"),
        ("/film/layers", json!(["direct", "direct"]), "impossible"),
        ("/film/layers", json!(["beauty of tomorrow"]), "`beauty of tomorrow`"),
        ("/film/layers", json!("direct"), "its header says: "),
        ("/statistics", json!({ "rays": -1 }), "its header says: "),
        // No memory is allocated for pixels whose bytes are missing.
        ("/film/frame/full_size", json!([1 << 24, 1 << 24]), "cut off"),
    ] {
        let error = forged(place, value);
        assert!(error.contains(words), "{place}: {error}");
    }
    let of_version = |version: u32| {
        let bytes = [&bytes[..8], &version.to_le_bytes(), &bytes[12..]].concat();
        read_bytes(&bytes).unwrap_err()
    };
    for (version, word) in [(VERSION + 1, "newer"), (MIN_VERSION - 1, "anew")] {
        let error = of_version(version);
        let words = format!("version {version} of the format");
        assert!(error.to_string().contains(&words), "{error}");
        assert!(error.help().unwrap().contains(word), "{error:?}");
    }
}
