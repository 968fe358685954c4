//! The loop equals the recursion of the rendering equation, sample by sample.
//!
//! Here the equation is solved as it is written: the radiance of a point is its emission plus the
//! radiance of the next point times `f cos / pdf`, function calling itself, one ray at a time. With
//! the same random numbers it must give what the batched loop gives, to f32 rounding.

use photosphere::accel::{Accel, Backend};
use photosphere::color::{PathRadiance, Rgb};
use photosphere::geometry::{PathRay, SurfaceHit};
use photosphere::integrator::{RenderContext, SampleAddress, Workspace, create};
use photosphere::light::{LightSampleContext, LightSource};
use photosphere::material::Lobe;
use photosphere::math::{Frame, Hit};
use photosphere::sampling::{Hemisphere, Sampler, power_heuristic};
use photosphere::scene::PreparedScene;

use crate::kit::{Kit, built};

/// An opaque Lambertian surface.
fn light_context(hit: &SurfaceHit) -> LightSampleContext {
    LightSampleContext { hit: *hit, is_two_sided: false, is_lambertian: true }
}

/// What a call needs to know of its callers.
struct Call<'a> {
    prepared: &'a PreparedScene,
    accel: &'a dyn Accel,
    sampler: Sampler,
    samples_emitters: bool,
}

/// The point where a ray was drawn, and its density.
type Drawn<'a> = Option<(&'a SurfaceHit, f64)>;

impl Call<'_> {
    fn radiance(&self, ray: &PathRay, depth: u32, weight: f32, drawn: Drawn<'_>) -> Rgb {
        let scene = self.prepared.scene();
        let spheres = scene.spheres();
        let mut hit = [Hit::MISS];
        self.accel.closest(&[spheres.to_query(ray)], &mut hit);
        let Some(hit) = spheres.resolve_hit(ray, hit[0]) else {
            return scene.background_radiance(ray.direction);
        };
        let material = scene.sphere_material(hit.id).material;

        let mut radiance = material.emission;
        if let (true, Some((at, pdf))) = (self.samples_emitters, drawn) {
            let (lights, context) = (self.prepared.lights(), &light_context(at));
            let categories = &lights.category_pmf(context);
            let source = LightSource::Emitter(hit.id);
            let aimed = lights.pdf_by(categories, spheres, context, source, ray.direction);
            let weight = match aimed.is_exact && aimed.pdf > 0.0 {
                true => 0.0,
                false => power_heuristic(pdf, aimed.pdf),
            };
            radiance *= weight as f32;
        }

        let bsdf = material.bsdf(None, 1.0, Hemisphere::Cosine);
        let frame = Frame::from_z(hit.facing_normal());
        let wo = frame.to_local(-ray.direction);
        // The table of docs/sampling.md: direction to a light, direction, lobe, roulette, lamp.
        let number = |i| self.sampler.get(8 * (depth - 1) + i);

        if self.samples_emitters && !bsdf.is_delta() {
            radiance += self.light_from_emitters(
                &hit,
                &frame,
                |wi| bsdf.eval(wo, wi),
                |wi| bsdf.pdf(wo, wi),
                [number(14), number(2), number(3)],
            );
        }

        let again = || self.sampler.get_2d((3 << 30) + 4 * depth);
        let Some(sample) = bsdf.sample(wo, number(12), [number(8), number(9)], &again) else {
            return radiance;
        };
        let mut factor = sample.weight;
        let mut weight = weight * factor.max_element();
        if depth >= 4 {
            let survival = weight.min(if depth < 64 { 1.0 } else { 0.95 });
            if number(13) >= f64::from(survival) {
                return radiance;
            }
            factor /= survival;
            weight /= survival;
        }
        let direction = frame.to_world(sample.wi).normalize();
        let Some(next) = hit.spawn_ray(direction) else { return radiance };
        let drawn = (sample.lobe != Lobe::Delta).then_some((&hit, sample.pdf));
        radiance + factor * self.radiance(&next, depth + 1, weight, drawn)
    }

    fn light_from_emitters(
        &self,
        hit: &SurfaceHit,
        frame: &Frame,
        eval: impl Fn(photosphere::math::DVec3) -> Rgb,
        pdf: impl Fn(photosphere::math::DVec3) -> f64,
        u: [f64; 3],
    ) -> Rgb {
        let spheres = self.prepared.scene().spheres();
        let lights = self.prepared.lights();
        let Some(light) = lights.sample(spheres, &light_context(hit), u[0], [u[1], u[2]]) else {
            return Rgb::ZERO;
        };
        let wi = frame.to_local(light.direction);
        let Some(ray) =
            hit.spawn_shadow_ray(light.direction, light.distance, light.source.sphere_id())
        else {
            return Rgb::ZERO;
        };
        let mut blocked = [false];
        self.accel.occluded(&[spheres.to_query(&ray)], &mut blocked);
        if blocked[0] || wi.z <= 0.0 {
            return Rgb::ZERO;
        }
        let by_chance = if light.is_exact { 0.0 } else { pdf(wi) };
        let weight = power_heuristic(light.pdf, by_chance);
        eval(wi) * light.radiance * (weight * wi.z / light.pdf) as f32
    }
}

