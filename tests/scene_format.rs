//! The scene file as a user meets it: what is read, and how each mistake is told.

use std::path::Path;

use photosphere::color::Rgb;
use photosphere::error::{Category, Error, Mistake};
use photosphere::film::Picture;
use photosphere::material::Metal;
use photosphere::math::DVec3;
use photosphere::output::Target;
use photosphere::scene::description::{
    Dome, FilterKind, Hemisphere, Integrator, Miss, Paper, Projection, SamplerKind, Stop, Surface,
};
use photosphere::scene::{Loaded, Override, Scene, read_file, read_text};
use proptest::prelude::*;

/// The smallest scene; each test changes something.
const SCENE: &str = r#"format = 1

[image]
width = 64
height = 48

[camera]
position = [0, 1, 5]
look_at = [0, 1, 0]

[materials.grass]
type = "diffuse"
albedo = [0.2, 0.6, 0.2]

[materials.glass]
type = "dielectric"
ior = 1.5

[[spheres]]
name = "ground"
center = [0, -10, 0]
radius = 10
material = "grass"

[[spheres]]
center = [0, 1, 0]
radius = 1
material = "glass"

[render]
seed = 7
"#;

/// A scene with every section.
const EXAMPLE: &str = include_str!("data/example.toml");

fn load(text: &str, options: &[&str]) -> Result<Loaded, Error> {
    let overrides: Vec<_> = options.iter().map(|option| set(option)).collect();
    read_text("test.toml", text, Path::new("tests/data"), &overrides)
}

/// An override as `--set` makes it.
fn set(assignment: &str) -> Override {
    let (key, value) = assignment.split_once('=').expect("an assignment");
    Override { option: format!("--set {assignment}"), key: key.into(), value: value.into() }
}

/// `SCENE` with one line in place of another.
fn with(old: &str, new: &str) -> String {
    assert_eq!(SCENE.matches(old).count(), 1, "{old}");
    SCENE.replace(old, new)
}

/// Each mistake as `line:column: message | help`.
fn told(text: &str, options: &[&str]) -> Vec<String> {
    let error = load(text, options).expect_err("a mistake");
    assert_eq!(error.category(), Category::Input);
    let tell = |mistake: &Mistake| {
        let told = mistake.to_string().trim_start_matches("test.toml:").to_owned();
        match &mistake.help {
            Some(help) => format!("{told} | {help}"),
            None => told,
        }
    };
    error.mistakes().iter().map(tell).collect()
}

fn assert_told(text: &str, options: &[&str], expected: &[&str]) {
    assert_eq!(told(text, options), expected);
}

#[test]
fn the_example_is_read_as_written() {
    let Loaded { description, rows, groups, .. } = load(EXAMPLE, &[]).expect("a good scene");
    assert_eq!((description.image.width, description.image.height), (640, 480));
    assert_eq!(description.image.filter, FilterKind::Box);
    assert_eq!(description.camera.position, DVec3::new(1.0, 2.0, 9.0));
    let pinhole = Projection::Perspective { vertical_fov_degrees: 36.0, lens: None };
    assert_eq!(description.camera.projection, pinhole);
    let names: Vec<_> = description.materials.iter().map(|material| &*material.name).collect();
    assert_eq!(names, ["grass", "lamp"]);
    assert_eq!(description.materials[1].emission.to_array(), [18.0, 17.0, 15.0]);
    assert_eq!(description.spheres[0].name.as_deref(), Some("ground"));
    assert_eq!(description.render.integrator, Integrator::Path);
    assert_eq!(description.render.max_depth, Some(6));
    assert_eq!(rows.exact[0].center.y, -250.0);
    assert_eq!(rows.table, [[1.0, 2.0, 3.0, 0.5], [-1.0, 0.0, 1.0, 0.25]]);
    assert!(rows.table.capacity() >= 3, "there is room for the exact sphere");
    assert_eq!((groups[0].first_row, groups[0].count, groups[0].material), (1, 2, 0));
    let colors = groups[0].colors.as_deref().expect("colours");
    assert_eq!(colors, [[0.25, 0.5, 0.75], [0.0, 1.0, 0.5]]);
}

