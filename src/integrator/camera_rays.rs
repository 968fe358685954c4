//! Maps a sample's address to a pixel position and a camera ray.

use crate::fault::fault;
use crate::geometry::PathRay;
use crate::sampling::Sampler;
use crate::scene::PreparedScene;

use super::sample::SampleAddress;

/// Stratification of a pixel's samples.
///
/// A pixel is divided into k x k sub-pixels; sample s belongs to sub-pixel s mod k^2, and each
/// sub-pixel has its own random sequence. The stratified point in the unit square is then warped by
/// the pixel filter, so the sub-pixels receive equal shares of the filter's weight.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strata {
    /// Number of sub-pixels along each side, k.
    pub(super) subpixels: u32,
    /// Jitter within a sub-pixel: 1 covers it, 0 stays at its centre.
    pub(super) jitter: f64,
}

impl Strata {
    /// A single stratum: the whole pixel.
    pub(super) const UNSTRATIFIED: Self = Self { subpixels: 1, jitter: 1.0 };

    fn warp(&self, sample: u32, u: [f64; 2]) -> [f64; 2] {
        let k = self.subpixels;
        if self.is_unstratified() {
            return u;
        }
        let cell = [sample % k, sample / k % k];
        std::array::from_fn(|axis| {
            let shift = self.jitter * (u[axis] - 0.5);
            (f64::from(cell[axis]) + 0.5 + shift) / f64::from(k)
        })
    }

    /// Returns true if samples may fall anywhere in their pixel.
    pub(super) fn is_unstratified(&self) -> bool {
        self.subpixels == 1 && self.jitter == 1.0
    }
}

/// Returns the sampler of a sample. Every sub-pixel has its own random sequence.
pub(super) fn sampler_for(
    prepared: &PreparedScene,
    strata: Strata,
    address: SampleAddress,
) -> Sampler {
    let (image, render) = (prepared.image_settings(), prepared.render_settings());
    let pixel = u64::from(address.y) * u64::from(image.width) + u64::from(address.x);
    let cells = strata.subpixels * strata.subpixels;
    let cell = pixel * u64::from(cells) + u64::from(address.sample % cells);
    let samples = render.samples_per_pixel.div_ceil(cells);
    Sampler::with_kind(render.sampler, render.seed, cell, address.sample / cells, samples)
}

/// Generates the camera ray of a sample. `pixel` and `lens` are the first of the two dimensions
/// used for the pixel position and for the lens position.
pub(super) fn generate_camera_ray(
    prepared: &PreparedScene,
    strata: Strata,
    address: SampleAddress,
    sampler: Sampler,
    [pixel, lens]: [u32; 2],
) -> PathRay {
    let stratified = strata.warp(address.sample, sampler.get_2d(pixel));
    let [dx, dy] = prepared.filter().sample(stratified);
    let half = if fault!(PixelCornerForCenter) { 0.0 } else { 0.5 };
    let (x, y) = (f64::from(address.x) + half + dx, f64::from(address.y) + half + dy);
    let camera = prepared.camera();
    let lens = if camera.has_lens() { sampler.get_2d(lens) } else { [0.5; 2] };
    camera.generate_ray(x, y, lens)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_go_around_the_subpixels_and_cover_them() {
        let strata = Strata { subpixels: 2, jitter: 1.0 };
        assert_eq!(strata.warp(0, [0.0, 0.0]), [0.0, 0.0]);
        assert_eq!(strata.warp(5, [0.5, 0.5]), [0.75, 0.25]);
        assert_eq!(strata.warp(2, [0.0, 0.0]), [0.0, 0.5]);
        let centered = Strata { subpixels: 2, jitter: 0.0 };
        assert_eq!(centered.warp(3, [0.1, 0.9]), [0.75, 0.75]);
    }

    #[test]
    fn places_in_a_subpixel_have_the_moments_of_a_uniform_square() {
        // Mean 1/4 of the first sub-pixel and variance (1/2)^2 / 12, each within five standard
        // errors (significance 6e-7 each).
        let strata = Strata { subpixels: 2, jitter: 1.0 };
        let n = 40_000;
        let xs: Vec<f64> =
            (0..n).map(|i| strata.warp(0, Sampler::independent(1, i, 0).get_2d(0))[0]).collect();
        let mean = xs.iter().sum::<f64>() / n as f64;
        let variance = xs.iter().map(|x| (x - 0.25).powi(2)).sum::<f64>() / n as f64;
        let sigma = (1.0f64 / 48.0).sqrt();
        assert!((mean - 0.25).abs() < 5.0 * sigma / (n as f64).sqrt());
        // The fourth moment of a uniform variable of variance s^2 is 1.8 s^4.
        assert!((variance - 1.0 / 48.0).abs() < 5.0 * (0.8f64).sqrt() / 48.0 / (n as f64).sqrt());
    }
}
