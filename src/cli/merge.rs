//! `photosphere merge`: parts of a picture become one.

use std::iter::Sum;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use crate::accel::{Backend, BuildOptions};
use crate::error::{Error, Result};
use crate::film::{BLOCK, Film, Format, Frame, Kind, Picture, Rect, summed_for};
use crate::output::{PartFile, PartHead, Record, WholeFile, write_part};
use crate::provenance::{Counts, INTERSECTOR_CHOICE, Made, Run, Samples};
use crate::render::{error_so_far, needs_scene, picture, picture_of_sums};
use crate::scene::Scene;
use crate::scene::description::Window;

use super::args::MergeArgs;
use super::exit::Exit;
use super::goal::CONFIDENCE;
use super::outputs::{self, Outputs, kinds_of};
use super::render::ENDED;
use super::{interrupt, print, system};

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
    let mut outputs = Outputs::new(&args.output)?;
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
    let whole = Whole::of(&pieces);
    if !args.allow_gaps || part.is_some() {
        whole.check_gaps(&pieces, outputs.has_pictures())?;
    }

    let mut sum = Film::without_memory(&whole.format);
    for piece in &pieces {
        let film = PartFile::open(&piece.path)?.film()?;
        if !args.allow_gaps {
            piece.check_finished(&film)?;
        }
        sum.add_film(&film)?;
    }
    let made = whole.made(first, &sum);
    let run = whole.run(&pieces, &sum);
    if let Some(part) = part {
        let mut records = whole.records(&pieces, &made, &run);
        records.push(outputs.record_of_layers());
        write_part(&part, &sum, &whole.samples, &records)?;
    }
    if outputs.has_pictures() {
        let picture = first.picture(&sum, &made, outputs.kinds())?;
        outputs.write(&picture, sum.frame(), &made, &run)?;
    }
    if !args.quiet {
        let parts = print::count(pieces.len(), "part");
        let (files, samples) = (outputs::in_words(&args.output.files), made.samples);
        print::remark(format_args!("wrote {files}, samples {samples} of {parts}"));
    }
    Ok(Exit::Done)
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
        Ok(())
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

/// What the parts make together.
struct Whole {
    format: Format,
    samples: Range<u32>,
    last_sample: u32,
}

impl Whole {
    /// The least rectangle and range that hold all the parts.
    fn of(pieces: &[Piece]) -> Self {
        let around = pieces.iter().map(Piece::window).reduce(|a, b| {
            let (x, y) = (a.x.min(b.x), a.y.min(b.y));
            let width = (a.x + a.width).max(b.x + b.width) - x;
            let height = (a.y + a.height).max(b.y + b.height) - y;
            Rect { x, y, width, height }
        });
        let format = &pieces[0].head.format;
        let window = around.unwrap_or(format.frame.window);
        let start = pieces.iter().map(|piece| piece.samples().start).min().unwrap_or(0);
        let end = pieces.iter().map(|piece| piece.samples().end).max().unwrap_or(0);
        let frame = Frame { window, ..format.frame };
        Self {
            format: Format { frame, first_sample: start, ..format.clone() },
            samples: start..end,
            last_sample: pieces.iter().map(Piece::last_sample).max().unwrap_or(end),
        }
    }

    /// Refuses pixels or samples that no part holds. Parts of one window make a picture of that window,
    /// parts of several make one of the whole; and a picture has all samples that the scene asks for.
    fn check_gaps(&self, pieces: &[Piece], is_picture: bool) -> Result<()> {
        let one_window = pieces.iter().all(|piece| piece.window() == pieces[0].window());
        let Frame { full_size: [width, height], window } = self.format.frame;
        let window = match is_picture && !one_window {
            true => Rect { x: 0, y: 0, width, height },
            false => window,
        };
        let samples = match is_picture {
            true => 0..self.last_sample.max(self.samples.end),
            false => self.samples.clone(),
        };
        let Some((pixels, missing)) = first_gap(pieces, window, &samples) else { return Ok(()) };
        let what = format!(
            "samples {}..{} of the pixels {} are missing",
            missing.start,
            missing.end,
            corners(pixels)
        );
        let help = match is_picture {
            true => "name the parts that hold them, or add --allow-gaps",
            false => "name the parts that hold them",
        };
        Err(Error::input(what).with_help(help))
    }

