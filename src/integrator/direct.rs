//! `integrator = "direct"`: what the camera sees by itself, and light scattered once on its way from
//! a light to the camera. Mirrors and smooth glass in between do not count as scattering.
//!
//! It is [`super::path`] without the rest: its picture is the layer `direct` of that one, bit by bit.

use crate::scene::settings::RenderSettings;

use super::path;
use super::transport::PathTracer;

/// Direct light only, as `[render]` asks for it.
pub(super) fn new(render: &RenderSettings) -> PathTracer {
    PathTracer { max_scatterings: 1, ..path::new(render) }
}
