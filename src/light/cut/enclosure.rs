//! Opaque spheres around the camera.

/// An opaque sphere in which points may be that are shaded. As no light passes it, only a sphere in
/// which camera rays start can be one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Enclosure {
    /// Id of the sphere.
    pub id: u32,
    /// True if all points that are shaded are inside; false if they may be on both sides.
    pub is_certain: bool,
}
