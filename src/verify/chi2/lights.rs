//! Sampling of directions to emitters, and selection among them.

use std::f64::consts::TAU;
use std::sync::Arc;

use crate::color::Rgb;
use crate::geometry::{Cone, PathRay, Side, Sphere, SphereRows, SphereSet, SurfaceHit};
use crate::light::{
    Emitter, EmitterCuts, Enclosure, Environment, LightSample, LightSampleContext,
    LightSamplerKind, LightSource, Lights,
};
use crate::math::{DVec3, Frame, Hit};
use crate::sampling::{atan2, safe_acos, sin_cos};

use super::SamplingTest;

pub(super) fn tests() -> Vec<SamplingTest> {
    let far = DVec3::new(6.0, 3.0, -1.0);
    vec![
        inside_emitter(),
        light_selection(),
        cut_emitter("from outside", far, Side::Outside),
        cut_emitter("from inside", -far, Side::Inside),
        cut_emitter("from the wall", DVec3::new(-0.24, 3.0, 0.0), Side::Outside),
        cut_emitter_near_its_rim(),
    ]
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
        let emitter = |row| Emitter::opaque(id_of(&spheres, row), Rgb::splat(row as f32));
        let lights = Lights::new(emitters.map(emitter).collect(), &spheres, Environment::default());
        let id = id_of(&spheres, 0);
        let ray = PathRay::new(spheres.sphere(id).center - towards * 3.0, towards);
        let hit =
            spheres.resolve_hit(&ray, Hit { t: 0.0, id }).expect("the ray aims at its centre");
        Arc::new(Self {
            spheres,
            lights,
            context: LightSampleContext { hit, is_two_sided: false, is_lambertian: false },
        })
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

/// An emitter of radius 1 that sticks out of a wall, whose rim lies in the plane `x = 0.2`, and a
/// point on one side of the wall, which sees the cap on that side.
struct CutEmitter {
    spheres: SphereSet,
    lights: Lights,
    context: LightSampleContext,
    id: u32,
    emitter: Sphere,
}

impl CutEmitter {
    /// The point is relative to the emitter's centre.
    fn new(point: DVec3, side: Side) -> Arc<Self> {
        let exact = vec![ball(0.0, 1.0), ball(-10.0, 105f64.sqrt())];
        let spheres = SphereSet::new(SphereRows { exact, table: vec![] }).expect("few spheres");
        let [id, wall] = [0, 1].map(|row| id_of(&spheres, row));
        let emitters = [Emitter::opaque(id, Rgb::ONE)];
        let enclosure = Enclosure { id: wall, is_certain: true };
        let enclosures: &[Enclosure] = if side == Side::Inside { &[enclosure] } else { &[] };
        let cuts = EmitterCuts::find(&emitters, &spheres, |sphere| sphere == wall, enclosures);
        let (kind, environment) = (LightSamplerKind::default(), Environment::default());
        let lights = Lights::with_sampler(
            kind,
            emitters.into(),
            cuts.into(),
            &spheres,
            Arc::new(environment),
        );
        let emitter = spheres.sphere(id);
        // On the wall, so that the side of the hit decides.
        let (point, normal) = (emitter.center + point, DVec3::X);
        let hit = SurfaceHit { id: wall, t: 0.0, point, normal, radius: 1.0, side };
        let context = LightSampleContext { hit, is_two_sided: true, is_lambertian: false };
        Arc::new(Self { spheres, lights, context, id, emitter })
    }

    fn sample(&self, u: [f64; 4]) -> Option<LightSample> {
        self.lights.sample(&self.spheres, &self.context, u[2], [u[0], u[1]])
    }

    fn pdf(&self, direction: DVec3) -> f64 {
        self.lights.pdf(&self.spheres, &self.context, LightSource::Emitter(self.id), direction)
    }
}

/// The emitter from a point that sees its cap, in height and azimuth on the emitter: per unit of
/// both, the solid angle is `cos / t^2`.
fn cut_emitter(name: &str, point: DVec3, side: Side) -> SamplingTest {
    let lit = CutEmitter::new(point, side);
    let pdf_lit = lit.clone();
    let frame = Frame::from_z(DVec3::X);
    SamplingTest::over_rectangle(
        format!("emitter that a wall cuts, {name}"),
        [[-1.0, 0.0], [1.0, TAU]],
        move |u| {
            let sample = lit.sample(u)?;
            let point = lit.context.hit.point + sample.direction * sample.distance;
            let local = frame.to_local(point - lit.emitter.center);
            Some([local.z, atan2(local.y, local.x).rem_euclid(TAU)])
        },
        move |[z, phi]| {
            let ((sin_phi, cos_phi), sin) = (sin_cos(phi), (1.0 - z * z).sqrt());
            let normal = frame.to_world(DVec3::new(sin * cos_phi, sin * sin_phi, z));
            let to_point = pdf_lit.emitter.center + normal - pdf_lit.context.hit.point;
            let (t, direction) = (to_point.length(), to_point.normalize());
            let cos = -normal.dot(direction);
            if cos > 0.0 { pdf_lit.pdf(direction) * cos / (t * t) } else { 0.0 }
        },
    )
    .with_discontinuities()
}

/// The emitter from 1e-3 beside its rim, where its cone is nearly half a space, and narrower than
/// the cap.
fn cut_emitter_near_its_rim() -> SamplingTest {
    // Along the wall, whose tangent there has the slope `-sin / 10.2`.
    let sin_rim = 0.96f64.sqrt();
    let along_wall = DVec3::new(-sin_rim, 10.2, 0.0) * 1e-4;
    let lit = CutEmitter::new(DVec3::new(0.2, sin_rim, 0.0) + along_wall, Side::Outside);
    let pdf_lit = lit.clone();
    let frame = Frame::from_z((lit.emitter.center - lit.context.hit.point).normalize());
    let cone = Cone::subtending(lit.context.hit.point, &lit.emitter).expect("from outside");
    // Rounding may put a direction one ulp outside the cone.
    let widest = (1.0 + 1e-9) * safe_acos(1.0 - cone.solid_angle() / TAU);
    SamplingTest::over_cap(
        "emitter that a wall cuts, near its rim",
        widest,
        move |u| Some(frame.to_local(lit.sample(u)?.direction)),
        move |w| pdf_lit.pdf(frame.to_world(w)),
    )
}
