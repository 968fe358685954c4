//! Checks what a picture says of how it was made, before anything is rendered: the file may be
//! damaged, or made to mislead.

use std::ops::Range;

use crate::accel::Backend;
use crate::error::{Error, Result};
use crate::film::{Aov, BLOCK_SIZE, Film, FilmFormat, FilmFrame, RadianceScale};
use crate::math::Rect;
use crate::scene::SceneDescription;

use super::film_format::format_for_settings;
use super::memory::MemoryPlan;
use super::metadata::Metadata;
use super::samples::{SampleRange, TileSampleCounts, WindowSamples};

/// Bytes per pixel and layer of a developed picture and its file.
const LAYER_PIXEL_BYTES: u64 = 32;

/// What it takes to render a picture again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReproductionCost {
    /// Pixels of the picture.
    pub pixels: u64,
    /// Samples to render, over all pixels.
    pub samples: u64,
    /// Peak memory in bytes, without the files of the scene.
    pub memory: u64,
}

impl ReproductionCost {
    /// Checks the record of a picture and sums up the work that it asks for.
    ///
    /// # Errors
    /// Describes what no render can have written.
    pub fn of(recorded: &Metadata) -> Result<Self> {
        refuse_converted(recorded)?;
        check_settings(recorded)?;
        let pixels = recorded.settings.image.pixel_bounds().pixel_count() as u64;
        Ok(Self { pixels, samples: samples(recorded)?, memory: memory(recorded) })
    }
}

/// Refuses a picture whose pixels are no longer those of a render.
fn refuse_converted(recorded: &Metadata) -> Result<()> {
    if recorded.converted.is_empty() {
        return Ok(());
    }
    let message =
        format!("the picture was changed after it was rendered: {}", recorded.converted.join("; "));
    Err(Error::input(message).with_help("use the picture that it was made from"))
}

fn impossible(what: impl std::fmt::Display) -> Error {
    let message = format!("the picture's record of how it was made is impossible: {what}");
    Error::input(message).with_help("it is damaged, or was not written by photosphere")
}

fn check_settings(recorded: &Metadata) -> Result<()> {
    recorded.settings.check().map_err(impossible)?;
    let layers = recorded.layers.as_deref().unwrap_or_default();
    let mut seen: Vec<&Aov> = Vec::new();
    for layer in layers {
        if seen.contains(&layer) {
            return Err(impossible(format!("it has the layer `{}` twice", layer.info().name)));
        }
        seen.push(layer);
    }
    Ok(())
}

/// Samples of the whole picture. The settings must be valid.
fn samples(recorded: &Metadata) -> Result<u64> {
    let Metadata { settings, samples, counts, parts, .. } = recorded;
    let window = settings.image.pixel_bounds();
    let full_size = [settings.image.width, settings.image.height];
    check_range(samples, 0..settings.render.samples_per_pixel)?;
    if parts.is_empty() {
        return samples_of(FilmFrame { full_size, window }, samples, counts);
    }
    let all = samples.first..samples.first + samples.max_count;
    let mut total = 0u64;
    for WindowSamples { window: part, samples, counts } in &parts.0 {
        check_part(part, &window)?;
        check_range(samples, all.clone())?;
        if samples.max_count == 0 {
            return Err(impossible("a part has no samples"));
        }
        let frame = FilmFrame { full_size, window: *part };
        total = total.saturating_add(samples_of(frame, samples, counts)?);
    }
    Ok(total)
}

fn check_range(samples: &SampleRange, all: Range<u32>) -> Result<()> {
    let SampleRange { first, min_count, max_count } = *samples;
    let is_within = first >= all.start
        && first % BLOCK_SIZE == 0
        && min_count <= max_count
        && first.checked_add(max_count).is_some_and(|end| end <= all.end);
    is_within.then_some(()).ok_or_else(|| {
        let Range { start, end } = all;
        impossible(format!("{max_count} samples from {first} on are not among {start}..{end}"))
    })
}

fn check_part(part: &Rect, window: &Rect) -> Result<()> {
    let is_within = |first: u32, length: u32, outer_first: u32, outer_length: u32| {
        let end = u64::from(first) + u64::from(length);
        length > 0
            && first >= outer_first
            && end <= u64::from(outer_first) + u64::from(outer_length)
    };
    let fits = is_within(part.x, part.width, window.x, window.width)
        && is_within(part.y, part.height, window.y, window.height);
    fits.then_some(()).ok_or_else(|| {
        let Rect { x, y, width, height } = part;
        impossible(format!(
            "a part of {width} x {height} pixels at {x},{y} is not within the window {window}"
        ))
    })
}

fn samples_of(frame: FilmFrame, samples: &SampleRange, counts: &TileSampleCounts) -> Result<u64> {
    let counts = counts.0.as_slice();
    if counts.is_empty() {
        return Ok(frame.pixel_count() as u64 * u64::from(samples.max_count));
    }
    if counts.len() != frame.tile_count() || counts.iter().any(|&count| count > samples.max_count) {
        return Err(impossible("its tiles have other samples than its pixels"));
    }
    let of_tile =
        |(tile, &count): (usize, &u32)| frame.tile(tile).pixel_count() as u64 * u64::from(count);
    Ok(counts.iter().enumerate().map(of_tile).sum())
}

