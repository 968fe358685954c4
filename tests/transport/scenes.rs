//! The scenes and estimators that the tests share.

/// The estimators that solve the whole rendering equation, as overrides.
pub(crate) const ESTIMATORS: [&[&str]; 4] = [
    &["render.integrator=path"],
    &["render.integrator=paper"],
    &["render.integrator=paper", "render.paper.hemisphere=uniform-solid-angle"],
    &["render.integrator=paper", "render.paper.hemisphere=uniform-angle"],
];

pub(crate) fn with<'a>(some: &[&'a str], more: &[&'a str]) -> Vec<&'a str> {
    some.iter().chain(more).copied().collect()
}

/// Inside a sphere of albedo 1/2 and emission 1 every point has radiance 1/(1 - 1/2), whatever else
/// of reflectance 1 is in there.
pub(crate) const FURNACE: &str = r#"
format = 1
[image]
width = 6
height = 6
[camera]
position = [0.0, 0.0, 3.0]
look_at = [0.0, 0.0, 0.0]
vertical_fov_degrees = 60.0
[materials.wall]
type = "diffuse"
albedo = [0.5, 0.5, 0.5]
emission = [1.0, 1.0, 1.0]
[materials.white]
type = "diffuse"
albedo = [1.0, 1.0, 1.0]
[materials.mirror]
type = "mirror"
reflectance = [1.0, 1.0, 1.0]
[materials.glass]
type = "dielectric"
ior = 1.5
[materials.water]
type = "dielectric"
ior = 1.33
priority = 1
[[spheres]]
center = [1.0, 2.0, 0.5]
radius = 10.0
material = "wall"
[render]
samples_per_pixel = 16
"#;

pub(crate) const CONTENTS: &str = r#"
[[spheres]]
center = [-1.2, 0.0, 0.0]
radius = 0.6
material = "white"
[[spheres]]
center = [0.0, 0.9, 0.0]
radius = 0.7
material = "mirror"
[[spheres]]
name = "glass"
center = [0.6, -0.4, 0.0]
radius = 0.8
material = "glass"
[[spheres]]
name = "bubble"
center = [0.6, -0.4, 0.1]
radius = 0.4
material = "glass"
[[spheres]]
name = "water reaching into the glass"
center = [1.3, -0.4, 0.0]
radius = 0.5
material = "water"
"#;

/// A matt ball under a lamp that it sees entirely: radiance is `albedo L (R / d)^2 cos`.
pub(crate) const LONE_BALL: &str = r#"
format = 1
[image]
width = 2
height = 2
[camera]
position = [0.0, 0.0, 6.0]
look_at = [0.0, 0.0, 1.0]
vertical_fov_degrees = 0.0001
[materials.ball]
type = "diffuse"
albedo = [0.8, 0.8, 0.8]
[materials.lamp]
type = "diffuse"
albedo = [0.0, 0.0, 0.0]
emission = [7.0, 7.0, 7.0]
[[spheres]]
name = "ball"
center = [0.0, 0.0, 0.0]
radius = 1.0
material = "ball"
[[spheres]]
name = "lamp"
center = [0.0, 3.0, 5.0]
radius = 2.0
material = "lamp"
[render]
samples_per_pixel = 256
"#;
