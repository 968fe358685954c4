//! Each mistake has its place and its words, and all come at once.

use crate::scenes::{SCENE, assert_told, told, with};

#[test]
fn all_mistakes_are_told_at_once_in_the_order_of_the_file() {
    let text = SCENE
        .replace("width = 64", "widht = 64")
        .replace("albedo = [0.2, 0.6, 0.2]", "albedo = [0.2, 1.6, 0.2]")
        .replace("radius = 10", "radius = nan")
        .replace("material = \"glass\"", "material = \"gras\"")
        .replace("seed = 7", "seed = -7");
    let expected = [
        "4:1: unknown key `image.widht` | did you mean `width`?",
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
    assert!(told[0].starts_with("4:1: unknown key `image.widht`"), "{told:#?}");
    assert!(told[1].starts_with("22:10: this is not TOML: "), "{told:#?}");
    assert!(told[2].starts_with("31:"), "{told:#?}");
    let twice = with("width = 64", "width = 64\nwidth = 65");
    assert_told(&twice, &[], &["5:1: this is not TOML: duplicate key"]);
}

/// One line of the scene, what is written instead, and what is said of it.
#[rustfmt::skip]
const MISTAKES: &[(&str, &str, &str)] = &[
    ("format = 1", "", "1:1: `format` is missing | add `format = 1` as the first line"),
    ("format = 1", "format = 2", "1:10: format 2 is not supported; this version of photosphere reads format 1"),
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
    ("position = [0, 1, 5]", "position = [0, 3, 0]", "9:11: `camera.up` must not be parallel to the view | use another direction, such as `up = [0, 0, 1]`"),
    ("position = [0, 1, 5]", "", "7:1: `camera.position` is missing | add `position = ...`, three numbers from -1e15 to 1e15"),
    ("look_at = [0, 1, 0]", "look_at = [0, 1, 0]\nup = [0, 0, 0]", "10:6: `camera.up` must not be [0, 0, 0]"),
    ("look_at = [0, 1, 0]", "look_at = [0, 1, 0]\nup = [0, 0, 3]", "10:6: `camera.up` must not be parallel to the view | use another direction, such as `up = [0, 1, 0]`"),
    ("look_at = [0, 1, 0]", "look_at = [0, 1, 0]\nvertical_fov_degrees = 180", "10:24: `camera.vertical_fov_degrees` must be a number above 0 and below 180, not 180"),
    ("type = \"diffuse\"", "", "11:1: `materials.grass.type` is missing | add `type = ...`, \"diffuse\" or \"mirror\" or \"conductor\" or \"dielectric\" or \"plastic\" or \"principled\" or \"phong\""),
    ("type = \"diffuse\"", "type = \"mirror\"\nreflectance = [1, 1, 1]", "14:1: unknown key `materials.grass.albedo` | known keys: type, reflectance, emission, opacity"),
    ("type = \"diffuse\"", "type = \"phong\"\nspecular = [0.9, 0, 0]\nexponent = 9", "13:12: `materials.grass.specular` and albedo add up to more than 1, so that the surface would create light | lower one of them, or set `normalized = false` for Phong's original form"),
    ("type = \"diffuse\"", "type = \"diffuse\"\nemission = [-1, 0, 0]", "13:13: `materials.grass.emission` must be three numbers from 0 to 1e15, not -1"),
    ("type = \"diffuse\"", "type = \"diffuse\"\nroughness = 2", "13:13: `materials.grass.roughness` must be a number from 0 to 1, not 2"),
    ("type = \"diffuse\"", "type = \"diffuse\"\nopacity = 1.5", "13:11: `materials.grass.opacity` must be a number from 0 to 1, not 1.5"),
    ("type = \"diffuse\"", "type = \"diffuse\"\nabsorption = [1, 1, 1]", "13:1: unknown key `materials.grass.absorption` | known keys: type, albedo, roughness, emission, opacity"),
    ("type = \"diffuse\"", "type = \"plastic\"\nior = 0.9", "13:7: `materials.grass.ior` must be a number from 1 to 10, not 0.9"),
    ("type = \"diffuse\"", "type = \"plastic\"\nroughness = -1", "13:13: `materials.grass.roughness` must be a number from 0 to 1, not -1"),
    ("ior = 1.5", "ior = 1.5\nabsorption = [0, 0, -1]", "18:21: `materials.glass.absorption` must be three numbers from 0 to 1e15, not -1"),
    ("ior = 1.5", "ior = 0", "17:7: `materials.glass.ior` must be a number from 0.1 to 10, not 0"),
    ("ior = 1.5", "ior = 1.5\npriority = 3000000000", "18:12: `materials.glass.priority` must be a whole number from -2147483648 to 2147483647, not 3000000000"),
    ("name = \"ground\"", "name = \"\"", "20:8: `spheres.\"\".name` must be a string, not an empty one"),
    ("radius = 10\n", "radius = 0\n", "22:10: `spheres.ground.radius` must be a number from 1e-15 to 1e15, not 0"),
    ("radius = 10\n", "radius = -inf\n", "22:10: `spheres.ground.radius` must be a number from 1e-15 to 1e15, not -inf"),
    ("material = \"grass\"", "material = \"water\"", "23:12: `spheres.ground.material` must be the name of a material, not \"water\" | add a table `[materials.water]`"),
    ("[render]", "[rendr]", "30:2: unknown key `rendr` | did you mean `render`?"),
    ("[render]", "[render]\nmax_depth = 0", "31:13: `render.max_depth` must be a whole number from 1 to 4294967295, not 0"),
    ("look_at = [0, 1, 0]", "look_at = [0, 1, 0]\ntype = \"fisheye\"", "10:8: `camera.type` must be \"perspective\" or \"orthographic\" or \"panoramic\", not \"fisheye\""),
    ("look_at = [0, 1, 0]", "look_at = \"0, 1,0\"", "9:11: `camera.look_at` must be three numbers from -1e15 to 1e15, not a string | write [0, 1,0]"),
    ("look_at = [0, 1, 0]", "look_at = [0, 1, 0]\nfov = 40", "10:1: unknown key `camera.fov` | here it is called vertical_fov_degrees"),
    ("type = \"diffuse\"", "type = \"lambertian\"", "12:8: `materials.grass.type` must be \"diffuse\" or \"mirror\" or \"conductor\" or \"dielectric\" or \"plastic\" or \"principled\" or \"phong\", not \"lambertian\" | here it is called diffuse"),
    ("look_at = [0, 1, 0]", "look_at = [0, 1, 0]\naperture_radius = 1\nf_number = 2", "11:12: `camera.f_number` and `camera.aperture_radius` both set the aperture; remove one"),
    ("look_at = [0, 1, 0]", "look_at = [0, 1, 0]\ntype = \"panoramic\"\nvertical_extent_degrees = 181", "11:27: `camera.vertical_extent_degrees` must be a number above 0 and at most 180, not 181"),
    ("look_at = [0, 1, 0]", "look_at = [0, 1, 0]\naperture_radius = -1", "10:19: `camera.aperture_radius` must be a number from 0 to 1e15, not -1"),
    ("look_at = [0, 1, 0]", "look_at = [0, 1, 0]\nblades = 2", "10:10: `camera.blades` must be 0 for a disk, or at least 3, not 2"),
    ("look_at = [0, 1, 0]", "look_at = [0, 1, 0]\nfocus_on = \"grond\"", "10:12: `camera.focus_on` must be the name of a sphere, not \"grond\" | did you mean `ground`?"),
    ("look_at = [0, 1, 0]", "look_at = [0, 1, 0]\nfocus_on = \"ground\"\nfocus_distance = 2", "10:12: `camera.focus_on` and `camera.focus_distance` both set the focus; remove one"),
    ("look_at = [0, 1, 0]", "look_at = [0, 1, 0]\nmargin = 0.1", "10:10: `camera.margin` is of use only with `fit = true` | add `fit = true`, or remove it"),
    ("look_at = [0, 1, 0]", "fit = true", "8:12: `camera.position` is given, but `fit = true` finds it | remove one of them"),
    ("position = [0, 1, 5]\nlook_at = [0, 1, 0]", "fit = true\ndirection = \"left\"", "9:13: `camera.direction` must be \"iso\", an axis such as \"-y\", \"AZIMUTH,ELEVATION\" in degrees, the first up to 360 and the second from -90 to 90, or three numbers, not \"left\""),
    ("position = [0, 1, 5]\nlook_at = [0, 1, 0]", "fit = true\ndirection = \"20,95\"", "9:13: `camera.direction` must be \"iso\", an axis such as \"-y\", \"AZIMUTH,ELEVATION\" in degrees, the first up to 360 and the second from -90 to 90, or three numbers, not \"20,95\""),
    ("position = [0, 1, 5]\nlook_at = [0, 1, 0]", "fit = true\ndirection = [0, 0, 0]", "9:13: `camera.direction` must be \"iso\", an axis such as \"-y\", \"AZIMUTH,ELEVATION\" in degrees, the first up to 360 and the second from -90 to 90, or three numbers, not [0, 0, 0]"),
    ("look_at = [0, 1, 0]", "look_at = [0, 1, 0]\nfocus_on_pixel = [1]", "10:18: `camera.focus_on_pixel` must be [x, y], the column and the row of a pixel, not 1 numbers"),
    ("[render]", "[render]\nestimator = \"mix\"", "31:13: `render.estimator` must be \"mis\" or \"light\" or \"bsdf\", not \"mix\" | did you mean `mis`?"),
    ("[render]", "[render]\nclamp_indirect = 0", "31:18: `render.clamp_indirect` must be a number above 0 and at most 1e15, not 0"),
    ("[render]", "[render]\nambient_occlusion.distance = -1", "31:30: `render.ambient_occlusion.distance` must be a number above 0 and at most 1e15, not -1"),
    ("[render]", "[render]\nsamples_per_pixel = 0", "31:21: `render.samples_per_pixel` must be a whole number from 1 to 4294967295, not 0"),
    ("[render]", "[render]\npaper = 3", "31:9: `render.paper` must be a table, not an integer"),
    ("[render]", "[render]\nraycast.shadows = 1", "31:19: `render.raycast.shadows` must be true or false, not an integer"),
    ("[render]", "[render]\npaper.threshold = 0.1", "31:19: `render.paper.threshold` needs `stop = \"threshold\"`"),
    ("[render]", "[render]\npaper.jitter = 1.1", "31:16: `render.paper.jitter` must be a number from 0 to 1, not 1.1"),
    ("[render]", "[render]\nsampler = \"sobl\"", "31:11: `render.sampler` must be \"sobol\" or \"independent\" or \"stratified\", not \"sobl\" | did you mean `sobol`?"),
    ("[render]", "[render]\nintegrator = \"paper\"\npaper.stop = \"depth\"", "32:14: `render.paper.stop = \"depth\"` needs `render.max_depth` | add `max_depth = 6` to `[render]`"),
];

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
        "5:1: unknown key `camera.spheres`",
        "5:13: the scene has no spheres | add `[[spheres]]` with center, radius and material",
    ];
    assert_told(text, &[], &expected);
    let expected = [
        "1:1: `format` is missing | add `format = 1` as the first line",
        "1:11: `spheres` must be a list of tables, not an integer | write `[[spheres]]` above each",
        "1:12: `[camera]` is missing | add `[camera]` with `fit = true`, which shows all that the scene \
         has, or with position and look_at",
    ];
    assert_told("spheres = 3", &[], &expected);
    let bare = SCENE.split("[[spheres]]").next().expect("what stands before the spheres");
    let expected = "1:17: `sphere_tables` must be a list of tables, not an integer \
                    | write `[[sphere_tables]]` above each";
    assert_told(&format!("sphere_tables = 3\n{bare}"), &[], &[expected]);
}
