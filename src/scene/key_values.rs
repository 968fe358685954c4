//! Converts a scene and its settings to a JSON tree under their scene file keys. Messages and
//! `photosphere info` use these keys.

mod camera;
mod section;

use serde_json::{Map, Value};

use crate::appearance::range_text;

use super::data::{FileColumn, SphereData};
use super::description::{
    BackgroundDescription, ColorSpace, ColorStorage, EnvironmentDescription, MaterialDescription,
    SceneDescription, SphereDescription, SphereTable, SunDescription,
};
use super::keys;
use super::particle_file::ParticleTable;
use super::settings::{
    ImageSettings, IntegratorSettings, PaperSettings, PathTermination, RenderSettings, Settings,
};
use super::validation_errors::quote_if_needed;

use section::Section;

impl SceneDescription {
    /// Values under their scene file keys: `camera.position`, `materials.grass.albedo`,
    /// `spheres.0.radius`. Material names are quoted as in a dotted key. Arrays in memory, which
    /// have no key, appear as the `file` of their table.
    pub fn to_keys(&self) -> Value {
        let Self { camera, background, materials, spheres, tables } = self;
        let name_of = |material: usize| materials.get(material).map(|m| m.name.as_str());
        let mut root = Section::default();
        root.add("camera", camera::of_camera(camera, self));
        root.add("background", of_background(background));
        let of_material =
            |m: &MaterialDescription| (quote_if_needed(&m.name), of_material(m).into());
        let surfaces: Map<String, Value> = materials.iter().map(of_material).collect();
        root.add("materials", surfaces);
        let of_sphere =
            |SphereDescription { name, center, radius, material, shadow_catcher }: &SphereDescription| {
                use keys::sphere as keys;
                let mut section = Section::default();
                section.set_if_given(&keys::NAME, name.as_ref());
                section.set(&keys::CENTER, center);
                section.set(&keys::RADIUS, radius);
                section.set_if_given(&keys::MATERIAL, name_of(*material));
                section.set_if_given(&keys::SHADOW_CATCHER, shadow_catcher.then_some(true));
                Value::from(section)
            };
        root.add("spheres", spheres.iter().map(of_sphere).collect::<Vec<_>>());
        let is_particles =
            |(_, table): &(usize, &SphereTable)| matches!(table.data, SphereData::Particles(_));
        let of_table = |(
            index,
            SphereTable { name: _, data, material, colors, color_space, offset },
        ): (_, &_)| {
            use keys::table as keys;
            let mut section = Section::default();
            section.set(&keys::NAME, self.name_of_table(index));
            let (file, columns) = file_and_columns(data);
            section.set(&keys::FILE, file);
            section.set(&keys::COLUMNS, columns);
            section.set_if_given(&keys::MATERIAL, name_of(*material));
            section.set_if_given(&keys::COLORS, data.has_colors().then_some(*colors));
            let has_space = data.has_colors() && *color_space != ColorSpace::default();
            section.set_if_given(&keys::COLOR_SPACE, has_space.then_some(*color_space));
            section.set(&keys::OFFSET, offset);
            if let SphereData::File { skip_rows, skip_bytes, .. } = data {
                section.set(&keys::SKIP_ROWS, skip_rows);
                section.set(&keys::SKIP_BYTES, skip_bytes);
            }
            Value::from(section)
        };
        let (particles, others): (Vec<_>, Vec<_>) =
            tables.iter().enumerate().partition(is_particles);
        root.add("sphere_tables", others.into_iter().map(of_table).collect::<Vec<_>>());
        let of_particles = |(index, table): (usize, &SphereTable)| {
            of_particles(table, self.name_of_table(index), name_of(table.material))
        };
        let particles: Vec<Value> = particles.into_iter().filter_map(of_particles).collect();
        if !particles.is_empty() {
            root.add("particles", particles);
        }
        root.into()
    }
}

impl Settings {
    /// Values under their scene file keys: `image.width`, `render.paper.subpixels`.
    pub fn to_keys(&self) -> Value {
        let Self { image, render } = self;
        let mut root = Section::default();
        root.add("image", of_image(image));
        root.add("render", of_render(render));
        root.into()
    }
}

fn of_background(background: &BackgroundDescription) -> Section {
    use keys::background as keys;
    let BackgroundDescription { dome, up, sun, camera_visible, transparent, backdrop } = background;
    let mut section = Section::default();
    section.set(&keys::UP, up);
    section.set_if_given(&keys::BACKDROP, *backdrop);
    section.set(&keys::CAMERA_VISIBLE, camera_visible);
    section.set(&keys::TRANSPARENT, transparent);
    let mut inner = Section::default();
    if let EnvironmentDescription::Image { file, .. } = dome {
        inner.set(&keys::image::FILE, file.display().to_string());
    }
    match dome.table() {
        None => dome.clone().visit_keys(&mut section),
        Some(name) => {
            dome.clone().visit_keys(&mut inner);
            section.add(name, inner);
        }
    }
    if let Some(SunDescription { direction, angular_diameter_degrees, irradiance }) = sun {
        let mut inner = Section::default();
        inner.set(&keys::sun::DIRECTION, direction);
        inner.set(&keys::sun::DIAMETER, angular_diameter_degrees);
        inner.set(&keys::sun::IRRADIANCE, irradiance);
        section.add("sun", inner);
    }
    section
}

