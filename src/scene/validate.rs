//! Validates a scene description and settings: each value within its limits, and all values
//! together.

mod camera;

use crate::math::{DVec3, MAX_COORDINATE, NO_SPHERE, Rect};

use super::data::{Column, FileColumn, SphereArrays, SphereData, StridedArray};
use super::description::{
    BackgroundDescription, EnvironmentDescription, MaterialDescription, SceneDescription,
    SphereDescription, SphereTable, SunDescription,
};
use super::keys::{self, Key, KeyVisitor};
use super::settings::{
    ImageSettings, IntegratorSettings, PathTermination, RenderSettings, Settings,
};
use super::surface::{AddedShares, SHARE_ROUNDING};
use super::table_path::table_path;
use super::validation_errors::{KeyPath, ValidationErrors};
use super::value_types::ValueType;

/// Maximum number of pixels of a picture.
const MAX_PIXELS: u64 = 1 << 31;

/// Index that marks a material of another [`SceneBuilder`](super::SceneBuilder).
pub(super) const FOREIGN_MATERIAL: usize = usize::MAX;

/// Checks the values of the keys of one table.
struct Checker<'a> {
    table: &'a KeyPath,
    problems: &'a mut ValidationErrors,
}

impl KeyVisitor for Checker<'_> {
    fn visit<K: ValueType>(&mut self, key: &'static Key<K>, value: &mut K::Output) {
        self.problems.check(self.table, key, value);
    }

    fn visit_option<K: ValueType>(&mut self, key: &'static Key<K>, value: &mut Option<K::Output>) {
        if let Some(value) = value {
            self.problems.check(self.table, key, value);
        }
    }
}

impl SceneDescription {
    /// Validates the description, without examining files.
    pub(super) fn validate(&self) -> ValidationErrors {
        let Self { camera: _, background, materials, spheres, tables } = self;
        let mut problems = ValidationErrors::default();
        camera::check_camera(self, &mut problems);
        check_background(background, &mut problems);
        check_names(materials, &mut problems);
        for material in materials {
            check_material(material, &mut problems);
        }
        for (index, sphere) in spheres.iter().enumerate() {
            check_sphere(index, sphere, materials.len(), &mut problems);
        }
        for (index, table) in tables.iter().enumerate() {
            check_table(table_path(tables, index), table, materials.len(), &mut problems);
        }
        if spheres.is_empty() && tables.is_empty() {
            let problem = problems.add(KeyPath::root("spheres"), "the scene has no spheres");
            problem
                .with_related(KeyPath::root("sphere_tables"))
                .with_related(KeyPath::root("particles"))
                .with_help("add a sphere or a table of spheres".to_owned());
        }
        problems
    }
}

impl Settings {
    /// Validates the settings.
    ///
    /// # Errors
    /// Reports all problems.
    pub(crate) fn check(&self) -> crate::error::Result<()> {
        self.validate().into_result()
    }

    /// Collects the problems of the settings.
    pub(super) fn validate(&self) -> ValidationErrors {
        let mut problems = ValidationErrors::default();
        check_image(&self.image, &mut problems);
        check_render(&self.render, &mut problems);
        problems
    }
}

/// Message for an invalid crop.
pub(super) fn crop_error(width: u32, height: u32) -> String {
    format!("`image.crop` must be [x0, y0, x1, y1] with x0 < x1 <= {width} and y0 < y1 <= {height}")
}

fn check_image(image: &ImageSettings, problems: &mut ValidationErrors) {
    let ImageSettings { width, height, crop, filter: _, filter_radius } = image;
    let at = KeyPath::root("image");
    problems.check(&at, &keys::image::WIDTH, width);
    problems.check(&at, &keys::image::HEIGHT, height);
    problems.check(&at, &keys::image::FILTER_RADIUS, filter_radius);
    if u64::from(*width) * u64::from(*height) > MAX_PIXELS {
        let message = format!("{width} x {height} pixels are more than 2^31");
        problems.add(at.key("height"), message).with_related(at.key("width"));
    }
    let is_within = |crop: &Rect| {
        let ends = |first: u32, length: u32, all: u32| {
            length > 0 && u64::from(first) + u64::from(length) <= u64::from(all)
        };
        ends(crop.x, crop.width, *width) && ends(crop.y, crop.height, *height)
    };
    if !crop.as_ref().is_none_or(is_within) {
        let problem = problems.add(at.key("crop"), crop_error(*width, *height));
        problem.with_related(at.key("width")).with_related(at.key("height"));
    }
}

