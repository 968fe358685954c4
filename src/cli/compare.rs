//! `photosphere compare`: how far a picture is from a reference.

use std::path::Path;

use serde_json::{Value, json};

use crate::color::Rgb;
use crate::error::{Error, Result};
use crate::image_io::{self, BEAUTY, Layered, Target};
use crate::math::DVec3;
use crate::verify::metrics::{Mean, flip, heatmap, mean_error, psnr, relative_squared, squared};

use super::args::{CompareArgs, Mapped, Metric};
use super::exit::Exit;
use super::print;

/// The layer that holds the variance of the beauty's pixels.
const VARIANCE: &str = "variance";

/// # Errors
/// When a picture cannot be read, or the pictures cannot be compared.
pub(super) fn run(args: &CompareArgs) -> Result<Exit> {
    check_heatmap(args)?;
    let heatmap = args.heatmap.as_deref().map(Target::new).transpose()?;
    let pair = Pair::read(args)?;
    let compared = pair.names(&args.layers)?;
    let results: Vec<Difference> =
        compared.iter().map(|name| Difference::of(args, &pair, name)).collect();
    if let Some(target) = heatmap {
        draw(args, &pair, &compared[0], target)?;
    }
    let exceeded: Vec<Exceeded> = results.iter().flat_map(|result| result.exceeded(args)).collect();
    if args.json {
        print::json(&in_json(args, &pair, &results, &exceeded))?;
    } else {
        pair.remarks().iter().for_each(print::remark);
        print::result(&in_words(args, &pair, &results))?;
        exceeded.iter().for_each(|one| print::remark(one.in_words()));
    }
    Ok(if exceeded.is_empty() { Exit::Done } else { Exit::CheckFailed })
}

/// Refuses to draw over what is compared.
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

/// The pictures, all of one size.
struct Pair {
    a: Layered,
    b: Layered,
    twin: Option<Layered>,
}

impl Pair {
    fn read(args: &CompareArgs) -> Result<Self> {
        let (mut a, mut b) = (image_io::read(&args.picture)?, image_io::read(&args.reference)?);
        forget_equal_infinities(&mut a, &mut b);
        let is_compared =
            |name: &str| args.layers.is_empty() || args.layers.iter().any(|layer| layer == name);
        check_finite(&args.picture, &a, is_compared)?;
        check_finite(&args.reference, &b, is_compared)?;
        let twin = args.twin.as_deref().map(image_io::read).transpose()?;
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
                    "only pictures of one size can be compared; render both with one --size",
                ));
            }
        }
        Ok(Self { a, b, twin })
    }

    /// The layers to compare: those asked for, or all that both have.
    fn names(&self, asked: &[String]) -> Result<Vec<String>> {
        let in_both = |name: &str| self.a.layer(name).is_some() && self.b.layer(name).is_some();
        let names = self.a.layers.iter().map(|layer| layer.name.as_str());
        let common: Vec<&str> = names.filter(|name| *name != VARIANCE && in_both(name)).collect();
        let common_in_words = common.join(", ");
        if let Some(missing) = asked.iter().find(|name| !in_both(name)) {
            let error = Error::input(format!("not both pictures have a layer `{missing}`"));
            return Err(error.with_help(format!("both have: {common_in_words}")));
        }
        if common.is_empty() {
            let of = |picture: &Layered| {
                picture.layers.iter().map(|layer| &*layer.name).collect::<Vec<_>>().join(", ")
            };
            let error = Error::input("the pictures have no layer in common");
            return Err(error.with_help(format!("A has {}; B has {}", of(&self.a), of(&self.b))));
        }
        if asked.is_empty() {
            return Ok(common.into_iter().map(str::to_owned).collect());
        }
        Ok(asked.to_vec())
    }

    /// What the reader of the figures should know about the files.
    fn remarks(&self) -> Vec<String> {
        let mut remarks = Vec::new();
        if self.a.for_screen || self.b.for_screen {
            remarks.push(
                "a PNG is decoded from sRGB to linear light; it has 8 bits and is cut off at 1"
                    .to_owned(),
            );
        }
        for (name, picture, other) in [("A", &self.a, &self.b), ("B", &self.b, &self.a)] {
            let alone = picture
                .layers
                .iter()
                .filter(|layer| layer.name != VARIANCE && other.layer(&layer.name).is_none());
            let alone: Vec<&str> = alone.map(|layer| &*layer.name).collect();
            if !alone.is_empty() {
                remarks.push(format!("only {name} has: {}", alone.join(", ")));
            }
        }
        remarks
    }

    /// The means of a layer in A and in B, with what is known of their noise.
    fn means(&self, name: &str) -> (Mean, Mean) {
        let mean = |picture: &Layered| {
            let pixels = pixels(picture, name);
            match picture.layer(VARIANCE).filter(|_| name == BEAUTY) {
                Some(variance) => Mean::with_variance(pixels, &variance.pixels),
                None => Mean::of(pixels),
            }
        };
        let twin = self.twin.as_ref().and_then(|twin| twin.layer(name));
        let a = match twin {
            Some(twin) => Mean::with_twin(pixels(&self.a, name), &twin.pixels),
            None => mean(&self.a),
        };
        (a, mean(&self.b))
    }
}

