//! The values of a scene and its settings under the keys that a scene file has for them, as a tree of
//! JSON. Messages and `photosphere info` name values by these keys.

use serde::Serialize;
use serde_json::{Map, Value};

use super::data::{Column, SphereData};
use super::description::{
    Background, Camera, Description, Dome, Lens, NamedMaterial, Projection, SphereRow, SphereTable,
    Sun, Surface,
};
use super::keys::{self, Key};
use super::problem::quoted_where_needed;
use super::settings::{Image, Integrator, Paper, Render, Settings, Stop};

/// One table of a scene file.
#[derive(Default)]
struct Section(Map<String, Value>);

impl Section {
    fn set<K>(&mut self, key: &Key<K>, value: impl Serialize) {
        let value = serde_json::to_value(value).expect("plain values are JSON");
        self.0.insert(key.name.to_owned(), value);
    }

    fn set_if_given<K>(&mut self, key: &Key<K>, value: Option<impl Serialize>) {
        if let Some(value) = value {
            self.set(key, value);
        }
    }

    fn add(&mut self, name: &str, inner: impl Into<Value>) {
        self.0.insert(name.to_owned(), inner.into());
    }
}

impl From<Section> for Value {
    fn from(Section(entries): Section) -> Self {
        Self::Object(entries)
    }
}

impl Description {
    /// The values under the keys of a scene file: `camera.position`, `materials.grass.albedo`,
    /// `spheres.0.radius`. Materials are quoted as in a dotted key. Arrays in memory, for which there is
    /// no key, are told as the `file` of their table.
    pub fn to_keys(&self) -> Value {
        let Self { camera, background, materials, spheres, tables } = self;
        let name_of = |material: usize| materials.get(material).map(|m| m.name.as_str());
        let mut root = Section::default();
        root.add("camera", of_camera(camera));
        root.add("background", of_background(background));
        let of_material = |m: &NamedMaterial| (quoted_where_needed(&m.name), of_material(m).into());
        let surfaces: Map<String, Value> = materials.iter().map(of_material).collect();
        root.add("materials", surfaces);
        let of_sphere = |SphereRow { name, center, radius, material }: &SphereRow| {
            use keys::sphere as keys;
            let mut section = Section::default();
            section.set_if_given(&keys::NAME, name.as_ref());
            section.set(&keys::CENTER, center);
            section.set(&keys::RADIUS, radius);
            section.set_if_given(&keys::MATERIAL, name_of(*material));
            Value::from(section)
        };
        root.add("spheres", spheres.iter().map(of_sphere).collect::<Vec<_>>());
        let of_table = |(index, SphereTable { name: _, data, material, colors }): (_, &_)| {
            use keys::table as keys;
            let mut section = Section::default();
            section.set(&keys::NAME, self.name_of_table(index));
            let (file, columns) = told(data);
            section.set(&keys::FILE, file);
            section.set(&keys::COLUMNS, columns);
            section.set_if_given(&keys::MATERIAL, name_of(*material));
            section.set_if_given(&keys::COLORS, data.has_colors().then_some(*colors));
            Value::from(section)
        };
        root.add("sphere_tables", tables.iter().enumerate().map(of_table).collect::<Vec<_>>());
        root.into()
    }
}

impl Settings {
    /// The values under the keys of a scene file: `image.width`, `render.paper.subpixels`.
    pub fn to_keys(&self) -> Value {
        let Self { image, render } = self;
        let mut root = Section::default();
        root.add("image", of_image(image));
        root.add("render", of_render(render));
        root.into()
    }
}

