//! The closed forms: each a scene of `scenes/verify/`, whose head derives the answer, and the same
//! answer as a function of what the scene says.

mod absorption;
mod cameras;
mod direct_light;
mod exchange;
mod first_hits;
mod glass;
mod list;
mod many_lights;
mod mirrors;
mod uniform;

pub use list::CLOSED_FORMS;

use crate::scene::PreparedScene;
use crate::scene::description::{EnvironmentDescription, MaterialDescription, SurfaceModel};

/// A scene whose picture is known.
#[derive(Clone, Copy, Debug)]
pub struct ClosedForm {
    /// The scene's file name without its ending.
    pub name: &'static str,
    /// What it shows, in a few words.
    pub title: &'static str,
    /// The answer as a formula.
    pub formula: &'static str,
    /// The scene file.
    pub scene_toml: &'static str,
    /// The sphere tables beside it, by their names.
    pub tables: &'static [(&'static str, &'static [u8])],
    /// Which estimators it is for.
    pub transport: LightTransport,
    /// The weights of red, green and blue in what is compared; they add up to 1.
    pub(super) channels: [f64; 3],
    /// Samples of each pixel in a quick check, from each seed: a multiple of 4.
    pub samples: u32,
    /// The answer for each pixel, `None` where there is none, by quadratures of so many nodes.
    pub(super) answer: fn(&PreparedScene, usize) -> Vec<Option<f64>>,
}

/// What light a scene shows, and thus which estimators find all of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightTransport {
    /// Light that was scattered any number of times.
    Global,
    /// Light that was scattered once at most, not counting mirrors and glass.
    Direct,
    /// No light: what the integrator shows that the scene names.
    Integrator(&'static str),
}

/// All channels are the same.
const GREY: [f64; 3] = [1.0 / 3.0; 3];
/// A channel in the place of another is seen.
const DISTINCT_CHANNELS: [f64; 3] = [1.0 / 7.0, 2.0 / 7.0, 4.0 / 7.0];

/// A material by its name.
fn material<'a>(shot: &'a PreparedScene, name: &str) -> &'a MaterialDescription {
    let found = shot.description().materials.iter().find(|material| material.name == name);
    found.expect("the scenes of this program have the materials that their answers are made of")
}

/// The radiance of an even background.
fn background_radiance(shot: &PreparedScene) -> f64 {
    match shot.description().background.dome {
        EnvironmentDescription::Constant { radiance } => f64::from(radiance.y),
        _ => f64::NAN,
    }
}

/// The emission of a grey lamp.
fn emission(shot: &PreparedScene, name: &str) -> f64 {
    f64::from(material(shot, name).emission.y)
}

/// The albedo or reflectance of a grey surface.
fn albedo(shot: &PreparedScene, name: &str) -> f64 {
    match &material(shot, name).surface {
        SurfaceModel::Diffuse { albedo: share, .. }
        | SurfaceModel::Mirror { reflectance: share, .. } => f64::from(share.y),
        _ => 0.0,
    }
}

/// The same answer for every pixel.
fn uniform_answer(shot: &PreparedScene, value: f64) -> Vec<Option<f64>> {
    vec![Some(value); (shot.image_settings().width * shot.image_settings().height) as usize]
}
