//! The closed-form scenes. Each is a scene in `scenes/verify/`, whose header derives the exact
//! solution, and a function that computes that solution from the scene description.

mod absorption;
mod cameras;
mod caustics;
mod direct_light;
mod exchange;
mod first_hits;
mod glass;
mod list;
mod many_lights;
mod mirrors;
mod on_axis;
mod refraction;
mod uniform;
mod visibility;

pub use list::CLOSED_FORMS;

use crate::scene::PreparedScene;
use crate::scene::description::{EnvironmentDescription, MaterialDescription, SurfaceModel};

/// A scene whose exact image is known.
#[derive(Clone, Copy, Debug)]
pub struct ClosedForm {
    /// File name of the scene without its extension.
    pub name: &'static str,
    /// Short title.
    pub title: &'static str,
    /// Formula of the exact solution.
    pub formula: &'static str,
    /// Contents of the scene file.
    pub scene_toml: &'static str,
    /// Sphere tables next to the scene: file name and contents.
    pub tables: &'static [(&'static str, &'static [u8])],
    /// Light transport in the scene, which decides the estimators that apply.
    pub transport: LightTransport,
    /// Weights of red, green and blue in the compared value; they sum to 1.
    pub(super) channels: [f64; 3],
    /// Samples per pixel and seed in a quick check: a multiple of 4.
    pub samples: u32,
    /// Exact value of each pixel, by quadratures with this many nodes; `None` where there is no
    /// closed form.
    pub(super) solution: fn(&PreparedScene, usize) -> Vec<Option<f64>>,
}

/// Light transport in a scene, and thus the estimators that capture all of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightTransport {
    /// Light scattered any number of times.
    Global,
    /// Light scattered at most once, not counting mirrors and glass.
    Direct,
    /// As [`Self::Direct`], at a point on a caustic: light sampling alone has no bounded variance
    /// there.
    Caustic,
    /// As [`Self::Direct`], by techniques that find small emitters over polished balls.
    Connected,
    /// No light transport: the output of the integrator that the scene names.
    Integrator(&'static str),
}

/// Weights if all channels are equal.
const GREY: [f64; 3] = [1.0 / 3.0; 3];
/// Distinct weights, which detect swapped channels.
const DISTINCT_CHANNELS: [f64; 3] = [1.0 / 7.0, 2.0 / 7.0, 4.0 / 7.0];

/// Returns the material with this name.
fn material<'a>(prepared: &'a PreparedScene, name: &str) -> &'a MaterialDescription {
    let found = prepared.description().materials.iter().find(|material| material.name == name);
    found.expect("the scenes of this program define all materials of their solutions")
}

/// Radiance of a constant environment.
fn background_radiance(prepared: &PreparedScene) -> f64 {
    match prepared.description().background.dome {
        EnvironmentDescription::Constant { radiance } => f64::from(radiance.y),
        _ => f64::NAN,
    }
}

/// Emission of a grey emitter.
fn emission(prepared: &PreparedScene, name: &str) -> f64 {
    f64::from(material(prepared, name).emission.y)
}

/// Albedo or reflectance of a grey surface.
fn albedo(prepared: &PreparedScene, name: &str) -> f64 {
    match &material(prepared, name).surface {
        SurfaceModel::Diffuse { albedo, .. } | SurfaceModel::Mirror { reflectance: albedo, .. } => {
            f64::from(albedo.y)
        }
        _ => 0.0,
    }
}

/// A solution with one value for every pixel.
fn uniform_solution(prepared: &PreparedScene, value: f64) -> Vec<Option<f64>> {
    vec![Some(value); (prepared.image_settings().width * prepared.image_settings().height) as usize]
}
