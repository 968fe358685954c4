//! From a document to a [`Description`]: which keys there are, what they may hold, and what they
//! are where they are left out. `docs/scene-format.md` says the same to users.

mod materials;
mod render;

use std::collections::BTreeMap;
use std::path::Path;

use toml::de::DeTable;

use crate::color::Rgb;
use crate::math::{DVec3, MAX_COORDINATE};

pub(super) use materials::SHARE_ROUNDING;

use super::description::{Camera, Column, Description, FilterKind, Image, SphereRow, SphereTable};
use super::document::Table;
use super::import::{Survey, survey};
use super::report::{Report, Wrong};
use super::values::{COORDINATES, Choice, Color, Each, Limits, MaterialName, Number, Text, Whole};

/// The version of the format that this program reads.
const FORMAT: i64 = 1;

/// The most pixels along one side.
const WIDEST: u32 = 65_536;

/// The most pixels of a picture.
const MOST_PIXELS: u64 = 1 << 31;

/// The smallest radius; its square is still a normal f32 number.
pub(super) const SMALLEST_RADIUS: f64 = 1e-15;

/// The largest radiance.
const BRIGHTEST: f64 = 1e15;

/// The sine of the angle between `up` and the view below which they count as parallel.
const PARALLEL: f64 = 1e-6;

/// Linear radiance, which no lamp can send out negatively.
const RADIANCE: Color = Color(Limits::FromTo(0.0, BRIGHTEST));

const FILTERS: Choice<FilterKind> = Choice(&[
    ("box", FilterKind::Box),
    ("tent", FilterKind::Tent),
    ("gaussian", FilterKind::Gaussian),
    ("blackman-harris", FilterKind::BlackmanHarris),
]);

const COLUMNS: Choice<Column> = Choice(&Column::NAMES);

/// What a document says, and what is known of its tables' files so far.
pub(super) struct Draft {
    pub(super) description: Description,
    /// One for each of the description's tables.
    pub(super) surveys: Vec<Survey>,
}

/// Reads a whole scene; relative paths start at `folder`. What is wrong goes to the report; `None`
/// where that is so much that there is no scene.
pub(super) fn read(
    document: &DeTable<'_>,
    integrator_of_file: Option<&str>,
    folder: &Path,
    report: &Report,
) -> Option<Draft> {
    Table::root(document, report, |root| {
        read_format(root);
        let image = root.optional_section("image", read_image);
        let camera = root.section("camera", read_camera);
        let background = root.optional_section("background", |table| {
            Some(table.optional("radiance", RADIANCE).unwrap_or(Rgb::ZERO))
        });
        let materials = materials::read(root);
        let names = materials.iter().map(|(name, _)| *name);
        let index_of: BTreeMap<_, _> = names.zip(0..).collect();
        let spheres = root.sections("spheres", |table| read_sphere(table, &index_of));
        let tables = root.sections("sphere_tables", |table| {
            let described = read_table(table, &index_of, folder)?;
            let surface = materials[described.material].1.as_ref()?.surface;
            let survey = survey(table, &described, &surface)?;
            Some((described, survey))
        });
        demand_spheres(root);
        let render =
            root.optional_section("render", |table| render::read(table, integrator_of_file));
        let materials = materials.into_iter().map(|(_, material)| material);
        let (tables, surveys) = tables.into_iter().unzip();
        let description = Description {
            image: image?,
            camera: camera?,
            background: background?,
            materials: materials.collect::<Option<_>>()?,
            spheres,
            tables,
            render: render?,
        };
        Some(Draft { description, surveys })
    })
}

fn read_format(root: &Table<'_>) {
    if root.span_of("format").is_none() {
        let help = format!("add `format = {FORMAT}` as the first line");
        root.report().add(Wrong::absence(0..0, "`format` is missing").help(help));
    }
    let Some(format) = root.optional("format", Whole(1..=i64::MAX)) else {
        return;
    };
    if format != FORMAT {
        let message = format!("this is format {format}; this photosphere reads format {FORMAT}");
        root.report().add(root.wrong("format", message));
    }
}

fn read_image(table: &Table<'_>) -> Option<Image> {
    let width = table.optional("width", Whole(1..=WIDEST)).unwrap_or(640);
    let height = table.optional("height", Whole(1..=WIDEST)).unwrap_or(480);
    if u64::from(width) * u64::from(height) > MOST_PIXELS {
        let message = format!("{width} x {height} pixels are more than 2^31");
        table.report().add(table.wrong("height", message));
    }
    let filter = table.optional("filter", FILTERS).unwrap_or_default();
    let radius = table.optional("filter_radius", Number(Limits::AboveTo(0.0, 64.0)));
    Some(Image { width, height, filter, filter_radius: radius.unwrap_or(usual_radius(filter)) })
}

