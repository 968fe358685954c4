//! What mirrors and lenses make of light.

use crate::kit::{Judged, Kit, diffuse, glass, mirror};
use crate::scenes::estimators;

#[test]
fn two_mirrors_facing_each_other_add_up_a_geometric_series() {
    // Along the common axis: L = e_a + r_a (e_b + r_b (e_a + ...)), six edges long.
    let mut kit = Kit::new(1, 1, 64).depth(6);
    kit.scene.camera([0.0; 3], [0.0, 0.0, 1.0]).field_of_view(0.000001);
    kit.glowing_ball([0.0, 0.0, 2.0], 1.0, mirror(0.5), 1.0);
    kit.glowing_ball([0.0, 0.0, -3.0], 2.0, mirror(0.8), 0.25);
    let round = 1.0 + 0.5 * 0.25;
    let expected = round * (1.0 + 0.4 + 0.16);
    for kit in &estimators(&kit)[..2] {
        kit.mean().must_be(expected, "two mirrors");
    }
}

#[test]
fn a_glass_ball_has_its_focus_where_lens_makers_say() {
    // A ball lens of index n and radius R focuses paraxial rays n R / (2 (n - 1)) from its centre:
    // 1.5 R for n = 1.5. A tiny emitter there fills the view; one 5 % further fills a part of it.
    let share = |z: f64| {
        let mut kit = Kit::new(32, 32, 16).depth(3);
        kit.scene.camera([0.0, 0.0, -100000.0], [0.0; 3]).field_of_view(0.00004);
        kit.ball([0.0; 3], 1.0, glass(1.5));
        kit.glowing_ball([0.0, 0.0, z], 0.0003, diffuse(0.0), 1.0);
        kit.picture().mean().y
    };
    // 4 % is reflected at each of the two surfaces.
    let focused = share(1.5);
    assert!((focused - 0.96 * 0.96).abs() < 0.01, "{focused}");
    assert!(share(1.575) < 0.5 * focused);
    assert!(share(1.425) < 0.5 * focused);
}
