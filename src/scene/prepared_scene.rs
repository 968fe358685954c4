//! A scene prepared for one job: camera, pixel filter and light sampler for its settings. Spheres
//! and materials are shared with the scene, so several shots cost little more than one.

use rayon::prelude::*;

use crate::camera::Camera;
use crate::error::{Error, Result};
use crate::geometry::Sphere;
use crate::light::specular::PairSampler;
use crate::light::{Enclosure, Lights};
use crate::material::{Medium, Model};
use crate::math::{DVec3, MAX_COORDINATE};
use crate::sampling::Filter;

use super::casters::find_pairs;
use super::description::{self, CameraDescription};
use super::light_trap::LightTrap;
use super::scene::Scene;
use super::settings::{ImageSettings, IntegratorSettings, RenderSettings, Settings};

/// Balls around the camera that are examined; there is seldom more than one.
const MAX_LIGHT_TRAPS: usize = 8;

/// A scene, ready to be rendered with certain settings.
#[derive(Debug)]
pub struct PreparedScene {
    scene: Scene,
    settings: Settings,
    lights: Lights,
    connections: Option<PairSampler>,
    camera_description: CameraDescription,
    camera: Camera,
    filter: Filter,
    /// The dielectric spheres in which a camera ray can start, largest first.
    camera_media: Vec<(Sphere, Medium)>,
    light_traps: Vec<LightTrap>,
}

