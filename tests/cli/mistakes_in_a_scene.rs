//! Mistakes in a scene file, as they are shown.

use crate::desk::{Desk, SCENE, render_with};

#[test]
fn all_of_them_are_shown_with_place_excerpt_and_caret() {
    let scene = SCENE.replace("radius = 1.0", "radius = nan").replace("width", "widht");
    let shown = Desk::new(&scene).run("render scene.toml -o out.png").fails(3, &[]);
    let radius = r#"
error: `spheres.ball.radius` must be a number from 1e-15 to 1e15, not nan
    ,-[scene.toml:29:10]
 28 | center = [0.0, 1.0, 0.0]
 29 | radius = nan
    :          ^^^
 30 | material = "grass"
    `----
"#;
    let width = r"
error: unknown key `image.widht`
   ,-[scene.toml:4:1]
 3 | [image]
 4 | widht = 16
   : ^^|^^
   :   `-- unknown
 5 | height = 12
   `----
  help: did you mean `width`?
";
    for expected in [radius.trim_start(), width.trim_start()] {
        assert!(shown.stderr.contains(expected), "{}", shown.stderr);
    }
}

#[test]
fn sizes_numbers_and_names_are_checked() {
    let cases = [
        ("width = 16", "width = 0", "`image.width` must be a whole number from 1"),
        ("width = 16", "width = 1e3", "`image.width` must be"),
        ("radius = 1.0", "radius = nan", "`spheres.ball.radius` must be"),
        ("radius = 1.0", "radius = -1.0", "`spheres.ball.radius` must be"),
        ("[0.0, 1.0, 0.0]\nradius", "[0.0, inf, 0.0]\nradius", "`spheres.ball.center"),
        ("albedo", "albdeo", "did you mean `albedo`"),
        ("\"path\"", "\"pth\"", "did you mean `path`"),
        ("\"diffuse\"", "\"difuse\"", "did you mean `diffuse`"),
        ("format = 1", "format = 2", "format"),
        ("samples_per_pixel = 4", "samples_per_pixel = 0", "`render.samples_per_pixel` must"),
        ("[render]", "[render", "[scene.toml:32:8]"),
    ];
    for (piece, replacement, message) in cases {
        render_with(piece, replacement).fails(3, &["error: ", "[scene.toml:", message]);
    }
}

#[test]
fn a_scene_without_spheres_is_refused() {
    let start = SCENE.find("[[spheres]]").expect("spheres");
    let end = SCENE.find("[render]").expect("render");
    let scene = [&SCENE[..start], &SCENE[end..]].concat();
    Desk::new(&scene).run("render scene.toml -o out.png").fails(3, &["no spheres"]);
}

#[test]
fn samples_must_suit_the_sub_pixels_of_the_paper() {
    let desk = Desk::new(SCENE);
    let paper = "render scene.toml -o out.png --integrator paper";
    desk.run(&format!("{paper} --spp 6"))
        .fails(3, &["--spp 6", "a multiple of the 2 x 2 sub-pixels, not 6"]);
}

#[test]
fn a_picture_without_light_or_spheres_is_warned_of() {
    let render = "render scene.toml -o out.png --spp 1 --quiet";
    let said = |from: &str, to: &str| {
        let desk = Desk::new(&SCENE.replacen(from, to, 1));
        [render, "info scene.toml"].map(|command| desk.run(command).succeeds().stderr)
    };
    let dark = said("radiance = [0.5, 0.6, 0.7]", "radiance = [0, 0, 0]");
    assert!(dark.iter().all(|told| told.contains("warning: nothing shines")), "{dark:?}");
    assert!(dark[0].contains("warning: the picture is black"), "{}", dark[0]);
    let paper = said("radiance = [0.5, 0.6, 0.7]", "backdrop = \"white\"");
    assert!(paper.iter().all(|told| told.contains("warning: nothing shines")), "{paper:?}");
    let away = said("look_at = [0.0, 1.5, 0.0]", "look_at = [1.0, 90.0, 19.0]");
    assert!(away.iter().all(|told| told.contains("no sphere is in view")), "{away:?}");
    assert!(away[0].contains("one colour everywhere"), "{}", away[0]);
    let fine = said("radiance", "radiance");
    assert!(fine.iter().all(String::is_empty), "{fine:?}");
}

#[test]
fn a_new_type_leaves_out_the_keys_of_the_old_one() {
    let desk = Desk::new(SCENE);
    let shown = desk.run("info scene.toml --json --set camera.type=orthographic").succeeds();
    let note =
        "`camera.vertical_fov_degrees` of the scene is left out: it does not go with this `type`";
    assert!(shown.stderr.contains(note), "{}", shown.stderr);
    let fitted = desk.run("info scene.toml --set camera.fit=true").succeeds();
    for key in ["position", "look_at"] {
        let note =
            format!("`camera.{key}` of the scene is left out: it does not go with this `fit`");
        assert!(fitted.stderr.contains(&note), "{}", fitted.stderr);
    }
    let glass = "render scene.toml -o a.png --spp 1 --quiet --set materials.grass.type=dielectric \
                 --set materials.grass.ior=1.5";
    let told = desk.run(glass).succeeds().stderr;
    assert!(told.contains("`materials.grass.albedo` of the scene is left out"), "{told}");
}

#[test]
fn a_file_that_is_no_scene_gets_one_sentence() {
    let shown =
        Desk::new("<scene version=\"3.0.0\">\n</scene>\n").run("render scene.toml -o a.png");
    let shown = shown.fails(3, &["this is no scene: it looks like XML", "format = 1"]);
    assert_eq!(shown.stderr.matches("error:").count(), 1, "{}", shown.stderr);
}
