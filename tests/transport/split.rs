//! Direct and indirect light add up.

use crate::kit::{Kit, diffuse};
use crate::scenes::{WALL, WHITE, full_furnace};

/// A figure of the paper, small.
fn figure(number: u32, overrides: &[&str]) -> Kit {
    let small = ["image.width=40", "image.height=30", "render.samples_per_pixel=16"];
    Kit::of_file(&format!("paper/fig{number}.toml"), &[&small[..], overrides].concat())
}

#[test]
fn direct_and_indirect_light_add_up_and_depth_two_is_direct() {
    let kit = figure(2, &[]);
    let all = kit.picture();
    assert!(all.direct.iter().any(|c| c.y > 0.0) && all.indirect.iter().any(|c| c.y > 0.0));
    let direct = kit.depth(2).picture();
    assert_eq!(direct.direct, all.direct, "the same numbers draw the same first edges");
    assert!(direct.indirect.iter().all(|c| c.max_element() == 0.0));
    for i in 0..all.len() {
        assert_eq!(all.beauty(i), all.direct[i] + all.indirect[i]);
    }
}

#[test]
fn mirrors_and_glass_do_not_count_as_scattering() {
    // Nothing scatters: all light is direct, however many mirrors and glasses it passes.
    let mut black = full_furnace();
    for ball in [WALL, WHITE] {
        black.material(ball).surface = diffuse(0.0);
    }
    let seen = black.picture();
    assert!(seen.indirect.iter().all(|c| c.max_element() == 0.0));
    assert!(seen.direct.iter().filter(|c| c.y > 0.0).count() > seen.len() / 2);
    // A ball lit by an emitter and seen in a mirror is direct light as well: three edges, one
    // scattering.
    let view = [
        "materials.floating.albedo=[0,0,0]",
        "camera.look_at=[-1.3,0.7,0]",
        "camera.vertical_fov_degrees=4",
    ];
    let mirrored = figure(4, &view).depth(3).picture();
    assert!(mirrored.indirect.iter().all(|c| c.max_element() == 0.0));
    assert!(mirrored.direct.iter().filter(|c| c.y > 0.0).count() > mirrored.len() / 2);
}

#[test]
fn light_of_the_background_is_split_like_a_emitters() {
    let dark = ["materials.lamp.emission=[0,0,0]", "background.radiance=[1,1,1]"];
    let at_depth = |depth| figure(2, &dark).depth(depth).picture();
    let lit = |layer: &[photosphere::color::Rgb]| layer.iter().filter(|c| c.y > 0.0).count();
    assert_eq!(lit(&at_depth(2).indirect), 0);
    assert!(lit(&at_depth(3).indirect) > 100);
    assert!(lit(&at_depth(3).direct) > 1100);
}