fn pixels<'a>(picture: &'a Layered, name: &str) -> &'a [Rgb] {
    &picture.layer(name).expect("the layer was chosen because it is there").pixels
}

/// Puts 0 where both pictures have the same value that is not finite, as the depth of nothing is
/// infinite: there is no difference.
fn forget_equal_infinities(a: &mut Layered, b: &mut Layered) {
    for ours in &mut a.layers {
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

/// Refuses pixels that are not finite in the layers that are to be compared. A variance may be infinite:
/// it is then not known.
pub(super) fn check_finite(
    path: &Path,
    picture: &Layered,
    is_compared: impl Fn(&str) -> bool,
) -> Result<()> {
    for layer in picture.layers.iter().filter(|layer| is_compared(&layer.name)) {
        if layer.name == VARIANCE {
            continue;
        }
        if let Some((count, first)) = layer.non_finite() {
            let (x, y) = (first % picture.width, first / picture.width);
            return Err(Error::input(format!(
                "`{}` has {} that are infinite or not a number in its layer `{}`, the first at {x}, {y}",
                path.display(),
                print::count(count, "pixel"),
                layer.name,
            ))
            .with_help("no difference can be computed from them; choose others with --layer"));
        }
    }
    Ok(())
}

/// How one layer differs.
struct Difference {
    layer: String,
    mse: f64,
    relmse: f64,
    psnr: f64,
    /// Computed only where it is wanted: it takes the longest.
    flip: Option<f64>,
    means: (Mean, Mean),
    ratio: (DVec3, Option<DVec3>),
}

impl Difference {
    fn of(args: &CompareArgs, pair: &Pair, name: &str) -> Self {
        let (a, b) = (pixels(&pair.a, name), pixels(&pair.b, name));
        let mse = mean_error(a, b, squared);
        let flip = args.wants(Metric::Flip).then(|| {
            let map = flip::map(a, b, pair.a.width, flip::PIXELS_PER_DEGREE);
            map.iter().sum::<f64>() / map.len() as f64
        });
        let means = pair.means(name);
        Self {
            layer: name.to_owned(),
            mse,
            relmse: mean_error(a, b, relative_squared),
            psnr: psnr(mse, args.peak),
            flip,
            ratio: means.0.ratio(&means.1),
            means,
        }
    }

    fn value(&self, metric: Metric) -> f64 {
        match metric {
            Metric::Mse => self.mse,
            Metric::Rmse => self.mse.sqrt(),
            Metric::Relmse => self.relmse,
            Metric::Psnr => self.psnr,
            Metric::Flip => self.flip.unwrap_or(f64::NAN),
            Metric::Mean => (self.ratio.0 - 1.0).abs().max_element(),
        }
    }

    fn exceeded(&self, args: &CompareArgs) -> Vec<Exceeded> {
        let judge = |(metric, limit): (Metric, f64)| {
            let value = self.value(metric);
            let is_good = if metric == Metric::Psnr { value >= limit } else { value <= limit };
            (!is_good).then(|| Exceeded { layer: self.layer.clone(), metric, value, limit })
        };
        args.limits.set().into_iter().filter_map(judge).collect()
    }
}

/// A limit that was not kept.
struct Exceeded {
    layer: String,
    metric: Metric,
    value: f64,
    limit: f64,
}

impl Exceeded {
    fn in_words(&self) -> String {
        let Self { layer, metric, value, limit } = self;
        let (name, allowed) = match metric {
            Metric::Mean => ("ratio of means - 1", "at most"),
            Metric::Psnr => ("psnr", "at least"),
            other => (name(*other), "at most"),
        };
        let value = match metric {
            Metric::Mean if value.is_infinite() => "infinite, since B is black".to_owned(),
            _ => short(*value),
        };
        format!("failed: {name} of `{layer}` is {value}, allowed is {allowed} {limit}")
    }
}

/// Draws the heat map and says what its colours mean.
fn draw(args: &CompareArgs, pair: &Pair, name: &str, target: Target) -> Result<()> {
    let (a, b) = (pixels(&pair.a, name), pixels(&pair.b, name));
    let root_of = |error: fn(Rgb, Rgb) -> f64| -> Vec<f64> {
        a.iter().zip(b).map(|(&a, &b)| error(a, b).sqrt()).collect()
    };
    let largest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
    let (values, what) = match args.heatmap_of {
        Mapped::Flip => (flip::map(a, b, pair.a.width, flip::PIXELS_PER_DEGREE), "FLIP"),
        Mapped::Rmse => (root_of(squared), "root mean square error of the channels"),
        Mapped::Relmse => (root_of(relative_squared), "relative error of the channels"),
    };
    let most = if args.heatmap_of == Mapped::Flip { 1.0 } else { largest(&values) };
    target.write(&heatmap::draw(&values, pair.a.width, most))?;
    print::remark(format_args!(
        "heat map of `{name}`: {what}; its scale runs from 0 (black, left) to {} (light yellow, \
         right), the largest is {}",
        short(most),
        short(largest(&values))
    ));
    Ok(())
}

fn name(metric: Metric) -> &'static str {
    match metric {
        Metric::Mse => "mse",
        Metric::Rmse => "rmse",
        Metric::Relmse => "relmse",
        Metric::Psnr => "psnr",
        Metric::Flip => "flip",
        Metric::Mean => "mean",
    }
}

const COLUMNS: [Metric; 5] =
    [Metric::Mse, Metric::Rmse, Metric::Relmse, Metric::Psnr, Metric::Flip];

/// Five digits, with an exponent where the number is very small or large.
fn short(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        x if x.is_finite() && !(1e-3..1e5).contains(&x) => format!("{value:.4e}"),
        _ => format!("{value:.5}"),
    }
}