fn check_render(render: &RenderSettings, problems: &mut ValidationErrors) {
    let RenderSettings { integrator, samples_per_pixel, max_depth, seed, .. } = render;
    let at = KeyPath::root("render");
    problems.check(&at, &keys::render::SAMPLES, samples_per_pixel);
    { *render }.visit_keys(&mut Checker { table: &at, problems });
    if i64::try_from(*seed).is_err() {
        let message =
            format!("`render.seed` must be a whole number from 0 to 2^63 - 1, not {seed}");
        problems.add(at.key("seed"), message);
    }
    match integrator {
        IntegratorSettings::AmbientOcclusion { distance: Some(distance) } => {
            let at = at.key("ambient_occlusion");
            problems.check(&at, &keys::render::ambient_occlusion::DISTANCE, distance);
        }
        IntegratorSettings::Paper(paper) => {
            let of_paper = at.key("paper");
            problems.check(&of_paper, &keys::render::paper::SUBPIXELS, &paper.subpixels);
            problems.check(&of_paper, &keys::render::paper::SAMPLES, &paper.samples);
            problems.check(&of_paper, &keys::render::paper::JITTER, &paper.jitter);
            if let PathTermination::Threshold(threshold) = &paper.stop {
                problems.check(&of_paper, &keys::render::paper::THRESHOLD, threshold);
            }
            if paper.stop == PathTermination::Depth && max_depth.is_none() {
                let message = "`render.paper.stop = \"depth\"` needs `render.max_depth`";
                let problem =
                    problems.add(of_paper.key("stop"), message).with_related(at.key("max_depth"));
                problem.with_help("add `max_depth = 6` to `[render]`".to_owned());
            }
            let total = paper.samples_per_pixel();
            if total != u64::from(*samples_per_pixel) {
                let (k, n) = (paper.subpixels, paper.samples);
                let message = format!(
                    "`render.samples_per_pixel` is {samples_per_pixel}, but {k} x {k} sub-pixels of \
                     {n} samples make {total}"
                );
                let problem = problems.add(at.key("samples_per_pixel"), message);
                problem
                    .with_related(of_paper.key("samples"))
                    .with_related(of_paper.key("subpixels"));
            }
        }
        _ => {}
    }
}

fn check_background(background: &BackgroundDescription, problems: &mut ValidationErrors) {
    use keys::background as keys;
    let BackgroundDescription { dome, up, sun, camera_visible, transparent, backdrop } = background;
    let at = KeyPath::root("background");
    if !is_unit(*up) {
        problems.add(at.key("up"), format!("`background.up` must be a unit vector, not {up}"));
    }
    let table = dome.table().map_or(at.clone(), |name| at.key(name));
    dome.clone().visit_keys(&mut Checker { table: &table, problems });
    if matches!(dome, EnvironmentDescription::Sky { .. }) {
        check_sky_sun(&at, background, problems);
    }
    if let Some(SunDescription { direction, angular_diameter_degrees, irradiance }) = sun {
        let at = at.key("sun");
        if !is_unit(*direction) {
            let message =
                format!("`background.sun.direction` must be a unit vector, not {direction}");
            problems.add(at.key("direction"), message);
        }
        problems.check(&at, &keys::sun::DIAMETER, angular_diameter_degrees);
        problems.check(&at, &keys::sun::IRRADIANCE, irradiance);
    }
    if let Some(backdrop) = backdrop {
        problems.check(&at, &keys::BACKDROP, backdrop);
    }
    if *transparent && *camera_visible {
        let message = "`background.camera_visible` is true, but `background.transparent` leaves the \
                       background out of the picture";
        let problem = problems.add(at.key("camera_visible"), message);
        problem.with_related(at.key("transparent")).with_help("remove one of them".to_owned());
    }
}

