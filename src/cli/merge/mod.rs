//! `photosphere merge`: parts of a picture become one.

mod cells;
mod whole;

use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::accel::{Backend, BuildOptions};
use crate::error::{Error, Result};
use crate::film::{BLOCK, Film, Format, Kind, Picture, Rect, summed_for};
use crate::output::{PartFile, PartHead, Record, WholeFile, write_part};
use crate::provenance::{Counts, Made, Samples, Share};
use crate::render::{needs_scene, picture, picture_of_sums};
use crate::scene::Scene;
use crate::scene::description::Window;

use super::args::MergeArgs;
use super::exit::Exit;
use super::outputs::{self, Outputs, kinds_of};
use super::render::{ENDED, MISSED};
use super::{interrupt, print};

use whole::Whole;

/// One of the parts.
struct Piece {
    path: PathBuf,
    head: PartHead,
    made: Made,
}

/// # Errors
/// When a part is damaged or foreign, when parts overlap, when something is missing, and when the
/// result cannot be written.
pub(super) fn run(args: &MergeArgs) -> Result<Exit> {
    let files: Vec<_> = args.output.files.iter().map(|file| ("-o", file.as_path())).collect();
    outputs::refuse_same_places(&files)?;
    let mut outputs = Outputs::new(&args.output, false)?;
    let part = outputs.part().map(WholeFile::new).transpose()?;
    interrupt::listen();
    let pieces: Vec<Piece> =
        args.parts.iter().map(|path| Piece::open(path)).collect::<Result<_>>()?;
    let Some(first) = pieces.first() else { return Err(Error::input("there is no part to merge")) };
    pieces.iter().try_for_each(|piece| piece.check_kin(first))?;
    check_overlaps(&pieces)?;
    if let Some(kinds) = kinds_of(&first.head.records).filter(|_| !args.output.asks_for_layers()) {
        outputs.set_kinds(kinds);
    }
    check_layers(outputs.kinds(), first)?;
    let whole = Whole::of(&pieces, args.crop)?;
    whole.check_squares(&pieces)?;
    if !args.allow_gaps || part.is_some() {
        // With gaps allowed, it is the part alone that cannot have them.
        whole.check_gaps(&pieces, !args.allow_gaps, outputs.has_pictures(), args.crop)?;
    }

    let mut sum = Film::without_memory(&whole.format);
    let mut shares = Vec::new();
    for piece in &pieces {
        let film = PartFile::open(&piece.path)?.film()?;
        if !args.allow_gaps || part.is_some() {
            piece.check_followed(&film, &pieces)?;
        }
        if !args.allow_gaps {
            piece.check_finished(&film)?;
        }
        shares.extend(piece.shares(&film));
        sum.add_film(&film)?;
    }
    let made = whole.made(first, shares, &sum);
    let run = whole.run(&pieces, &sum);
    if let Some(part) = part {
        let mut records = whole.records(&pieces, &made, &run);
        records.push(outputs.record_of_layers());
        if !args.allow_gaps {
            records.push(Record::new(ENDED, "true")); // as all its parts are
        }
        write_part(&part, &sum, &whole.samples, &records)?;
    }
    if outputs.has_pictures() {
        let picture = first.picture(&sum, &made, outputs.kinds())?;
        let words = outputs.words(sum.frame(), &made, &run, false);
        outputs.pictures().iter().try_for_each(|file| file.write(None, &picture, &words))?;
    }
    if !args.quiet {
        let parts = print::count(pieces.len(), "part");
        let (files, samples) = (outputs::in_words(&args.output.files), made.samples_in_words());
        print::remark(format_args!("wrote {files}, samples {samples} of {parts}"));
    }
    Ok(tell_missed(&pieces))
}

/// Says which parts ended without having met their noise target.
fn tell_missed(pieces: &[Piece]) -> Exit {
    let mut exit = Exit::Done;
    for piece in pieces {
        if let Some(missed) = piece.record(MISSED) {
            print::warning(format_args!("`{}`: {missed}", piece.path.display()));
            exit = Exit::CheckFailed;
        }
    }
    exit
}

impl Piece {
    fn open(path: &Path) -> Result<Self> {
        let part = PartFile::open(path)?;
        let made = Made::read(path, &part.head().records)?;
        Ok(Self { path: path.to_path_buf(), head: part.head().clone(), made })
    }

    fn window(&self) -> Rect {
        self.head.format.frame.window
    }

    fn samples(&self) -> &Range<u32> {
        &self.head.samples
    }

    fn record(&self, name: &str) -> Option<&str> {
        let found = self.head.records.iter().find(|record| record.name == name);
        found.map(|record| record.text.as_str())
    }

    /// Which samples it holds of which pixels.
    fn shares(&self, film: &Film) -> Vec<Share> {
        if !self.made.shares.is_empty() {
            return self.made.shares.0.clone();
        }
        let (fewest, most) = film.fewest_and_most();
        let Rect { x, y, width, height } = self.window();
        let samples = Samples { first: self.samples().start, fewest, most };
        let counts = Counts::of(film).unwrap_or_default();
        vec![Share { window: Window { x, y, width, height }, samples, counts }]
    }

