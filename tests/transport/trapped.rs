//! Light that total reflection traps in a glass ball around the camera.

use photosphere::accel::Backend;
use photosphere::scene::description::SurfaceModel;
use photosphere::scene::settings::{PaperSettings, PathTermination};

use crate::kit::{Judged, Kit, diffuse, glass, rendered};
use crate::scenes::{furnace, must_be};

/// The camera stands at 0.7 of the radius of a ball of index 1.5 and looks across: all that it sees
/// is totally reflected, in planes through the x axis.
fn in_a_ball() -> Kit {
    let mut kit = Kit::new(4, 4, 16);
    kit.scene.camera([0.7, 0.0, 0.0], [0.7, 0.0, 1.0]).field_of_view(20.0).background([2.0; 3]);
    kit.ball([0.0; 3], 1.0, glass(1.5));
    kit
}

/// Adds a lamp on the axis, on the other side of the centre. Every chord comes by sooner or later.
fn with_lamp(mut kit: Kit, x: f64, radius: f64) -> Kit {
    kit.glowing_ball([x, 0.0, 0.0], radius, diffuse(0.0), 3.0);
    kit
}

/// Mean of the green channel, and rays per sample.
fn traced(kit: &Kit) -> (f64, f64) {
    let image = rendered(&kit.prepared(), Backend::BruteForce);
    assert!(image.warnings.is_empty(), "{:?}", image.warnings);
    (image.picture.mean().y, image.rays as f64 / image.samples as f64)
}

#[test]
fn what_is_trapped_is_black_at_once_and_the_rest_is_not() {
    for kit in in_a_ball().both_ways() {
        assert_eq!(traced(&kit), (0.0, 1.0), "{}", kit.how());
        // Another sphere that the chords do not reach, inside their ring, changes nothing.
        assert_eq!(traced(&with_lamp(kit.clone(), -0.3, 0.2)), (0.0, 1.0), "{}", kit.how());
        // Towards the centre all leave the ball, inside of which the field has n^2 its radiance.
        let mut kit = kit;
        kit.scene.camera([0.7, 0.0, 0.0], [0.0; 3]);
        kit.mean().must_be(2.0 * 1.5 * 1.5, &kit.how());
    }
}

/// Some paths need thousands of reflections to find the lamp, and all find it: its radiance.
#[test]
fn a_lamp_in_the_ring_is_found_however_long_it_takes() {
    for (x, radius) in [(-0.85, 0.1), (-0.9, 0.02), (-1.0, 0.03)] {
        for kit in with_lamp(in_a_ball(), x, radius).both_ways() {
            let (_, rays) = traced(&kit);
            assert!(rays < 500.0, "{rays} rays per sample");
            kit.mean().must_be(3.0, &format!("{x}, {}", kit.how()));
        }
    }
}

/// In front of the camera, a hundred flakes: in the middle, where no chord comes, or outside of the
/// planes of all chords, which is known after some reflections.
#[test]
fn many_spheres_that_no_chord_reaches_free_no_light() {
    for (x, y, limit) in [(0.3, 0.0, 1.0), (0.6, 0.6, 64.0)] {
        for mut kit in in_a_ball().both_ways() {
            // All planes contain the x axis, and their angles to the view are below 8 degrees.
            for i in 0..100 {
                let at = [x - 0.005 * f64::from(i), y + 1e-3 * f64::from(i), 0.0];
                kit.glowing_ball(at, 1e-3, diffuse(0.0), 3.0);
            }
            assert_eq!(traced(&kit), (0.0, limit), "{}", kit.how());
        }
    }
}

/// The other stop rules of the paper end no path here, and nothing is lost. Chords of a square
/// never find the lamp, whose ring they are in.
#[test]
fn roulette_shortens_what_no_other_rule_ends() {
    for stop in [PathTermination::Depth, PathTermination::Threshold(0.1)] {
        let paper = PaperSettings { stop, ..PaperSettings::default() };
        let kit = with_lamp(in_a_ball(), -0.9, 0.02).depth(9000).paper(paper);
        kit.mean().must_be(3.0, &format!("{stop:?}"));
        let mut square = kit;
        let x = 0.5f64.sqrt();
        square.scene.camera([x, 0.0, 0.0], [x, 0.0, 1.0]).field_of_view(1e-7);
        let (mean, rays) = traced(&square);
        assert_eq!(mean, 0.0);
        assert!(rays < 1000.0, "{stop:?}: {rays} rays per sample");
    }
}

/// A glowing ball adds light at each reflection: of what each chord leaves, the geometric series.
#[test]
fn a_ball_that_glows_itself_is_no_trap() {
    let mut kit = in_a_ball();
    let SurfaceModel::Dielectric { absorption, .. } = &mut kit.material(0).surface else {
        panic!("glass");
    };
    *absorption = [0.0, 0.4, 0.0].into();
    kit.material(0).emission = [1.0; 3].into();
    // The view is narrow: all chords are at 0.7 from the centre, and the first is half of one.
    kit.scene.field_of_view(1e-3);
    let half = f64::sqrt(1.0 - 0.49);
    let [first, chord] = [half, 2.0 * half].map(|length| f64::exp(-0.4 * length));
    for kit in kit.both_ways() {
        kit.mean().must_be(first / (1.0 - chord), &kit.how());
    }
}

/// From outside a ball of index 0.75 light may be reflected totally, too, but never is trapped.
#[test]
fn total_reflection_from_outside_is_no_trap() {
    let mut kit = furnace();
    kit.scene.camera([0.5, 0.0, 0.0], [0.0; 3]);
    kit.ball([0.0; 3], 1.0, glass(0.75));
    must_be(&kit, 2.0 * 0.75 * 0.75, "a bubble in a furnace");
}
