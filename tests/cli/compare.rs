//! `photosphere compare` as its users meet it: figures, limits, refusals.

use std::fs;
use std::path::Path;

use photosphere::color::Rgb;
use photosphere::image_io::{ChannelValues, ImageChannel, ImageWriter, Picture};
use serde_json::Value;

use crate::desk::{Desk, Outcome};

const SIZE: (usize, usize) = (20, 10);

fn run(desk: &Desk, arguments: &str) -> Outcome {
    desk.run(&format!("compare {arguments}"))
}

fn json(desk: &Desk, arguments: &str) -> Value {
    run(desk, &format!("{arguments} --json")).succeeds().json()
}

fn write(desk: &Desk, name: &str, size: (usize, usize), direct: f32, indirect: f32) {
    let layer = |value| vec![Rgb::splat(value); size.0 * size.1];
    let picture = Picture {
        width: size.0,
        height: size.1,
        direct: layer(direct),
        indirect: layer(indirect),
        ..Picture::default()
    };
    let path = desk.path().join(name);
    ImageWriter::new(&path).expect("a writable place").write(&picture).expect("written");
}

/// `a.exr` is 0.25 + 0.25, `b.exr` 0.25 + 0.5, `c.exr` the same as `a.exr`.
fn desk() -> Desk {
    let desk = Desk::empty();
    write(&desk, "a.exr", SIZE, 0.25, 0.25);
    write(&desk, "b.exr", SIZE, 0.25, 0.5);
    write(&desk, "c.exr", SIZE, 0.25, 0.25);
    desk
}

#[track_caller]
fn close(value: &Value, expected: f64) {
    let value = value.as_f64().expect("a number");
    assert!((value - expected).abs() <= 1e-6 * expected.abs(), "{value} for {expected}");
}

/// A picture over a black one has no ratio, and light over black is infinitely far from 1.
#[test]
fn over_black_there_is_no_ratio() {
    let desk = desk();
    write(&desk, "black.exr", SIZE, 0.0, 0.0);
    let outcome = run(&desk, "a.exr black.exr --twin c.exr --max-mean 0.5");
    assert_eq!(outcome.code, Some(1), "{}", outcome.stderr);
    for told in ["none, B is black", "0.50000 +- 0.0e0"] {
        assert!(outcome.stdout.contains(told), "{told}: {}", outcome.stdout);
    }
    let all = format!("{}{}", outcome.stdout, outcome.stderr);
    assert!(!all.contains("NaN") && !all.contains("inf "), "{all}");
    assert!(outcome.stderr.contains("is infinite, since B is black"), "{}", outcome.stderr);
    let told = json(&desk, "a.exr black.exr --twin c.exr --metric mean");
    assert!(told["layers"][0]["mean_ratio"][0].is_null(), "{told}");
    let outcome = run(&desk, "black.exr black.exr --twin black.exr --max-mean 0");
    assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
    assert!(!outcome.stdout.contains("NaN"), "{}", outcome.stdout);
}

#[test]
fn every_metric_of_every_layer_is_told() {
    let told = json(&desk(), "a.exr b.exr --peak 2");
    let layers = told["layers"].as_array().expect("a list");
    let names: Vec<_> = layers.iter().map(|layer| layer["layer"].as_str().unwrap()).collect();
    assert_eq!(names, ["beauty", "direct", "indirect"]);
    close(&layers[0]["mse"], 0.0625);
    close(&layers[0]["rmse"], 0.25);
    close(&layers[0]["relmse"], (0.25f64 / 0.76).powi(2));
    close(&layers[0]["psnr"], 10.0 * (4.0f64 / 0.0625).log10());
    close(&layers[0]["mean_ratio"][1], 0.5 / 0.75);
    assert_eq!(layers[0]["mean_a_half_width_95"], Value::Null);
    assert_eq!(layers[1]["flip"], 0.0);
    assert_eq!(layers[1]["psnr"], Value::Null); // infinite
    close(&layers[2]["mean_a"][0], 0.25);
}

#[test]
fn formats_meet_each_other() {
    let desk = desk();
    write(&desk, "a.pfm", SIZE, 0.25, 0.25);
    write(&desk, "a.hdr", SIZE, 0.25, 0.25);
    write(&desk, "a.png", SIZE, 0.25, 0.25);
    for (other, allowed) in [("a.pfm", 0.0), ("a.hdr", 0.004), ("a.png", 0.005)] {
        let outcome = run(&desk, &format!("a.exr {other} --metric rmse --max-rmse {allowed}"));
        assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
        assert!(outcome.stderr.contains("only A has: direct, indirect"), "{}", outcome.stderr);
        let tells_of_png = outcome.stderr.contains("decoded from sRGB to linear");
        assert_eq!(tells_of_png, other == "a.png");
    }
}

