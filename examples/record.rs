//! The figures that `benches/record/` keeps of the intersectors: native against Embree, ray by ray and
//! picture by picture, in interleaved rounds of one run.
//!
//!     cargo run --release --example record > benches/record/DATE-intersectors.txt
//!     cargo run --release --example record -- --largest 1e5 --rounds 3
//!
//! The first, on a quiet machine with 4 GB of memory, takes about a quarter of an hour. Beside each ratio
//! stands, in brackets, what we ask of it: a change that falls behind is no improvement.

#![allow(clippy::print_stdout, reason = "a program that prints a table")]

use std::fs;
use std::path::{Path, PathBuf};

use photosphere::accel::{Accel, Backend, BuildOptions, Choice, embree_info};
use photosphere::generate::{Arrangement, Recipe, scene_text, write_rows};
use photosphere::geometry::{PathRay, Sphere, SphereSet};
use photosphere::job::{COMMIT, VERSION};
use photosphere::math::{DVec3, Hit, NO_SPHERE, Ray};
use photosphere::scene::{Override, Shot, read_file};
use photosphere::task::Cancel;
use photosphere::verify::bench::{
    CAMERA, Field, Figure, Question, RayKind, Rounds, SECOND_BOUNCE, Setting, StandardScene, bench,
    renders, sweep,
};
use photosphere::verify::rays;

type Outcome<T> = Result<T, Box<dyn std::error::Error + Send + Sync>>;

const GAS: Arrangement = Arrangement::Gas;
const PACKED: Arrangement = Arrangement::Packed;

/// Scenes, and the ratios asked for: closest hit and occlusion.
const TRACED: [(Arrangement, u64, [f64; 2]); 5] = [
    (GAS, 100_000, [1.8, 2.3]),
    (GAS, 1_000_000, [2.4, 4.0]),
    (GAS, 10_000_000, [3.6, 4.4]),
    (PACKED, 1_000_000, [1.75, 2.6]),
    (PACKED, 10_000_000, [1.9, 3.5]),
];

/// Matt spheres under a sky that is equally bright everywhere, and the ratio asked for.
const RENDERED: [(Arrangement, u64, f64); 3] =
    [(GAS, 1_000_000, 2.6), (GAS, 10_000_000, 3.3), (PACKED, 1_000_000, 1.7)];

/// Three spheres and a lamp.
const TINY: &str = "scenes/paper/fig2.toml";
const TINY_RATIO: f64 = 3.5;

/// The pixels of the renders.
const SIZE: [u32; 2] = [320, 240];

const PAIR: [Backend; 2] = [Backend::Native, Backend::Embree];

/// What the command line asks for.
struct Wanted {
    largest: f64,
    rounds: usize,
}

fn main() -> Outcome<()> {
    let mut wanted = Wanted { largest: 1e7, rounds: 9 };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let value: f64 = words.next().ok_or("an option lacks its number")?.parse()?;
        match word.as_str() {
            "--largest" => wanted.largest = value,
            "--rounds" => wanted.rounds = value.max(1.0) as usize,
            _ => return Err(format!("`{word}` is neither --largest nor --rounds").into()),
        }
    }
    let embree = embree_info().ok_or("this build has no Embree to compare with")??;
    println!("photosphere {VERSION}, commit {COMMIT}; {}", processor());
    println!(
        "Embree {}, {}, tasks by {}; native with {}",
        embree.runtime_version,
        embree.instruction_set,
        embree.tasking,
        photosphere::accel::Instance::best().name()
    );
    println!("command: cargo run --release --example record");
    println!("medians of {} interleaved rounds, +- the middle half of them;", wanted.rounds);
    println!("ratio: how much faster than Embree; in brackets what is asked for");
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let all = rayon::ThreadPoolBuilder::new().build()?;
    one.install(|| trace(&wanted))?;
    one.install(|| giants(&wanted))?;
    all.install(|| build(&wanted))?;
    all.install(|| scale(&wanted))?;
    one.install(|| render(&wanted))
}

fn processor() -> String {
    let info = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = info.lines().find_map(|line| line.strip_prefix("model name"));
    let cores = std::thread::available_parallelism().map_or(0, usize::from);
    let load = fs::read_to_string("/proc/loadavg").unwrap_or_default();
    let load = load.split(' ').next().unwrap_or("?").to_owned();
    format!(
        "{cores} cores,{}, load {load}",
        name.unwrap_or(": unknown").trim_start_matches(['\t', ':'])
    )
}

fn name(arrangement: Arrangement, spheres: u64) -> String {
    format!("{} {:e}", arrangement.name(), spheres as f64)
}

fn options() -> BuildOptions {
    BuildOptions { threads: rayon::current_num_threads(), ..BuildOptions::default() }
}

