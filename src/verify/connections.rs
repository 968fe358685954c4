//! Each kind of connection over a polished ball against chance: small pictures of one ball and a
//! lamp of angular radius 20 degrees or more, so that chance is a good judge.
//!
//! In every scene, the kind carries most of the light. Connections alone (`light`) have a bounded
//! variance there: no lit point is at a fold, nor on the line through the ball's centre and the
//! lamp. Next to chance (`mis`), a wide lamp is connected seldom.

use crate::accel::{Accel, Backend, BuildOptions};
use crate::error::Result;
use crate::film::Aov;
use crate::job::render_with_accel;
use crate::math::DVec3;
use crate::scene::settings::{Caustics, Estimator, ImageSettings, RenderSettings, Settings};
use crate::scene::{PreparedScene, SceneBuilder};
use crate::task::CancelToken;

use super::check::{Check, CheckGroup, CheckMeasurement, Effort, TestStatistic, seed};
use super::statistics::MeanEstimate;

/// Independent renders behind every mean.
const SEEDS: u64 = 32;
/// Pixels along each side of a picture.
const SIZE: u32 = 4;
/// Samples per pixel by chance. The last brings its standard error below 0.025 %.
const SAMPLES: [u32; 3] = [1 << 10, 1 << 12, 1 << 18];
/// Connections vary less.
const FEWER: u32 = 16;

/// A matt ball, a polished ball and a lamp, seen at a point of the matt one.
struct KindScene {
    name: &'static str,
    /// Position of the camera, the point that it looks at, and its field of view in degrees.
    camera: ([f64; 3], [f64; 3], f64),
    matt: ([f64; 3], f64),
    polished: ([f64; 3], f64),
    /// Index of refraction; `None` for a mirror.
    ior: Option<f64>,
    lamp: ([f64; 3], f64),
    /// Edges of the paths over the ball.
    edges: u32,
}

const SCENES: [KindScene; 5] = [
    KindScene {
        name: "off a mirror ball",
        camera: ([0.0, 2.0, 3.0], [0.0, 0.0, 0.0], 5.0),
        matt: ([0.0, -100.0, 0.0], 100.0),
        polished: ([1.6, 1.2, 0.0], 1.0),
        ior: None,
        lamp: ([-2.0, 4.0, 0.0], 2.0),
        edges: 3,
    },
    KindScene {
        name: "through a glass ball",
        camera: ([2.0, 0.25, 1.5], [0.0, 0.0, 0.0], 5.0),
        matt: ([0.0, -0.3, 0.0], 0.3),
        polished: ([0.0, 2.5, 0.0], 1.0),
        ior: Some(1.5),
        lamp: ([3.4, 7.5, 0.0], 2.25),
        edges: 4,
    },
    KindScene {
        name: "reflected inside a glass ball",
        camera: ([-1.2, 1.2, 1.9], [-1.2, 0.0, 1.6], 4.0),
        matt: ([-1.32, 0.0, 1.76], 0.2),
        polished: ([0.0, 0.0, 0.0], 1.0),
        ior: Some(2.4),
        lamp: ([1.9, 0.0, 3.5], 1.5),
        edges: 5,
    },
    KindScene {
        name: "into a glass ball",
        camera: ([0.0, 0.0, 4.0], [-0.3, 0.1, 0.1], 4.0),
        matt: ([-0.3, 0.1, 0.1], 0.5),
        polished: ([0.0, 0.0, 0.0], 1.0),
        ior: Some(1.5),
        lamp: ([1.0, 4.0, 2.0], 1.8),
        edges: 4,
    },
    KindScene {
        name: "out of a glass ball",
        camera: ([0.0, 2.0, 3.0], [0.0, 0.0, 0.0], 5.0),
        matt: ([0.0, -100.0, 0.0], 100.0),
        polished: ([0.5, 1.6, 0.0], 1.0),
        ior: Some(1.5),
        lamp: ([0.7, 1.8, 0.1], 0.45),
        edges: 3,
    },
];