#[test]
fn limits_decide_the_exit_code() {
    let desk = desk();
    for kept in [
        "--max-mse 0.07 --max-rmse 0.26 --max-relmse 0.25 --min-psnr 10",
        "--layer direct --max-flip 0 --max-mean 0 --min-psnr 100",
    ] {
        assert_eq!(run(&desk, &format!("a.exr b.exr {kept}")).code, Some(0), "{kept}");
    }
    for (exceeded, told) in [
        ("--max-mse 0.06", "mse of `beauty` is 0.06250, allowed is at most 0.06"),
        ("--max-rmse 0.24", "rmse of `indirect` is 0.25000"),
        ("--max-relmse 0.1", "relmse"),
        ("--max-flip 0.01", "flip"),
        ("--max-mean 0.3", "ratio of means - 1 of `beauty` is 0.33333"),
        ("--min-psnr 13", "psnr of `beauty` is 12.04120, allowed is at least 13"),
    ] {
        let outcome = run(&desk, &format!("a.exr b.exr --metric mean {exceeded}"));
        assert_eq!(outcome.code, Some(1), "{exceeded}");
        assert!(outcome.stderr.contains(told), "{exceeded}: {}", outcome.stderr);
    }
}

#[test]
fn a_twin_tells_the_interval_of_the_mean() {
    let desk = desk();
    let told = json(&desk, "a.exr b.exr --twin b.exr --metric mean");
    // Every pixel's variance is 0.25^2 / 2; there are 200 pixels.
    let expected = 1.959_964 * (0.25f64 * 0.25 / 2.0 / 200.0).sqrt();
    close(&told["layers"][0]["mean_a_half_width_95"][0], expected);
    close(&told["layers"][0]["mean_ratio_half_width_95"][0], expected / 0.75);
    assert_eq!(told["layers"][0]["mean_b_half_width_95"], Value::Null);
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let desk = desk();
    write(&desk, "small.exr", (10, 10), 0.25, 0.25);
    write(&desk, "nan.exr", SIZE, f32::NAN, 0.25);
    fs::write(desk.path().join("text.exr"), "no picture").expect("written");
    for (arguments, code, told) in [
        ("a.exr small.exr", 3, "`a.exr` has 20 x 10 pixels and `small.exr` has 10 x 10"),
        ("a.exr b.exr --twin small.exr", 3, "`small.exr` has 10 x 10"),
        ("a.exr nan.exr", 3, "`nan.exr` has 200 pixels that are infinite or not a number"),
        ("a.exr nan.exr", 3, "the first at 0,0"),
        ("a.exr text.exr", 4, "cannot read `text.exr`"),
        ("a.exr none.exr", 4, "cannot read `none.exr`"),
        ("a.exr b.tiff", 3, "`b.tiff` does not end in .png, .exr, .hdr or .pfm"),
        ("a.exr b.exr --layer alpha", 3, "the layer `alpha` is not in both pictures"),
        ("a.exr b.exr --layer alpha", 3, "layers in both: beauty, direct, indirect"),
        ("a.exr b.exr --max-mse -1", 2, "not below 0"),
        ("a.exr b.exr --peak 0", 2, "above 0"),
        ("a.exr b.exr --metric ssim", 2, "ssim"),
        ("a.exr b.exr --heatmap none/h.png", 4, "does not exist"),
        ("a.exr b.exr --heatmap a.exr", 3, "the heat map would replace `a.exr`"),
    ] {
        let outcome = run(&desk, arguments);
        assert_eq!(outcome.code, Some(code), "{arguments}: {}", outcome.stderr);
        assert!(outcome.stderr.contains(told), "{arguments}: {}", outcome.stderr);
        assert_eq!(outcome.stdout, "");
    }
}

#[test]
fn a_heat_map_is_drawn_with_its_scale_told() {
    let desk = desk();
    for (which, told) in [
        ("flip", "FLIP; its scale runs from 0 (black, left) to 1"),
        ("rmse", "to 0.25000"),
        ("relmse", "relative error"),
    ] {
        let arguments = format!("a.exr b.exr --heatmap h.png --heatmap-of {which}");
        let outcome = run(&desk, &arguments);
        assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
        assert!(outcome.stderr.contains(told), "{}", outcome.stderr);
        let map = photosphere::image_io::read_image(&desk.path().join("h.png")).expect("a picture");
        assert_eq!((map.width, map.height), (260, 146));
    }
    let outcome = run(&desk, "a.exr b.exr --heatmap-of rmse");
    assert_eq!(outcome.code, Some(2));
    assert!(!Path::new("h.png").exists());
}