fn millions(figure: Figure) -> String {
    format!("{:8.3} +-{:2.0} %", 1e-6 * figure.median, 100.0 * figure.spread())
}

/// Rays of the second bounce on one thread, and what their exactness costs.
fn trace(wanted: &Wanted) -> Outcome<()> {
    println!(
        "\nOne thread, millions of rays per second: rays of the second bounce, closest hit and"
    );
    println!("occlusion; rays of the camera, sixteen to a pixel, closest hit");
    println!("{:<13}{:<10}{:>15}{:>17}{:>17}", "", "", "native", "embree", "ratio");
    let mut costs = String::new();
    for (arrangement, spheres, asked) in TRACED {
        if spheres as f64 > wanted.largest {
            continue;
        }
        let scene = StandardScene::new(arrangement, spheres)?;
        let field = Field::build(&scene.spheres, &PAIR, &options(), 1)?;
        let camera = scene.camera.iter().map(|ray| scene.spheres.ask(ray)).collect();
        let (accel, bounced) = second_bounce(&field, scene.camera)?;
        let ask = |ray: &PathRay| scene.spheres.ask(ray);
        let kinds = [
            RayKind { name: SECOND_BOUNCE, rays: bounced.iter().map(ask).collect() },
            RayKind {
                name: "free",
                rays: bounced.iter().map(|ray| ask(&freed(&scene.spheres, ray))).collect(),
            },
            RayKind { name: CAMERA, rays: camera },
        ];
        let rounds = Rounds { count: wanted.rounds, batch: 512 };
        let [native, embree] = &bench(&field, &kinds, rounds, &Cancel::default())?[..] else {
            return Err("two intersectors were asked".into());
        };
        let name = name(arrangement, spheres);
        let [Some(ours), free, ours_of_camera] = native.rates[..] else {
            return Err("no ray bounces".into());
        };
        let Some(theirs) = embree.rates[0] else { return Err("no ray bounces".into()) };
        for (question, asked) in Question::ALL.into_iter().zip(asked) {
            let (ours, theirs) = (ours.of(question), theirs.of(question));
            let ratio = ours.median / theirs.median;
            println!(
                "{name:<13}{:<10}{}  {}   {ratio:5.2} ({asked})",
                format!("{question:?}").to_lowercase(),
                millions(ours),
                millions(theirs),
            );
        }
        if let (Some(ours), Some(theirs)) = (ours_of_camera, embree.rates[2]) {
            let ratio = ours.closest.median / theirs.closest.median;
            let [ours, theirs] = [ours, theirs].map(|rates| millions(rates.closest));
            println!("{name:<13}{:<10}{ours}  {theirs}   {ratio:5.2}", "camera");
        }
        if theirs.other_ids > 0 {
            println!("{name:<13}{} of 4096 ids differ, as f32 allows", theirs.other_ids);
        }
        let ratio = |question| Some(ours.of(question).median / free?.of(question).median);
        let [closest, occluded] = Question::ALL.map(|q| ratio(q).unwrap_or(f64::NAN));
        let nanoseconds = seconds_of_answers(&scene.spheres, accel, &bounced) * 1e9;
        let per_ray = 1e9 / ours.closest.median;
        costs += &format!(
            "{name:<13}{closest:10.2}{occluded:10.2}{nanoseconds:14.0} ns of {per_ray:.0}\n"
        );
    }
    println!(
        "\nWhat exactness costs, native: the rate of rays that leave a sphere by its id against that of"
    );
    println!(
        "the same rays started a thousandth of its radius further on, and the exact hit of a ray"
    );
    println!("{:<13}{:>10}{:>10}{:>14}", "", "closest", "occluded", "exact hit");
    print!("{costs}");
    Ok(())
}

/// What one giant beside the tree costs every ray.
fn giants(wanted: &Wanted) -> Outcome<()> {
    println!(
        "\nThe rate of rays of the second bounce where a giant lies below, against that without it"
    );
    println!("{:<13}{:>10}{:>10}", "", "closest", "occluded");
    for arrangement in [GAS, PACKED] {
        let spheres = wanted.largest.min(1e6) as u64;
        let giant = Sphere { center: DVec3::NEG_Y * (1e7 + 0.55), radius: 1e7 };
        let mut fields = Vec::new();
        for giants in [vec![giant], Vec::new()] {
            let count = giants.len();
            let scene = StandardScene::beside(giants, arrangement, spheres)?;
            assert_eq!(scene.spheres.giants().len(), count, "it is one");
            let field = Field::build(&scene.spheres, &PAIR[..1], &options(), 1)?;
            let (_, bounced) = second_bounce(&field, scene.camera)?;
            let rays = bounced.iter().map(|ray| scene.spheres.ask(ray)).collect();
            fields.push((field, [RayKind { name: SECOND_BOUNCE, rays }]));
        }
        let mut ratios = [Vec::new(), Vec::new()];
        for _ in 0..wanted.rounds {
            let mut rates = Vec::new();
            for (field, kinds) in &fields {
                let measured = bench(field, kinds, ROUND, &Cancel::default())?;
                rates.push(measured[0].rates[0].ok_or("no ray bounces")?);
            }
            for (ratios, question) in ratios.iter_mut().zip(Question::ALL) {
                ratios.push(rates[0].of(question).median / rates[1].of(question).median);
            }
        }
        let [closest, occluded] =
            ratios.map(|ratios| Figure::of(ratios).map_or(f64::NAN, |figure| figure.median));
        println!("{:<13}{closest:10.2}{occluded:10.2}", name(arrangement, spheres));
    }
    Ok(())
}

