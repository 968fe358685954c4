//! `photosphere reproduce`: a picture again, from what it says of itself.

use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::accel::{Backend, BuildOptions};
use crate::color::Look;
use crate::error::{Error, Result};
use crate::film::{Film, Kind, Layer};
use crate::output::{self, Notes, RawChannel, Target};
use crate::provenance::{self, Made, Samples};
use crate::render::{self, RenderOptions, Session};

use super::args::ReproduceArgs;
use super::exit::Exit;
use super::progress::{Progress, State};
use super::{interrupt, on_threads, outputs, print};

/// What a picture says of itself, as far as it is needed here.
struct Said {
    made: Made,
    look: Look,
    kinds: Vec<Kind>,
    scene_file: Option<PathBuf>,
}

/// A picture again.
struct Again {
    made: Made,
    film: Film,
    channels: Vec<RawChannel>,
}

/// # Errors
/// When the picture does not say how it was made, when its scene is not what it was, or when it
/// cannot be rendered.
pub(super) fn run(args: &ReproduceArgs) -> Result<Exit> {
    let path = &args.picture;
    let said = read(path)?;
    let then = output::raw_channels(path)?;
    let again = on_threads(args.threads, || render_again(args, &said))?;
    let wrong = differing(&then, &again.channels);
    let count = then.len();
    if wrong.is_empty() {
        let what = print::count(count, "channel");
        print::result(&format!("all pixels agree to the bit, in {what}\n"))?;
        return Ok(Exit::Done);
    }
    print::result(&in_words(path, &said, &then, &again, &wrong))?;
    Ok(Exit::CheckFailed)
}

fn read(path: &Path) -> Result<Said> {
    let records = output::records(path)?;
    let made = Made::read(path, &records)?;
    let text = |name: &str| records.iter().find(|r| r.name == name).map(|r| r.text.as_str());
    let strange = |name: &str| {
        let message = format!("`{}` says `{name}` in a way that is not understood", path.display());
        Error::input(message).with_help("it may be of a newer version of photosphere")
    };
    let look = match text("look") {
        None => Look::default(),
        Some(words) => provenance::look_of_words(words).ok_or_else(|| strange("look"))?,
    };
    let kinds = match text("layers") {
        None if made_with_alpha(path)? => vec![Kind::Mean(Layer::Alpha)],
        None => Vec::new(),
        Some("") => Vec::new(),
        Some(names) => {
            let kinds: Option<Vec<Kind>> = names.split(',').map(Kind::named).collect();
            kinds.ok_or_else(|| strange("layers"))?
        }
    };
    Ok(Said { made, look, kinds, scene_file: text("scene-file").map(PathBuf::from) })
}

/// Whether a picture has an alpha channel, which the scene or the command may have asked for.
fn made_with_alpha(path: &Path) -> Result<bool> {
    Ok(output::raw_channels(path)?.iter().any(|channel| channel.name == "A"))
}

fn render_again(args: &ReproduceArgs, said: &Said) -> Result<Again> {
    let folder = folder(args, said);
    let scene = said.made.scene(&folder, said.scene_file.as_deref())?;
    let backend = backend(args, said)?;
    let interrupt = interrupt::listen();
    let threads = rayon::current_num_threads();
    let build = BuildOptions { threads, cancel: interrupt.cancel(), ..Default::default() };
    let accel = backend.build(scene.spheres(), &build)?;
    let mut format = render::format_with(&scene, &said.kinds);
    format.first_sample = said.made.samples.first;
    let film = Film::new(&format)?;
    let progress = Progress::new(args.quiet);
    let began = Instant::now();
    let show = |state: render::Progress| {
        progress.show(&State::since(began, state.samples_done, state.samples_total));
    };
    let options = RenderOptions { cancel: interrupt.cancel(), progress: &show };
    let session = Session::new(&scene, accel.as_ref(), &film, &options);
    let filled = fill(&session, &said.made);
    progress.finish();
    filled?;
    let picture = render::picture(&scene, accel.as_ref(), &film, &said.kinds);
    let made = Made::new(&scene, backend, said.made.samples);
    let notes =
        Notes { cropped_from: outputs::crop(film.frame()), look: said.look, records: Vec::new() };
    let temporary = tempfile::tempdir().map_err(|e| Error::file("write", &args.picture, e))?;
    let name = if said.is_png(&args.picture) { "again.png" } else { "again.exr" };
    let file = temporary.path().join(name);
    Target::new(&file)?.write_with(&picture, &notes)?;
    Ok(Again { made, film, channels: output::raw_channels(&file)? })
}

impl Said {
    fn is_png(&self, path: &Path) -> bool {
        path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"))
    }
}

/// Where the scene's files are.
fn folder(args: &ReproduceArgs, said: &Said) -> PathBuf {
    let then = said.scene_file.as_deref().and_then(Path::parent);
    let beside = args.picture.parent().unwrap_or(Path::new(""));
    args.folder.clone().unwrap_or_else(|| then.unwrap_or(beside).to_path_buf())
}

