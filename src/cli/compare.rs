//! `photosphere compare`: measures the error of a picture against a reference.

use std::path::Path;

use crate::color::Rgb;
use crate::error::{Error, Result};
use crate::image_io::{self, BEAUTY, ImageWriter, LayeredImage};
use crate::report::compare::{Comparison, ImagePair, VARIANCE};

use super::args::CompareArgs;
use super::exit::Exit;
use super::print;
use super::system::on_threads;

/// Runs the command.
///
/// # Errors
/// If a picture cannot be read, or the pictures cannot be compared.
pub(super) fn run(args: &CompareArgs) -> Result<Exit> {
    check_heatmap(args)?;
    let heatmap = args.heatmap.as_deref().map(ImageWriter::new).transpose()?;
    on_threads(None, || compare(args, heatmap))
}

fn compare(args: &CompareArgs, heatmap: Option<ImageWriter>) -> Result<Exit> {
    let pair = read(args)?;
    let layers = layers(&pair, &args.layers)?;
    let options = args.options();
    let comparison = Comparison::of(&pair, &options, &layers);
    if let Some(target) = heatmap {
        let (picture, words) = pair.heatmap(&layers[0], args.heatmap_of);
        target.write(&picture)?;
        print::note(words);
    }
    let exceeded = comparison.exceeded();
    if args.json {
        print::json(&comparison.json(&args.picture, &args.reference))?;
    } else {
        pair.remarks().iter().for_each(print::note);
        print::result(&comparison.to_string())?;
        exceeded.iter().for_each(print::note);
    }
    Ok(if exceeded.is_empty() { Exit::Done } else { Exit::CheckFailed })
}

/// Refuses a heat map path that is one of the compared pictures.
fn check_heatmap(args: &CompareArgs) -> Result<()> {
    let whole = |path: &Path| path.canonicalize().ok();
    let Some(map) = args.heatmap.as_deref().and_then(whole) else { return Ok(()) };
    let read = [Some(&args.picture), Some(&args.reference), args.twin.as_ref()];
    match read.into_iter().flatten().find(|path| whole(path).as_ref() == Some(&map)) {
        Some(path) => Err(Error::input(format!("the heat map would replace `{}`", path.display()))
            .with_help("give --heatmap another name")),
        None => Ok(()),
    }
}

/// Reads both pictures, and refuses pairs that cannot be compared: the beauty and requested layers
/// must be finite. Other layers that are not are left out.
fn read(args: &CompareArgs) -> Result<ImagePair> {
    let (mut a, mut b) =
        (image_io::read_image(&args.picture)?, image_io::read_image(&args.reference)?);
    forget_equal_infinities(&mut a, &mut b);
    for (path, picture, other) in [(&args.picture, &a, &b), (&args.reference, &b, &a)] {
        let is_needed = |name: &str| match args.layers.is_empty() {
            true => name == BEAUTY && other.layer(name).is_some(),
            false => args.layers.iter().any(|layer| layer == name),
        };
        check_finite(path, picture, is_needed)?;
    }
    let twin = args.twin.as_deref().map(image_io::read_image).transpose()?;
    if let Some((path, twin)) = args.twin.as_deref().zip(twin.as_ref()) {
        check_finite(path, twin, |name| name == BEAUTY)?;
    }
    let others = twin.iter().map(|twin| (twin, args.twin.as_deref()));
    for (other, path) in others.chain([(&b, Some(args.reference.as_path()))]) {
        if (other.width, other.height) != (a.width, a.height) {
            return Err(Error::input(format!(
                "`{}` has {} x {} pixels and `{}` has {} x {}",
                args.picture.display(),
                a.width,
                a.height,
                path.unwrap_or(Path::new("")).display(),
                other.width,
                other.height
            ))
            .with_help(
                "compared pictures must have the same size; render both with the same --size",
            ));
        }
    }
    Ok(ImagePair { a, b, twin })
}

/// Returns the layers to compare: the requested ones, or all that both pictures have and that have
/// a difference.
fn layers(pair: &ImagePair, asked: &[String]) -> Result<Vec<String>> {
    let common = pair.common();
    let in_both = |name: &str| pair.a.layer(name).is_some() && pair.b.layer(name).is_some();
    if let Some(missing) = asked.iter().find(|name| !in_both(name)) {
        let error = Error::input(format!("the layer `{missing}` is not in both pictures"));
        return Err(error.with_help(format!("layers in both: {}", common.join(", "))));
    }
    let comparable = pair.comparable();
    if !common.is_empty() && comparable.is_empty() && asked.is_empty() {
        let error = Error::input("no layer of both pictures can be compared");
        return Err(error.with_help(pair.remarks().join("; ")));
    }
    if common.is_empty() {
        let of = |picture: &LayeredImage| {
            picture.layers.iter().map(|layer| &*layer.name).collect::<Vec<_>>().join(", ")
        };
        let error = Error::input("the pictures have no layer in common");
        return Err(error.with_help(format!("A has {}; B has {}", of(&pair.a), of(&pair.b))));
    }
    if asked.is_empty() {
        return Ok(comparable.into_iter().map(str::to_owned).collect());
    }
    Ok(asked.to_vec())
}

/// Sets values to 0 where both pictures have the same non-finite value, such as the infinite depth
/// of a miss, so that they do not differ. Not in the variance, where infinity means unknown.
fn forget_equal_infinities(a: &mut LayeredImage, b: &mut LayeredImage) {
    for ours in a.layers.iter_mut().filter(|layer| layer.name != VARIANCE) {
        let Some(theirs) = b.layers.iter_mut().find(|layer| layer.name == ours.name) else {
            continue;
        };
        for (x, y) in ours.pixels.iter_mut().zip(&mut theirs.pixels) {
            if !x.is_finite() && x.to_array().map(f32::to_bits) == y.to_array().map(f32::to_bits) {
                (*x, *y) = (Rgb::ZERO, Rgb::ZERO);
            }
        }
    }
}

/// Refuses non-finite pixels in the layers to compare. A variance may be infinite, which means that
/// it is unknown.
pub(super) fn check_finite(
    path: &Path,
    picture: &LayeredImage,
    is_compared: impl Fn(&str) -> bool,
) -> Result<()> {
    for layer in picture.layers.iter().filter(|layer| is_compared(&layer.name)) {
        if layer.name == VARIANCE {
            continue;
        }
        if let Some((count, first)) = layer.count_non_finite() {
            let (x, y) = (first % picture.width, first / picture.width);
            return Err(Error::input(format!(
                "`{}` has {} that are infinite or not a number in layer `{}`, the first at {x},{y}",
                path.display(),
                print::count(count, "pixel"),
                layer.name,
            ))
            .with_help("their error is undefined; choose other layers with --layer"));
        }
    }
    Ok(())
}
