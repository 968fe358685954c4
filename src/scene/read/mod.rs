//! From a document to a [`Description`]: which keys there are, what they may hold, and what they
//! are where they are left out. `docs/scene-format.md` says the same to users.

mod background;
mod camera;
mod materials;
mod render;

use std::collections::BTreeMap;
use std::path::Path;

use toml::de::DeTable;

use crate::math::MAX_COORDINATE;

pub(super) use materials::SHARE_ROUNDING;

use super::description::{
    ColorStorage, Column, Description, FilterKind, Image, SphereRow, SphereTable, Window,
};
use super::document::Table;
use super::environment::Pixels;
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

/// Linear radiance, which no lamp can send out negatively.
const RADIANCE: Color = Color(Limits::FromTo(0.0, BRIGHTEST));

const FILTERS: Choice<FilterKind> = Choice(&[
    ("box", FilterKind::Box),
    ("tent", FilterKind::Tent),
    ("gaussian", FilterKind::Gaussian),
    ("blackman-harris", FilterKind::BlackmanHarris),
]);

const COLOR_STORAGE: Choice<ColorStorage> =
    Choice(&[("exact", ColorStorage::Exact), ("packed", ColorStorage::Packed)]);

const COLUMNS: Choice<Column> = Choice(&Column::NAMES);

/// What a document says, and what is known of its tables' files so far.
#[derive(Debug)]
pub(super) struct Draft {
    pub(super) description: Description,
    /// One for each of the description's tables.
    pub(super) surveys: Vec<Survey>,
    /// The pixels of the background's image.
    pub(super) environment: Option<Pixels>,
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
        let background =
            root.optional_section("background", |table| background::read(table, folder));
        let materials = materials::read(root);
        let names = materials.iter().map(|(name, _)| *name);
        let index_of: BTreeMap<_, _> = names.zip(0..).collect();
        let spheres = root.sections("spheres", |table| read_sphere(table, &index_of));
        let camera = root.section("camera", |table| camera::read(table, &spheres));
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
        let (background, environment) = background?;
        let description = Description {
            image: image?,
            camera: camera?,
            background,
            materials: materials.collect::<Option<_>>()?,
            spheres,
            tables,
            render: render?,
        };
        Some(Draft { description, surveys, environment })
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
    let crop = read_crop(table, width, height);
    let filter = table.optional("filter", FILTERS).unwrap_or_default();
    let radius = table.optional("filter_radius", Number(Limits::AboveTo(0.0, 64.0)));
    let filter_radius = radius.unwrap_or(usual_radius(filter));
    Some(Image { width, height, crop, filter, filter_radius })
}

/// The part of the picture that is rendered.
fn read_crop(table: &Table<'_>, width: u32, height: u32) -> Option<Window> {
    let edges = table.optional("crop", Each(Whole(0..=WIDEST)))?;
    let wrong = |message: String| table.report().add(table.wrong("crop", message));
    let [x0, y0, x1, y1] = edges[..] else {
        let found = edges.len();
        wrong(format!("`image.crop` must be four numbers, [x0, y0, x1, y1], not {found}"));
        return None;
    };
    if x0 >= x1 || y0 >= y1 || x1 > width || y1 > height {
        wrong(format!(
            "`image.crop` must be [x0, y0, x1, y1] with x0 < x1 <= {width} and y0 < y1 <= {height}"
        ));
        return None;
    }
    Some(Window { x: x0, y: y0, width: x1 - x0, height: y1 - y0 })
}

fn usual_radius(filter: FilterKind) -> f64 {
    match filter {
        FilterKind::Box => 0.5,
        FilterKind::Tent => 1.0,
        FilterKind::Gaussian => 1.5,
        FilterKind::BlackmanHarris => 2.0,
    }
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
    let colors = table.optional("colors", COLOR_STORAGE);
    let columns = columns?;
    if colors.is_some() && !columns.iter().any(|column| column.is_color()) {
        let message = format!("`{}` is for tables with colours", table.path_to("colors"));
        let help = "drop it, or add r, g and b to `columns`".to_owned();
        table.report().add(table.wrong("colors", message).help(help));
    }
    let (file, colors) = (folder.join(file?), colors.unwrap_or_default());
    Some(SphereTable { file, columns, material: material?, colors })
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
