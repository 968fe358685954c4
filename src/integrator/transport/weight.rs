//! Multiple importance sampling.

use crate::sampling::power_heuristic;
use crate::scene::settings::Estimator;

/// MIS weight of a light sample against BSDF sampling. An exact sample has no variance that BSDF
/// sampling could reduce.
#[inline(always)]
pub(super) fn light_weight(estimator: Estimator, is_exact: bool, pdf: f64, pdf_bsdf: f64) -> f64 {
    match estimator {
        Estimator::Light => 1.0,
        _ if is_exact => 1.0,
        _ => power_heuristic(pdf, pdf_bsdf),
    }
}
