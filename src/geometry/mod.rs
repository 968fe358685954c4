//! The heart: one sphere, and all the spheres of a scene as one array.

mod arrange;
mod cone;
mod giants;
mod median;
mod morton;
mod origin;
mod rays;
mod set;
mod sphere;
mod surface;

pub use cone::{Cone, ConeSample};
pub use rays::{PathRays, RayBlock};
pub use set::{SphereRows, SphereSet};
pub use sphere::{Roots, Sphere};
pub use surface::{PathRay, Side, SurfaceHit};
