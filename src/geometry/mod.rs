//! Spheres and the rays that hit them: one sphere, and all spheres of a scene as one array.

mod build;
mod cap;
mod cone;
mod giants;
mod median;
mod morton;
mod origin;
mod path_ray;
mod projected_cap;
mod rays;
mod set;
mod sphere;
mod storage;

pub use cap::{Cap, SphereCut, VisibleCap};
pub use cone::{Cone, ConeSample};
pub use path_ray::{PathRay, Side, SurfaceHit};
pub use projected_cap::ProjectedCap;
pub use rays::{PathRays, RayBlock};
pub use set::SphereSet;
pub use sphere::{LineApproach, Roots, Sphere};
pub use storage::SphereRows;
