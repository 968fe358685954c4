//! Measures the stages of the path tracer, on one thread.

use crate::accel::{Accel, Backend};
use crate::color::PathRadiance;
use crate::integrator::{RenderContext, SampleAddress, StageProfile, Workspace, create};
use crate::scene::PreparedScene;
use crate::task::CancelToken;

use super::BackendSet;

/// Samples per batch, as in a render.
const BATCH: usize = 1024;
/// Samples per pixel that are next to each other in a batch, as in a render.
const BLOCK: u32 = 16;

/// Measures the stages of a render with every intersector that [`super::bench_renders`] measures.
pub fn bench_stages(
    prepared: &PreparedScene,
    backend_set: &BackendSet,
    cancel: &CancelToken,
) -> Vec<(Backend, StageProfile)> {
    let profile = |(backend, accel)| (backend, profile_stages(prepared, accel, cancel));
    backend_set.feasible_backends().map(profile).collect()
}

/// Estimates all samples of a picture and returns what the stages took. The clock adds a few
/// nanoseconds per vertex. Integrators that do not follow paths have no stages.
fn profile_stages(
    prepared: &PreparedScene,
    accel: &dyn Accel,
    cancel: &CancelToken,
) -> StageProfile {
    let context = RenderContext::new(prepared, accel, cancel);
    let integrator = create(prepared);
    let (window, end) = {
        let image = prepared.image_settings();
        (image.pixel_bounds(), prepared.render_settings().samples_per_pixel)
    };
    let mut workspace = Workspace::profiled();
    let mut radiance = vec![PathRadiance::default(); BATCH];
    let mut batch: Vec<SampleAddress> = Vec::with_capacity(BATCH);
    let mut estimate = |batch: &mut Vec<SampleAddress>| {
        if !cancel.is_cancelled() {
            integrator.estimate(context, batch, &mut radiance[..batch.len()], &mut workspace);
        }
        batch.clear();
    };
    for first in (0..end).step_by(BLOCK as usize) {
        for y in window.y..window.y + window.height {
            for x in window.x..window.x + window.width {
                let samples = first..end.min(first.saturating_add(BLOCK));
                if batch.len() + samples.len() > BATCH {
                    estimate(&mut batch);
                }
                batch.extend(samples.map(|sample| SampleAddress { x, y, sample }));
            }
        }
    }
    estimate(&mut batch);
    workspace.profile().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::accel::{Backend, BuildOptions};
    use crate::integrator::Stage;
    use crate::scene::read_text;

    const SCENE: &str = r#"format = 1
image = { width = 20, height = 16 }
render = { samples_per_pixel = 20 }
camera = { position = [0, 0, 5], look_at = [0, 0, 0], vertical_fov_degrees = 20 }
background = { radiance = [1, 1, 1] }
materials.diffuse = { type = "diffuse", albedo = [0.5, 0.5, 0.5] }
materials.veil = { type = "diffuse", albedo = [0.5, 0.5, 0.5], opacity = 0.5 }
spheres = [
  { center = [-1.0, 0, 0], radius = 1.0, material = "diffuse" },
  { center = [1.0, 0, 0], radius = 1.0, material = "veil" },
]
"#;

    #[test]
    fn every_vertex_is_counted_and_what_the_scalar_code_shades_by_itself() {
        let (scene, settings) =
            read_text("scene", SCENE, Path::new("."), &[]).unwrap().build().unwrap();
        let prepared = PreparedScene::new(&scene, settings).unwrap();
        let options = BuildOptions::default();
        let backends = [Backend::BruteForce];
        let backend_set = BackendSet::build(scene.spheres(), &backends, &options, 1).unwrap();
        let stages = bench_stages(&prepared, &backend_set, &options.cancel);
        let [(Backend::BruteForce, profile)] = stages[..] else { panic!("{stages:?}") };
        // Each of 20 x 16 x 20 camera rays hits at most a few times, and many hit.
        assert!((3000..30_000).contains(&profile.vertices), "{profile:?}");
        let scalar = profile.scalar_vertices as f64 / profile.vertices as f64;
        assert!((0.2..0.8).contains(&scalar), "the veiled one of two: {scalar}");
        assert!(Stage::NAMES.iter().all(|&(_, stage)| profile.nanoseconds(stage) > 0));
    }
}