#[test]
fn what_is_left_out_has_its_default() {
    let description = load(SCENE, &[]).expect("a good scene").description;
    assert_eq!((description.camera.up, description.camera.near), (DVec3::Y, 0.0));
    let background = &description.background;
    assert_eq!(background.dome, Dome::Constant { radiance: [0.0; 3].into() });
    assert!(background.camera_visible && !background.transparent && background.sun.is_none());
    assert_eq!(description.image.filter_radius, 0.5);
    assert_eq!(
        description.materials[1].surface,
        Surface::Dielectric { ior: 1.5, priority: 0, absorption: Rgb::ZERO }
    );
    let render = description.render;
    assert_eq!((render.samples_per_pixel, render.max_depth, render.seed), (64, None, 7));
    for (filter, radius) in [("tent", 1.0), ("gaussian", 1.5), ("blackman-harris", 2.0)] {
        let option = format!("image.filter={filter}");
        let image = load(SCENE, &[&option]).expect("a good scene").description.image;
        assert_eq!(image.filter_radius, radius);
    }
}

#[test]
fn the_examples_in_the_manual_and_in_scenes_are_good() {
    let manual = include_str!("../docs/scene-format.md");
    let blocks: Vec<_> = manual.split("```toml\n").skip(1).collect();
    assert!(!blocks.is_empty());
    for block in blocks {
        let (example, _) = block.split_once("```").expect("a closed block");
        load(example, &[]).expect("the manual is right");
    }
    for scene in ["scenes/furnace.toml", "scenes/cornell-spheres.toml"] {
        read_file(Path::new(scene), &[]).expect("our own scene");
    }
}

#[test]
fn all_mistakes_are_told_at_once_in_the_order_of_the_file() {
    let text = SCENE
        .replace("width = 64", "widht = 64")
        .replace("albedo = [0.2, 0.6, 0.2]", "albedo = [0.2, 1.6, 0.2]")
        .replace("radius = 10", "radius = nan")
        .replace("material = \"glass\"", "material = \"gras\"")
        .replace("seed = 7", "seed = -7");
    let expected = [
        "4:1: `image.widht` is not a key of a scene | did you mean `width`?",
        "13:16: `materials.grass.albedo` must be three numbers from 0 to 1, not 1.6",
        "22:10: `spheres.ground.radius` must be a number from 1e-15 to 1e15, not nan",
        "28:12: `spheres.1.material` must be the name of a material, not \"gras\" \
         | did you mean `grass`?",
        "31:8: `render.seed` must be a whole number from 0 to 2^63 - 1, not -7",
        "command line:1:19: `camera.near` must be a number from 0 to 1e15, not -1",
    ];
    assert_told(&text, &["camera.near=-1"], &expected);
}

#[test]
fn syntax_errors_come_several_at_once_and_hide_only_what_follows() {
    let text = with("width = 64", "widht = 64")
        .replace("radius = 10", "radius = 1O")
        .replace("seed = 7", "seed = ");
    let told = told(&text, &[]);
    assert_eq!(told.len(), 3, "{told:#?}");
    assert!(told[0].starts_with("4:1: `image.widht`"), "{told:#?}");
    assert!(told[1].starts_with("22:10: this is not TOML: "), "{told:#?}");
    assert!(told[2].starts_with("31:"), "{told:#?}");
    let twice = with("width = 64", "width = 64\nwidth = 65");
    assert_told(&twice, &[], &["5:1: this is not TOML: duplicate key"]);
}

