//! Noise targets by name.

use crate::color::ViewTransform;
use crate::names::named_enum;

use super::noise::NoiseTarget;

/// Names for targets in displayed values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// 90 % of the values within 12 of 255: grainy, but everything can be seen.
    Preview,
    /// 95 % of the values within 5 of 255: a little grain.
    Good,
    /// 95 % of the values within 2 of 255: no grain at arm's length.
    Print,
}

named_enum! { Quality { Preview = "preview", Good = "good", Print = "print" } }

impl Quality {
    /// The target, for pictures that are looked at through this view transform.
    pub fn target(self, view: ViewTransform) -> NoiseTarget {
        let (steps, confidence) = match self {
            Self::Preview => (12.0, 0.9),
            Self::Good => (5.0, 0.95),
            Self::Print => (2.0, 0.95),
        };
        // Dithering hides steps; it changes no mean.
        let view = ViewTransform { dither: false, ..view };
        NoiseTarget { error: steps / 255.0, confidence, display: Some(view) }
    }
}