/// Peak memory in bytes. The settings must be valid.
fn memory(recorded: &Metadata) -> u64 {
    let layers = recorded.layers.as_deref().unwrap_or_default();
    let transparent = recorded.scene.as_ref().is_some_and(|scene| scene.background.transparent);
    let scale = RadianceScale::from_max_radiance(1.0);
    let format: FilmFormat = format_for_settings(&recorded.settings, transparent, scale, layers);
    // A picture of parts is the sum of their films.
    let films = if recorded.parts.is_empty() { 1 } else { 2 };
    let picture = format.frame.pixel_count() as u64 * LAYER_PIXEL_BYTES * (layers.len() as u64 + 1);
    let spheres = recorded.scene.as_ref().map_or(0, inline_spheres);
    let backends: &[Backend] = &[recorded.intersector];
    let plan = MemoryPlan::for_spheres(spheres, backends, rayon::current_num_threads());
    plan.peak() + films * Film::bytes(&format) as u64 + picture
}

fn inline_spheres(scene: &SceneDescription) -> u64 {
    scene.spheres.len() as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::samples::MergedSamples;
    use crate::scene::{ContentHash, Settings};

    fn recorded() -> Metadata {
        let mut settings = Settings::default();
        (settings.image.width, settings.image.height) = (40, 8);
        settings.render.samples_per_pixel = 64;
        Metadata {
            version: String::new(),
            commit: String::new(),
            scene_identity: ContentHash::default(),
            job_identity: ContentHash::default(),
            intersector: Backend::Native,
            settings,
            samples: SampleRange::first_n(64),
            counts: TileSampleCounts::default(),
            parts: MergedSamples::default(),
            biased: Vec::new(),
            look: None,
            bits: None,
            converted: Vec::new(),
            overlay: None,
            layers: None,
            column_layers: Vec::new(),
            files: Vec::new(),
            scene: None,
            run: None,
        }
    }

    fn part(x: u32, width: u32, first: u32, max_count: u32) -> MergedSamples {
        let samples = SampleRange { first, min_count: max_count, max_count };
        let window = Rect { x, y: 0, width, height: 8 };
        MergedSamples(vec![WindowSamples { window, samples, counts: TileSampleCounts::default() }])
    }

    #[track_caller]
    fn refused(change: impl FnOnce(&mut Metadata), words: &str) {
        let mut recorded = recorded();
        change(&mut recorded);
        let error = ReproductionCost::of(&recorded).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }

    #[test]
    fn the_samples_are_those_of_the_tiles_and_the_parts() {
        let cost = |change: &dyn Fn(&mut Metadata)| {
            let mut recorded = recorded();
            change(&mut recorded);
            ReproductionCost::of(&recorded).unwrap().samples
        };
        assert_eq!(cost(&|_| {}), 40 * 8 * 64);
        // Three tiles across, the last half as wide, and two down.
        let counts = TileSampleCounts(vec![64, 16, 32, 16, 16, 16]);
        let of_tiles = 16 * 4 * (64 + 16 + 16 + 16) + 8 * 4 * (32 + 16);
        assert_eq!(cost(&|recorded| recorded.counts = counts.clone()), of_tiles);
        assert_eq!(cost(&|recorded| recorded.parts = part(8, 5, 32, 32)), 5 * 8 * 32);
    }

    #[test]
    fn records_that_no_render_writes_are_refused() {
        refused(|it| it.settings.image.width = 0, "`image.width`");
        refused(|it| it.parts = part(8, 0, 0, 16), "a part of 0 x 8 pixels at 8,0 is not within");
        refused(|it| it.parts = part(u32::MAX, 2, 0, 16), "is not within the window 0,0,40,8");
        refused(|it| it.parts = part(8, 33, 0, 16), "is not within");
        refused(|it| it.parts = part(8, 5, 48, 32), "32 samples from 48 on are not among 0..64");
        refused(|it| it.parts = part(8, 5, 8, 16), "16 samples from 8 on");
        refused(|it| it.parts = part(8, 5, 16, 0), "a part has no samples");
        refused(|it| it.samples.first = u32::MAX - 15, "are not among 0..64");
        refused(|it| it.samples.min_count = 65, "are not among 0..64");
        refused(|it| it.counts = TileSampleCounts(vec![16; 5]), "its tiles have other samples");
        refused(|it| it.counts = TileSampleCounts(vec![65; 6]), "its tiles have other samples");
        refused(
            |it| it.converted = vec!["layer depth".to_owned()],
            "changed after it was rendered: l",
        );
        let twice = vec![Aov::Beauty, Aov::Beauty];
        refused(|it| it.layers = Some(twice), "twice");
    }
}