/// One line of the scene, what is written instead, and what is said of it.
#[rustfmt::skip]
const MISTAKES: &[(&str, &str, &str)] = &[
    ("format = 1", "", "1:1: `format` is missing | add `format = 1` as the first line"),
    ("format = 1", "format = 2", "1:10: this is format 2; this photosphere reads format 1"),
    ("format = 1", "format = \"1\"", "1:10: `format` must be a whole number from 1 to 2^63 - 1, not a string"),
    ("width = 64", "width = 0", "4:9: `image.width` must be a whole number from 1 to 65536, not 0"),
    ("width = 64", "width = 64.0", "4:9: `image.width` must be a whole number from 1 to 65536, not 64.0"),
    ("width = 64", "width = 0xFFFFFFFFFFFFFFFFFF", "4:9: `image.width` must be a whole number from 1 to 65536, not 0xFFFFFFFFFFFFFFFFFF"),
    ("width = 64", "filter = \"bux\"", "4:10: `image.filter` must be \"box\" or \"tent\" or \"gaussian\" or \"blackman-harris\", not \"bux\" | did you mean `box`?"),
    ("width = 64", "filter_radius = 0", "4:17: `image.filter_radius` must be a number above 0 and at most 64, not 0"),
    ("position = [0, 1, 5]", "position = [0, 1]", "8:12: `camera.position` must be three numbers from -1e15 to 1e15, not 2 entries"),
    ("position = [0, 1, 5]", "position = []", "8:12: `camera.position` must be three numbers from -1e15 to 1e15, not 0 entries"),
    ("position = [0, 1, 5]", "position = [0, 1, 2e15]", "8:19: `camera.position` must be three numbers from -1e15 to 1e15, not 2e15"),
    ("position = [0, 1, 5]", "position = [0, inf, 5]", "8:16: `camera.position` must be three numbers from -1e15 to 1e15, not inf"),
    ("position = [0, 1, 5]", "position = [0, 1e999, 5]", "8:16: `camera.position` must be three numbers from -1e15 to 1e15, not 1e999"),
    ("position = [0, 1, 5]", "position = [0, true, 5]", "8:16: `camera.position` must be three numbers from -1e15 to 1e15, not a boolean"),
    ("position = [0, 1, 5]", "position = [0, 1, 0]", "9:11: `camera.look_at` must not be `camera.position`"),
    ("position = [0, 1, 5]", "position = [0, 3, 0]", "9:11: `camera.up` must not be parallel to the view | any other direction will do, as in `up = [0, 0, 1]`"),
    ("position = [0, 1, 5]", "", "7:1: `camera.position` is missing | add `position = ...`, three numbers from -1e15 to 1e15"),
    ("look_at = [0, 1, 0]", "look_at = [0, 1, 0]\nup = [0, 0, 0]", "10:6: `camera.up` must not be [0, 0, 0]"),
    ("look_at = [0, 1, 0]", "look_at = [0, 1, 0]\nup = [0, 0, 3]", "10:6: `camera.up` must not be parallel to the view | any other direction will do, as in `up = [0, 1, 0]`"),
    ("look_at = [0, 1, 0]", "look_at = [0, 1, 0]\nvertical_fov_degrees = 180", "10:24: `camera.vertical_fov_degrees` must be a number above 0 and below 180, not 180"),
    ("type = \"diffuse\"", "", "11:1: `materials.grass.type` is missing | add `type = ...`, \"diffuse\" or \"mirror\" or \"conductor\" or \"dielectric\" or \"plastic\" or \"phong\""),
    ("type = \"diffuse\"", "type = \"mirror\"\nreflectance = [1, 1, 1]", "14:1: `materials.grass.albedo` is not a key of a scene | known here: type, reflectance, emission, opacity"),
    ("type = \"diffuse\"", "type = \"phong\"\nspecular = [0.9, 0, 0]\nexponent = 9", "13:12: `materials.grass.specular` and albedo add up to more than 1, so that the surface would create light | lower one of them; `normalized = false` is Phong's own form"),
    ("type = \"diffuse\"", "type = \"diffuse\"\nemission = [-1, 0, 0]", "13:13: `materials.grass.emission` must be three numbers from 0 to 1e15, not -1"),
    ("type = \"diffuse\"", "type = \"diffuse\"\nroughness = 2", "13:13: `materials.grass.roughness` must be a number from 0 to 1, not 2"),
    ("type = \"diffuse\"", "type = \"diffuse\"\nopacity = 1.5", "13:11: `materials.grass.opacity` must be a number from 0 to 1, not 1.5"),
    ("type = \"diffuse\"", "type = \"diffuse\"\nabsorption = [1, 1, 1]", "13:1: `materials.grass.absorption` is not a key of a scene | known here: type, albedo, roughness, emission, opacity"),
    ("type = \"diffuse\"", "type = \"plastic\"\nior = 0.9", "13:7: `materials.grass.ior` must be a number from 1 to 10, not 0.9"),
    ("type = \"diffuse\"", "type = \"plastic\"\nroughness = -1", "13:13: `materials.grass.roughness` must be a number from 0 to 1, not -1"),
    ("ior = 1.5", "ior = 1.5\nabsorption = [0, 0, -1]", "18:21: `materials.glass.absorption` must be three numbers from 0 to 1e15, not -1"),
    ("ior = 1.5", "ior = 0", "17:7: `materials.glass.ior` must be a number from 0.1 to 10, not 0"),
    ("ior = 1.5", "ior = 1.5\npriority = 3000000000", "18:12: `materials.glass.priority` must be a whole number from -2147483648 to 2147483647, not 3000000000"),
    ("name = \"ground\"", "name = \"\"", "20:8: `spheres.\"\".name` must be a string, not an empty one"),
    ("radius = 10\n", "radius = 0\n", "22:10: `spheres.ground.radius` must be a number from 1e-15 to 1e15, not 0"),
    ("radius = 10\n", "radius = -inf\n", "22:10: `spheres.ground.radius` must be a number from 1e-15 to 1e15, not -inf"),
    ("material = \"grass\"", "material = \"water\"", "23:12: `spheres.ground.material` must be the name of a material, not \"water\" | add a table `[materials.water]`"),
    ("[render]", "[rendr]", "30:2: `rendr` is not a key of a scene | did you mean `render`?"),
    ("[render]", "[render]\nmax_depth = 0", "31:13: `render.max_depth` must be a whole number from 1 to 4294967295, not 0"),
    ("look_at = [0, 1, 0]", "look_at = [0, 1, 0]\ntype = \"fisheye\"", "10:8: `camera.type` must be \"perspective\" or \"orthographic\" or \"panoramic\", not \"fisheye\""),
    ("look_at = [0, 1, 0]", "look_at = [0, 1, 0]\ntype = \"orthographic\"", "7:1: `camera.height` is missing | add `height = ...`, a number above 0 and at most 1e15"),
    ("look_at = [0, 1, 0]", "look_at = [0, 1, 0]\ntype = \"panoramic\"\nvertical_extent_degrees = 181", "11:27: `camera.vertical_extent_degrees` must be a number above 0 and at most 180, not 181"),
    ("look_at = [0, 1, 0]", "look_at = [0, 1, 0]\naperture_radius = -1", "10:19: `camera.aperture_radius` must be a number from 0 to 1e15, not -1"),
    ("look_at = [0, 1, 0]", "look_at = [0, 1, 0]\nblades = 2", "10:10: `camera.blades` must be 0 for a disk, or at least 3, not 2"),
    ("look_at = [0, 1, 0]", "look_at = [0, 1, 0]\nfocus_on = \"grond\"", "10:12: `camera.focus_on` must be the name of a sphere, not \"grond\" | did you mean `ground`?"),
    ("look_at = [0, 1, 0]", "look_at = [0, 1, 0]\nfocus_on = \"ground\"\nfocus_distance = 2", "10:12: `camera.focus_on` and `camera.focus_distance` say the same; leave one out"),
    ("[render]", "[render]\nestimator = \"mix\"", "31:13: `render.estimator` must be \"mis\" or \"light\" or \"bsdf\", not \"mix\" | did you mean `mis`?"),
    ("[render]", "[render]\nclamp_indirect = 0", "31:18: `render.clamp_indirect` must be a number above 0 and at most 1e15, not 0"),
    ("[render]", "[render]\nambient_occlusion.distance = -1", "31:30: `render.ambient_occlusion.distance` must be a number above 0 and at most 1e15, not -1"),
    ("[render]", "[render]\nsamples_per_pixel = 0", "31:21: `render.samples_per_pixel` must be a whole number from 1 to 4294967295, not 0"),
    ("[render]", "[render]\npaper = 3", "31:9: `render.paper` must be a table, not an integer"),
    ("[render]", "[render]\nraycast.shadows = 1", "31:19: `render.raycast.shadows` must be true or false, not an integer"),
    ("[render]", "[render]\npaper.threshold = 0.1", "31:19: `render.paper.threshold` means nothing without `stop = \"threshold\"`"),
    ("[render]", "[render]\npaper.jitter = 1.1", "31:16: `render.paper.jitter` must be a number from 0 to 1, not 1.1"),
    ("[render]", "[render]\nsampler = \"sobl\"", "31:11: `render.sampler` must be \"sobol\" or \"independent\" or \"stratified\", not \"sobl\" | did you mean `sobol`?"),
    ("[render]", "[render]\nintegrator = \"paper\"\npaper.stop = \"depth\"", "32:14: `render.paper.stop = \"depth\"` needs `render.max_depth` | add `max_depth = 6` to `[render]`"),
];

