//! Reflection and refraction at a smooth interface between transparent media.

use crate::fault::fault;
use crate::math::DVec3;

/// Fresnel reflection of unpolarised light at a smooth interface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fresnel {
    /// The fraction of light that is reflected.
    pub reflectance: f64,
    /// Cosine of the refracted direction; 0 for total internal reflection.
    pub cos_transmitted: f64,
}

/// Solves the Fresnel equations for light arriving at the cosine `cos >= 0`, where `eta` is the
/// index of refraction beyond the interface over the index on this side (Born and Wolf, section
/// 1.5.2).
pub fn fresnel(cos: f64, eta: f64) -> Fresnel {
    let sin_squared = (1.0 - cos) * (1.0 + cos) / (eta * eta);
    if sin_squared >= 1.0 {
        return Fresnel { reflectance: 1.0, cos_transmitted: 0.0 };
    }
    let cos_transmitted = (1.0 - sin_squared).sqrt();
    let parallel = (eta * cos - cos_transmitted) / (eta * cos + cos_transmitted);
    let perpendicular = (cos - eta * cos_transmitted) / (cos + eta * cos_transmitted);
    let perpendicular = if fault!(OnePolarization) { parallel } else { perpendicular };
    let reflectance = (parallel * parallel + perpendicular * perpendicular) / 2.0;
    Fresnel { reflectance, cos_transmitted }
}

/// Returns the refracted direction at a facet of normal `m`; `None` for total internal reflection.
pub(super) fn refract(wo: DVec3, m: DVec3, eta: f64) -> Option<DVec3> {
    let cos = wo.dot(m).clamp(0.0, 1.0);
    let Fresnel { reflectance, cos_transmitted } = fresnel(cos, eta);
    let along = cos / eta - cos_transmitted;
    (reflectance < 1.0).then(|| (m * along - wo / eta).normalize())
}
