//! Multiple importance sampling.

use crate::sampling::power_heuristic;
use crate::scene::settings::Estimator;

/// MIS weight of a light sample against BSDF sampling.
#[inline(always)]
pub(super) fn mis_weight(estimator: Estimator, pdf: f64, pdf_bsdf: f64) -> f64 {
    match estimator {
        Estimator::Light => 1.0,
        _ => power_heuristic(pdf, pdf_bsdf),
    }
}
