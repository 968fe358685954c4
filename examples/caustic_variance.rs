//! Where the variance of a picture with polished balls comes from, by chance and with connections.
//!
//!     cargo run --release --example caustic_variance -- scenes/caustics/two-balls.toml [SAMPLES]
//!
//! Prints the variance of a sample (of green), averaged over the pixels of a small picture, by the
//! way that the light took: seen directly, also in a mirror or through glass; over one ball from a
//! surface that scatters, without or with a reflection inside; over several balls; and the rest.

use std::collections::HashMap;

use photosphere::accel::BuildOptions;
use photosphere::error::Result;
use photosphere::geometry::Side;
use photosphere::integrator::{PathEvent, PathTrace, RenderContext, SampleAddress, create};
use photosphere::light::specular::SpecularPath;
use photosphere::material::Lobe;
use photosphere::scene::settings::Caustics;
use photosphere::scene::{Override, PreparedScene, Scene, read_file};
use photosphere::task::CancelToken;

const CLASSES: [&str; 5] =
    ["seen directly", "over one ball", "reflected inside a ball", "over several balls", "other"];

/// What a path has met since it was last scattered in more than one direction.
#[derive(Default)]
struct Chain {
    has_scattered: bool,
    balls: Vec<u32>,
    inner_reflections: u32,
}

impl Chain {
    fn class(&self) -> usize {
        let is_one = self.balls.windows(2).all(|pair| pair[0] == pair[1]);
        match (self.has_scattered, self.balls.is_empty(), is_one, self.inner_reflections) {
            (false, ..) => 0,
            (_, true, ..) => 4,
            (_, _, false, _) => 3,
            (_, _, true, 0) => 1,
            (_, _, true, _) => 2,
        }
    }

    fn scatter(&mut self, ball: u32, side: Side, lobe: Lobe, is_reflected: bool) {
        if lobe == Lobe::Delta {
            self.balls.push(ball);
            self.inner_reflections += u32::from(is_reflected && side == Side::Inside);
        } else {
            *self = Self { has_scattered: true, ..Self::default() };
        }
    }
}

/// The green light of a sample by class.
fn by_class(trace: &PathTrace) -> [f64; 5] {
    let mut light = [0.0; 5];
    let (mut chain, mut connected) = (Chain::default(), HashMap::new());
    let mut hit = None;
    for event in &trace.events {
        match event {
            PathEvent::Hit { hit: found, .. } => {
                hit = Some(*found);
                connected.clear();
            }
            PathEvent::Connection { number, kind, .. } => {
                let is_inner = *kind == SpecularPath::ThroughReflected;
                connected.insert(*number, if is_inner { 2 } else { 1 });
            }
            PathEvent::ShadowRay { connection, contribution, .. } => {
                let class = connected.get(connection).copied().unwrap_or(4);
                light[class] += f64::from(contribution.radiance.y);
            }
            PathEvent::Emission { contribution, .. } => {
                light[chain.class()] += f64::from(contribution.radiance.y);
            }
            PathEvent::BsdfSample { lobe, wi, .. } => {
                if let Some(hit) = hit {
                    let is_reflected = wi.dot(hit.facing_normal()) > 0.0;
                    chain.scatter(hit.id, hit.side, *lobe, is_reflected);
                }
            }
            _ => {}
        }
    }
    light
}

/// The variance of a sample by class, averaged over the pixels.
fn variances(prepared: &PreparedScene, samples: u32) -> Result<[f64; 5]> {
    let accel = photosphere::accel::Backend::Native
        .build(prepared.scene().spheres(), &BuildOptions::default())?;
    let cancel = CancelToken::default();
    let context = RenderContext::new(prepared, &*accel, &cancel);
    let integrator = create(prepared);
    let image = prepared.image_settings();
    let mut mean = [0.0; 5];
    for (x, y) in (0..image.height).flat_map(|y| (0..image.width).map(move |x| (x, y))) {
        let (mut sums, mut squares) = ([0.0; 5], [0.0; 5]);
        for sample in 0..samples {
            let address = SampleAddress { x, y, sample };
            let Some(trace) = integrator.trace_path(context, address) else { continue };
            for (class, light) in by_class(&trace).into_iter().enumerate() {
                sums[class] += light;
                squares[class] += light * light;
            }
        }
        let n = f64::from(samples);
        for class in 0..5 {
            let variance = (squares[class] - sums[class] * sums[class] / n) / (n - 1.0);
            mean[class] += variance / f64::from(image.width * image.height);
        }
    }
    Ok(mean)
}

#[allow(clippy::print_stdout, reason = "its purpose")]
fn main() -> Result<()> {
    let usual = "scenes/caustics/two-balls.toml".to_owned();
    let file = std::env::args().nth(1).unwrap_or(usual);
    let samples = std::env::args().nth(2).and_then(|count| count.parse().ok()).unwrap_or(256);
    let small = [("image.width", "80"), ("image.height", "60"), ("render.sampler", "independent")];
    let small: Vec<_> = small.iter().map(|(key, value)| Override::new(*key, *value)).collect();
    let described = read_file(file.as_ref(), &small)?;
    let mut settings = described.settings;
    let scene = Scene::build(described.description)?;
    let mut of = |caustics| {
        settings.render.caustics = caustics;
        variances(&PreparedScene::new(&scene, settings)?, samples)
    };
    let [chance, connect] = [of(Caustics::Chance)?, of(Caustics::Connect)?];
    let totals = [chance, connect].map(|all| all.iter().sum::<f64>());
    println!("{:<26}{:>12}{:>8}{:>12}{:>8}", "variance of a sample", "chance", "", "connect", "");
    for (class, name) in CLASSES.iter().enumerate() {
        let shares = [chance[class] / totals[0], connect[class] / totals[1]].map(|s| 100.0 * s);
        println!(
            "{name:<26}{:>12.3e}{:>7.2}%{:>12.3e}{:>7.2}%",
            chance[class], shares[0], connect[class], shares[1]
        );
    }
    println!("{:<26}{:>12.3e}{:>8}{:>12.3e}{:>8}", "sum", totals[0], "", totals[1], "");
    Ok(())
}