#[test]
fn values_that_are_infinite_by_their_meaning_are_no_obstacle() {
    let desk = desk();
    write(&desk, "far.exr", SIZE, 0.25, f32::INFINITY);
    write(&desk, "far2.exr", SIZE, 0.25, f32::INFINITY);
    let outcome = run(&desk, "far.exr far2.exr --json");
    assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
    assert_eq!(run(&desk, "far.exr a.exr").code, Some(3));
}

/// Writes a picture with these channels beside the beauty of 0.5.
fn write_with(desk: &Desk, name: &str, channels: &[(&str, Vec<f32>)]) {
    let layer = vec![Rgb::splat(0.25); SIZE.0 * SIZE.1];
    let channel = |(name, values): &(&str, Vec<f32>)| {
        ImageChannel::new(name, ChannelValues::Float(values.clone()))
    };
    let picture = Picture {
        width: SIZE.0,
        height: SIZE.1,
        direct: layer.clone(),
        indirect: layer,
        hidden_layers: vec!["direct", "indirect"],
        channels: channels.iter().map(channel).collect(),
        ..Picture::default()
    };
    let path = desk.path().join(name);
    ImageWriter::new(&path).expect("a writable place").write(&picture).expect("written");
}

#[test]
fn layers_without_a_difference_are_left_out_and_named() {
    let desk = Desk::empty();
    let mut depth = vec![1.0; SIZE.0 * SIZE.1];
    write_with(&desk, "hit.exr", &[("depth", depth.clone()), ("id", depth.clone())]);
    depth[23] = f32::INFINITY;
    write_with(&desk, "miss.exr", &[("depth", depth.clone()), ("id", vec![2.0; depth.len()])]);
    write_with(&desk, "plain.pfm", &[]);

    let outcome = run(&desk, "hit.exr miss.exr").succeeds();
    let told = "left out: `depth`; B has 1 pixel that is infinite or not a number in it, the first at 3, 1";
    assert!(outcome.stderr.contains(told), "{}", outcome.stderr);
    assert!(!outcome.stdout.contains("depth"), "{}", outcome.stdout);
    let told = json(&desk, "hit.exr miss.exr");
    let names: Vec<_> = told["layers"].as_array().expect("a list").iter().collect();
    assert_eq!(names.iter().map(|layer| &layer["layer"]).collect::<Vec<_>>(), ["beauty", "id"]);
    assert!(told["remarks"].to_string().contains("left out: `depth`"), "{told}");
    // Who asks for the layer is told that it has no difference.
    run(&desk, "hit.exr miss.exr --layer depth").fails(3, &["infinite or not a number", "`depth`"]);

    // A layer that only one file has does not matter, whatever is in it.
    for pair in ["miss.exr plain.pfm", "plain.pfm miss.exr"] {
        let outcome = run(&desk, &format!("{pair} --max-rmse 0")).succeeds();
        assert!(outcome.stderr.contains("has: depth, id"), "{}", outcome.stderr);
    }
}

#[test]
fn an_unknown_variance_is_no_certainty() {
    let desk = Desk::empty();
    let mut variance = vec![0.04; SIZE.0 * SIZE.1];
    let channels = |values: &Vec<f32>| {
        ["variance.R", "variance.G", "variance.B"].map(|name| (name, values.clone()))
    };
    write_with(&desk, "known.exr", &channels(&variance));
    variance[7] = f32::INFINITY;
    write_with(&desk, "a.exr", &channels(&variance));
    write_with(&desk, "b.exr", &channels(&variance));
    let outcome = run(&desk, "known.exr known.exr --metric mean").succeeds();
    assert!(outcome.stdout.contains("0.50000 +- 2.8e-2"), "{}", outcome.stdout);
    let outcome = run(&desk, "a.exr b.exr --metric mean").succeeds();
    let count = outcome.stdout.matches("+- unknown").count();
    assert_eq!(count, 9, "{}", outcome.stdout);
    let told = json(&desk, "a.exr b.exr --metric mean");
    assert_eq!(told["layers"][0]["mean_ratio_half_interval_95"][0], Value::Null);
}
