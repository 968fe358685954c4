//! Scenes and renders as values: what a program fills in is what a scene file says, arrays in
//! memory are the spheres that they hold, and a session can be looked at, stopped, resumed and
//! extended.

mod arrays;
mod inputs;
mod memory;
mod sessions;
mod text;

use photosphere::Error;
use photosphere::accel::{Backend, BackendChoice};
use photosphere::film::Aov;
use photosphere::geometry::Sphere;
use photosphere::image_io::{ChannelValues, Picture};
use photosphere::job::Job;
use photosphere::math::DVec3;
use photosphere::scene::{Scene, SceneBuilder, Settings, SphereArrays};

/// A job for these settings on two threads.
fn job(settings: Settings, kinds: &[Aov]) -> Job {
    Job { threads: 2, accel: BackendChoice::Only(Backend::Native), ..Job::from_settings(settings) }
        .aovs(kinds)
}

/// Numbers that f32 can hold, or not.
fn balls(is_f64: bool) -> Vec<Sphere> {
    let more = if is_f64 { 1e-9 } else { 0.0 };
    let ball = |i: u32| {
        let at = |step: u32, range: u32| f64::from(i * step % range) / 16.0 + more;
        let center = DVec3::new(at(29, 101) - 3.0, at(17, 67) - 2.0, at(13, 43) - 3.0);
        Sphere { center, radius: f64::from(1 + i % 5) / 16.0 + more }
    };
    (0..60).map(ball).collect()
}

fn color_of(row: usize) -> [f32; 3] {
    [row % 4, row % 3, row % 5].map(|part| part as f32 / 8.0 + 0.25)
}

fn view() -> SceneBuilder {
    let mut scene = SceneBuilder::new();
    scene.camera([0.0, 0.0, 12.0], [0.0; 3]).background([0.9, 1.0, 1.1]);
    scene
}

fn of_arrays(arrays: SphereArrays) -> Result<Scene, Error> {
    let mut scene = view();
    let grey = scene.diffuse([0.5; 3]);
    scene.spheres(grey, arrays).build()
}

fn sphere_ids(picture: &Picture) -> &[u32] {
    let plane = picture.channels.iter().find(|plane| plane.name == "sphere_id").expect("asked for");
    match &plane.values {
        ChannelValues::Uint(ids) => ids,
        other => panic!("{other:?}"),
    }
}

/// The numbers of each sphere: x, y, z and the radius.
fn rows(balls: &[Sphere]) -> Vec<[f64; 4]> {
    balls.iter().map(|ball| [ball.center.x, ball.center.y, ball.center.z, ball.radius]).collect()
}

fn narrow<const N: usize>(rows: &[[f64; N]]) -> Vec<[f32; N]> {
    rows.iter().map(|row| row.map(|number| number as f32)).collect()
}