/// The metals, as a message lists them.
const METALS: &str = "\"gold\" or \"silver\" or \"copper\" or \"aluminium\" or \"aluminum\" or \"iron\" or \"chromium\" or \"nickel\" or \"titanium\" or \"platinum\" or \"tungsten\" or \"brass\"";

#[test]
fn metals_are_named_or_given_by_their_index() {
    let metal = |keys: &str| with("type = \"diffuse\"\nalbedo = [0.2, 0.6, 0.2]", keys);
    let of = |keys: &str| {
        let text = metal(&format!("type = \"conductor\"\n{keys}"));
        load(&text, &[]).expect("a good scene").description.materials[0].surface
    };
    let gold = Metal::NAMED[0].1;
    assert_eq!(of("metal = \"gold\""), Surface::Conductor { metal: gold, roughness: 0.0 });
    let own = Metal { ior: [0.0, 1.0, 2.0].into(), extinction: [3.0, 4.0, 5.0].into() };
    let given = of("ior = [0, 1, 2]\nextinction = [3, 4, 5]\nroughness = 0.5");
    assert_eq!(given, Surface::Conductor { metal: own, roughness: 0.5 });

    let told = |keys: &str, expected: &[&str]| {
        assert_told(&metal(&format!("type = \"conductor\"\n{keys}")), &[], expected);
    };
    let expected =
        format!("11:1: `materials.grass.metal` is missing | add `metal = ...`, {METALS}");
    told("", &[&expected]);
    let wrong = format!("13:9: `materials.grass.metal` must be {METALS}, not \"golt\" ");
    told("metal = \"golt\"", &[&(wrong + "| did you mean `gold`?")]);
    told(
        "metal = \"gold\"\nextinction = [3, 4, 5]",
        &["14:14: `materials.grass.extinction` says again what `metal` says already \
           | remove `metal`, or both `ior` and `extinction`"],
    );
    told(
        "ior = [0, 1, 101]",
        &[
            "11:1: `materials.grass.extinction` is missing | add `extinction = ...`, \
             three numbers from 0 to 100",
            "13:14: `materials.grass.ior` must be three numbers from 0 to 100, not 101",
        ],
    );
    told(
        "metal = \"iron\"\nroughness = 2",
        &["14:13: `materials.grass.roughness` must be a number from 0 to 1, not 2"],
    );
}

