//! Sphere tables: what is read from them, and how each fault is told.

use std::fs;
use std::path::Path;

use photosphere::error::Result;
use photosphere::scene::{Scene, SceneFile, read_file};
use tempfile::TempDir;

pub(crate) const COLUMNS: &str = r#"["x", "y", "z", "radius"]"#;
const COLORED: &str = r#"["r", "g", "b", "radius", "z", "y", "x"]"#;

const MATERIALS: &str = r#"
[materials.diffuse]
type = "diffuse"
albedo = [0.5, 0.5, 0.5]
[materials.mirror]
type = "mirror"
reflectance = [1, 1, 1]
[materials.glass]
type = "dielectric"
ior = 1.5
[materials.glossy]
type = "phong"
albedo = [0.5, 0.5, 0.5]
specular = [0.5, 0.25, 0.125]
exponent = 10
"#;

/// A scene file in its own folder, with tables beside it.
pub(crate) struct Desk {
    pub(crate) folder: TempDir,
    pub(crate) text: String,
}

impl Desk {
    pub(crate) fn new() -> Self {
        let text = format!(
            "format = 1\ncamera = {{ position = [0, 0, 9], look_at = [0, 0, 0] }}\n{MATERIALS}"
        );
        Self { folder: tempfile::tempdir().expect("a folder"), text }
    }

    pub(crate) fn table(mut self, file: &str, columns: &str, material: &str) -> Self {
        self.text += &format!(
            "[[sphere_tables]]\nfile = \"{file}\"\ncolumns = {columns}\nmaterial = \"{material}\"\n"
        );
        self
    }

    pub(crate) fn bytes(self, file: &str, bytes: &[u8]) -> Self {
        fs::write(self.folder.path().join(file), bytes).expect("a file");
        self
    }

    pub(crate) fn values(self, file: &str, values: &[f32]) -> Self {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        self.bytes(file, &bytes)
    }

    pub(crate) fn load(&self) -> Result<Scene> {
        let path = self.folder.path().join("scene.toml");
        fs::write(&path, &self.text).expect("a file");
        let (scene, _) = read_file(&path, &[]).and_then(SceneFile::build)?;
        Ok(scene)
    }

    /// The mistakes without their places, and without the name of the folder.
    pub(crate) fn told(&self) -> Vec<String> {
        let error = self.load().expect_err("a mistake");
        let folder = format!("{}/", self.folder.path().display());
        let messages =
            error.diagnostics().iter().map(|mistake| mistake.message.replace(&folder, ""));
        messages.collect()
    }
}

/// One table of plain rows, and what is said of it.
fn assert_told(values: &[f32], expected: &str) {
    let scene = Desk::new().table("a.f32", COLUMNS, "diffuse").values("a.f32", values);
    assert_eq!(scene.told(), [expected]);
}

#[test]
fn tables_follow_each_other_behind_the_exact_spheres() {
    let mut scene = Desk::new()
        .table("a.f32", COLUMNS, "mirror")
        .table("b.f32", COLORED, "diffuse")
        .values("a.f32", &[1.0, 2.0, 3.0, 0.5, 4.0, 5.0, 6.0, 0.25])
        .values("b.f32", &[0.0, 0.5, 1.0, 0.125, 9.0, 8.0, 7.0]);
    scene.text += "[[spheres]]\ncenter = [0, 0, 0]\nradius = 1\nmaterial = \"diffuse\"\n";
    let scene = scene.load().expect("good tables");
    let rows =
        [[0.0, 0.0, 0.0, 1.0], [1.0, 2.0, 3.0, 0.5], [4.0, 5.0, 6.0, 0.25], [7.0, 8.0, 9.0, 0.125]];
    assert_eq!([0, 1, 2, 3].map(|row| sphere(&scene, row)), rows);
    let names = ["spheres", "a.f32", "a.f32", "b.f32"];
    assert_eq!([0, 1, 2, 3].map(|row| scene.table_of_row(row)), names);
    let material = |row| &*scene.description().materials[scene.material_of_row(row)].name;
    assert_eq!([0, 1, 2, 3].map(material), ["diffuse", "mirror", "mirror", "diffuse"]);
    assert_eq!([0, 1, 2].map(|row| color(&scene, row)), [None; 3]);
    assert_eq!(color(&scene, 3), Some([0.0, 0.5, 1.0]));
}

fn id(scene: &Scene, row: u32) -> u32 {
    let rows = scene.spheres().rows();
    rows.iter().position(|&of_id| of_id == row).expect("every row has an id") as u32
}

/// The sphere in a row, where the user put it.
fn sphere(scene: &Scene, row: u32) -> [f64; 4] {
    let sphere = scene.spheres().sphere(id(scene, row));
    let [x, y, z] = (sphere.center + scene.spheres().origin()).to_array();
    [x, y, z, sphere.radius]
}

