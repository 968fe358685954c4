//! Merges partial renders. The result is bit-identical to a single uninterrupted render.

mod cells;
mod extent;
mod input;

use std::path::PathBuf;

use crate::accel::BuildOptions;
use crate::error::{Error, Result, Suggestion};
use crate::film::{Aov, BLOCK_SIZE, Film, required_layers};
use crate::image_io::AtomicFile;
use crate::image_io::Picture;
use crate::math::Rect;
use crate::scene::PreparedScene;

use super::aovs::{develop, develop_without_scene, needs_scene};
use super::checkpoint::{Checkpoint, CheckpointHeader, write_checkpoint};
use super::metadata::Metadata;
use super::noise_status::NoiseStatus;

use extent::MergedExtent;
use input::MergeInput;

/// Options for [`merge`].
#[derive(Clone, Debug, Default)]
pub struct MergeOptions {
    /// The layers of the picture; `None` selects those of the parts.
    pub layers: Option<Vec<Aov>>,
    /// The window that parts of several windows must fill, if it is not the whole picture.
    pub crop: Option<Rect>,
    /// True if a picture may have missing pixels or samples.
    pub allow_gaps: bool,
    /// True if a picture will be written.
    pub writes_picture: bool,
    /// True if a checkpoint will be written; checkpoints cannot have gaps.
    pub writes_checkpoint: bool,
    /// The shell-quoted command line, to be recorded in the files.
    pub command: Option<String>,
}

/// A merged render.
#[derive(Debug)]
pub struct MergedRender {
    /// The film with the samples of all parts.
    pub film: Film,
    /// Metadata of the merged picture.
    pub metadata: Metadata,
    /// The layers of the picture.
    pub layers: Vec<Aov>,
    /// The parts that missed their noise targets, with those targets.
    pub missed_targets: Vec<(PathBuf, Vec<NoiseStatus>)>,
    header: CheckpointHeader,
    first: MergeInput,
}

/// Merges partial renders.
///
/// # Errors
/// If a part is damaged or belongs to another render, if parts overlap, or if pixels or samples are
/// missing.
pub fn merge(paths: &[PathBuf], options: &MergeOptions) -> Result<MergedRender> {
    let mut inputs: Vec<MergeInput> =
        paths.iter().map(|path| MergeInput::open(path)).collect::<Result<_>>()?;
    let Some(first) = inputs.first() else {
        return Err(Error::input("there are no parts to merge"));
    };
    inputs.iter().try_for_each(|input| input.check_compatible(first))?;
    check_overlaps(&inputs)?;
    let stored = || first.header.metadata.layers.clone().unwrap_or_default();
    let layers = options.layers.clone().unwrap_or_else(stored);
    check_aovs(&layers, first)?;
    let extent = MergedExtent::new(&inputs, options.crop)?;
    extent.check_tile_alignment(&inputs)?;
    let must_be_complete = !options.allow_gaps || options.writes_checkpoint;
    if must_be_complete {
        // If the picture may have gaps, only the checkpoint must be complete.
        extent.check_gaps(&inputs, !options.allow_gaps, options.writes_picture, options.crop)?;
    }
    let mut film = Film::new_lazy(&extent.format);
    let mut window_samples = Vec::new();
    for input in &inputs {
        let part = Checkpoint::open(&input.path)?.into_film()?;
        if must_be_complete {
            input.check_continuation(&part, &inputs)?;
        }
        if !options.allow_gaps {
            input.check_finished(&part)?;
        }
        window_samples.extend(input.window_samples(&part));
        film.merge(&part)?;
    }
    let metadata = extent.metadata(&inputs, window_samples, &film, options.command.clone());
    let missed_targets: Vec<(PathBuf, Vec<NoiseStatus>)> = inputs
        .iter()
        .map(|input| (input.path.clone(), input.missed_targets().to_vec()))
        .filter(|(_, missed_targets)| !missed_targets.is_empty())
        .collect();
    let header = extent.header(&inputs, &metadata, &layers, !options.allow_gaps);
    let first = inputs.swap_remove(0);
    Ok(MergedRender { film, metadata, layers, missed_targets, header, first })
}

impl MergedRender {
    /// Writes the merged film as a checkpoint, to be merged further or resumed.
    ///
    /// # Errors
    /// If writing fails.
    pub fn write_checkpoint(&self, file: &AtomicFile) -> Result<()> {
        write_checkpoint(file, &self.film, &self.header)
    }

    /// Develops the picture. Sphere and material ids are not stored in the film and need the scene.
    ///
    /// # Errors
    /// If such ids are requested and the scene is missing or has changed.
    pub fn picture(&self) -> Result<Picture> {
        if !self.layers.iter().any(|aov| needs_scene(*aov)) {
            return Ok(develop_without_scene(
                &self.film,
                &self.layers,
                self.first.header.transparent,
            ));
        }
        let (scene, mut settings) = self.first.scene()?;
        settings.image.crop = self.metadata.settings.image.crop;
        let prepared = PreparedScene::new(&scene, settings)?;
        let accel = self.metadata.intersector.build(scene.spheres(), &BuildOptions::default())?;
        Ok(develop(&prepared, accel.as_ref(), &self.film, &self.layers))
    }
}

/// Rejects layers that the parts do not have.
fn check_aovs(aovs: &[Aov], first: &MergeInput) -> Result<()> {
    let stored = &first.header.film.layers;
    let is_missing =
        |aov: &&Aov| required_layers(&[**aov]).iter().any(|layer| !stored.contains(layer));
    let Some(aov) = aovs.iter().find(is_missing) else { return Ok(()) };
    let (layer, path) = (aov.info().name, first.path.display());
    Err(Error::input(format!("`{path}` does not have the layer `{layer}`"))
        .with_help("render all parts with this layer")
        .with_suggestion(Suggestion::Layers, layer))
}

/// Rejects samples that are in two parts, and blocks split between two parts.
fn check_overlaps(inputs: &[MergeInput]) -> Result<()> {
    for (index, a) in inputs.iter().enumerate() {
        for b in &inputs[..index] {
            let Some(common) = a.window().intersection(&b.window()) else { continue };
            let (first, second) =
                if a.samples().start < b.samples().start { (a, b) } else { (b, a) };
            let (early, late) = (first.samples(), second.samples());
            if early.is_empty() || late.is_empty() {
                continue;
            }
            let (first_path, second_path) = (first.path.display(), second.path.display());
            if late.start < early.end {
                let end = early.end.min(late.end);
                let message = format!(
                    "`{first_path}` and `{second_path}` both have samples {}..{end} of the pixels {common}",
                    late.start,
                );
                return Err(Error::input(message).with_help("leave one of them out"));
            }
            if early.end % BLOCK_SIZE != 0 {
                let message = format!(
                    "`{first_path}` ends within a block, at sample {}, so `{second_path}` cannot continue it",
                    early.end
                );
                let help = format!(
                    "render it again up to a multiple of {BLOCK_SIZE}, or resume and extend it"
                );
                return Err(Error::input(message)
                    .with_help(help)
                    .with_suggestion(Suggestion::Resume, first_path.to_string()));
            }
        }
    }
    Ok(())
}