fn of_camera(camera: &Camera) -> Section {
    use keys::camera as keys;
    let Camera { position, look_at, up, near, projection } = camera;
    let mut section = Section::default();
    section.set(&keys::TYPE, projection.kind());
    section.set(&keys::POSITION, position);
    section.set(&keys::LOOK_AT, look_at);
    section.set(&keys::UP, up);
    section.set(&keys::NEAR, near);
    match projection {
        Projection::Perspective { vertical_fov_degrees, lens } => {
            section.set(&keys::perspective::FOV, vertical_fov_degrees);
            if let Some(Lens { radius, focus_distance, blades, rotation_degrees }) = lens {
                section.set(&keys::perspective::APERTURE_RADIUS, radius);
                section.set(&keys::perspective::FOCUS_DISTANCE, focus_distance);
                section.set(&keys::perspective::BLADES, blades);
                section.set(&keys::perspective::ROTATION, rotation_degrees);
            }
        }
        Projection::Orthographic { height } => section.set(&keys::orthographic::HEIGHT, height),
        Projection::Panoramic { horizontal_degrees, vertical_degrees } => {
            section.set(&keys::panoramic::HORIZONTAL, horizontal_degrees);
            section.set(&keys::panoramic::VERTICAL, vertical_degrees);
        }
    }
    section
}

fn of_background(background: &Background) -> Section {
    use keys::background as keys;
    let Background { dome, up, sun, camera_visible, transparent } = background;
    let mut section = Section::default();
    section.set(&keys::UP, up);
    section.set(&keys::CAMERA_VISIBLE, camera_visible);
    section.set(&keys::TRANSPARENT, transparent);
    let mut inner = Section::default();
    match dome {
        Dome::Constant { radiance } => section.set(&keys::RADIANCE_EVERYWHERE, radiance),
        Dome::Gradient { zenith, horizon, nadir } => {
            inner.set(&keys::gradient::ZENITH, zenith);
            inner.set(&keys::gradient::HORIZON, horizon);
            inner.set(&keys::gradient::NADIR, nadir);
            section.add("gradient", inner);
        }
        Dome::Image { file, rotation_degrees, scale } => {
            inner.set(&keys::image::FILE, file.display().to_string());
            inner.set(&keys::image::ROTATION, rotation_degrees);
            inner.set(&keys::image::FACTOR, scale);
            section.add("image", inner);
        }
        Dome::Sky { turbidity, ground_albedo, scale } => {
            inner.set(&keys::sky::TURBIDITY, turbidity);
            inner.set(&keys::sky::GROUND_ALBEDO, ground_albedo);
            inner.set(&keys::sky::FACTOR, scale);
            section.add("sky", inner);
        }
    }
    if let Some(Sun { direction, angular_diameter_degrees, irradiance }) = sun {
        let mut inner = Section::default();
        inner.set(&keys::sun::DIRECTION, direction);
        inner.set(&keys::sun::DIAMETER, angular_diameter_degrees);
        inner.set(&keys::sun::IRRADIANCE, irradiance);
        section.add("sun", inner);
    }
    section
}

fn of_material(material: &NamedMaterial) -> Section {
    use keys::material as keys;
    let NamedMaterial { name: _, surface, emission, opacity } = material;
    let mut section = Section::default();
    section.set(&keys::TYPE, surface.kind());
    match surface {
        Surface::Diffuse { albedo, roughness } => {
            section.set(&keys::diffuse::ALBEDO, albedo);
            section.set(&keys::diffuse::ROUGHNESS, roughness);
        }
        Surface::Mirror { reflectance } => section.set(&keys::mirror::REFLECTANCE, reflectance),
        Surface::Conductor { metal, roughness } => {
            section.set(&keys::conductor::IOR, metal.ior);
            section.set(&keys::conductor::EXTINCTION, metal.extinction);
            section.set(&keys::conductor::ROUGHNESS, roughness);
        }
        Surface::Dielectric { ior, roughness, priority, absorption } => {
            section.set(&keys::dielectric::IOR, ior);
            section.set(&keys::dielectric::ROUGHNESS, roughness);
            section.set(&keys::dielectric::PRIORITY, priority);
            section.set(&keys::dielectric::ABSORPTION, absorption);
        }
        Surface::Plastic { albedo, ior, roughness } => {
            section.set(&keys::plastic::ALBEDO, albedo);
            section.set(&keys::plastic::IOR, ior);
            section.set(&keys::plastic::ROUGHNESS, roughness);
        }
        Surface::Principled(parameters) => {
            use keys::principled as keys;
            section.set(&keys::BASE_COLOR, parameters.base_color);
            section.set(&keys::METALLIC, parameters.metallic);
            section.set(&keys::ROUGHNESS, parameters.roughness);
            section.set(&keys::SPECULAR, parameters.specular);
            section.set(&keys::IOR, parameters.ior);
            section.set(&keys::COAT, parameters.coat);
            section.set(&keys::COAT_ROUGHNESS, parameters.coat_roughness);
            section.set(&keys::TRANSMISSION, parameters.transmission);
        }
        Surface::Phong { albedo, specular, exponent, normalized } => {
            section.set(&keys::phong::ALBEDO, albedo);
            section.set(&keys::phong::SPECULAR, specular);
            section.set(&keys::phong::EXPONENT, exponent);
            section.set(&keys::phong::NORMALIZED, normalized);
        }
    }
    section.set(&keys::EMISSION, emission);
    section.set(&keys::OPACITY, opacity);
    section
}