fn color(scene: &Scene, row: u32) -> Option<[f32; 3]> {
    scene.sphere_material(id(scene, row)).albedo.map(|color| color.to_array())
}

#[test]
fn the_file_must_be_there_and_whole() {
    let missing = Desk::new().table("a.f32", COLUMNS, "diffuse");
    let told = missing.told();
    assert!(told[0].starts_with("cannot read `a.f32`: No such file"), "{told:?}");
    let place =
        missing.load().expect_err("missing").diagnostics()[0].location.clone().expect("a place");
    assert_eq!(&place.source.text[place.span], "\"a.f32\"");
    let folder = Desk::new().table("a.f32", COLUMNS, "diffuse");
    fs::create_dir(folder.folder.path().join("a.f32")).expect("a folder");
    assert_eq!(folder.told(), ["`a.f32` is a folder"]);
    assert_told(&[], "`a.f32` is empty");
    let short = Desk::new().table("a.f32", COLUMNS, "diffuse").bytes("a.f32", &[0; 37]);
    assert_eq!(
        short.told(),
        [
            "`a.f32` has 37 bytes, which is not a whole number of rows: 2 rows of 16 bytes and 5 bytes \
          left over"
        ]
    );
    assert_eq!(
        Desk::new().table("a.f32", COLUMNS, "diffuse").bytes("a.f32", &[0; 17]).told(),
        [
            "`a.f32` has 17 bytes, which is not a whole number of rows: 1 row of 16 bytes and 1 byte \
             left over"
        ]
    );
}

#[cfg(unix)]
#[test]
fn an_endless_file_is_refused() {
    let endless = Desk::new().table("/dev/zero", COLUMNS, "diffuse");
    assert_eq!(endless.told(), ["`/dev/zero` is not a regular file"]);
}

#[test]
fn every_value_is_checked() {
    let row = |at: usize, value: f32| {
        let mut rows = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        rows[at] = value;
        rows
    };
    let said = "`a.f32`: row 1 (the first is 0) has";
    assert_told(
        &row(5, f32::NAN),
        &format!("{said} y = NaN at byte 20; it must be from -1e15 to 1e15"),
    );
    assert_told(
        &row(4, f32::INFINITY),
        &format!("{said} x = inf at byte 16; it must be from -1e15 to 1e15"),
    );
    assert_told(
        &row(6, -1e17),
        &format!("{said} z = -1e17 at byte 24; it must be from -1e15 to 1e15"),
    );
    assert_told(
        &row(7, 0.0),
        &format!("{said} radius = 0.0 at byte 28; it must be from 1e-15 to 1e15"),
    );
    assert_told(
        &row(7, -1.0),
        &format!("{said} radius = -1.0 at byte 28; it must be from 1e-15 to 1e15"),
    );
    assert_told(
        &row(7, f32::NAN),
        &format!("{said} radius = NaN at byte 28; it must be from 1e-15 to 1e15"),
    );
    let scene = Desk::new().table("a.f32", COLORED, "diffuse");
    let scene = scene.values("a.f32", &[0.5, 1.5, 0.0, 1.0, 0.0, 0.0, 0.0]);
    assert_eq!(
        scene.told(),
        ["`a.f32`: row 0 (the first is 0) has g = 1.5 at byte 4; it must be from 0 to 1"]
    );
}

#[test]
fn the_first_of_many_bad_rows_is_told_and_the_rest_counted() {
    let mut values: Vec<f32> = (0..600_000).flat_map(|_| [0.0, 0.0, 0.0, 1.0]).collect();
    for row in [300_000, 300_001, 599_999] {
        values[row * 4 + 3] = -1.0;
    }
    assert_told(
        &values,
        "`a.f32`: row 300000 (the first is 0) has radius = -1.0 at byte 4800012; it must be \
         from 1e-15 to 1e15; 2 more rows are invalid",
    );
    let two = [0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0];
    let scene = Desk::new().table("a.f32", COLUMNS, "diffuse").values("a.f32", &two);
    assert!(scene.told()[0].ends_with("from 1e-15 to 1e15; 1 more row is invalid"));
    let mistake = scene.load().expect_err("a mistake").diagnostics()[0].clone();
    let help = mistake.help.expect("a help");
    let expected = "according to `columns`, a row is 4 little-endian numbers in 16 bytes";
    assert!(help.starts_with(expected), "{help}");
}