#[test]
fn every_mistake_has_its_place_and_its_words() {
    for (old, new, expected) in MISTAKES {
        assert_told(&with(old, new), &[], &[expected]);
    }
    let expected = ["command line:1:20: 65536 x 32769 pixels are more than 2^31"];
    assert_told(SCENE, &["image.width=65536", "image.height=32769"], &expected);
}

#[test]
fn a_scene_without_its_parts_says_which() {
    let text = "format = 1\n[camera]\nposition=[0,0,1]\nlook_at=[0,0,0]\nspheres = []\n";
    let expected = [
        "5:1: `camera.spheres` is not a key of a scene \
         | known here: type, position, look_at, up, near, vertical_fov_degrees, aperture_radius, focus_distance, focus_on, blades, rotation_degrees",
        "5:13: the scene has no spheres | add `[[spheres]]` with center, radius and material",
    ];
    assert_told(text, &[], &expected);
    let expected = [
        "1:1: `format` is missing | add `format = 1` as the first line",
        "1:11: `spheres` must be a list of tables, not an integer | write `[[spheres]]` above each",
        "1:12: `[camera]` is missing",
    ];
    assert_told("spheres = 3", &[], &expected);
}

#[test]
fn options_replace_what_the_file_says() {
    let options = [
        "materials.grass.albedo=[1,0,0]",
        "spheres.0.radius=20",
        "spheres.ground.center.1 = -20",
        "spheres.1.name='a \"b\"'",
        "render.integrator=paper",
        "render.paper.samples=9",
        "image.filter='tent'",
        "render.seed=1",
        "render.seed=2",
    ];
    let description = load(SCENE, &options).expect("a good scene").description;
    let albedo = [1.0, 0.0, 0.0].into();
    assert_eq!(description.materials[0].surface, Surface::Diffuse { albedo, roughness: 0.0 });
    assert_eq!(description.spheres[0].radius, 20.0);
    assert_eq!(description.spheres[0].center.y, -20.0);
    assert_eq!(description.spheres[1].name.as_deref(), Some("a \"b\""));
    assert!(matches!(description.render.integrator, Integrator::Paper(Paper { samples: 9, .. })));
    assert_eq!(description.render.samples_per_pixel, 36);
    assert_eq!(description.image.filter, FilterKind::Tent);
    assert_eq!(description.render.seed, 2, "the last one wins");
}

#[test]
fn options_reach_quoted_names_and_whole_tables() {
    let named = with("name = \"ground\"", "name = \"the ground\"");
    let description = load(&named, &["spheres.\"the ground\".radius=3"]).expect("good").description;
    assert_eq!(description.spheres[0].radius, 3.0);
    let whole = "materials.water={ type = \"mirror\", reflectance = [1, 1, 1] }";
    let description = load(SCENE, &[whole, "spheres.1.material=water"]).expect("good").description;
    assert_eq!(description.materials[description.spheres[1].material].name, "water");
}

