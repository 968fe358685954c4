//! Writes a scene file with camera and lights that suit the table.

use std::path::Path;

use super::{Arrangement, Recipe};

/// The camera's target.
const LOOK_AT: [f64; 3] = [0.02, -0.06, 0.0];

impl Recipe {
    /// Camera position, target, and vertical field of view in degrees of [`scene_text`].
    pub fn viewpoint(&self) -> ([f64; 3], [f64; 3], f64) {
        let view = preset_for(self.arrangement);
        (view.position, LOOK_AT, view.fov)
    }
}

/// A floor just below the box, so large that its edge is out of sight.
const FLOOR: &str = r#"
[materials.floor]
type = "diffuse"
albedo = [0.6, 0.58, 0.55]

[[spheres]]
name = "floor"
center = [0.0, -1000.54, 0.0]
radius = 1000.0
material = "floor"
"#;

/// Returns the text of a scene that renders the table `file`, over a floor if asked for.
pub fn scene_text(recipe: &Recipe, file: &Path, has_floor: bool) -> String {
    let Recipe { arrangement, count, seed, colors, .. } = recipe;
    let name = arrangement.name();
    let own = if *colors { ", with colours" } else { "" };
    let columns = if *colors { r#", "r", "g", "b""# } else { "" };
    // JSON string escapes are valid in TOML.
    let file = serde_json::Value::from(file.display().to_string());
    let Viewpoint { position, fov, zenith, horizon, nadir, sun } = preset_for(*arrangement);
    let floor = if has_floor { FLOOR } else { "" };
    format!(
        r#"# {count} generated spheres: {name}, seed {seed}{own}.

format = 1

[image]
width = 960
height = 720
filter = "blackman-harris"

[camera]
position = {position:?}
look_at = {LOOK_AT:?}
vertical_fov_degrees = {fov:?}

[background.gradient]
zenith = {zenith:?}
horizon = {horizon:?}
nadir = {nadir:?}

[background.sun]
elevation_degrees = 38.0
azimuth_degrees = -115.0
angular_diameter_degrees = 3.0
irradiance = {sun:?}

[materials.grain]
type = "diffuse"
albedo = [0.78, 0.76, 0.72]
{floor}
[[sphere_tables]]
file = {file}
columns = ["x", "y", "z", "radius"{columns}]
material = "grain"

[render]
samples_per_pixel = 64
"#
    )
}

/// Camera and lights.
struct Viewpoint {
    position: [f64; 3],
    fov: f64,
    zenith: [f64; 3],
    horizon: [f64; 3],
    nadir: [f64; 3],
    sun: [f64; 3],
}

fn preset_for(arrangement: Arrangement) -> Viewpoint {
    let day = Viewpoint {
        position: [1.75, 1.2, 2.65],
        fov: 29.0,
        zenith: [0.2, 0.3, 0.5],
        horizon: [0.62, 0.55, 0.5],
        nadir: [0.16, 0.14, 0.14],
        sun: [3.8, 3.3, 2.6],
    };
    match arrangement {
        Arrangement::Gas | Arrangement::Packed | Arrangement::Lattice => day,
        Arrangement::Clusters => Viewpoint {
            position: [1.3, 0.6, 2.1],
            fov: 34.0,
            zenith: [0.03, 0.045, 0.09],
            horizon: [0.012, 0.014, 0.025],
            nadir: [0.008, 0.008, 0.012],
            sun: [6.0, 5.4, 4.6],
        },
    }
}