    fn made(&self, first: &Piece, sum: &Film) -> Made {
        let (fewest, most) = sum.fewest_and_most();
        let Frame { full_size, window } = self.format.frame;
        let Rect { x, y, width, height } = window;
        let is_whole = Frame::whole(full_size[0], full_size[1]).window == window;
        Made {
            samples: Samples { first: self.samples.start, fewest, most },
            counts: Counts::of(sum),
            crop: (!is_whole).then_some(Window { x, y, width, height }),
            ..first.made.clone()
        }
    }

    /// The parts' work.
    fn run(&self, pieces: &[Piece], sum: &Film) -> Run {
        Run {
            command: system::command_line(),
            scene_file: pieces[0].record("scene-file").unwrap_or_default().to_owned(),
            rays: total(pieces, "rays"),
            seconds: total(pieces, "seconds"),
            threads: 1,
            error: error_so_far(sum, CONFIDENCE),
            noise: pieces[0].record("noise").map(str::to_owned),
            intersector: pieces[0].record(INTERSECTOR_CHOICE).unwrap_or_default().to_owned(),
        }
    }

    fn records(&self, pieces: &[Piece], made: &Made, run: &Run) -> Vec<Record> {
        let mut records = made.records();
        records.extend(run.records());
        for name in ["media-overflows", "cut-off"] {
            records.push(Record::new(name, total::<u64>(pieces, name).to_string()));
        }
        records.push(Record::new("samples-per-pixel", self.last_sample.to_string()));
        let transparent = pieces[0].record("transparent").unwrap_or_default();
        records.push(Record::new("transparent", transparent));
        records
    }
}

/// A figure that the parts tell, added up.
fn total<N: FromStr + Sum<N>>(pieces: &[Piece], name: &str) -> N {
    pieces.iter().filter_map(|piece| piece.record(name)?.parse().ok()).sum()
}

/// The first pixels and samples of a box that no piece holds.
///
/// The sides of the pieces cut the box into cells, each of which a piece holds whole or not at all.
fn first_gap(pieces: &[Piece], window: Rect, samples: &Range<u32>) -> Option<(Rect, Range<u32>)> {
    let cuts = |from: u32, to: u32, of: &dyn Fn(&Piece) -> [u32; 2]| {
        let mut cuts: Vec<u32> = pieces.iter().flat_map(of).collect();
        cuts.extend([from, to]);
        cuts.retain(|cut| (from..=to).contains(cut));
        cuts.sort_unstable();
        cuts.dedup();
        cuts
    };
    let columns = cuts(window.x, window.x + window.width, &|piece| {
        let Rect { x, width, .. } = piece.window();
        [x, x + width]
    });
    let times =
        cuts(samples.start, samples.end, &|piece| [piece.samples().start, piece.samples().end]);
    let rows = cuts(window.y, window.y + window.height, &|piece| {
        let Rect { y, height, .. } = piece.window();
        [y, y + height]
    });
    for row in rows.windows(2) {
        for column in columns.windows(2) {
            let (x, y) = (column[0], row[0]);
            let pixels = Rect { x, y, width: column[1] - x, height: row[1] - y };
            // Only those that have these pixels can have samples of them.
            let here: Vec<&Range<u32>> = pieces
                .iter()
                .filter(|piece| piece.window().common(&pixels).is_some())
                .map(Piece::samples)
                .collect();
            let is_held = |time: &[u32]| here.iter().any(|range| range.contains(&time[0]));
            if let Some(time) = times.windows(2).find(|time| !is_held(time)) {
                return Some((pixels, time[0]..time[1]));
            }
        }
    }
    None
}