/// What is set, and what is said of it.
#[rustfmt::skip]
const MISTAKES_IN_OPTIONS: &[(&str, &str)] = &[
    ("image.widht=3", "1:7: `image.widht` is not a key of a scene | did you mean `width`?"),
    ("images.width=3", "1:7: `images` is not a key of a scene | did you mean `image`?"),
    ("image.width=0", "1:19: `image.width` must be a whole number from 1 to 65536, not 0"),
    ("image.width=", "1:19: the value is missing"),
    ("image.width=wide", "1:19: `image.width` must be a whole number from 1 to 65536, not a string"),
    ("image..width=3", "1:7: the key cannot be read: unquoted keys cannot be empty, expected letters, numbers, `-`, `_`"),
    ("materials.grass.albedo=[1,0", "1:34: the value is not TOML: unclosed array, expected `]`"),
    ("materials.grass.albedo=[1,0,2]", "1:35: `materials.grass.albedo` must be three numbers from 0 to 1, not 2"),
    ("materials.gras.albedo=[1,0,0]", "1:7: there is no material \"gras\" | did you mean `grass`?"),
    ("spheres.2.radius=1", "1:7: `spheres` has 2 entries, counted from 0"),
    ("spheres.-1.radius=1", "1:7: no entry of `spheres` is named \"-1\""),
    ("spheres.grund.radius=1", "1:7: no entry of `spheres` is named \"grund\" | did you mean `ground`?"),
    ("spheres.'0'.radius=1", "1:7: no entry of `spheres` is named \"0\""),
    ("render.seed.x=1", "1:7: `render.seed` is an integer and has no keys"),
    ("render.seed=1\nrender.max_depth=2", "1:19: the value must be a single one"),
];

#[test]
fn mistakes_in_options_are_shown_in_the_option() {
    for (option, expected) in MISTAKES_IN_OPTIONS {
        assert_told(SCENE, &[option], &[&format!("command line:{expected}")]);
    }
    let twin = "[[spheres]]\nname='ground'\ncenter=[0,0,0]\nradius=1\nmaterial='grass'\n";
    let expected = "command line:1:7: 2 entries of `spheres` are named \"ground\" \
                    | say which by its number, as in `spheres.0`";
    assert_told(&format!("{SCENE}{twin}"), &["spheres.ground.radius=1"], &[expected]);
}

#[test]
fn an_option_of_its_own_name_is_shown_as_written() {
    let spp = Override {
        option: "--spp 0".into(),
        key: "render.samples_per_pixel".into(),
        value: "0".into(),
    };
    let error = read_text("a.toml", SCENE, Path::new(""), &[spp]).expect_err("0 samples");
    let place = error.mistakes()[0].place.as_ref().expect("a place");
    assert_eq!(place.source.text, "--spp 0");
    assert_eq!(place.span, 6..7);
}

/// Sub-pixels and samples of the paper's integrator with these lines in `[render]`.
fn paper_samples(render: &str, options: &[&str]) -> (u32, u32) {
    let text = with("seed = 7", render);
    let render = load(&text, options).expect("a good scene").description.render;
    let Integrator::Paper(paper) = render.integrator else { panic!("not the paper's") };
    assert_eq!(render.samples_per_pixel, paper.subpixels.pow(2) * paper.samples);
    (paper.subpixels, paper.samples)
}

#[test]
fn the_papers_samples_follow_from_all_that_is_said_of_them() {
    let switch = "render.integrator=paper";
    assert_eq!(paper_samples("integrator = \"paper\"", &[]), (2, 4));
    assert_eq!(paper_samples("integrator = \"paper\"\nsamples_per_pixel = 20", &[]), (2, 5));
    assert_eq!(paper_samples("integrator = \"paper\"\npaper.samples = 100", &[]), (2, 100));
    assert_eq!(paper_samples("samples_per_pixel = 64", &[switch]), (2, 16));
    assert_eq!(paper_samples("samples_per_pixel = 64\npaper.samples = 3", &[switch]), (2, 3));
    assert_eq!(paper_samples("samples_per_pixel = 64\npaper.subpixels = 3", &[switch]), (3, 4));
    let spp = "render.samples_per_pixel=36";
    assert_eq!(paper_samples("paper.subpixels = 3", &[switch, spp]), (3, 4));
    assert_eq!(paper_samples("integrator = \"paper\"\nsamples_per_pixel = 8", &[spp]), (2, 9));
}

#[test]
fn the_papers_samples_must_not_contradict_each_other() {
    let said = |render: &str, options: &[&str], expected: &str| {
        let text = with("seed = 7", &format!("integrator = \"paper\"\n{render}"));
        assert_told(&text, options, &[expected]);
    };
    said(
        "samples_per_pixel = 10",
        &[],
        "32:21: `render.samples_per_pixel` must be a multiple of the 2 x 2 sub-pixels, not 10 \
         | try 8",
    );
    said(
        "samples_per_pixel = 20\npaper.samples = 4",
        &[],
        "32:21: `render.samples_per_pixel` is 20, but 2 x 2 sub-pixels of 4 samples make 16 \
         | `render.paper.samples` is set in test.toml:33:17; leave one of the two out",
    );
    said(
        "paper.samples = 4",
        &["render.samples_per_pixel=36"],
        "command line:1:32: `render.samples_per_pixel` is 36, but 2 x 2 sub-pixels of 4 samples \
         make 16 | `render.paper.samples` is set in test.toml:32:17; leave one of the two out",
    );
    said(
        "paper.samples = 4000000000",
        &[],
        "32:1: `render.paper` asks for 16000000000 samples per pixel, more than 2^32 - 1",
    );
}