fn of_material(material: &MaterialDescription) -> Section {
    use keys::material as keys;
    let MaterialDescription { name: _, surface, emission, opacity } = material;
    let mut section = Section::default();
    section.set(&keys::TYPE, surface.kind());
    { *surface }.visit_keys(&mut section);
    section.set(&keys::EMISSION, emission);
    section.set(&keys::OPACITY, opacity);
    section
}

impl SceneDescription {
    /// The keys of an entry of `[[particles]]` that are not left at their defaults, with their
    /// values as TOML; without file, name and material. Empty if there is no such entry.
    pub fn particle_keys(&self, index: usize) -> Vec<(String, String)> {
        let particles = |table: &&SphereTable| matches!(table.data, SphereData::Particles(_));
        let Some(table) = self.tables.iter().filter(particles).nth(index) else {
            return Vec::new();
        };
        let plain = SphereTable {
            data: SphereData::Particles(Box::default()),
            colors: ColorStorage::Packed,
            ..SphereTable::default()
        };
        let keys = |table| of_particles(table, String::new(), None).unwrap_or_default();
        let (given, usual) = (keys(table), keys(&plain));
        let entries = given.as_object().into_iter().flatten();
        let changed =
            entries.filter(|(key, value)| *key != "file" && usual.get(key) != Some(value));
        changed.map(|(key, value)| (key.clone(), value.to_string())).collect()
    }
}

/// The keys of `[[particles]]`; `None` for other tables.
fn of_particles(table: &SphereTable, name: String, material: Option<&str>) -> Option<Value> {
    use keys::particles as keys;
    let SphereData::Particles(particles) = &table.data else { return None };
    let ParticleTable { path, format, frame, columns, topology, appearance } = &**particles;
    let mut section = Section::default();
    section.set(&keys::NAME, name);
    section.set(&keys::FILE, path.display().to_string());
    section.set_if_given(&keys::MATERIAL, material);
    section.set(&keys::COLORS, table.colors);
    section.set_if_given(&keys::FORMAT, *format);
    section.set(&keys::FRAME, frame);
    section.set_if_given(&keys::COLUMNS, (!columns.is_empty()).then(|| columns.join(",")));
    let topology = topology.as_ref().map(|file| file.display().to_string());
    section.set_if_given(&keys::TOPOLOGY, topology);
    section.set(&keys::RADIUS, appearance.radius.to_string());
    section.set(&keys::COLOR, appearance.color.to_string());
    section.set(&keys::RANGE, range_text(&appearance.range));
    section.set(&keys::REPLICATE, appearance.replicate);
    keys::visit_keys(&mut appearance.clone(), &mut section);
    Some(section.into())
}

/// File and columns of a table.
fn file_and_columns(data: &SphereData) -> (String, Vec<FileColumn>) {
    match data {
        SphereData::File { path, columns, .. } => (path.display().to_string(), columns.clone()),
        SphereData::Particles(particles) => (particles.path.display().to_string(), Vec::new()),
        SphereData::Memory(arrays) => {
            let columns = arrays.columns().map(|(column, _)| column.into()).collect();
            (format!("{} spheres in memory", arrays.len()), columns)
        }
    }
}

fn of_image(image: &ImageSettings) -> Section {
    use keys::image as keys;
    let ImageSettings { width, height, crop, filter, filter_radius } = image;
    let mut section = Section::default();
    section.set(&keys::WIDTH, width);
    section.set(&keys::HEIGHT, height);
    section.set_if_given(&keys::CROP, crop.map(|crop| crop.corners()));
    section.set(&keys::FILTER, filter);
    section.set(&keys::FILTER_RADIUS, filter_radius);
    section
}

fn of_render(render: &RenderSettings) -> Section {
    use keys::render as keys;
    let RenderSettings { integrator, estimator, samples_per_pixel, seed, sampler, .. } = render;
    let mut section = Section::default();
    section.set(&keys::INTEGRATOR, integrator.kind());
    section.set(&keys::ESTIMATOR, estimator);
    section.set(&keys::SAMPLER, sampler);
    section.set(&keys::SAMPLES, samples_per_pixel);
    section.set(&keys::SEED, seed);
    { *render }.visit_keys(&mut section);
    let mut inner = Section::default();
    match integrator {
        IntegratorSettings::AmbientOcclusion { distance } => {
            inner.set_if_given(&keys::ambient_occlusion::DISTANCE, *distance);
            section.add("ambient_occlusion", inner);
        }
        IntegratorSettings::Paper(paper) => section.add("paper", of_paper(paper)),
        IntegratorSettings::Raycast { shadows } => {
            inner.set(&keys::raycast::SHADOWS, shadows);
            section.add("raycast", inner);
        }
        IntegratorSettings::Path | IntegratorSettings::Direct | IntegratorSettings::Normals => {}
    }
    section
}

fn of_paper(paper: &PaperSettings) -> Section {
    use keys::render::paper as keys;
    let PaperSettings { subpixels, samples, hemisphere, stop, miss, jitter } = paper;
    let mut section = Section::default();
    section.set(&keys::SUBPIXELS, subpixels);
    section.set(&keys::SAMPLES, samples);
    section.set(&keys::HEMISPHERE, hemisphere);
    section.set(&keys::STOP, stop.kind());
    if let PathTermination::Threshold(threshold) = stop {
        section.set(&keys::THRESHOLD, threshold);
    }
    section.set(&keys::MISS, miss);
    section.set(&keys::JITTER, jitter);
    section
}
