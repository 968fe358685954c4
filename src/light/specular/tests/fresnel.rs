//! Fresnel's equations at a ball, as the tests need them.

/// Reflectance for unpolarised light that arrives from outside at this cosine.
pub(super) fn reflectance(cos: f64, ior: f64) -> f64 {
    let sin_squared = (1.0 - cos * cos) / (ior * ior);
    if sin_squared >= 1.0 {
        return 1.0;
    }
    let inside = (1.0 - sin_squared).sqrt();
    let parallel = (ior * cos - inside) / (ior * cos + inside);
    let perpendicular = (cos - ior * inside) / (cos + ior * inside);
    0.5 * (parallel * parallel + perpendicular * perpendicular)
}