#[test]
fn samplers_are_read_and_the_paper_keeps_independent_numbers() {
    let sampler = |lines: &str, overrides: &[&str]| {
        let text = with("seed = 7", lines);
        load(&text, overrides).expect("good").description.render.sampler
    };
    assert_eq!(sampler("", &[]), SamplerKind::Sobol);
    assert_eq!(sampler("sampler = \"independent\"", &[]), SamplerKind::Independent);
    assert_eq!(sampler("", &["render.sampler=stratified"]), SamplerKind::Stratified);
    assert_eq!(sampler("integrator = \"paper\"", &[]), SamplerKind::Independent);
    let asked = "integrator = \"paper\"\nsampler = \"sobol\"";
    assert_eq!(sampler(asked, &[]), SamplerKind::Sobol);
}

#[test]
fn the_papers_options_are_read() {
    let text = with(
        "seed = 7",
        "integrator = \"paper\"\nmax_depth = 3\n[render.paper]\nsubpixels = 3\nsamples = 5\n\
         hemisphere = \"uniform-angle\"\nstop = \"threshold\"\nthreshold = 0.25\nmiss = \"redraw\"\n\
         jitter = 0.5\n[render.raycast]\nshadows = true",
    );
    let expected = Paper {
        subpixels: 3,
        samples: 5,
        hemisphere: Hemisphere::UniformAngle,
        stop: Stop::Threshold(0.25),
        miss: Miss::Redraw,
        jitter: 0.5,
    };
    let render = load(&text, &[]).expect("good").description.render;
    assert_eq!(render.integrator, Integrator::Paper(expected));
    let render = load(&text, &["render.integrator=raycast"]).expect("good").description.render;
    assert_eq!(render.integrator, Integrator::Raycast { shadows: true });
    assert_eq!(render.samples_per_pixel, 1);
}

#[test]
fn no_truncated_scene_makes_the_reader_panic() {
    let mut good = 0;
    for end in (0..=EXAMPLE.len()).filter(|&end| EXAMPLE.is_char_boundary(end)) {
        good += usize::from(load(&EXAMPLE[..end], &["image.width=8"]).is_ok());
    }
    assert!((1..EXAMPLE.len() / 2).contains(&good), "{good} pieces are scenes");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn no_edited_scene_makes_the_reader_panic(
        edits in prop::collection::vec(
            (any::<prop::sample::Index>(), 0usize..12, "[ -~\n]{0,6}"), 1..4),
        key in "[a-z0-9.\"']{0,12}",
        value in "[ -~\n]{0,8}",
    ) {
        let mut text = EXAMPLE.to_owned();
        for (at, cut, insert) in edits {
            let start = at.index(text.len() + 1);
            let end = (start + cut).min(text.len());
            text.replace_range(start..end, &insert);
        }
        let option = Override { option: format!("--set {key}={value}"), key, value };
        if let Err(error) = read_text("edited.toml", &text, Path::new("tests/data"), &[option]) {
            let shows_text = |mistake: &Mistake| {
                let place = mistake.place.as_ref();
                place.is_none_or(|place| place.source.text.get(place.span.clone()).is_some())
            };
            prop_assert!(error.mistakes().iter().all(shows_text), "{error}");
            prop_assert!(!error.to_string().is_empty());
        }
    }
}

#[test]
fn backgrounds_are_read_with_their_defaults() {
    let background = |options: &[&str]| load(SCENE, options).expect("good").description.background;
    let gradient = background(&["background.gradient={zenith=[0,0,1],horizon=[1,1,1]}"]);
    let white = [1.0; 3].into();
    let dome = Dome::Gradient { zenith: [0.0, 0.0, 1.0].into(), horizon: white, nadir: white };
    assert_eq!(gradient.dome, dome);

    let sun = "background.sun={elevation_degrees=30,azimuth_degrees=90,irradiance=[1,1,1]}";
    let sun = background(&[sun, "background.sky={}"]).sun.expect("a sun");
    assert!(sun.direction.distance(DVec3::new(0.75f64.sqrt(), 0.5, 0.0)) < 1e-12);
    assert_eq!(sun.angular_diameter_degrees, 0.533);
    let sun = "background.sun={elevation_degrees=90,irradiance=[1,1,1]}";
    let up = background(&[sun, "background.up=[0,0,2]"]).sun.expect("a sun").direction;
    assert!(up.distance(DVec3::Z) < 1e-12);

    let transparent = background(&["background.transparent=true"]);
    assert!(transparent.transparent && !transparent.camera_visible);
}

