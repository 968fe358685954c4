//! Connections over polished balls: light that reaches a vertex by way of a mirror or glass ball,
//! computed as [`crate::light::specular`] describes, and the shadow rays along its legs.

use crate::color::Rgb;
use crate::fault::fault;
use crate::geometry::{PathRay, Side, Sphere, SurfaceHit};
use crate::light::specular::{CasterPair, Connection, SpecularPath};
use crate::light::{ConnectedPoint, LightSource};
use crate::material::{Medium, MediumStack, fresnel};
use crate::math::{DVec3, NO_SPHERE};
use crate::sampling::Hemisphere;
use crate::scene::SphereMaterial;

use super::super::dimension;
use super::super::trace::{PathEvent, PathRecorder};
use super::batch::PathBatch;
use super::next_event::Scattering;
use super::pair_site::{PairSite, connected_kinds};
use super::paths::{PathState, PendingDirect, ShadowQueue};
use super::vertex::VertexNumbers;
use super::weight::light_weight;

/// The most legs of a connection.
const MAX_LEGS: usize = 4;

/// The ball of a connection, and the legs along which its light arrives.
struct BallLegs<'a> {
    id: u32,
    ball: &'a Sphere,
    medium: Option<Medium>,
    /// The shadow rays along the legs, and whether each is inside the ball.
    rays: [Option<(PathRay, bool)>; MAX_LEGS],
    count: usize,
    transmittance: Rgb,
}

/// The light of a pair, and the ball that it goes over.
struct PairLight<'a> {
    pair: &'a CasterPair,
    point: &'a ConnectedPoint,
    kind: SpecularPath,
    /// Number of the connection at its vertex, from 1.
    number: u8,
}

impl<R: PathRecorder> PathBatch<'_, R> {
    /// Adds the shadow rays of all connections that can contribute at a vertex.
    #[inline(never)]
    pub(super) fn add_connections(
        &mut self,
        state: &PathState,
        scattering: &Scattering<'_>,
        numbers: &impl VertexNumbers,
        shadow_queue: &mut ShadowQueue<'_>,
    ) {
        let Some(pairs) = self.context.prepared.connections() else { return };
        let Some(inside) = self.connection_place(pairs, state) else { return };
        let room = self.integrator.max_depth - state.depth;
        let sampler = self.sampler(state);
        let lights = self.context.prepared.lights();
        let mut number = 0;
        let hit = &scattering.ctx.hit;
        let u_light = || sampler.get(dimension::connection_light(state.depth));
        for pair in numbers.choose_pairs(pairs, scattering.ctx, inside, u_light).iter() {
            let of = (pair.caster, pair.light);
            let kinds = connected_kinds(pairs, of, inside, (hit.point, hit.facing_normal()));
            if kinds.is_empty() {
                continue;
            }
            let caster = &pairs.casters().all()[pair.caster as usize];
            let site = PairSite { pairs, pair: &pair, inside, kinds, x: hit.point, room };
            let u = || sampler.get_2d(dimension::connection(state.depth, pair.n));
            let has_light = numbers.connect(lights, &site, u, |point, kind, connection| {
                number += 1;
                let light = PairLight { pair: &pair, point, kind, number };
                let legs = BallLegs::new(caster.id, &caster.ball);
                self.add_connection(state, scattering, &light, legs, connection, shadow_queue);
            });
            self.stats.connections += u64::from(has_light);
        }
    }

    /// Adds the shadow rays of one connection, if it can contribute.
    fn add_connection(
        &mut self,
        state: &PathState,
        scattering: &Scattering<'_>,
        light: &PairLight<'_>,
        mut legs: BallLegs<'_>,
        connection: &Connection,
        shadow_queue: &mut ShadowQueue<'_>,
    ) -> Option<()> {
        let Scattering { ctx, bsdf, frame, wo, .. } = *scattering;
        let wi = frame.to_local(connection.direction_at_x);
        let f = if wi.z > 0.0 { bsdf.eval(wo, wi) } else { Rgb::ZERO };
        let pdf = light.pair.pmf * light.point.pdf(connection);
        // At a caustic, all of the light is at one point: the density is infinite or 0.
        if f.max_element() <= 0.0 || !(pdf > 0.0 && pdf < f64::INFINITY) {
            return None;
        }
        let surface = self.context.scene.sphere_material(legs.id);
        let (passage, chance) = passage(&surface, light.kind, connection);
        legs.medium = surface.medium(legs.id);
        self.trace_legs(&mut legs, &ctx.hit, connection, light)?;
        let pdf_bsdf = bsdf.pdf(wo, wi) * chance;
        let rival = if fault!(ConnectionWeightMissing) { 0.0 } else { pdf_bsdf };
        let weight = light_weight(self.integrator.estimator, false, pdf, rival);
        let transmittance = passage * legs.transmittance;
        self.recorder.record(|| PathEvent::Connection {
            number: light.number,
            caster: legs.id,
            kind: light.kind,
            source: light.point.emitter.map_or(LightSource::Environment, LightSource::Emitter),
            connection: *connection,
            radiance: light.point.radiance,
            transmittance,
            f,
            cos: wi.z,
            pmf: light.pair.pmf,
            pdf,
            pdf_chance: pdf_bsdf,
            weight,
        });
        let factor = (weight * wi.z / pdf) as f32;
        let radiance = state.throughput * f * (light.point.radiance * transmittance) * factor;
        if radiance != Rgb::ZERO {
            self.push_legs(state, &legs, radiance, light, shadow_queue);
        }
        Some(())
    }

    /// Spawns the shadow rays along all legs; `None` if a surface that a leg starts at is in its
    /// way.
    fn trace_legs(
        &self,
        legs: &mut BallLegs<'_>,
        from: &SurfaceHit,
        connection: &Connection,
        light: &PairLight<'_>,
    ) -> Option<()> {
        let Connection { direction_at_x, leg_at_x, direction_at_y, leg_at_y, .. } = *connection;
        let is_first_inside = light.kind == SpecularPath::Outward;
        let is_last_inside = light.kind == SpecularPath::Inward;
        let first = self.spawn_leg(from, direction_at_x, leg_at_x, legs.id)?;
        self.push_leg(legs, first, is_first_inside, leg_at_x);
        let points = connection.points();
        for chord in points.windows(2) {
            let start = legs.point(chord[0], Side::Inside);
            let direction = (chord[1] - chord[0]).normalize();
            let ray = self.spawn_leg(&start, direction, connection.chord, legs.id)?;
            self.push_leg(legs, ray, true, connection.chord);
        }
        let side = if is_last_inside { Side::Inside } else { Side::Outside };
        let last = legs.point(*points.last()?, side);
        let target = light.point.emitter.unwrap_or(NO_SPHERE);
        let ray = self.spawn_leg(&last, -direction_at_y, leg_at_y, target)?;
        self.push_leg(legs, ray, is_last_inside, leg_at_y);
        Some(())
    }

    /// Spawns the shadow ray along a leg to a sphere.
    fn spawn_leg(
        &self,
        from: &SurfaceHit,
        direction: DVec3,
        length: f64,
        target: u32,
    ) -> Option<PathRay> {
        match self.context.scene.has_passable_surfaces() {
            true => from.spawn_ray_to(direction, length, target),
            false => from.spawn_shadow_ray(direction, length, target),
        }
    }

    /// Adds a leg, and multiplies by its transmittance unless its shadow ray does.
    fn push_leg(&self, legs: &mut BallLegs<'_>, ray: PathRay, is_inside: bool, length: f64) {
        legs.rays[legs.count] = Some((ray, is_inside));
        legs.count += 1;
        match legs.medium {
            Some(medium) if is_inside && !self.context.scene.has_straight_boundaries() => {
                legs.transmittance *= MediumStack::VACUUM.with(medium).transmittance(length);
            }
            _ => {}
        }
    }

    /// Adds the shadow rays along the legs to the queue.
    fn push_legs(
        &self,
        state: &PathState,
        legs: &BallLegs<'_>,
        radiance: Rgb,
        light: &PairLight<'_>,
        shadow_queue: &mut ShadowQueue<'_>,
    ) {
        let is_direct = state.is_light_sample_direct();
        let needs_media = self.context.scene.has_passable_surfaces();
        for (index, (ray, is_inside)) in legs.rays[..legs.count].iter().flatten().enumerate() {
            let has_more = index + 1 < legs.count;
            let batch_index = state.batch_index;
            let connection = light.number;
            let is_caught = false;
            let pending =
                PendingDirect { batch_index, radiance, is_direct, has_more, connection, is_caught };
            shadow_queue.shadow_rays.push(ray, pending);
            if needs_media {
                let medium = legs.medium.filter(|_| *is_inside);
                let vacuum = MediumStack::VACUUM;
                shadow_queue.media.push(medium.map_or(vacuum.clone(), |m| vacuum.with(m)));
            }
        }
    }
}

