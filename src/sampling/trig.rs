//! The one place that transcendental functions come from, so that pictures have the same bits on
//! every machine: the `libm` crate, compiled with us, and not the system's.

/// Sine and cosine of an angle in radians.
pub fn sin_cos(angle: f64) -> (f64, f64) {
    libm::sincos(angle)
}
