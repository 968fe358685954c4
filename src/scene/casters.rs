//! Finds the balls of a scene over which specular connections are made.

use rayon::prelude::*;

use crate::color::luminance;
use crate::light::Lights;
use crate::light::specular::{Caster, CasterSurface, Casters, PairSampler};
use crate::material::Model;
use crate::math::DVec3;
use crate::sampling::Hemisphere;

use super::scene::Scene;
use super::settings::{Caustics, Estimator, IntegratorSettings, RenderSettings};
use super::sphere_material::Surface;

/// More balls than this are left to chance: of so many, one chosen ball brings little light.
const MAX_CASTERS: usize = 1 << 20;

/// Glass whose index of refraction is nearer to 1 hardly bends light: left to chance.
const MIN_INDEX_DIFFERENCE: f64 = 0.01;

/// Returns the pairs to connect, if the settings ask for connections and the scene has any pair.
pub(super) fn find_pairs(
    scene: &Scene,
    lights: &Lights,
    render: &RenderSettings,
) -> Option<PairSampler> {
    let follows_paths =
        matches!(render.integrator, IntegratorSettings::Path | IntegratorSettings::Direct);
    let is_wanted = render.caustics == Caustics::Connect && render.estimator != Estimator::Bsdf;
    if !follows_paths || !is_wanted || !lights.may_connect() {
        return None;
    }
    let candidates = find_candidates(scene);
    if candidates.is_empty() {
        return None;
    }
    let spheres = scene.spheres();
    let has_medium = |&id: &u32| scene.sphere_material(id).medium(id).is_some();
    let dielectrics: Vec<u32> = match scene.has_media() {
        true => (0..spheres.len() as u32).into_par_iter().filter(has_medium).collect(),
        false => Vec::new(),
    };
    let casters = Casters::find(&candidates, &dielectrics, spheres);
    let is_certain = render.estimator == Estimator::Light;
    (!casters.is_empty()).then(|| lights.pairs_with(casters, spheres, is_certain))
}

fn find_candidates(scene: &Scene) -> Vec<Caster> {
    let may_be = |model: &Model| surface_of(model).is_some();
    if !scene.materials().iter().any(|material| may_be(&material.model)) {
        return Vec::new();
    }
    let spheres = scene.spheres();
    let is_candidate = |&id: &u32| {
        let material = scene.surface(id).material;
        material.opacity >= 1.0 && may_be(&material.model)
    };
    let ids = || (0..spheres.len() as u32).into_par_iter().filter(is_candidate);
    if ids().count() > MAX_CASTERS {
        return Vec::new();
    }
    let caster = |id| {
        let Surface { material, color, .. } = scene.surface(id);
        let surface = match surface_of(&material.model)? {
            // The sphere's own colour counts.
            CasterSurface::Opaque(_) => {
                let bsdf = material.bsdf(color, 1.0, Hemisphere::Cosine);
                let reflected = bsdf.sample(DVec3::Z, 0.0, [0.5; 2], &|| [0.5; 2])?;
                CasterSurface::Opaque(f64::from(luminance(reflected.weight)))
            }
            glass => glass,
        };
        let is_dark = surface == CasterSurface::Opaque(0.0);
        (!is_dark).then(|| Caster { id, ball: spheres.sphere(id), surface })
    };
    ids().filter_map(caster).collect()
}

/// Returns what a polished surface does with light, without its colour; `None` for others.
fn surface_of(model: &Model) -> Option<CasterSurface> {
    match model {
        Model::Mirror(_) => Some(CasterSurface::Opaque(1.0)),
        Model::Conductor(metal) if metal.is_smooth() => Some(CasterSurface::Opaque(1.0)),
        Model::Dielectric(glass)
            if glass.is_smooth() && (glass.ior - 1.0).abs() >= MIN_INDEX_DIFFERENCE =>
        {
            Some(CasterSurface::Dielectric(glass.ior))
        }
        _ => None,
    }
}
