//! Reads a document into a [`SceneDescription`] and [`Settings`]. Missing and invalid values become
//! defaults, so the values are always complete and can be validated as a whole, like those from a
//! program.

mod background;
mod camera;
mod materials;
mod particles;
mod render;

use std::collections::BTreeMap;
use std::path::Path;

use toml::de::DeTable;

use crate::math::Rect;
use crate::scene::data::{Column, FileColumn, SphereData};
use crate::scene::description::{
    MaterialDescription, SceneDescription, SphereDescription, SphereTable, name_of_table,
};
use crate::scene::keys;
use crate::scene::settings::{ImageSettings, Settings};
use crate::scene::validate::crop_error;
use crate::scene::value_types::MaterialName;

use super::diagnostics::{Diagnostics, SpannedError};
use super::document::Table;

/// The version of the scene format that this program reads.
const FORMAT: i64 = 1;

/// Reads a whole scene. Relative paths start at `folder`. Errors are added to the diagnostics.
pub(super) fn read(
    document: &DeTable<'_>,
    integrator_of_file: Option<&str>,
    folder: &Path,
    report: &Diagnostics,
) -> (SceneDescription, Settings) {
    Table::root(document, report, |root| {
        read_format(root);
        let image = root.optional_section("image", read_image);
        let mut background =
            root.optional_section("background", |table| background::read(table, folder));
        let materials = materials::read(root);
        let names = materials.iter().map(|(name, _)| *name);
        let index_of: BTreeMap<_, _> = names.zip(0..).collect();
        let spheres = root.sections("spheres", |table| read_sphere(table, &index_of));
        let mut tables =
            root.sections("sphere_tables", |table| read_table(table, &index_of, folder));
        tables
            .extend(root.sections("particles", |table| particles::read(table, &index_of, folder)));
        require_spheres(root);
        let table_names: Vec<String> =
            (0..tables.len()).map(|index| name_of_table(&tables, index)).collect();
        let camera = root.section("camera", Some(NO_CAMERA), |table| {
            camera::read(table, &spheres, &table_names)
        });
        let light = root.section_if_present("light", |table| background::read_light(table, root));
        if let Some((preset, strength)) = light.flatten() {
            preset.light(&mut background, camera.direction_to_camera(), strength);
        }
        let render =
            root.optional_section("render", |table| render::read(table, integrator_of_file));
        let named = |(name, material): (&str, MaterialDescription)| MaterialDescription {
            name: name.to_owned(),
            ..material
        };
        let materials = materials.into_iter().map(named).collect();
        let description = SceneDescription { camera, background, materials, spheres, tables };
        (description, Settings { image, render })
    })
}

fn read_format(root: &Table<'_>) {
    if root.span_of("format").is_none() {
        let help = format!("add `format = {FORMAT}` as the first line");
        root.diagnostics().add(SpannedError::absence(0..0, "`format` is missing").help(help));
    }
    let key = &keys::root::FORMAT;
    let Some(format) = root.optional(key.name, &key.kind) else {
        return;
    };
    if format != FORMAT {
        let message = format!(
            "format {format} is not supported; this version of photosphere reads format {FORMAT}"
        );
        root.error_at("format", message, None);
    }
}

fn read_image(table: &Table<'_>) -> ImageSettings {
    let usual = ImageSettings::default();
    let width = table.get(&keys::image::WIDTH).unwrap_or(usual.width);
    let height = table.get(&keys::image::HEIGHT).unwrap_or(usual.height);
    let crop = read_crop(table, width, height);
    let filter = table.get(&keys::image::FILTER).unwrap_or_default();
    let radius = table.get(&keys::image::FILTER_RADIUS);
    let filter_radius = radius.unwrap_or(ImageSettings::default_filter_radius(filter));
    ImageSettings { width, height, crop, filter, filter_radius }
}