/// Rays of the second bounce, and the intersector that found them.
fn second_bounce(field: &Field, camera: Vec<PathRay>) -> Outcome<(&dyn Accel, Vec<PathRay>)> {
    let (_, accel) = field.contenders().next().ok_or("there is an intersector")?;
    let first = rays::bounces(field.spheres(), accel, &camera, 0);
    Ok((accel, rays::bounces(field.spheres(), accel, &first, 1)))
}

/// The same ray from a little further on, where it has no sphere to overlook.
fn freed(spheres: &SphereSet, ray: &PathRay) -> PathRay {
    let step = if ray.leaves == NO_SPHERE { 0.0 } else { 1e-3 * spheres.sphere(ray.leaves).radius };
    PathRay::free(ray.at(step), ray.direction)
}

/// Seconds that it takes to solve the hit of a ray exactly: the median of some passes.
fn seconds_of_answers(spheres: &SphereSet, accel: &dyn Accel, bounced: &[PathRay]) -> f64 {
    let asked: Vec<Ray> = bounced.iter().map(|ray| spheres.ask(ray)).collect();
    let mut hits = vec![Hit::MISS; asked.len()];
    accel.closest(&asked, &mut hits);
    let pass = |_| {
        let start = std::time::Instant::now();
        for (ray, hit) in bounced.iter().zip(&hits) {
            std::hint::black_box(spheres.answer(ray, *hit));
        }
        start.elapsed().as_secs_f64() / bounced.len() as f64
    };
    Figure::of((0..9).map(pass).collect()).map_or(f64::NAN, |figure| figure.median)
}

/// Building the largest scenes on all cores.
fn build(wanted: &Wanted) -> Outcome<()> {
    println!("\nBuild on {} threads, seconds", rayon::current_num_threads());
    println!("{:<13}{:>10}{:>16}{:>10}{:>18}", "", "native", "embree", "ratio", "bytes per sphere");
    let spheres = wanted.largest as u64;
    for arrangement in [GAS, PACKED] {
        let scene = StandardScene::new(arrangement, spheres)?;
        let field = Field::build(&scene.spheres, &PAIR, &options(), wanted.rounds.min(5))?;
        let [native, embree] = &bench(&field, &[], ROUND, &Cancel::default())?[..] else {
            return Err("two intersectors were built".into());
        };
        let seconds =
            |figure: Figure| format!("{:8.3} +-{:2.0} %", figure.median, 100.0 * figure.spread());
        let (ours, theirs) = (native.build_s, embree.build_s);
        println!(
            "{:<13}{}  {}  {:6.2} (1){:10.1} {:.1}",
            name(arrangement, spheres),
            seconds(ours),
            seconds(theirs),
            theirs.median / ours.median,
            native.bytes_per_sphere,
            embree.bytes_per_sphere
        );
    }
    Ok(())
}

const ROUND: Rounds = Rounds { count: 1, batch: 512 };

/// What further threads bring, beside what they bring to arithmetic alone.
fn scale(wanted: &Wanted) -> Outcome<()> {
    let threads = rayon::current_num_threads();
    println!("\n{threads} threads against one, native, rays of the second bounce");
    println!(
        "{:<13}{:>10}{:>10}{:>12}{:>26}",
        "", "closest", "occluded", "arithmetic", "of arithmetic"
    );
    for (arrangement, spheres) in [(GAS, 1e6_f64), (PACKED, 1e6)] {
        let scene = StandardScene::new(arrangement, spheres.min(wanted.largest) as u64)?;
        let field = Field::build(&scene.spheres, &PAIR[..1], &options(), 1)?;
        let (_, bounced) = second_bounce(&field, scene.camera)?;
        let asked: Vec<Ray> = bounced.iter().map(|ray| scene.spheres.ask(ray)).collect();
        let settings = [1, threads].map(|threads| Setting { threads, batch: 512 });
        let swept = sweep(&field, &asked, &settings, wanted.rounds, &Cancel::default())?;
        let [one, all] = &swept[..] else { return Err("no ray bounces".into()) };
        let gain = |question: usize| all.rates[0][question].median / one.rates[0][question].median;
        let arithmetic = all.arithmetic.median / one.arithmetic.median;
        println!(
            "{:<13}{:10.2}{:10.2}{arithmetic:12.2}{:14.2} and {:.2} (0.95)",
            name(arrangement, scene.spheres.len() as u64),
            gain(0),
            gain(1),
            gain(0) / arithmetic,
            gain(1) / arithmetic,
        );
    }
    Ok(())
}