#[test]
fn columns_must_make_a_sphere() {
    let told = |columns: &str, expected: &[&str]| {
        // As many numbers as make whole rows of any of these columns.
        let desk = Desk::new().table("a.f32", columns, "diffuse").values("a.f32", &[1.0; 420]);
        assert_eq!(desk.told(), expected);
    };
    told(r#"["x", "y", "z"]"#, &["`sphere_tables.0.columns` lacks \"radius\""]);
    told(
        r#"["x", "y", "y", "radius"]"#,
        &["`sphere_tables.0.columns` lacks \"z\"", "`sphere_tables.0.columns` repeats \"y\""],
    );
    told(r#"["x", "y", "z", "radius", "g"]"#, &["`sphere_tables.0.columns` lacks \"r\", \"b\""]);
    let list = "`sphere_tables.0.columns` must be a list, each entry \"x\" or \"y\" or \"z\" or \
                \"radius\" or \"r\" or \"g\" or \"b\" or \"emission\" or \"emission_r\" or \
                \"emission_g\" or \"emission_b\" or \"_\" for a number that is not read, with an \
                optional type, \":f32\" or \":f64\", not";
    told(r#"["x", "y", "z", "radios"]"#, &[&format!("{list} \"radios\"")]);
    told("[]", &[&format!("{list} an empty one")]);
    told(
        r#"["x", "y", "z", "radius", "emission_g", "emission_r", "emission"]"#,
        &[
            "`sphere_tables.0.columns` lacks \"emission_b\"",
            "`sphere_tables.0.columns` has \"emission\", and its channels one by one",
        ],
    );
}

#[test]
fn colours_are_as_bright_as_their_material_lets_them_be() {
    let values = [0.75, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
    let colored =
        |material: &str| Desk::new().table("a.f32", COLORED, material).values("a.f32", &values);
    colored("diffuse").load().expect("a diffuse table");
    colored("glass").load().expect("a table of coloured glass");
    assert_eq!(
        colored("glossy").told(),
        ["`a.f32`: row 0 (the first is 0) has r = 0.75 at byte 0; it must be from 0 to 0.500001"],
        "0.75 and the material's specular 0.5 are more than 1"
    );
}

#[test]
fn a_coloured_bead_leaves_its_colour_of_light_that_crosses_it() {
    let values = [1.0, 0.5, 0.0, 2.0, 0.0, 0.0, 0.0];
    let desk = Desk::new().table("a.f32", COLORED, "glass").values("a.f32", &values);
    let medium = desk.load().expect("a good scene").sphere_material(0).medium(0).expect("glass");
    assert_eq!(medium.absorption.x, 0.0);
    assert!((f64::from(medium.absorption.y) - std::f64::consts::LN_2 / 4.0).abs() < 1e-7);
    assert!(medium.absorption.z > 10.0 && medium.absorption.is_finite());
}

#[test]
fn packed_colours_are_nearly_the_same() {
    let values = [0.0, 0.3, 1.0, 1.0, 0.0, 0.0, 0.0];
    let mut scene = Desk::new().table("a.f32", COLORED, "diffuse").values("a.f32", &values);
    scene.text += "colors = \"packed\"\n";
    let [r, g, b] = color(&scene.load().expect("a good table"), 0).expect("a colour");
    assert_eq!((r, b), (0.0, 1.0));
    assert!(g != 0.3 && (g - 0.3).abs() < 3e-4, "{g}");
}

#[test]
fn only_tables_with_colours_say_how_they_are_kept() {
    let mut scene = Desk::new().table("a.f32", COLUMNS, "diffuse").values("a.f32", &[0.0; 4]);
    scene.text += "colors = \"packed\"\n";
    assert_eq!(scene.told(), ["`sphere_tables.0.colors` applies only to tables with colours"]);
}

#[test]
fn mistakes_in_the_scene_and_in_its_tables_are_told_together() {
    let mut scene =
        Desk::new().table("a.f32", COLUMNS, "diffuse").table("b.f32", COLUMNS, "diffus");
    scene.text += "[image]\nwidth = 0\n";
    let told = scene.told();
    assert_eq!(told.len(), 4, "{told:?}");
    assert!(told[0].starts_with("cannot read `a.f32`"), "{told:?}");
    assert!(told[1].starts_with("cannot read `b.f32`"), "{told:?}");
}

#[test]
fn scene_files_that_cannot_be_read_are_told_with_their_path() {
    let said = |path: &Path| read_file(path, &[]).expect_err("unreadable").to_string();
    let folder = tempfile::tempdir().expect("a folder");
    let missing = folder.path().join("no.toml");
    assert!(
        said(&missing).starts_with(&format!("cannot read the scene `{}`: ", missing.display()))
    );
    assert!(said(folder.path()).ends_with("it is a folder"));
    let binary = folder.path().join("binary.toml");
    fs::write(&binary, b"format = \xff\xfe").expect("a file");
    assert!(said(&binary).ends_with("it is not UTF-8 text at byte 9"));
}
