//! How far a picture is from its noise target.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::adaptive::NoiseProgress;
use super::noise::NoiseTarget;

/// Status of a noise target.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NoiseStatus {
    /// The noise target.
    pub target: NoiseTarget,
    /// Number of 16 x 16 pixel tiles in the picture.
    pub tiles: usize,
    /// Tiles that meet the target.
    pub tiles_converged: usize,
    /// The largest error of any tile; `None` if some tile's error is unknown.
    pub worst_error: Option<f64>,
}

impl NoiseStatus {
    /// Returns true if all tiles meet the target.
    pub fn is_met(&self) -> bool {
        self.tiles_converged == self.tiles
    }
}

impl From<&NoiseProgress> for NoiseStatus {
    fn from(progress: &NoiseProgress) -> Self {
        let NoiseProgress { target, tiles, tiles_converged, worst_error, .. } = *progress;
        Self {
            target,
            tiles,
            tiles_converged,
            worst_error: worst_error.is_finite().then_some(worst_error),
        }
    }
}

/// The message for a missed target.
impl fmt::Display for NoiseStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { target, tiles, tiles_converged, worst_error } = self;
        let error = target.format_error(target.error);
        write!(
            f,
            "the noise target of {error} is not met in {} of {tiles} tiles; ",
            tiles - tiles_converged
        )?;
        match worst_error {
            Some(worst_error) => {
                write!(f, "the worst has an error of {}", target.format_error(*worst_error))
            }
            None => f.write_str("their errors are not known yet"),
        }
    }
}
