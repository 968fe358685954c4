//! Light transport over batches of paths, one file per integrator.
//!
//! A batch of samples goes through the stages together: camera rays, closest hits, surfaces, light
//! samples, occlusion, scattering. One intersector call serves many rays, and each stage is a plain
//! loop. The result of a sample depends only on its address, never on its batch.

mod ambient_occlusion;
mod aov;
mod camera_rays;
mod context;
mod dimension;
mod direct;
mod estimate;
mod normals;
mod paper;
mod path;
mod primary_hits;
mod profile;
mod raycast;
mod sample;
mod trace;
mod transport;
mod workspace;

pub use context::RenderContext;
pub use estimate::Integrator;
pub use profile::{Stage, StageProfile};
pub use sample::{RenderStats, SampleAddress};
pub use trace::{ChosenLight, Contribution, PathEvent, PathTrace, Rival, Termination};
pub use workspace::Workspace;

use crate::scene::PreparedScene;
use crate::scene::settings::IntegratorSettings;

use ambient_occlusion::AmbientOcclusion;
use normals::Normals;
use raycast::Raycast;

/// Creates the integrator that the render settings select.
pub fn create(prepared: &PreparedScene) -> Box<dyn Integrator> {
    let render = prepared.render_settings();
    match render.integrator {
        IntegratorSettings::Path => Box::new(path::new(render)),
        IntegratorSettings::Direct => Box::new(direct::new(render)),
        IntegratorSettings::Paper(paper) => Box::new(paper::new(&paper, render)),
        IntegratorSettings::AmbientOcclusion { distance } => {
            let distance = distance.unwrap_or(f64::INFINITY);
            Box::new(AmbientOcclusion { distance })
        }
        IntegratorSettings::Normals => Box::new(Normals::new(render.samples_per_pixel)),
        IntegratorSettings::Raycast { shadows } => {
            Box::new(Raycast::new(shadows, render.samples_per_pixel))
        }
    }
}