fn usual_radius(filter: FilterKind) -> f64 {
    match filter {
        FilterKind::Box => 0.5,
        FilterKind::Tent => 1.0,
        FilterKind::Gaussian => 1.5,
        FilterKind::BlackmanHarris => 2.0,
    }
}

fn read_camera(table: &Table<'_>) -> Option<Camera> {
    let position = table.required("position", COORDINATES);
    let look_at = table.required("look_at", COORDINATES);
    let up = table.optional("up", COORDINATES).unwrap_or(DVec3::Y);
    let vertical_fov_degrees =
        table.optional("vertical_fov_degrees", Number(Limits::Between(0.0, 180.0))).unwrap_or(36.0);
    let near =
        table.optional("near", Number(Limits::FromTo(0.0, MAX_COORDINATE))).unwrap_or_default();
    let camera = Camera { position: position?, look_at: look_at?, up, vertical_fov_degrees, near };
    check_axes(table, &camera);
    Some(camera)
}

/// Whether the camera looks anywhere, and knows how to hold its head.
fn check_axes(table: &Table<'_>, camera: &Camera) {
    let view = unit(camera.look_at - camera.position);
    let up = unit(camera.up);
    let wrong = match (view, up) {
        (None, _) => table.wrong("look_at", "`camera.look_at` must not be `camera.position`"),
        (_, None) => table.wrong("up", "`camera.up` must not be [0, 0, 0]"),
        (Some(view), Some(up)) if view.cross(up).length() < PARALLEL => {
            let other = if view.y.abs() < 0.5 { "[0, 1, 0]" } else { "[0, 0, 1]" };
            let key = if table.span_of("up").is_some() { "up" } else { "look_at" };
            table
                .wrong(key, "`camera.up` must not be parallel to the view")
                .help(format!("any other direction will do, as in `up = {other}`"))
        }
        _ => return,
    };
    table.report().add(wrong);
}

/// The direction of a vector however long or short, if it has one.
fn unit(v: DVec3) -> Option<DVec3> {
    (v / v.abs().max_element()).try_normalize()
}

fn read_sphere(table: &Table<'_>, index_of: &BTreeMap<&str, usize>) -> Option<SphereRow> {
    let name = table.optional("name", Text);
    let center = table.required("center", COORDINATES);
    let radius = table.required("radius", Number(Limits::FromTo(SMALLEST_RADIUS, MAX_COORDINATE)));
    let material = table.required("material", MaterialName(index_of));
    Some(SphereRow { name, center: center?, radius: radius?, material: material? })
}

fn read_table(
    table: &Table<'_>,
    index_of: &BTreeMap<&str, usize>,
    folder: &Path,
) -> Option<SphereTable> {
    let file = table.required("file", Text);
    let columns = table.required("columns", Each(COLUMNS));
    let material = table.required("material", MaterialName(index_of));
    let columns = columns.filter(|columns| check_columns(table, columns));
    Some(SphereTable { file: folder.join(file?), columns: columns?, material: material? })
}

/// Whether every column is there that must be, and none twice.
fn check_columns(table: &Table<'_>, columns: &[Column]) -> bool {
    let count = |column: Column| columns.iter().filter(|&&c| c == column).count();
    let words = |wrong: &dyn Fn(Column) -> bool| {
        let wrong = Column::NAMES.iter().filter(|(_, column)| wrong(*column));
        wrong.map(|(word, _)| format!("\"{word}\"")).collect::<Vec<_>>().join(", ")
    };
    let has_color = columns.iter().any(|c| c.is_color());
    let missing = words(&|c| count(c) == 0 && (has_color || !c.is_color()));
    let repeated = words(&|c| count(c) > 1);
    for (what, which) in [("lacks", &missing), ("repeats", &repeated)] {
        if !which.is_empty() {
            let message = format!("`{}` {what} {which}", table.path_to("columns"));
            let help = "x, y, z and radius once each; r, g, b all or none".to_owned();
            table.report().add(table.wrong("columns", message).help(help));
        }
    }
    missing.is_empty() && repeated.is_empty()
}

fn demand_spheres(root: &Table<'_>) {
    if root.is_empty_list("spheres") && root.is_empty_list("sphere_tables") {
        let help = "add `[[spheres]]` with center, radius and material".to_owned();
        root.report().add(Wrong::absence(root.span(), "the scene has no spheres").help(help));
    }
}