fn check_sky_sun(
    at: &KeyPath,
    background: &BackgroundDescription,
    problems: &mut ValidationErrors,
) {
    match &background.sun {
        None => {
            let message = "`background.sky` needs `[background.sun]` for the direction of the sun";
            let problem = problems.add(at.key("sky"), message).with_related(at.key("sun"));
            problem.with_help("an irradiance of [0, 0, 0] hides the sun itself".to_owned());
        }
        Some(sun) if sun.direction.dot(background.up) <= 0.0 => {
            let problem =
                problems.add(at.key("sun"), "`background.sky` needs a sun above the horizon");
            for key in ["direction", "elevation_degrees", "azimuth_degrees"] {
                problem.with_related(at.key("sun").key(key));
            }
        }
        Some(_) => {}
    }
}

/// Checks that material names are unique.
fn check_names(materials: &[MaterialDescription], problems: &mut ValidationErrors) {
    let mut names = std::collections::BTreeSet::new();
    let at = KeyPath::root("materials");
    for (index, MaterialDescription { name, .. }) in materials.iter().enumerate() {
        if !names.insert(name) {
            problems.add(at.key(name), format!("two materials are named {name:?}"));
        }
        if name.contains('\0') {
            problems.add(at.key(name), format!("the name of material {index} has a zero byte"));
        }
    }
}

fn check_material(material: &MaterialDescription, problems: &mut ValidationErrors) {
    let MaterialDescription { name, surface, emission, opacity } = material;
    let at = KeyPath::root("materials").key(name);
    problems.check(&at, &keys::material::EMISSION, emission);
    problems.check(&at, &keys::material::OPACITY, opacity);
    { *surface }.visit_keys(&mut Checker { table: &at, problems });
    if let Some(shares) = surface.added_shares() {
        check_energy(&at, &shares, problems);
    }
}

fn is_unit(v: DVec3) -> bool {
    (v.length_squared() - 1.0).abs() < 1e-6
}

fn check_energy(at: &KeyPath, shares: &AddedShares, problems: &mut ValidationErrors) {
    let AddedShares { keys: [first, second], sum, help } = *shares;
    if sum.max_element() > 1.0 + SHARE_ROUNDING {
        let key = at.key(first);
        let message = format!(
            "`{key}` and {second} add up to more than 1, so that the surface would create light"
        );
        problems.add(key, message).with_related(at.key(second)).with_help(help.to_owned());
    }
}

fn check_sphere(
    index: usize,
    sphere: &SphereDescription,
    materials: usize,
    problems: &mut ValidationErrors,
) {
    let SphereDescription { name, center, radius, material, shadow_catcher: _ } = sphere;
    // Fast path: most spheres are valid, and a scene may have millions.
    let is_good = *material < materials
        && center.abs().cmple(DVec3::splat(MAX_COORDINATE)).all()
        && (keys::MIN_RADIUS..=MAX_COORDINATE).contains(radius)
        && name.is_none();
    if is_good {
        return;
    }
    let at = KeyPath::root("spheres").entry(index, name.as_deref());
    if let Some(name) = name {
        problems.check(&at, &keys::sphere::NAME, name);
    }
    problems.check(&at, &keys::sphere::CENTER, center);
    problems.check(&at, &keys::sphere::RADIUS, radius);
    check_index(&at, *material, materials, problems);
}