/// The file and the columns of a table.
fn told(data: &SphereData) -> (String, Vec<Column>) {
    match data {
        SphereData::File { path, columns } => (path.display().to_string(), columns.clone()),
        SphereData::Memory(arrays) => {
            let columns = arrays.columns().map(|(column, _)| column).collect();
            (format!("{} spheres in memory", arrays.len()), columns)
        }
    }
}

fn of_image(image: &Image) -> Section {
    use keys::image as keys;
    let Image { width, height, crop, filter, filter_radius } = image;
    let mut section = Section::default();
    section.set(&keys::WIDTH, width);
    section.set(&keys::HEIGHT, height);
    section.set_if_given(&keys::CROP, crop.map(|crop| crop.corners()));
    section.set(&keys::FILTER, filter);
    section.set(&keys::FILTER_RADIUS, filter_radius);
    section
}

fn of_render(render: &Render) -> Section {
    use keys::render as keys;
    let Render {
        integrator,
        estimator,
        samples_per_pixel,
        max_depth,
        clamp_indirect,
        seed,
        sampler,
        light_choice,
    } = render;
    let mut section = Section::default();
    section.set(&keys::INTEGRATOR, integrator.kind());
    section.set(&keys::ESTIMATOR, estimator);
    section.set(&keys::SAMPLER, sampler);
    section.set(&keys::SAMPLES, samples_per_pixel);
    section.set(&keys::SEED, seed);
    section.set_if_given(&keys::MAX_DEPTH, *max_depth);
    section.set_if_given(&keys::CLAMP_INDIRECT, *clamp_indirect);
    section.set(&keys::LIGHT_CHOICE, light_choice);
    let mut inner = Section::default();
    match integrator {
        Integrator::AmbientOcclusion { distance } => {
            inner.set_if_given(&keys::ambient_occlusion::DISTANCE, *distance);
            section.add("ambient_occlusion", inner);
        }
        Integrator::Paper(paper) => section.add("paper", of_paper(paper)),
        Integrator::Raycast { shadows } => {
            inner.set(&keys::raycast::SHADOWS, shadows);
            section.add("raycast", inner);
        }
        Integrator::Path | Integrator::Direct | Integrator::Normals => {}
    }
    section
}

fn of_paper(paper: &Paper) -> Section {
    use keys::render::paper as keys;
    let Paper { subpixels, samples, hemisphere, stop, miss, jitter } = paper;
    let mut section = Section::default();
    section.set(&keys::SUBPIXELS, subpixels);
    section.set(&keys::SAMPLES, samples);
    section.set(&keys::HEMISPHERE, hemisphere);
    section.set(&keys::STOP, stop.kind());
    if let Stop::Threshold(threshold) = stop {
        section.set(&keys::THRESHOLD, threshold);
    }
    section.set(&keys::MISS, miss);
    section.set(&keys::JITTER, jitter);
    section
}