impl<'a> BallLegs<'a> {
    fn new(id: u32, ball: &'a Sphere) -> Self {
        let rays = [None; MAX_LEGS];
        Self { id, ball, medium: None, rays, count: 0, transmittance: Rgb::ONE }
    }

    /// Returns a point of the ball as a surface that a leg starts at.
    fn point(&self, point: DVec3, side: Side) -> SurfaceHit {
        let Sphere { center, radius } = *self.ball;
        SurfaceHit { id: self.id, t: 0.0, point, normal: (point - center) / radius, radius, side }
    }
}

/// Returns what the ball multiplies radiance by, and the probability with which chance goes
/// this way over the ball.
fn passage(
    surface: &SphereMaterial<'_>,
    kind: SpecularPath,
    connection: &Connection,
) -> (Rgb, f64) {
    let cos = connection.cos_outside.clamp(0.0, 1.0);
    if let Some(glass) = surface.material.dielectric() {
        let reflectance = fresnel(cos, glass.ior).reflectance;
        let share = kind.passage(reflectance);
        let kept = if fault!(ConnectionFresnelMissing) { 1.0 } else { share };
        let scale = match fault!(ConnectionEtaSquaredMissing) {
            true => 1.0,
            false => kind.radiance_scale(glass.ior),
        };
        return (Rgb::splat((kept * scale) as f32), share);
    }
    let bsdf = surface.material.bsdf(surface.albedo, 1.0, Hemisphere::Cosine);
    let wo = DVec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos);
    let reflected = bsdf.sample(wo, 0.0, [0.5; 2], &|| [0.5; 2]);
    (reflected.map_or(Rgb::ZERO, |sample| sample.weight), 1.0)
}