fn check_table(
    at: KeyPath,
    table: &SphereTable,
    materials: usize,
    problems: &mut ValidationErrors,
) {
    let SphereTable { name, data, material, colors: _, color_space: _, offset } = table;
    if let Some(name) = name {
        problems.check(&at, &keys::table::NAME, name);
    }
    match data {
        // Columns that are not listed are those that the file names.
        SphereData::File { columns, .. } if columns.is_empty() => {}
        SphereData::File { columns, .. } => check_columns(&at, columns, problems),
        SphereData::Memory(arrays) => check_arrays(&at, arrays, problems),
        SphereData::Particles(particles) => {
            let mut appearance = particles.appearance.clone();
            keys::particles::visit_keys(&mut appearance, &mut Checker { table: &at, problems });
            problems.check(&at, &keys::particles::REPLICATE, &appearance.replicate.to_vec());
        }
    }
    problems.check(&at, &keys::table::OFFSET, offset);
    check_index(&at, *material, materials, problems);
}

fn check_index(at: &KeyPath, material: usize, materials: usize, problems: &mut ValidationErrors) {
    if material >= materials {
        let key = at.key("material");
        let message = match material {
            FOREIGN_MATERIAL => format!("`{key}` is a material of another builder"),
            _ => format!("`{key}` is the index {material}, but there are {materials} materials"),
        };
        problems.add(key, message);
    }
}

/// Checks that all required columns are present, and none twice.
pub(super) fn check_columns(at: &KeyPath, columns: &[FileColumn], problems: &mut ValidationErrors) {
    let read = || columns.iter().filter_map(|column| column.column);
    let count = |column: Column| read().filter(|&c| c == column).count();
    let words = |wrong: &dyn Fn(Column) -> bool| {
        let wrong = Column::NAMES.iter().filter(|(_, column)| wrong(*column));
        wrong.map(|(word, _)| format!("\"{word}\"")).collect::<Vec<_>>().join(", ")
    };
    let has_color = read().any(Column::is_color);
    let has_channels = read().any(|column| Column::EMISSION.contains(&column));
    let is_required = |column: Column| match column {
        Column::Emission => false,
        column if column.is_color() => has_color,
        column if column.is_emission() => has_channels,
        _ => true,
    };
    let key = at.key("columns");
    let mut add = |message: String| {
        let help = "give x, y, z and radius once each, r, g, b all or none, and emission, or \
                    emission_r, emission_g and emission_b, or neither";
        problems.add(key.clone(), message).with_help(help.to_owned());
    };
    let missing = words(&|c| count(c) == 0 && is_required(c));
    let repeated = words(&|c| count(c) > 1);
    for (what, which) in [("lacks", &missing), ("repeats", &repeated)] {
        if !which.is_empty() {
            add(format!("`{key}` {what} {which}"));
        }
    }
    if has_channels && count(Column::Emission) > 0 {
        add(format!("`{key}` has \"emission\", and its channels one by one"));
    }
}

/// Checks that every array has a number for each sphere.
fn check_arrays(at: &KeyPath, arrays: &SphereArrays, problems: &mut ValidationErrors) {
    let len = arrays.len();
    if len == 0 {
        problems.add(at.clone(), format!("`{at}` has no spheres"));
    }
    for (column, StridedArray { len: found, .. }) in arrays.columns() {
        if *found != len {
            let message = format!(
                "`{at}` has {len} radii, but {found} numbers in its column {}",
                column.name()
            );
            problems.add(at.clone(), message);
        }
    }
    for (column, _) in arrays.columns().filter(|(_, array)| !array.is_in_bounds()) {
        let message = format!("the column {} of `{at}` reaches beyond its array", column.name());
        problems.add(at.clone(), message);
    }
    if let Some(ids) = &arrays.ids {
        let distinct = if ids.stride == 0 { 1 } else { ids.len };
        if ids.len != len {
            let message = format!("`{at}` has {len} radii, but {} ids", ids.len);
            problems.add(at.clone(), message);
        }
        if !ids.fits() {
            problems.add(at.clone(), format!("the ids of `{at}` reach beyond their array"));
        } else if ids.iter().take(distinct).any(|id| id == NO_SPHERE) {
            problems.add(at.clone(), format!("`{at}` has the id 2^32 - 1, which is reserved"));
        }
    }
}