/// Returns one check per kind of connection.
pub(super) fn checks(effort: Effort, backends: &[Backend]) -> Vec<Check> {
    let backend = backends.first().copied().unwrap_or(Backend::Native);
    let check = |scene: &'static KindScene| {
        Check::new(CheckGroup::Connections, scene.name, move |cancel| {
            measure(scene, backend, effort.select(SAMPLES), cancel)
        })
    };
    SCENES.iter().map(check).collect()
}

fn measure(
    scene: &KindScene,
    backend: Backend,
    samples: u32,
    cancel: &CancelToken,
) -> Result<CheckMeasurement> {
    let mean = |caustics, estimator, samples_per_pixel| {
        let settings =
            RenderSettings { caustics, estimator, samples_per_pixel, ..scene.render_settings() };
        mean(scene.prepared(settings)?, backend, scene.name, cancel)
    };
    let chance = mean(Caustics::Chance, Estimator::Mis, samples)?;
    let mis = mean(Caustics::Connect, Estimator::Mis, samples / FEWER)?;
    let light = mean(Caustics::Connect, Estimator::Light, samples / FEWER)?;
    let p = [mis, light].map(|connected| connected.welch_p_value(&chance));
    let [by_chance, with_mis, alone] = [chance, mis, light].map(text);
    let detail = format!("{by_chance} by chance, {with_mis} connected, {alone} without chance");
    Ok(CheckMeasurement::new(TestStatistic::PValue((2.0 * p[0].min(p[1])).min(1.0)), detail))
}

fn text(estimate: MeanEstimate) -> String {
    let percent = 100.0 * estimate.standard_error / estimate.mean;
    format!("{:.6} ± {percent:.4} %", estimate.mean)
}

/// The mean of a picture's green channel over independent seeds.
fn mean(
    mut prepared: PreparedScene,
    backend: Backend,
    name: &str,
    cancel: &CancelToken,
) -> Result<MeanEstimate> {
    let build = BuildOptions { threads: 1, cancel: cancel.clone(), ..Default::default() };
    let accel = backend.build(prepared.scene().spheres(), &build)?;
    let caustics = prepared.render_settings().caustics;
    let mut one = |index| {
        // Chance and connections must not share their numbers.
        prepared.set_seed(seed(name, 2 * index + u64::from(caustics == Caustics::Chance)));
        picture_mean(&prepared, &*accel, cancel)
    };
    let values: Vec<f64> = (0..SEEDS).map(&mut one).collect::<Result<_>>()?;
    Ok(MeanEstimate::from_values(&values))
}

fn picture_mean(prepared: &PreparedScene, accel: &dyn Accel, cancel: &CancelToken) -> Result<f64> {
    let picture = render_with_accel(prepared, accel, &Aov::DEFAULT, cancel)?.picture;
    cancel.check()?;
    let sum: f64 = (0..picture.len()).map(|pixel| f64::from(picture.beauty(pixel).y)).sum();
    Ok(sum / picture.len() as f64)
}

impl KindScene {
    fn render_settings(&self) -> RenderSettings {
        RenderSettings { max_depth: Some(self.edges), ..RenderSettings::default() }
    }

    fn prepared(&self, render: RenderSettings) -> Result<PreparedScene> {
        let mut builder = SceneBuilder::new();
        let (position, look_at, field_of_view) = self.camera;
        builder.camera(position, look_at).field_of_view(field_of_view);
        let matt = builder.diffuse([0.6; 3]);
        let polished = match self.ior {
            Some(ior) => builder.glass(ior),
            None => builder.mirror([0.9; 3]),
        };
        let lamp = builder.emitter([1.0; 3]);
        for (material, (center, radius)) in
            [(matt, self.matt), (polished, self.polished), (lamp, self.lamp)]
        {
            builder.sphere(material, DVec3::from(center), radius);
        }
        let image = ImageSettings { width: SIZE, height: SIZE, ..ImageSettings::default() };
        PreparedScene::new(&builder.into_scene()?, Settings { image, render })
    }
}
