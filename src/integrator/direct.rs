//! `integrator = "direct"`: directly visible emission, plus light scattered once between a light
//! and the camera. Mirrors and smooth glass in between do not count as scattering.
//!
//! The picture is bit-identical to the `direct` layer of [`super::path`].

use crate::scene::settings::RenderSettings;

use super::path;
use super::transport::PathTracer;

/// Creates the direct-light integrator from the `[render]` settings.
pub(super) fn new(render: &RenderSettings) -> PathTracer {
    PathTracer { max_scatterings: 1, ..path::new(render) }
}
