//! What a smooth interface between transparent media reflects, and where it sends the rest.

use crate::fault::fault;
use crate::math::DVec3;

/// What a smooth interface does with unpolarised light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fresnel {
    /// The share that is reflected.
    pub reflectance: f64,
    /// Cosine of the refracted direction; 0 where all is reflected.
    pub cos_transmitted: f64,
}

/// The Fresnel equations for light arriving at the cosine `cos >= 0`, where `eta` is the index of
/// refraction beyond the interface over the index on this side (Born and Wolf, section 1.5.2).
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

/// Where a facet of normal `m` sends the light that it does not reflect; `None` where it reflects
/// all.
pub(super) fn refract(wo: DVec3, m: DVec3, eta: f64) -> Option<DVec3> {
    let cos = wo.dot(m).clamp(0.0, 1.0);
    let Fresnel { reflectance, cos_transmitted } = fresnel(cos, eta);
    let along = cos / eta - cos_transmitted;
    (reflectance < 1.0).then(|| (m * along - wo / eta).normalize())
}
