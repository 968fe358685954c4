//! The scenes and estimators that the tests share.

use photosphere::accel::Backend;
use photosphere::color::Rgb;
use photosphere::scene::description::SurfaceModel;
use photosphere::scene::settings::{Hemisphere, PaperSettings};

use crate::kit::{Judged, Kit, diffuse, glass, mirror};

/// The estimators that solve the whole rendering equation: `path_index`, then the paper's.
pub(crate) fn estimators(kit: &Kit) -> [Kit; 4] {
    let paper =
        |hemisphere| kit.clone().paper(PaperSettings { hemisphere, ..PaperSettings::default() });
    [
        kit.clone(),
        paper(Hemisphere::Cosine),
        paper(Hemisphere::UniformSolidAngle),
        paper(Hemisphere::UniformAngle),
    ]
}

/// The mean must be this with every estimator, by brute force.
pub(crate) fn must_be(kit: &Kit, expected: f64, what: &str) {
    for kit in estimators(kit) {
        kit.mean().must_be(expected, &format!("{what}, {}", kit.how()));
    }
}

/// The mean must be this with every estimator and every backend.
pub(crate) fn must_be_everywhere(kit: &Kit, expected: f64, what: &str) {
    for &backend in Backend::AVAILABLE {
        for kit in estimators(kit) {
            let what = format!("{what}, {}, {}", backend.name(), kit.how());
            kit.estimate(backend).must_be(expected, &what);
        }
    }
}

/// The balls of [`furnace`] and [`full_furnace`].
pub(crate) const WALL: usize = 0;
pub(crate) const WHITE: usize = 1;
pub(crate) const BUBBLE: usize = 4;

/// Inside a sphere of albedo 1/2 and emission 1 every point has radiance 1/(1 - 1/2), whatever else
/// of reflectance 1 is in there.
pub(crate) fn furnace() -> Kit {
    let mut kit = Kit::new(6, 6, 16);
    kit.scene.camera([0.0, 0.0, 3.0], [0.0; 3]).field_of_view(60.0);
    kit.glowing_ball([1.0, 2.0, 0.5], 10.0, diffuse(0.5), 1.0);
    kit
}

/// With a white ball, a mirror, a bubble of glass in glass, and water that reaches into the glass.
pub(crate) fn full_furnace() -> Kit {
    let water =
        SurfaceModel::Dielectric { ior: 1.33, roughness: 0.0, priority: 1, absorption: Rgb::ZERO };
    let mut kit = furnace();
    kit.ball([-1.2, 0.0, 0.0], 0.6, diffuse(1.0));
    kit.ball([0.0, 0.9, 0.0], 0.7, mirror(1.0));
    kit.ball([0.6, -0.4, 0.0], 0.8, glass(1.5));
    kit.ball([0.6, -0.4, 0.1], 0.4, glass(1.5));
    kit.ball([1.3, -0.4, 0.0], 0.5, water);
    kit
}

/// A diffuse ball under an emitter that it sees entirely: radiance is `albedo L (R / d)^2 cos`.
pub(crate) fn lone_ball(surface: SurfaceModel) -> Kit {
    let mut kit = Kit::new(2, 2, 256);
    kit.scene.camera([0.0, 0.0, 6.0], [0.0, 0.0, 1.0]).field_of_view(0.0001);
    kit.ball([0.0; 3], 1.0, surface).glowing_ball([0.0, 3.0, 5.0], 2.0, diffuse(0.0), 7.0);
    kit
}
