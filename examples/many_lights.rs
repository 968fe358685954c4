//! The ground under a cloud of small spheres of which every tenth glows, and what the choice among
//! its emitters is worth.
//!
//! `cargo run --release --example many_lights -- FOLDER [SPHERES]` writes `many-lights.toml` with
//! its tables into the folder, renders it with each way of choosing, and prints the errors at equal
//! samples and at equal time. `docs/lights.md` quotes such a run.
#![allow(clippy::print_stdout, reason = "an example's result")]

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use photosphere::accel::{Backend, BuildOptions};
use photosphere::image_io::Picture;
use photosphere::job::render_with_accel;
use photosphere::sampling::Sampler;
use photosphere::scene::{Override, PreparedScene, read_file};

const SCENE: &str = r#"format = 1
[image]
width = 96
height = 72
[camera]
position = [0.0, 0.9, 0.0]
look_at = [0.0, 0.0, -0.7]
vertical_fov_degrees = 50.0
[materials.diffuse]
type = "diffuse"
albedo = [0.7, 0.7, 0.7]
[materials.warm]
type = "diffuse"
albedo = [0.0, 0.0, 0.0]
emission = [9.0, 5.0, 2.0]
[materials.cold]
type = "diffuse"
albedo = [0.0, 0.0, 0.0]
emission = [2.0, 5.0, 9.0]
[[spheres]]
name = "ground"
center = [0.0, -1000.0, 0.0]
radius = 1000.0
material = "diffuse"
[render]
max_depth = 4
samples_per_pixel = 16
"#;

/// The table of a material: a file of that name, one row of four numbers for each sphere.
const MATERIALS: [&str; 3] = ["diffuse", "warm", "cold"];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = PathBuf::from(arguments.next().ok_or("name a folder")?);
    let count: u32 = arguments.next().map_or(Ok(20_000), |text| text.parse())?;
    let path = write_scene(&folder, count)?;
    let (reference, _) = picture(&path, "hierarchy", 1024, 1)?;
    println!("{count} spheres, {} lamps", count / 10);
    println!("choice      samples  seconds  MSE        MSE x seconds");
    for choice in ["uniform", "power", "hierarchy"] {
        let (picture, seconds) = picture(&path, choice, 16, 2)?;
        let mse = mse(&picture, &reference);
        println!("{choice:<10}  {:7}  {seconds:7.2}  {mse:.3e}  {:.3e}", 16, mse * seconds);
    }
    Ok(())
}

/// Spheres scattered over a slab above the camera, sized so that they hide about a quarter of what
/// is above.
fn write_scene(folder: &Path, count: u32) -> std::io::Result<PathBuf> {
    let radius = 25.0 / f64::from(count).sqrt();
    let mut rows = [const { Vec::new() }; MATERIALS.len()];
    for i in 0..count {
        let sampler = Sampler::independent(0, u64::from(i), 0);
        let [x, y, z] = [0, 1, 2].map(|dimension| sampler.get(dimension));
        let place = [80.0 * x - 40.0, 1.0 + 0.5 * y, 80.0 * z - 40.0];
        let material = [1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0];
        let rows = &mut rows[material[i as usize % material.len()]];
        let numbers = place.into_iter().chain([radius]);
        rows.extend(numbers.flat_map(|number| (number as f32).to_le_bytes()));
    }
    fs::create_dir_all(folder)?;
    let mut text = SCENE.to_owned();
    for (name, rows) in MATERIALS.iter().zip(rows) {
        fs::write(folder.join(format!("{name}.f32")), rows)?;
        text += &format!(
            "[[sphere_tables]]\nfile = \"{name}.f32\"\ncolumns = [\"x\", \"y\", \"z\", \"radius\"]\n\
             material = \"{name}\"\n"
        );
    }
    let path = folder.join("many-lights.toml");
    fs::write(&path, text)?;
    Ok(path)
}

/// The picture and the seconds that its rendering took.
fn picture(
    path: &Path,
    choice: &str,
    samples: u32,
    seed: u32,
) -> photosphere::Result<(Picture, f64)> {
    let set = |key: &str, value: String| Override::new(format!("render.{key}"), value);
    let overrides = [
        set("light_choice", choice.into()),
        set("samples_per_pixel", samples.to_string()),
        set("seed", seed.to_string()),
    ];
    let start = Instant::now();
    let (scene, settings) = read_file(path, &overrides)?.build()?;
    let prepared = PreparedScene::new(&scene, settings)?;
    let loaded = start.elapsed().as_secs_f64();
    let threads = rayon::current_num_threads();
    let accel = Backend::default()
        .build(scene.spheres(), &BuildOptions { threads, ..Default::default() })?;
    let start = Instant::now();
    let picture = render_with_accel(&prepared, &*accel, &[], &Default::default())?.picture;
    println!("({choice}: the scene took {loaded:.2} s to load)");
    Ok((picture, start.elapsed().as_secs_f64()))
}

fn mse(picture: &Picture, reference: &Picture) -> f64 {
    let squared = |i| (picture.beauty(i) - reference.beauty(i)).as_dvec3().length_squared() / 3.0;
    (0..picture.len()).map(squared).sum::<f64>() / picture.len() as f64
}
