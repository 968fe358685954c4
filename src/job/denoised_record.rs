//! What the record of a picture says of denoising.

use super::metadata::Metadata;

/// The entry among the biases.
const BIAS: &str = "denoised";

/// How the entry among the later changes begins.
const CHANGE: &str = "denoised by ";

impl Metadata {
    /// Records that the picture is denoised by this program, and so biased.
    pub fn mark_denoised(&mut self, by: &str) {
        self.unmark_denoised();
        self.biased.push(BIAS.to_owned());
        self.converted.push(format!("{CHANGE}{by}"));
    }

    /// Records that the picture is not denoised, or no more.
    pub fn unmark_denoised(&mut self) {
        self.biased.retain(|bias| bias != BIAS);
        self.converted.retain(|change| !change.starts_with(CHANGE));
    }
}