#[test]
fn mistakes_in_backgrounds_say_what_to_do() {
    let sun = "background.sun={direction=[0,1,0],irradiance=[1,1,1]}";
    for (options, expected) in [
        (
            &["background.radiance=[1,1,1]", "background.sky={}", sun][..],
            "`background` has both `radiance` and `sky`",
        ),
        (&["background.sky={}"], "`background.sky` needs `[background.sun]`"),
        (
            &["background.sky={}", "background.sun={direction=[0,-1,0],irradiance=[1,1,1]}"],
            "needs a sun above the horizon",
        ),
        (
            &["background.sky={turbidity=11}", sun],
            "`background.sky.turbidity` must be a number from 2 to 10, not 11",
        ),
        (
            &["background.sun={irradiance=[1,1,1]}"],
            "`background.sun` needs `direction`, or `elevation_degrees`",
        ),
        (&["background.sun={direction=[0,1,0]}"], "`background.sun.irradiance` is missing"),
        (
            &["background.sun={direction=[0,0,0],irradiance=[1,1,1]}"],
            "`background.sun.direction` must not be [0, 0, 0]",
        ),
        (
            &["background.sun={direction=[0,1,0],elevation_degrees=3,irradiance=[1,1,1]}"],
            "`background.sun` has a direction and angles",
        ),
        (&["background.gradient={zenith=[1,1,1]}"], "`background.gradient.horizon` is missing"),
        (&["background.up=[0,0,0]"], "`background.up` must not be [0, 0, 0]"),
        (
            &["background.transparent=true", "background.camera_visible=true"],
            "`background.camera_visible` is true, but",
        ),
        (&["background.image={}"], "`background.image.file` is missing"),
        (&["background.image={file=\"none.exr\"}"], "none.exr` as background: No such file"),
        (&["background.image={file=\"example.toml\"}"], "does not end in .exr or .hdr"),
    ] {
        let told = told(SCENE, options);
        assert!(told.len() == 1 && told[0].contains(expected), "{told:?} is not {expected}");
    }
}

#[test]
fn images_that_are_no_background_say_why() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, width: usize, height: usize, pixel: f32| {
        let layer = vec![Rgb::splat(1.0); width * height];
        let mut picture =
            Picture { width, height, direct: layer.clone(), indirect: layer, alpha: None };
        picture.direct[5] = Rgb::new(1.0, pixel, 1.0);
        Target::new(&folder.path().join(name)).unwrap().write(&picture).unwrap();
    };
    write("square.exr", 4, 4, 1.0);
    write("square.hdr", 4, 4, 1.0);
    write("negative.exr", 4, 2, -3.0);
    write("nan.exr", 4, 2, f32::NAN);
    write("good.exr", 4, 2, 3.0);
    write("good.hdr", 4, 2, 3.0);
    std::fs::write(folder.path().join("empty.exr"), "").unwrap();
    std::fs::write(folder.path().join("text.hdr"), "no picture").unwrap();
    let load = |name: &str| {
        let image = set(&format!("background.image={{file=\"{name}\"}}"));
        read_text("test.toml", SCENE, folder.path(), &[image])
    };
    for (name, expected) in [
        ("square.exr", "it has 4 x 4 pixels, but"),
        ("square.hdr", "it has 4 x 4 pixels, but"),
        (
            "negative.exr",
            "1 of its pixels are negative, infinite or not a number, first the one in column 1, row 1, which is [2, -2, 2]",
        ),
        ("nan.exr", "which is [2, NaN, 2]"),
        ("empty.exr", "as background: "),
        ("text.hdr", "as background: "),
    ] {
        let told = load(name).expect_err("a mistake").mistakes()[0].to_string();
        assert!(told.contains(expected), "{told} is not {expected}");
    }
    for name in ["good.exr", "good.hdr"] {
        let scene = Scene::new(load(name).expect("a good image")).expect("few spheres");
        // Pixel (1, 1) is seen in the middle of its quarter, at 45 degrees below the horizon.
        let seen = scene.background(DVec3::new(-0.5, -0.5f64.sqrt(), -0.5));
        assert!((seen - Rgb::new(2.0, 4.0, 2.0)).length() < 0.04, "{name}: {seen}");
    }
}
