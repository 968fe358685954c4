//! Options that replace what the file says.

use std::path::Path;

use photosphere::scene::description::SurfaceModel;
use photosphere::scene::settings::{FilterKind, IntegratorSettings, PaperSettings};
use photosphere::scene::{Override, SceneFile, read_text};

use crate::scenes::{SCENE, assert_told, load, with};

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
    let SceneFile { description, settings, .. } = load(SCENE, &options).expect("a good scene");
    let albedo = [1.0, 0.0, 0.0].into();
    assert_eq!(description.materials[0].surface, SurfaceModel::Diffuse { albedo, roughness: 0.0 });
    assert_eq!(description.spheres[0].radius, 20.0);
    assert_eq!(description.spheres[0].center.y, -20.0);
    assert_eq!(description.spheres[1].name.as_deref(), Some("a \"b\""));
    assert!(matches!(
        settings.render.integrator,
        IntegratorSettings::Paper(PaperSettings { samples: 9, .. })
    ));
    assert_eq!(settings.render.samples_per_pixel, 36);
    assert_eq!(settings.image.filter, FilterKind::Tent);
    assert_eq!(settings.render.seed, 2, "the last one wins");
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
    ("image.widht=3", "1:7: unknown key `image.widht` | did you mean `width`?"),
    ("images.width=3", "1:7: unknown key `images` | did you mean `image`?"),
    ("image.width=0", "1:19: `image.width` must be a whole number from 1 to 65536, not 0"),
    ("image.width=", "1:19: the value is missing"),
    ("image.width=wide", "1:19: `image.width` must be a whole number from 1 to 65536, not a string"),
    ("image..width=3", "1:7: the key cannot be read: unquoted keys cannot be empty, expected letters, numbers, `-`, `_`"),
    ("materials.grass.albedo=[1,0", "1:34: the value is not TOML: unclosed array, expected `]`"),
    ("materials.grass.albedo=[1,0,2]", "1:35: `materials.grass.albedo` must be three numbers from 0 to 1, not 2"),
    ("materials.gras.albedo=[1,0,0]", "1:7: there is no material \"gras\" | did you mean `grass`?"),
    ("spheres.2.radius=1", "1:7: `spheres` has 2 entries, counted from 0"),
    ("spheres.-1.radius=1", "1:7: no entry of `spheres` is named \"-1\" | named are \"ground\"; each has a number, from 0 to 1"),
    ("spheres.grund.radius=1", "1:7: no entry of `spheres` is named \"grund\" | did you mean `ground`?"),
    ("spheres.'0'.radius=1", "1:7: no entry of `spheres` is named \"0\" | named are \"ground\"; each has a number, from 0 to 1"),
    ("particles.0.radius=1", "1:7: the scene has no `[[particles]]` whose keys could be set"),
    ("sphere_tables.a.name=b", "1:7: the scene has no `[[sphere_tables]]` whose keys could be set"),
    ("render.seed.x=1", "1:7: `render.seed` is an integer and has no keys"),
    ("render.seed=1\nrender.max_depth=2", "1:19: the value must be a single TOML value"),
];

#[test]
fn mistakes_in_options_are_shown_in_the_option() {
    for (option, expected) in MISTAKES_IN_OPTIONS {
        assert_told(SCENE, &[option], &[&format!("command line:{expected}")]);
    }
    let twin = "[[spheres]]\nname='ground'\ncenter=[0,0,0]\nradius=1\nmaterial='grass'\n";
    let expected = "command line:1:7: 2 entries of `spheres` are named \"ground\" \
                    | use its number, such as `spheres.0`";
    assert_told(&format!("{SCENE}{twin}"), &["spheres.ground.radius=1"], &[expected]);
}

#[test]
fn an_option_of_its_own_name_is_shown_as_written() {
    let spp = Override::new("render.samples_per_pixel", "0").with_option(["--spp", "0"]);
    let error = read_text("a.toml", SCENE, Path::new(""), &[spp]).expect_err("0 samples");
    let place = error.diagnostics()[0].location.as_ref().expect("a place");
    assert_eq!(place.source.text, "--spp 0");
    assert_eq!(place.span, 6..7);
}

#[test]
fn an_override_of_a_program_is_shown_as_a_key_and_a_value() {
    let spp = Override::new("render.samples_per_pixel", "0");
    let error = read_text("a.toml", SCENE, Path::new(""), &[spp]).expect_err("0 samples");
    let place = error.diagnostics()[0].location.as_ref().expect("a place");
    assert_eq!(place.source.text, "render.samples_per_pixel=0");
    assert!(error.to_string().starts_with("override:1:26: `render.samples_per_pixel`"), "{error}");
}