    /// How many samples per pixel the scene asks for.
    fn last_sample(&self) -> u32 {
        self.record("samples-per-pixel").and_then(|text| text.parse().ok()).unwrap_or(0)
    }

    /// The picture of a film with all of the samples. Ids of spheres and materials are not sums, and need
    /// the scene again.
    fn picture(&self, sum: &Film, made: &Made, kinds: &[Kind]) -> Result<Picture> {
        if !kinds.iter().any(|kind| needs_scene(*kind)) {
            let transparent = self.record("transparent") == Some("true");
            return Ok(picture_of_sums(sum, kinds, transparent));
        }
        let path = PathBuf::from(self.record("scene-file").unwrap_or_default());
        let scene = Scene::load(&path, &made.overrides())?;
        let backend: Backend = made.intersector.split(' ').next().unwrap_or_default().parse()?;
        if scene.identity(&backend.name_and_version()) != made.identity {
            let message = format!("`{}` has changed since its parts were rendered", path.display());
            return Err(Error::input(message).with_help(
                "leave out the layers sphere_id and material_id, which need the scene",
            ));
        }
        let accel = backend.build(scene.spheres(), &BuildOptions::default())?;
        Ok(picture(&scene, accel.as_ref(), sum, kinds))
    }

    /// Refuses what is of another picture.
    fn check_kin(&self, first: &Self) -> Result<()> {
        let (ours, theirs) = (self.path.display(), first.path.display());
        let refused = |what: &str| {
            Err(Error::input(format!(
                "`{ours}` and `{theirs}` are no parts of one picture: {what}"
            ))
            .with_help("merge parts of the same scene, with the same options"))
        };
        if self.made.identity != first.made.identity {
            let what = self.made.difference(&first.made);
            return refused(&format!("in the first, {what}"));
        }
        let kind = |piece: &Self| {
            let Format { frame, scale, layers, squares, .. } = piece.head.format.clone();
            (frame.full_size, scale, layers, squares)
        };
        if kind(self) != kind(first) {
            return refused("they keep other layers");
        }
        let noise = |piece: &Self| piece.record("noise").unwrap_or("none").to_owned();
        if noise(self) != noise(first) {
            let (first, ours) = (noise(first), noise(self));
            return refused(&format!("in the first, the noise target is {first}, not {ours}"));
        }
        Ok(())
    }

    /// Refuses what ended before the samples that another part goes on with: there would be a hole, which
    /// a film cannot tell from the samples behind it.
    fn check_followed(&self, film: &Film, pieces: &[Self]) -> Result<()> {
        let end = self.samples().start + film.fewest_and_most().0;
        let follows = |other: &&Self| {
            other.samples().start >= self.samples().end
                && !other.samples().is_empty()
                && other.window().common(&self.window()).is_some()
        };
        let Some(other) = pieces.iter().find(follows).filter(|_| end < self.samples().end) else {
            return Ok(());
        };
        let (ours, theirs) = (self.path.display(), other.path.display());
        let what = format!(
            "`{ours}` ended at sample {end} of {}, so `{theirs}` cannot follow it",
            self.samples().end
        );
        Err(Error::input(what)
            .with_help("render it again without --time and --noise, or leave it out"))
    }

    /// Refuses what has not all of its samples.
    fn check_finished(&self, film: &Film) -> Result<()> {
        let (fewest, all) = (film.fewest_and_most().0, self.samples().len());
        // One that ends at a noise target or at a time has as many as that took.
        if fewest as usize == all || self.record(ENDED).is_some() {
            return Ok(());
        }
        let path = self.path.display();
        Err(Error::input(format!("`{path}` is not finished: it has {fewest} of {all} samples"))
            .with_help(format!("finish it with photosphere resume '{path}', or add --allow-gaps")))
    }
}

/// Refuses layers that the parts do not hold.
fn check_layers(kinds: &[Kind], first: &Piece) -> Result<()> {
    let held = &first.head.format.layers;
    let lacks = |kind: &&Kind| summed_for(&[**kind]).iter().any(|layer| !held.contains(layer));
    let Some(kind) = kinds.iter().find(lacks) else { return Ok(()) };
    let (layer, path) = (kind.row().name, first.path.display());
    Err(Error::input(format!("`{path}` does not hold the layer `{layer}`"))
        .with_help(format!("render all parts with --layers {layer}")))
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
                    "`{x}` and `{y}` both hold samples {}..{end} of the pixels {}",
                    late.start,
                    corners(common)
                );
                return Err(Error::input(what).with_help("leave one of them out"));
            }
            if early.end % BLOCK != 0 {
                let what = format!(
                    "`{x}` ends within a block, at sample {}, so that `{y}` cannot follow it",
                    early.end
                );
                let help = format!(
                    "render it again up to a multiple of {BLOCK}, or extend it with photosphere \
                     resume"
                );
                return Err(Error::input(what).with_help(help));
            }
        }
    }
    Ok(())
}

/// `0,0,640,480`, as `--crop` has it.
fn corners(Rect { x, y, width, height }: Rect) -> String {
    format!("{x},{y},{},{}", x + width, y + height)
}