/// Whole renders on one thread.
fn render(wanted: &Wanted) -> Outcome<()> {
    let [width, height] = SIZE;
    println!("\nRenders on one thread, path integrator, {width} x {height} pixels");
    println!(
        "{:<18}{:>8}{:>16}{:>16}{:>19}{:>14}{:>16}{:>14}",
        "", "samples", "ours (s)", "embree (s)", "ratio", "ours", "outside (15 %)", "other pixels"
    );
    let tiny = Path::new(env!("CARGO_MANIFEST_DIR")).join(TINY);
    one_render("three and a lamp", &tiny, Some(TINY_RATIO), 64, wanted)?;
    let folder = tempfile::tempdir()?;
    for (arrangement, spheres, asked) in RENDERED {
        if spheres as f64 <= wanted.largest {
            let scene = generated(folder.path(), arrangement, spheres)?;
            one_render(&name(arrangement, spheres), &scene, Some(asked), 16, wanted)?;
        }
    }
    // The same spheres in the light that `photosphere generate` gives them.
    if wanted.largest >= 1e6 {
        let scene = folder.path().join("gas-1000000.toml");
        let recipe = Recipe::new(GAS, 1_000_000, 0, false)?;
        fs::write(&scene, scene_text(&recipe, &scene.with_extension("f32")))?;
        one_render("... sun and sky", &scene, None, 16, wanted)?;
    }
    Ok(())
}

fn one_render(
    name: &str,
    path: &Path,
    asked: Option<f64>,
    samples: u32,
    wanted: &Wanted,
) -> Outcome<()> {
    let [width, height] = SIZE;
    let keys =
        [("image.width", width), ("image.height", height), ("render.samples_per_pixel", samples)];
    let overrides = keys.map(|(key, value)| Override {
        option: format!("{key}={value}"),
        key: key.to_owned(),
        value: value.to_string(),
    });
    let (scene, settings) = read_file(path, &overrides)?.build()?;
    let shot = Shot::new(&scene, settings)?;
    let backends = [Choice::Auto.choose(scene.spheres()).backend, Backend::Embree];
    let field = Field::build(scene.spheres(), &backends, &options(), 1)?;
    let [ours, embree] = &renders(&shot, &field, wanted.rounds, &Cancel::default())?[..] else {
        return Err("two intersectors rendered".into());
    };
    let seconds =
        |figure: Figure| format!("{:7.3} +-{:2.0} %", figure.median, 100.0 * figure.spread());
    println!(
        "{name:<18}{samples:8}{:>16}{:>16}{:10.2} {:<6}{:>16}{:14.1} %{:>14}",
        seconds(ours.seconds),
        seconds(embree.seconds),
        embree.seconds.median / ours.seconds.median,
        asked.map_or(String::new(), |asked| format!("({asked:.2})")),
        ours.backend.name(),
        100.0 * (1.0 - ours.inside.median),
        embree.other_pixels
    );
    Ok(())
}

/// A scene file with its table.
fn generated(folder: &Path, arrangement: Arrangement, spheres: u64) -> Outcome<PathBuf> {
    let recipe = Recipe::new(arrangement, spheres, 0, false)?;
    let table = folder.join(format!("{}-{spheres}.f32", arrangement.name()));
    let mut file = std::io::BufWriter::new(fs::File::create(&table)?);
    write_rows(&recipe, &mut file, &|_| {})?;
    std::io::Write::flush(&mut file)?;
    let (position, look_at, fov) = recipe.view();
    let text = format!(
        r#"format = 1
[camera]
position = {position:?}
look_at = {look_at:?}
vertical_fov_degrees = {fov:?}
[background]
radiance = [1.0, 1.0, 1.0]
[materials.grain]
type = "diffuse"
albedo = [0.7, 0.7, 0.7]
[[sphere_tables]]
file = "{}"
columns = ["x", "y", "z", "radius"]
material = "grain"
[render]
max_depth = 6
"#,
        table.display()
    );
    let path = table.with_extension("toml");
    fs::write(&path, text)?;
    Ok(path)
}
