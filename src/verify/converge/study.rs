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

use super::{ConvergencePoint, Reference, Series};

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
    pub reference: ReferenceSource,
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
pub enum ReferenceSource {
    /// An existing image.
    Picture(Reference),
    /// Two halves rendered with these settings, by the first variant's intersector.
    Halves(Settings),
}

impl Study {
    /// Total samples of all images, reference included.
    pub fn total_samples(&self) -> u64 {
        let sample_count = |settings: &Settings| {
            let image = settings.image;
            let pixels = u64::from(image.width) * u64::from(image.height);
            pixels * u64::from(settings.render.samples_per_pixel)
        };
        let points = self.variants.iter().flat_map(|variant| &variant.settings);
        let curves = points.map(sample_count).sum::<u64>() * (self.seeds.end - self.seeds.start);
        let reference = match &self.reference {
            ReferenceSource::Picture(_) => 0,
            ReferenceSource::Halves(settings) => 2 * sample_count(settings),
        };
        curves + reference
    }

    /// Renders the study on the current rayon pool; `on_image` is called after each image.
    ///
    /// # Errors
    /// If an intersector cannot be built, or a render fails.
    pub fn measure(&self, on_image: &dyn Fn(&RenderedImage)) -> Result<(Reference, Vec<Series>)> {
        let build = BuildOptions { threads: rayon::current_num_threads(), ..Default::default() };
        let build_accel = |variant: &Variant| variant.accel.build(self.scene.spheres(), &build);
        let accels: Vec<Box<dyn Accel>> =
            self.variants.iter().map(build_accel).collect::<Result<_>>()?;
        let reference = self.reference(&*accels[0], on_image)?;
        let empty = |variant: &Variant| Series { name: variant.name.clone(), points: Vec::new() };
        let mut series: Vec<Series> = self.variants.iter().map(empty).collect();
        for (index, &samples) in self.samples.iter().enumerate() {
            let prepared =
                |variant: &Variant| PreparedScene::new(&self.scene, variant.settings[index]);
            let mut scenes: Vec<PreparedScene> =
                self.variants.iter().map(prepared).collect::<Result<_>>()?;
            let mut runs = vec![Vec::new(); scenes.len()];
            // Variants are interleaved, so that other load on the machine affects all of them
            // equally.
            for seed in self.seeds.clone() {
                for ((prepared, accel), runs) in scenes.iter_mut().zip(&accels).zip(&mut runs) {
                    prepared.set_seed(seed);
                    let (pixels, seconds) = render(prepared, &**accel, on_image)?;
                    runs.push(reference.measure(&pixels, seconds));
                }
            }
            for (series, runs) in series.iter_mut().zip(runs) {
                series.points.push(ConvergencePoint { samples, runs });
            }
        }
        Ok((reference, series))
    }

    fn reference(&self, accel: &dyn Accel, on_image: &dyn Fn(&RenderedImage)) -> Result<Reference> {
        let settings = match &self.reference {
            ReferenceSource::Picture(reference) => return Ok(reference.clone()),
            ReferenceSource::Halves(settings) => *settings,
        };
        let mut prepared = PreparedScene::new(&self.scene, settings)?;
        let mut render_half = |seed| {
            prepared.set_seed(seed);
            render(&prepared, accel, on_image).map(|(pixels, _)| pixels)
        };
        let (a, b) = (render_half(REFERENCE_SEED)?, render_half(REFERENCE_SEED + 1)?);
        Ok(Reference::from_halves(&a, &b))
    }
}

/// Renders the beauty; also returns the seconds it took.
fn render(
    prepared: &PreparedScene,
    accel: &dyn Accel,
    on_image: &dyn Fn(&RenderedImage),
) -> Result<(Vec<Rgb>, f64)> {
    let start = Instant::now();
    let rendered = job::render_with_accel(prepared, accel, &[], &CancelToken::default())?;
    let seconds = start.elapsed().as_secs_f64();
    on_image(&rendered);
    let picture = &rendered.picture;
    Ok(((0..picture.len()).map(|pixel| picture.beauty(pixel)).collect(), seconds))
}
