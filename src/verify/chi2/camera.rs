//! Sampling of lenses and film positions.

use crate::camera::Aperture;

use super::SamplingTest;

pub(super) fn tests() -> Vec<SamplingTest> {
    [(0, 0.0), (3, 0.4), (6, -1.0), (9, 2.0)].map(aperture).into()
}

fn aperture((blades, rotation): (u32, f64)) -> SamplingTest {
    let aperture = Aperture { radius: 0.8, blades, rotation };
    SamplingTest::over_rectangle(
        format!("lens of {blades} blades"),
        [[-0.8; 2], [0.8; 2]],
        move |u| Some(aperture.sample([u[0], u[1]])),
        move |at| aperture.pdf(at),
    )
    .with_discontinuities()
}
