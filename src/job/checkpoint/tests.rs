//! Checkpoints round-trip, or are rejected.

use serde_json::{Value, json};

use super::version::MIN_VERSION;
use super::*;
use std::path::PathBuf;
use std::time::Duration;

use crate::accel::Backend;
use crate::color::{PathRadiance, Rgb, ViewTransform, VisibleSurface};
use crate::film::{FilmFormat, FilmFrame, Layer, RadianceScale, SampleRun};
use crate::job::{Job, Metadata, TileSampleCounts};
use crate::math::Rect;
use crate::overlay::OverlayChoice;
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
        sums_squares: true,
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
        let surfaces = vec![VisibleSurface { row: 7, ..VisibleSurface::NONE }; samples.len()];
        film.add(tile, &counts, SampleRun { radiance: &samples, visible_surfaces: &surfaces })
            .unwrap();
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
    let output = OutputSpec {
        overlay: OverlayChoice::default(),
        columns: Vec::new(),
        files: vec![path()],
        look: ViewTransform::default(),
        dpi: Some(300),
        denoise: true,
        with_run_record: true,
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
        status: RenderStatus::Ended { missed_targets: Vec::new() },
        statistics: CumulativeStats { rays: 1 << 60, seconds: 0.1, truncated_paths: 2 },
        transparent: true,
        source: Some(SceneSource { name: "a.toml".to_owned(), ..SceneSource::default() }),
        output: Some(output),
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
    let (read_header, read_film) = read_bytes(&bytes).unwrap();
    let format = film.format();
    assert_eq!(read_header, header);
    assert_eq!(read_film.format(), format);
    assert_eq!((read_film.counts(), read_film.picture()), (film.counts(), film.picture()));
    // Writing the film again produces the same bytes.
    let (_folder, path) = written(&read_film, &read_header);
    assert!(std::fs::read(path).unwrap() == bytes);
}

#[test]
fn sample_counts_that_make_the_header_too_long_are_left_out() {
    let (film, mut header, _) = part();
    header.metadata.counts = TileSampleCounts((0..3 << 20).map(|tile| 16 + tile % 2).collect());
    let bytes = encode_checkpoint(&film, &header).unwrap();
    let back = Checkpoint::from_bytes(bytes).unwrap();
    assert!(back.header().metadata.counts.is_uniform());
    assert_eq!(back.into_film().unwrap().counts(), film.counts());
    header.metadata.commit = "x".repeat(16 << 20);
    let told = encode_checkpoint(&film, &header).unwrap_err().to_string();
    assert!(told.ends_with("more than the 16777216 that can be read again"), "{told}");
}

#[test]
fn cut_off_at_any_byte_a_part_is_refused() {
    let (_, _, bytes) = part();
    let lengths = (0..200).chain((200..bytes.len()).step_by(37)).chain([bytes.len() - 1]);
    for length in lengths {
        let error = read_bytes(&bytes[..length]).unwrap_err().to_string();
        let expected = if length < 8 { "it is neither" } else { "it is truncated after" };
        assert!(error.contains(expected), "{length}: {error}");
    }
    let error = read_bytes(&[&bytes[..], b"x"].concat()).unwrap_err().to_string();
    assert!(error.ends_with("it is damaged: data follows its end"), "{error}");
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
        let reasons = ["neither", "version", "truncated", "damaged"];
        assert!(reasons.iter().any(|reason| error.contains(reason)), "{error}");
    }
}

#[test]
fn a_part_with_good_checksums_and_impossible_numbers_is_refused() {
    let (_, _, bytes) = part();
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let header_text: Value = serde_json::from_slice(&bytes[16..16 + length]).unwrap();
    let forged = |pointer: &str, value: Value| {
        let mut header_text = header_text.clone();
        let forged =
            header_text.pointer_mut(pointer).unwrap_or_else(|| panic!("there is no {pointer}"));
        assert_ne!(*forged, value);
        *forged = value;
        let header_text = header_text.to_string();
        let mut bytes = MAGIC.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend((header_text.len() as u32).to_le_bytes());
        bytes.extend(header_text.as_bytes());
        bytes.extend(blake3::hash(&bytes).as_bytes());
        read_bytes(&bytes).unwrap_err().to_string()
    };
    let huge = u32::MAX;
    for (pointer, value, expected) in [
        ("/film/frame/full_size", json!([huge, huge]), "inconsistent"),
        ("/film/frame/window/width", json!(40), "inconsistent"),
        ("/film/frame/window/width", json!(0), "inconsistent"),
        ("/film/frame/window/x", json!(huge), "inconsistent"),
        ("/film/first_sample", json!(33), "inconsistent"),
        ("/film/first_sample", json!(48), "inconsistent"),
        ("/samples/start", json!(33), "inconsistent"),
        ("/samples/start", json!(80), "inconsistent"),
        ("/samples/end", json!(16), "inconsistent"),
        ("/samples", json!([32]), "its header is not supported: "),
        ("/film/scale", json!(1000), "its header is not supported: no radiance has this exponent"),
        ("/film/layers", json!(["direct", "direct"]), "inconsistent"),
        ("/film/layers", json!(["beauty of tomorrow"]), "`beauty of tomorrow`"),
        ("/film/layers", json!("direct"), "its header is not supported: "),
        ("/statistics", json!({ "rays": -1 }), "its header is not supported: "),
        // No memory is allocated for pixels whose bytes are missing.
        ("/film/frame/full_size", json!([1 << 24, 1 << 24]), "truncated"),
    ] {
        let error = forged(pointer, value);
        assert!(error.contains(expected), "{pointer}: {error}");
    }
    let of_version = |version: u32| {
        let bytes = [&bytes[..8], &version.to_le_bytes(), &bytes[12..]].concat();
        read_bytes(&bytes).unwrap_err()
    };
    for (version, word) in [(VERSION + 1, "newer"), (MIN_VERSION - 1, "again")] {
        let error = of_version(version);
        let expected = format!("its format has version {version}");
        assert!(error.to_string().contains(&expected), "{error}");
        assert!(error.help().unwrap().contains(word), "{error:?}");
    }
}
