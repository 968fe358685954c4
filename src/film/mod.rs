//! Per-pixel sums of samples.

mod picture;

pub use picture::Picture;

use crate::color::{Radiance, Rgb};
use crate::error::{Error, Result};
use crate::fault::fault;

/// Samples are summed in blocks of this many consecutive ones, in index order.
pub const BLOCK: u32 = 16;

/// The running sums of one pixel.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pixel {
    direct: [f64; 3],
    indirect: [f64; 3],
    alpha: f64,
    samples: u32,
}

/// The running sums of a picture, row by row from the upper left corner.
#[derive(Clone, Debug)]
pub struct Film {
    width: usize,
    height: usize,
    pixels: Vec<Pixel>,
}

impl Pixel {
    /// Adds the next samples in index order: first to the sum of their block, then that sum to the
    /// pixel, so that the bits do not depend on who adds when. `samples` is one whole block, or the
    /// last and unfinished one.
    pub fn add_block(&mut self, samples: &[Radiance]) {
        let mut sums = [[0.0; 3]; 2];
        for sample in samples {
            for (sum, color) in sums.iter_mut().zip([sample.direct, sample.indirect]) {
                for (sum, channel) in sum.iter_mut().zip(color.to_array()) {
                    *sum += f64::from(channel);
                }
            }
        }
        if fault!(FirstBlockDropped) && self.samples == 0 {
            sums = Default::default();
        }
        let [direct, indirect] = sums;
        self.alpha += samples.iter().map(|sample| f64::from(sample.alpha)).sum::<f64>();
        self.direct.iter_mut().zip(direct).for_each(|(total, sum)| *total += sum);
        self.indirect.iter_mut().zip(indirect).for_each(|(total, sum)| *total += sum);
        self.samples += samples.len() as u32;
    }

    /// Samples so far.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    fn mean(&self, sums: [f64; 3]) -> Rgb {
        let n = if fault!(DividedByN) { self.samples / 4 } else { self.samples };
        let count = f64::from(n.max(1));
        Rgb::from_array(sums.map(|sum| (sum / count) as f32))
    }
}

impl Film {
    /// An empty film.
    ///
    /// # Errors
    /// When there is no memory for it.
    pub fn new(width: usize, height: usize) -> Result<Self> {
        let mut pixels = Vec::new();
        let count = width * height;
        pixels.try_reserve_exact(count).map_err(|_| {
            let bytes = Self::bytes(width, height);
            Error::input(format!("there is no memory for a film of {bytes} bytes"))
                .with_help("render a smaller picture")
        })?;
        pixels.resize(count, Pixel::default());
        Ok(Self { width, height, pixels })
    }

    /// Bytes that a film of this size holds.
    pub fn bytes(width: usize, height: usize) -> usize {
        width * height * size_of::<Pixel>()
    }

    /// The pixels, row by row, to be added to.
    pub fn pixels_mut(&mut self) -> &mut [Pixel] {
        &mut self.pixels
    }

    /// The mean of every pixel; black where there is no sample yet.
    pub fn picture(&self) -> Picture {
        Picture {
            width: self.width,
            height: self.height,
            direct: self.pixels.iter().map(|pixel| pixel.mean(pixel.direct)).collect(),
            indirect: self.pixels.iter().map(|pixel| pixel.mean(pixel.indirect)).collect(),
            alpha: None,
        }
    }

    /// The same, with the share of each pixel that something covers.
    pub fn picture_with_alpha(&self) -> Picture {
        let alpha = |pixel: &Pixel| (pixel.alpha / f64::from(pixel.samples.max(1))) as f32;
        Picture { alpha: Some(self.pixels.iter().map(alpha).collect()), ..self.picture() }
    }
}