/// The intersector that was asked for, or that the picture was made with.
fn backend(args: &ReproduceArgs, said: &Said) -> Result<Backend> {
    if let Some(backend) = args.accel {
        return Ok(backend);
    }
    let name = said.made.intersector.split(' ').next().unwrap_or_default();
    let backend: Backend = name.parse()?;
    if Backend::AVAILABLE.contains(&backend) {
        return Ok(backend);
    }
    Err(Error::backend(format!("the picture was made with `{name}`, which this build has not"))
        .with_help("take another and see by how much it differs: --accel native"))
}

/// Renders as many samples of each pixel as the picture has. Where a noise target, a time or a signal
/// ended it, they differ from tile to tile, and the picture says how many each has.
fn fill(session: &Session<'_>, made: &Made) -> Result<()> {
    let Samples { first, fewest, most } = made.samples;
    let tiles = session.film().frame().tiles();
    let counts = match made.counts.0.as_slice() {
        [] if fewest == most => vec![most; tiles],
        counts if counts.len() == tiles => counts.to_vec(),
        _ => {
            let what = "its pixels have different numbers of samples, and it does not say which";
            return Err(
                Error::input(what).with_help("it may be of an older version of photosphere")
            );
        }
    };
    let mut steps = counts.clone();
    steps.sort_unstable();
    steps.dedup();
    for step in steps {
        session.advance(first + step, &|tile| counts[tile] >= step)?;
        session.cancel().check()?;
    }
    Ok(())
}

/// The names of the channels that differ, or that only one of both has.
fn differing(then: &[RawChannel], now: &[RawChannel]) -> Vec<String> {
    let differs = |channel: &&RawChannel| !now.contains(channel);
    let gone = then.iter().filter(differs).map(|channel| channel.name.clone());
    let is_new = |channel: &&RawChannel| !then.iter().any(|other| other.name == channel.name);
    gone.chain(now.iter().filter(is_new).map(|channel| channel.name.clone())).collect()
}

fn in_words(
    path: &Path,
    said: &Said,
    then: &[RawChannel],
    again: &Again,
    wrong: &[String],
) -> String {
    let mut words =
        format!("`{}` comes out differently, in {}\n", path.display(), wrong.join(", "));
    let differences = said.made.differences(&again.made);
    if differences.is_empty() {
        words += "nothing that is known differs in how it was made: the file was changed since, or this \
                  is a mistake of photosphere; please report it\n";
    }
    for difference in differences {
        words += &format!("  {difference}\n");
    }
    words += &match said.is_png(path) {
        true => in_steps(then, &again.channels),
        false => in_standard_errors(then, again),
    };
    words
}

fn in_steps(then: &[RawChannel], now: &[RawChannel]) -> String {
    let (mut most, mut pixels) = (0, std::collections::BTreeSet::new());
    for (then, now) in then.iter().zip(now) {
        for (pixel, (a, b)) in then.bits.iter().zip(&now.bits).enumerate() {
            if a != b {
                pixels.insert(pixel);
                // Values of 8 bits are stored as 257 times as much.
                most = most.max(a.abs_diff(*b) / 257);
            }
        }
    }
    format!("{} pixels differ, by up to {most} of 255 steps\n", pixels.len())
}

/// How far the beauty is off, measured by the standard error that both pictures have by chance.
fn in_standard_errors(then: &[RawChannel], again: &Again) -> String {
    let Some(variance) = again.film.variance() else { return String::new() };
    let channel = |from: &[RawChannel], name: &str| {
        from.iter().find(|channel| channel.name == name).map(|channel| channel.bits.clone())
    };
    let (mut worst, mut differing) = ((0.0f64, 0), 0);
    let (mut difference, mut spread) = (0.0f64, 0.0f64);
    for (axis, name) in ["R", "G", "B"].into_iter().enumerate() {
        let (Some(a), Some(b)) = (channel(then, name), channel(&again.channels, name)) else {
            return "one of the two has no beauty\n".to_owned();
        };
        for (pixel, (a, b)) in a.into_iter().zip(b).enumerate() {
            let off = f64::from(f32::from_bits(a)) - f64::from(f32::from_bits(b));
            let both = 2.0 * f64::from(variance[pixel][axis]);
            (difference, spread) = (difference + off, spread + both);
            let errors = off.abs() / both.sqrt();
            differing += usize::from(off != 0.0);
            if off != 0.0 && errors > worst.0 {
                worst = (errors, pixel);
            }
        }
    }
    let width = again.film.frame().window.width as usize;
    let (errors, pixel) = worst;
    format!(
        "{differing} values of the beauty differ; their mean is off by {:.2} standard errors, and the \
         worst, in column {}, row {}, by {errors:.2}\n",
        difference.abs() / spread.sqrt(),
        pixel % width,
        pixel / width,
    )
}
