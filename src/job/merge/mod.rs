//! Parts of a picture become one, to the bit of one render without a break.

mod cells;
mod piece;
mod whole;

use std::path::PathBuf;

use crate::accel::BuildOptions;
use crate::error::{Error, Result, Setting};
use crate::film::{BLOCK, Film, Kind, summed_for};
use crate::image_io::Picture;
use crate::image_io::WholeFile;
use crate::math::Rect;
use crate::scene::Shot;

use super::aovs::{needs_scene, picture, picture_of_sums};
use super::checkpoint::{Checkpoint, Header, write_checkpoint};
use super::metadata::Metadata;
use super::outcome::NoiseStatus;

use piece::Piece;
use whole::Whole;

/// What parts are to become.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    /// The layers of the picture; `None`: those of the parts.
    pub layers: Option<Vec<Kind>>,
    /// The window that parts of several windows make together, where that is not the whole picture.
    pub crop: Option<Rect>,
    /// Whether pixels or samples may be missing in a picture.
    pub allow_gaps: bool,
    /// Whether a picture is made.
    pub makes_picture: bool,
    /// Whether a checkpoint is made, which can have no gaps.
    pub makes_part: bool,
    /// The command, quoted for a shell, for files to tell.
    pub command: Option<String>,
}

/// Parts added up.
#[derive(Debug)]
pub struct Merged {
    /// The sums.
    pub film: Film,
    /// How the picture was made.
    pub metadata: Metadata,
    /// The layers of the picture.
    pub layers: Vec<Kind>,
    /// The parts that did not meet their noise targets.
    pub missed: Vec<(PathBuf, Vec<NoiseStatus>)>,
    header: Header,
    first: Piece,
}

/// Adds up parts.
///
/// # Errors
/// When a part is damaged or foreign, when parts overlap, or when something is missing.
pub fn merge(paths: &[PathBuf], plan: &Plan) -> Result<Merged> {
    let mut pieces: Vec<Piece> =
        paths.iter().map(|path| Piece::open(path)).collect::<Result<_>>()?;
    let Some(first) = pieces.first() else { return Err(Error::input("there is no part to merge")) };
    pieces.iter().try_for_each(|piece| piece.check_kin(first))?;
    check_overlaps(&pieces)?;
    let own = || first.header.metadata.layers.clone().unwrap_or_default();
    let layers = plan.layers.clone().unwrap_or_else(own);
    check_layers(&layers, first)?;
    let whole = Whole::of(&pieces, plan.crop)?;
    whole.check_squares(&pieces)?;
    let must_be_whole = !plan.allow_gaps || plan.makes_part;
    if must_be_whole {
        // With gaps allowed, it is the part alone that cannot have them.
        whole.check_gaps(&pieces, !plan.allow_gaps, plan.makes_picture, plan.crop)?;
    }
    let mut film = Film::without_memory(&whole.format);
    let mut shares = Vec::new();
    for piece in &pieces {
        let part = Checkpoint::open(&piece.path)?.film()?;
        if must_be_whole {
            piece.check_followed(&part, &pieces)?;
        }
        if !plan.allow_gaps {
            piece.check_finished(&part)?;
        }
        shares.extend(piece.shares(&part));
        film.add_film(&part)?;
    }
    let metadata = whole.metadata(&pieces, shares, &film, plan.command.clone());
    let missed: Vec<(PathBuf, Vec<NoiseStatus>)> = pieces
        .iter()
        .map(|piece| (piece.path.clone(), piece.missed().to_vec()))
        .filter(|(_, missed)| !missed.is_empty())
        .collect();
    let header = whole.header(&pieces, &metadata, &layers, !plan.allow_gaps);
    let first = pieces.swap_remove(0);
    Ok(Merged { film, metadata, layers, missed, header, first })
}

impl Merged {
    /// Writes the sums, to be merged further or resumed.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn write_part(&self, file: &WholeFile) -> Result<()> {
        write_checkpoint(file, &self.film, &self.header)
    }

    /// The picture. Ids of spheres and materials are not sums, and need the scene again.
    ///
    /// # Errors
    /// When they are asked for and the scene is gone or has changed.
    pub fn picture(&self) -> Result<Picture> {
        if !self.layers.iter().any(|kind| needs_scene(*kind)) {
            return Ok(picture_of_sums(&self.film, &self.layers, self.first.header.transparent));
        }
        let (scene, mut settings) = self.first.scene()?;
        settings.image.crop = self.metadata.settings.image.crop;
        let shot = Shot::new(&scene, settings)?;
        let accel =
            self.metadata.intersector.backend.build(scene.spheres(), &BuildOptions::default())?;
        Ok(picture(&shot, accel.as_ref(), &self.film, &self.layers))
    }
}

/// Refuses layers that the parts do not hold.
fn check_layers(kinds: &[Kind], first: &Piece) -> Result<()> {
    let held = &first.header.film.layers;
    let lacks = |kind: &&Kind| summed_for(&[**kind]).iter().any(|layer| !held.contains(layer));
    let Some(kind) = kinds.iter().find(lacks) else { return Ok(()) };
    let (layer, path) = (kind.row().name, first.path.display());
    Err(Error::input(format!("`{path}` does not hold the layer `{layer}`"))
        .with_help("render all parts with this layer")
        .with_setting(Setting::Layers, layer))
}

/// Refuses samples that two parts hold, and blocks that end in one part and go on in another.
fn check_overlaps(pieces: &[Piece]) -> Result<()> {
    for (at, a) in pieces.iter().enumerate() {
        for b in &pieces[..at] {
            let Some(common) = a.window().common(&b.window()) else { continue };
            let (first, second) =
                if a.samples().start < b.samples().start { (a, b) } else { (b, a) };
            let (early, late) = (first.samples(), second.samples());
            if early.is_empty() || late.is_empty() {
                continue;
            }
            let (x, y) = (first.path.display(), second.path.display());
            if late.start < early.end {
                let end = early.end.min(late.end);
                let what = format!(
                    "`{x}` and `{y}` both hold samples {}..{end} of the pixels {common}",
                    late.start,
                );
                return Err(Error::input(what).with_help("leave one of them out"));
            }
            if early.end % BLOCK != 0 {
                let what = format!(
                    "`{x}` ends within a block, at sample {}, so that `{y}` cannot follow it",
                    early.end
                );
                let help =
                    format!("render it again up to a multiple of {BLOCK}, or resume and extend it");
                return Err(Error::input(what)
                    .with_help(help)
                    .with_setting(Setting::Resume, x.to_string()));
            }
        }
    }
    Ok(())
}
