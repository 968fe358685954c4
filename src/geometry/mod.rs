//! The heart: one sphere, and all the spheres of a scene as one array.

mod build;
mod cone;
mod giants;
mod median;
mod morton;
mod origin;
mod rays;
mod set;
mod sphere;
mod path_ray;

pub use cone::{Cone, ConeSample};
pub use rays::{PathRays, RayBlock};
pub use set::{SphereRows, SphereSet};
pub use sphere::{Roots, Sphere};
pub use path_ray::{PathRay, Side, SurfaceHit};