fn in_words(args: &CompareArgs, pair: &Pair, results: &[Difference]) -> String {
    let Layered { width, height, .. } = pair.a;
    let mut text = format!("{width} x {height} pixels; B is the reference\n");
    let columns: Vec<Metric> = COLUMNS.into_iter().filter(|&metric| args.wants(metric)).collect();
    if !columns.is_empty() {
        text += &format!("{:<12}", "layer");
        text.extend(columns.iter().map(|&metric| format!("{:>13}", name(metric))));
        for result in results {
            text += &format!("\n{:<12}", result.layer);
            text.extend(columns.iter().map(|&m| format!("{:>13}", short(result.value(m)))));
        }
        text.push('\n');
    }
    if args.wants(Metric::Mean) {
        text += &format!("{:<12}{:<7}{:<24}{:<24}A / B\n", "means", "", "A", "B");
        results.iter().for_each(|result| text += &means_in_words(result));
    }
    text
}

fn means_in_words(result: &Difference) -> String {
    let mut text = String::new();
    let (a, b) = &result.means;
    for (axis, channel) in ["red", "green", "blue"].into_iter().enumerate() {
        let with_interval = |value: DVec3, half: Option<DVec3>| match half {
            Some(half) => format!("{} +- {:.1e}", short(value[axis]), half[axis]),
            None => short(value[axis]),
        };
        text += &format!(
            "{:<12}{channel:<7}{:<24}{:<24}{}\n",
            if axis == 0 { &result.layer } else { "" },
            with_interval(a.value, a.half_interval()),
            with_interval(b.value, b.half_interval()),
            match result.ratio.0[axis].is_finite() {
                true => with_interval(result.ratio.0, result.ratio.1),
                false => "none, B is black".to_owned(),
            },
        );
    }
    text
}

fn in_json(
    args: &CompareArgs,
    pair: &Pair,
    results: &[Difference],
    exceeded: &[Exceeded],
) -> Value {
    let array = |v: Option<DVec3>| v.map(|v| v.to_array());
    let layer = |result: &Difference| {
        let mut object = json!({ "layer": result.layer });
        for metric in COLUMNS.into_iter().filter(|&metric| args.wants(metric)) {
            object[name(metric)] = json!(result.value(metric));
        }
        if args.wants(Metric::Mean) {
            let (a, b) = &result.means;
            object["mean_a"] = json!(a.value.to_array());
            object["mean_a_half_interval_95"] = json!(array(a.half_interval()));
            object["mean_b"] = json!(b.value.to_array());
            object["mean_b_half_interval_95"] = json!(array(b.half_interval()));
            object["mean_ratio"] = json!(result.ratio.0.to_array());
            object["mean_ratio_half_interval_95"] = json!(array(result.ratio.1));
        }
        object
    };
    let one = |Exceeded { layer, metric, value, limit }: &Exceeded| json!({ "layer": layer, "metric": name(*metric), "value": value, "limit": limit });
    json!({
        "picture": args.picture.display().to_string(),
        "reference": args.reference.display().to_string(),
        "width": pair.a.width,
        "height": pair.a.height,
        "peak": args.peak,
        "layers": results.iter().map(layer).collect::<Vec<_>>(),
        "exceeded": exceeded.iter().map(one).collect::<Vec<_>>(),
        "remarks": pair.remarks(),
    })
}
