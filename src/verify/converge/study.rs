//! Renders for a convergence study: every variant at every sample count with every seed, compared
//! with one reference.

use std::ops::Range;
use std::time::Instant;

use crate::accel::{Accel, Backend, BuildOptions};
use crate::color::Rgb;
use crate::error::Result;
use crate::job::{self, RenderedImage};
use crate::scene::{PreparedScene, Scene, Settings};
use crate::task::CancelToken;

use super::{ChartPoint, Reference, Series};

/// Seed of the reference halves, far from any that a user is likely to choose.
const REFERENCE_SEED: u64 = 1 << 40;

/// Plan of a convergence study.
#[derive(Debug)]
pub struct Study {
    /// Scene to render.
    pub scene: Scene,
    /// Variants, one curve each.
    pub variants: Vec<Variant>,
    /// Samples per pixel, in increasing order.
    pub samples: Vec<u32>,
    /// Seeds, one image each per variant and sample count.
    pub seeds: Range<u64>,
    /// Reference to compare with.
    pub reference: ReferenceFrom,
}

/// One curve.
#[derive(Clone, Debug)]
pub struct Variant {
    /// Name of the variant.
    pub name: String,
    /// Intersector.
    pub accel: Backend,
    /// Settings for each sample count of the study.
    pub settings: Vec<Settings>,
}

/// Source of the reference.
#[derive(Clone, Debug)]
pub enum ReferenceFrom {
    /// An existing image.
    Picture(Reference),
    /// Two halves rendered with these settings, by the first variant's intersector.
    Halves(Settings),
}

impl Study {
    /// Total samples of all images, reference included.
    pub fn samples_in_all(&self) -> u64 {
        let of = |settings: &Settings| {
            let image = settings.image;
            let pixels = u64::from(image.width) * u64::from(image.height);
            pixels * u64::from(settings.render.samples_per_pixel)
        };
        let points = self.variants.iter().flat_map(|variant| &variant.settings);
        let curves = points.map(of).sum::<u64>() * (self.seeds.end - self.seeds.start);
        let reference = match &self.reference {
            ReferenceFrom::Picture(_) => 0,
            ReferenceFrom::Halves(settings) => 2 * of(settings),
        };
        curves + reference
    }

    /// Renders the study on the current rayon pool; `done` is called after each image.
    ///
    /// # Errors
    /// If an intersector cannot be built, or a render fails.
    pub fn measure(&self, done: &dyn Fn(&RenderedImage)) -> Result<(Reference, Vec<Series>)> {
        let build = BuildOptions { threads: rayon::current_num_threads(), ..Default::default() };
        let built = |variant: &Variant| variant.accel.build(self.scene.spheres(), &build);
        let accels: Vec<Box<dyn Accel>> = self.variants.iter().map(built).collect::<Result<_>>()?;
        let reference = self.reference(&*accels[0], done)?;
        let empty = |variant: &Variant| Series { name: variant.name.clone(), points: Vec::new() };
        let mut series: Vec<Series> = self.variants.iter().map(empty).collect();
        for (at, &samples) in self.samples.iter().enumerate() {
            let prepared =
                |variant: &Variant| PreparedScene::new(&self.scene, variant.settings[at]);
            let mut shots: Vec<PreparedScene> =
                self.variants.iter().map(prepared).collect::<Result<_>>()?;
            let mut runs = vec![Vec::new(); shots.len()];
            // Variants are interleaved, so that other load on the machine affects all of them
            // equally.
            for seed in self.seeds.clone() {
                for ((prepared, accel), runs) in shots.iter_mut().zip(&accels).zip(&mut runs) {
                    prepared.set_seed(seed);
                    let (pixels, seconds) = render(prepared, &**accel, done)?;
                    runs.push(reference.measure(&pixels, seconds));
                }
            }
            for (series, runs) in series.iter_mut().zip(runs) {
                series.points.push(ChartPoint { samples, runs });
            }
        }
        Ok((reference, series))
    }

    fn reference(&self, accel: &dyn Accel, done: &dyn Fn(&RenderedImage)) -> Result<Reference> {
        let settings = match &self.reference {
            ReferenceFrom::Picture(reference) => return Ok(reference.clone()),
            ReferenceFrom::Halves(settings) => *settings,
        };
        let mut prepared = PreparedScene::new(&self.scene, settings)?;
        let mut half = |seed| {
            prepared.set_seed(seed);
            render(&prepared, accel, done).map(|(pixels, _)| pixels)
        };
        let (a, b) = (half(REFERENCE_SEED)?, half(REFERENCE_SEED + 1)?);
        Ok(Reference::from_halves(&a, &b))
    }
}

/// Renders the beauty; also returns the seconds it took.
fn render(
    prepared: &PreparedScene,
    accel: &dyn Accel,
    done: &dyn Fn(&RenderedImage),
) -> Result<(Vec<Rgb>, f64)> {
    let began = Instant::now();
    let rendered = job::render_with_accel(prepared, accel, &[], &CancelToken::default())?;
    let seconds = began.elapsed().as_secs_f64();
    done(&rendered);
    let picture = &rendered.picture;
    Ok(((0..picture.len()).map(|pixel| picture.beauty(pixel)).collect(), seconds))
}