/// The part of the picture that is rendered.
fn read_crop(table: &Table<'_>, width: u32, height: u32) -> Option<Rect> {
    let edges = table.get(&keys::image::CROP)?;
    let Ok(corners) = <[u32; 4]>::try_from(edges.as_slice()) else {
        let found = edges.len();
        let message = format!("`image.crop` must be four numbers, [x0, y0, x1, y1], not {found}");
        table.error_at("crop", message, None);
        return None;
    };
    let crop = Rect::from_corners(corners);
    if crop.is_none() {
        table.error_at("crop", crop_error(width, height), None);
    }
    crop
}

fn read_sphere(table: &Table<'_>, index_of: &BTreeMap<&str, usize>) -> SphereDescription {
    let name = table.get(&keys::sphere::NAME);
    let center = table.get(&keys::sphere::CENTER);
    let radius = table.get(&keys::sphere::RADIUS);
    let material = table.required(keys::sphere::MATERIAL.name, &MaterialName(index_of));
    SphereDescription {
        name,
        center: center.unwrap_or_default(),
        radius: radius.unwrap_or_default(),
        material: material.unwrap_or_default(),
        shadow_catcher: table.get(&keys::sphere::SHADOW_CATCHER).unwrap_or(false),
    }
}

fn read_table(table: &Table<'_>, index_of: &BTreeMap<&str, usize>, folder: &Path) -> SphereTable {
    let name = table.get(&keys::table::NAME);
    let file = table.get(&keys::table::FILE);
    let columns = read_columns(table, file.is_some());
    let material = table.required(keys::table::MATERIAL.name, &MaterialName(index_of));
    let colors = table.get(&keys::table::COLORS);
    let color_space = table.get(&keys::table::COLOR_SPACE);
    let is_color = |column: &FileColumn| column.column.is_some_and(Column::is_color);
    if !columns.is_empty() && !columns.iter().any(is_color) {
        let given = [("colors", colors.is_some()), ("color_space", color_space.is_some())];
        for (key, _) in given.into_iter().filter(|(_, is_given)| *is_given) {
            let message = format!("`{}` applies only to tables with colours", table.path_to(key));
            let help = "remove it, or add r, g and b to `columns`".to_owned();
            table.error_at(key, message, help);
        }
    }
    let of_count = |count: Option<i64>| count.unwrap_or_default().unsigned_abs();
    let data = SphereData::File {
        path: folder.join(file.unwrap_or_default()),
        columns,
        skip_rows: of_count(table.get(&keys::table::SKIP_ROWS)),
        skip_bytes: of_count(table.get(&keys::table::SKIP_BYTES)),
    };
    let offset = table.get(&keys::table::OFFSET).unwrap_or_default();
    SphereTable {
        name,
        data,
        material: material.unwrap_or_default(),
        colors: colors.unwrap_or_default(),
        color_space: color_space.unwrap_or_default(),
        offset,
    }
}

/// The columns of a table; none if its file, if there is one, may name them.
fn read_columns(table: &Table<'_>, has_file: bool) -> Vec<FileColumn> {
    let key = &keys::table::COLUMNS;
    let columns = match has_file {
        true => table.get(key),
        false => table.required(key.name, &key.kind),
    };
    let usual = || match table.span_of(key.name) {
        Some(_) => Column::SPHERE.map(FileColumn::from).to_vec(),
        None => Vec::new(),
    };
    columns.unwrap_or_else(usual)
}

/// What to do without a camera.
const NO_CAMERA: &str = "add `[camera]` with `fit = true`, which shows all that the scene has, or with \
                         position and look_at";

fn require_spheres(root: &Table<'_>) {
    if ["spheres", "sphere_tables", "particles"].iter().all(|list| root.is_empty_list(list)) {
        let help = "add `[[spheres]]` with center, radius and material".to_owned();
        root.diagnostics()
            .add(SpannedError::absence(root.span(), "the scene has no spheres").help(help));
        // The values lack them too, which must not be reported again.
        root.mark_invalid("spheres");
    }
}
