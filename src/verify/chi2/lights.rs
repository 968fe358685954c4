//! Sampling of directions to emitters, and selection among them.

use std::sync::Arc;

use crate::color::Rgb;
use crate::geometry::{Cone, PathRay, Sphere, SphereRows, SphereSet};
use crate::light::{Emitter, Environment, LightSampleContext, LightSource, Lights};
use crate::math::{DVec3, Frame, Hit};

use super::SamplingTest;

pub(super) fn tests() -> Vec<SamplingTest> {
    vec![inside_emitter(), light_selection()]
}

/// Spheres of which the first is lit by the others, which are emitters.
struct LitScene {
    spheres: SphereSet,
    lights: Lights,
    /// Shading point on the first sphere.
    context: LightSampleContext,
}

impl LitScene {
    /// Places the shading point where a ray in direction `towards` first hits the first sphere.
    /// Emitter i, counted from 1, has radiance i.
    fn new(spheres: Vec<Sphere>, towards: DVec3) -> Arc<Self> {
        let emitters = 1..spheres.len() as u32;
        let rows = SphereRows { exact: spheres, table: Vec::new() };
        let spheres = SphereSet::new(rows).expect("few spheres");
        let emitter = |row| Emitter { id: id_of(&spheres, row), emission: Rgb::splat(row as f32) };
        let lights = Lights::new(emitters.map(emitter).collect(), &spheres, Environment::default());
        let id = id_of(&spheres, 0);
        let ray = PathRay::new(spheres.sphere(id).center - towards * 3.0, towards);
        let hit =
            spheres.resolve_hit(&ray, Hit { t: 0.0, id }).expect("the ray aims at its centre");
        Arc::new(Self { spheres, lights, context: LightSampleContext { hit, is_two_sided: false } })
    }

    fn pdf(&self, source: LightSource, direction: DVec3) -> f64 {
        self.lights.pdf(&self.spheres, &self.context, source, direction)
    }
}

fn id_of(spheres: &SphereSet, row: u32) -> u32 {
    spheres.rows().iter().position(|&r| r == row).expect("every row has an id") as u32
}

fn ball(x: f64, radius: f64) -> Sphere {
    Sphere { center: DVec3::new(x, 0.0, 0.0), radius }
}

/// From a ball inside an emissive sphere, every direction above the surface hits the emitter.
fn inside_emitter() -> SamplingTest {
    let scene = LitScene::new(vec![ball(0.5, 1.0), ball(0.0, 10.0)], DVec3::new(0.0, 0.6, -0.8));
    let emitter = LightSource::Emitter(id_of(&scene.spheres, 1));
    let frame = Frame::from_z(scene.context.hit.facing_normal());
    let pdf_scene = scene.clone();
    SamplingTest::over_hemisphere(
        "light from inside an emitter",
        move |u| {
            let LitScene { spheres, lights, context } = &*scene;
            let sample = lights.sample(spheres, context, u[2], [u[0], u[1]])?;
            Some(frame.to_local(sample.direction))
        },
        move |w| pdf_scene.pdf(emitter, frame.to_world(w)),
    )
}

/// Selection probability of three emitters of different power and distance, computed as `pdf` over
/// the pdf of the cone.
fn light_selection() -> SamplingTest {
    let spheres = vec![ball(0.0, 1.0), ball(5.0, 1.0), ball(9.0, 0.5), ball(-30.0, 8.0)];
    let scene = LitScene::new(spheres, DVec3::new(0.0, 0.0, -1.0));
    let probability = |row: u32| {
        let id = id_of(&scene.spheres, row);
        let sphere = scene.spheres.sphere(id);
        let cone = Cone::subtending(scene.context.hit.point, &sphere).expect("from outside");
        scene.pdf(LightSource::Emitter(id), DVec3::X) / cone.pdf()
    };
    let probabilities = (1..4).map(probability).collect();
    SamplingTest::over_indices("choice among three emitters", probabilities, move |u| {
        let LitScene { spheres, lights, context } = &*scene;
        let sample = lights.sample(spheres, context, u[2], [u[0], u[1]])?;
        Some(spheres.row(sample.source.sphere_id()) as usize - 1)
    })
}
