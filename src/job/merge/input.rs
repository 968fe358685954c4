//! One input of a merge, and checks that it fits the other inputs.

use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result, Suggestion};
use crate::film::{Film, FilmFormat};
use crate::math::Rect;
use crate::scene::Scene;

use super::super::checkpoint::{Checkpoint, CheckpointHeader, RenderStatus};
use super::super::metadata::Metadata;
use super::super::noise_status::NoiseStatus;
use super::super::samples::{SampleRange, TileSampleCounts, WindowSamples};

/// A partial render to be merged.
#[derive(Debug)]
pub(super) struct MergeInput {
    pub(super) path: PathBuf,
    pub(super) header: CheckpointHeader,
}

impl MergeInput {
    pub(super) fn open(path: &Path) -> Result<Self> {
        let header = Checkpoint::open(path)?.header().clone();
        Ok(Self { path: path.to_path_buf(), header })
    }

    pub(super) fn window(&self) -> Rect {
        self.header.film.frame.window
    }

    pub(super) fn samples(&self) -> &Range<u32> {
        &self.header.samples
    }

    pub(super) fn missed_targets(&self) -> &[NoiseStatus] {
        match &self.header.status {
            RenderStatus::Unfinished => &[],
            RenderStatus::Ended { missed_targets } => missed_targets,
        }
    }

    /// Samples per pixel that the job asks for.
    pub(super) fn samples_per_pixel(&self) -> u32 {
        self.header.job.settings.render.samples_per_pixel
    }

    /// Loads the scene of the part.
    ///
    /// # Errors
    /// If the scene is not in a regular file or has changed.
    pub(super) fn scene(&self) -> Result<(Scene, crate::scene::Settings)> {
        let file = self.header.source.as_ref().and_then(|source| source.file.clone());
        let Some(path) = file else {
            return Err(Error::input("the scene of the parts was not read from a file").with_help(
                "leave out the layers sphere_id and material_id, which need the scene",
            ));
        };
        // A pipe or a device that the part of a stranger names could keep the program waiting.
        if path.exists() && !path.is_file() {
            return Err(Error::file("read the scene", &path, "it is not a regular file"));
        }
        let overrides = self.header.source.iter().flat_map(|source| &source.overrides);
        let overrides: Vec<_> =
            overrides.map(|(key, value)| crate::scene::Override::new(key, value)).collect();
        let (scene, _) = crate::scene::read_file(&path, &overrides)?.build()?;
        if scene.content_hash() != self.header.metadata.scene_identity {
            let message = format!("`{}` has changed since its parts were rendered", path.display());
            return Err(Error::input(message).with_help(
                "leave out the layers sphere_id and material_id, which need the scene",
            ));
        }
        Ok((scene, self.header.job.settings))
    }

    /// The samples in the part, by window.
    pub(super) fn window_samples(&self, film: &Film) -> Vec<WindowSamples> {
        if !self.header.metadata.parts.is_empty() {
            return self.header.metadata.parts.0.clone();
        }
        let samples = SampleRange::from_film(film, self.samples().start);
        let counts = TileSampleCounts::from_film(film).unwrap_or_default();
        vec![WindowSamples { window: self.window(), samples, counts }]
    }

    /// Rejects a part of a different picture than `first`.
    pub(super) fn check_compatible(&self, first: &Self) -> Result<()> {
        let (path, other_path) = (self.path.display(), first.path.display());
        let incompatible = |reason: &str| {
            Err(Error::input(format!(
                "`{path}` and `{other_path}` are not parts of the same picture: {reason}"
            ))
            .with_help("merge parts of the same scene, with the same options"))
        };
        let (metadata, other) = (&self.header.metadata, &first.header.metadata);
        let identity = |metadata: &Metadata| (metadata.scene_identity, metadata.job_identity);
        if identity(metadata) != identity(other) {
            return incompatible(&format!("in the first, {}", metadata.describe_difference(other)));
        }
        let format = |input: &Self| {
            let FilmFormat { frame, scale, layers, sums_squares, .. } = input.header.film.clone();
            (frame.full_size, scale, layers, sums_squares)
        };
        if format(self) != format(first) {
            return incompatible("they have different layers");
        }
        let noise = |input: &Self| input.header.job.until.noise;
        if noise(self) != noise(first) {
            let describe = |input: &Self| noise(input).map_or("none".to_owned(), |n| n.to_string());
            let (first, own) = (describe(first), describe(self));
            return incompatible(&format!("in the first, the noise target is {first}, not {own}"));
        }
        Ok(())
    }

    /// Rejects a part that ended before the samples at which another part continues. A film cannot
    /// represent such a gap in a pixel's samples.
    pub(super) fn check_continuation(&self, film: &Film, inputs: &[Self]) -> Result<()> {
        let end = self.samples().start + film.sample_count_range().0;
        let is_next = |other: &&Self| {
            other.samples().start >= self.samples().end
                && !other.samples().is_empty()
                && other.window().intersection(&self.window()).is_some()
        };
        let Some(other) = inputs.iter().find(is_next).filter(|_| end < self.samples().end) else {
            return Ok(());
        };
        let (path, other_path) = (self.path.display(), other.path.display());
        let reason = format!(
            "`{path}` ended at sample {end} of {}, so `{other_path}` cannot continue it",
            self.samples().end
        );
        Err(Error::input(reason)
            .with_help("render it again without a time limit and a noise target, or leave it out"))
    }

    /// Rejects an unfinished part.
    pub(super) fn check_finished(&self, film: &Film) -> Result<()> {
        let (min_count, all) = (film.sample_count_range().0, self.samples().len());
        // A part that ended at a noise target or time limit may have fewer samples.
        if min_count as usize == all || self.header.status != RenderStatus::Unfinished {
            return Ok(());
        }
        let path = self.path.display();
        Err(Error::input(format!("`{path}` is not finished: it has {min_count} of {all} samples"))
            .with_help("resume it, or allow gaps")
            .with_suggestion(Suggestion::Resume, path.to_string())
            .with_suggestion(Suggestion::AllowGaps, ""))
    }
}