impl PreparedScene {
    /// Prepares a scene for these settings.
    ///
    /// # Errors
    /// If the settings are invalid, the camera cannot be [placed](Scene::camera), or camera rays
    /// start out of reach.
    pub fn new(scene: &Scene, settings: Settings) -> Result<Self> {
        settings.validate().into_result()?;
        let ImageSettings { filter, filter_radius, .. } = settings.image;
        let camera_description = scene.camera(&settings.image)?;
        let camera = camera_description.build(&settings.image, scene.spheres().origin());
        check_reach(&camera, filter_radius)?;
        let enclosures = find_enclosures(scene, &camera, filter_radius);
        let lights = scene.lights(settings.render.light_choice, &enclosures);
        let connections = find_pairs(scene, &lights, &settings.render);
        let around_camera = find_camera_media(scene, &camera, filter_radius);
        let filter = Filter::new(filter, filter_radius);
        Ok(Self {
            scene: scene.clone(),
            settings,
            lights,
            connections,
            camera_description,
            camera,
            filter,
            light_traps: find_light_traps(scene, &around_camera),
            camera_media: around_camera,
        })
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The description from which the scene was built.
    pub fn description(&self) -> &description::SceneDescription {
        self.scene.description()
    }

    /// The image settings.
    pub fn image_settings(&self) -> &ImageSettings {
        &self.settings.image
    }

    /// The render settings.
    pub fn render_settings(&self) -> &RenderSettings {
        &self.settings.render
    }

    /// All settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Sets the random seed. Nothing else depends on it.
    pub fn set_seed(&mut self, seed: u64) {
        self.settings.render.seed = seed;
    }

    /// The light sampler over all emitters.
    pub fn lights(&self) -> &Lights {
        &self.lights
    }

    /// The pairs of a polished ball and a light that paths are connected over, if there are any and
    /// the settings ask for it.
    pub fn connections(&self) -> Option<&PairSampler> {
        self.connections.as_ref()
    }

    /// The camera's position, focus and projection, in the user's coordinates.
    pub fn camera_description(&self) -> &CameraDescription {
        &self.camera_description
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// The pixel filter.
    pub fn filter(&self) -> &Filter {
        &self.filter
    }

    /// The largest radiance emitted in the scene, over all channels; 1 for integrators that do not
    /// compute radiance.
    pub fn max_radiance(&self) -> f32 {
        match self.settings.render.integrator {
            IntegratorSettings::AmbientOcclusion { .. } | IntegratorSettings::Normals => 1.0,
            _ => self.scene.max_radiance(),
        }
    }

    /// The media at a camera ray's origin, in the order in which they are entered.
    pub fn media_at(&self, point: DVec3) -> impl Iterator<Item = Medium> + '_ {
        let containing = self.camera_media.iter().filter(move |(sphere, _)| sphere.contains(point));
        containing.map(|&(_, medium)| medium)
    }

    /// Returns true if light that a sphere totally reflects from inside, at this point and into
    /// this unit direction, is known to hit nothing but that sphere ever after, and so to find no
    /// light. `count` is the number of total reflections in succession, with this one.
    pub fn is_light_trapped(
        &self,
        sphere: u32,
        point: DVec3,
        direction: DVec3,
        count: u16,
    ) -> bool {
        self.light_traps.iter().any(|trap| trap.holds(sphere, point, direction, count))
    }
}

/// Checks the range of ray origins. Backends take coordinates up to four times [`MAX_COORDINATE`],
/// and moving the origin may have used up two of them.
fn check_reach(camera: &Camera, margin: f64) -> Result<()> {
    let is_near = camera.max_origin_distance(margin) <= 2.0 * MAX_COORDINATE
        && camera.max_start_distance(margin) <= 4.0 * MAX_COORDINATE;
    let message = "`camera.near` puts the start of some camera rays out of reach";
    let help = "lower `near`, or narrow the view";
    if is_near { Ok(()) } else { Err(Error::input(message).with_help(help)) }
}

fn find_camera_media(scene: &Scene, camera: &Camera, margin: f64) -> Vec<(Sphere, Medium)> {
    if !scene.has_media() {
        return Vec::new();
    }
    let around = |id| {
        let medium = scene.sphere_material(id).medium(id)?;
        let sphere = scene.spheres().sphere(id);
        camera.may_start_inside(&sphere, margin).then_some((sphere, medium))
    };
    let mut found: Vec<_> =
        (0..scene.spheres().len() as u32).into_par_iter().filter_map(around).collect();
    found.sort_by(|(a, _), (b, _)| b.radius.total_cmp(&a.radius));
    found
}

/// Finds the opaque spheres in which camera rays may start. They matter only where there are
/// emitters.
fn find_enclosures(scene: &Scene, camera: &Camera, margin: f64) -> Vec<Enclosure> {
    if scene.emitter_count() == 0 {
        return Vec::new();
    }
    let around = |id| {
        let sphere = scene.spheres().sphere(id);
        let is_around = camera.may_start_inside(&sphere, margin);
        let is_certain = is_around && camera.must_start_inside(&sphere, margin);
        let is_enclosure = is_around && scene.sphere_material(id).is_opaque();
        is_enclosure.then_some(Enclosure { id, is_certain })
    };
    (0..scene.spheres().len() as u32).into_par_iter().filter_map(around).collect()
}

fn find_light_traps(scene: &Scene, camera_media: &[(Sphere, Medium)]) -> Vec<LightTrap> {
    let is_dark_and_smooth = |id| {
        let material = scene.sphere_material(id).material;
        let is_smooth = matches!(&material.model, Model::Dielectric(glass) if glass.is_smooth());
        is_smooth && !material.is_emissive()
    };
    // Of all media that may be on either side of the surface.
    let smallest_ior = scene.iors().fold(1.0, f64::min);
    let largest_ior = scene.iors().fold(1.0, f64::max);
    let smooth = camera_media.iter().filter(|(_, medium)| is_dark_and_smooth(medium.sphere));
    let trap = |(_, medium): &(Sphere, Medium)| {
        LightTrap::new(scene.spheres(), medium.sphere, smallest_ior / largest_ior)
    };
    smooth.take(MAX_LIGHT_TRAPS).filter_map(trap).collect()
}

/// An opaque sphere around the camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CameraEnclosure {
    /// Id of the sphere.
    pub sphere: u32,
    /// True if no other surface reaches into it, so that the camera sees only its inner wall.
    pub is_empty: bool,
}

impl CameraEnclosure {
    /// Finds the smallest opaque sphere in which the ray through the centre of the picture starts.
    pub fn find(scene: &Scene, image: &ImageSettings) -> Option<Self> {
        let spheres = scene.spheres();
        let camera = scene.camera(image).ok()?.build(image, spheres.origin());
        let [x, y] = [image.width, image.height].map(|pixels| 0.5 * f64::from(pixels));
        let ray = camera.generate_ray(x, y, [0.5; 2]);
        let start = ray.at(ray.t_min);
        let ids = || (0..spheres.len() as u32).into_par_iter();
        let around = ids()
            .filter(|&id| spheres.sphere(id).contains(start))
            .filter(|&id| scene.sphere_material(id).is_opaque())
            .min_by(|a, b| spheres.sphere(*a).radius.total_cmp(&spheres.sphere(*b).radius))?;
        let wall = spheres.sphere(around);
        let reaches_in = |id: u32| {
            let Sphere { center, radius } = spheres.sphere(id);
            id != around && (center.distance(wall.center) - radius).abs() < wall.radius
        };
        Some(Self { sphere: around, is_empty: !ids().any(reaches_in) })
    }
}