#[test]
fn the_loop_equals_the_recursion() {
    // White balls with equal channels, so that the largest component of a product is the product of
    // the largest components, and roulette decides alike.
    let grey = [
        "materials.ground.albedo=[0.7,0.7,0.7]",
        "materials.floating.albedo=[0.9,0.9,0.9]",
        "background.radiance=[0.1,0.2,0.3]",
        "image.width=64",
        "image.height=48",
        "image.filter=box",
    ];
    let cases = [
        ("path", true, "sobol"),
        ("path", true, "independent"),
        ("path", true, "stratified"),
        ("paper", false, "independent"),
    ];
    for (integrator, samples_emitters, sampler) in cases {
        let choice =
            [format!("render.integrator={integrator}"), format!("render.sampler={sampler}")];
        // The recursion knows no connections.
        let more = ["render.paper.subpixels=1", "render.caustics=chance"];
        let options = [&grey[..], &[&choice[0], &choice[1]], &more].concat();
        let prepared = Kit::of_file("paper/fig4.toml", &options).prepared();
        let accel = built(&prepared, Backend::BruteForce);
        let address = |i: u32| SampleAddress { x: i * 7 % 64, y: i * 5 % 48, sample: i / 100 };
        let samples: Vec<_> = (0..3000).map(address).collect();

        let mut looped = vec![PathRadiance::default(); samples.len()];
        let cancel = Default::default();
        let context = RenderContext::new(&prepared, &*accel, &cancel);
        create(&prepared).estimate(context, &samples, &mut looped, &mut Workspace::default());

        let mut bright = 0;
        for (address, looped) in samples.iter().zip(&looped) {
            let render = prepared.render_settings();
            let sampler = Sampler::with_kind(
                render.sampler,
                0,
                u64::from(address.y) * 64 + u64::from(address.x),
                address.sample,
                render.samples_per_pixel,
            );
            let [u, v] = sampler.get_2d(0);
            let (x, y) = (f64::from(address.x) + u, f64::from(address.y) + v);
            let ray = prepared.camera().generate_ray(x, y, [0.0; 2]);
            let call = Call { prepared: &prepared, accel: &*accel, sampler, samples_emitters };
            let recursive = call.radiance(&ray, 1, 1.0, None);
            let looped = looped.direct + looped.indirect;
            let allowed = 2e-5 * recursive.max_element().max(1e-3);
            assert!(
                (looped - recursive).abs().max_element() <= allowed,
                "{integrator} {address:?}: loop {looped}, recursion {recursive}"
            );
            bright += usize::from(recursive.max_element() > 0.2);
        }
        assert!(bright > 100, "there is something to compare");
    }
}
