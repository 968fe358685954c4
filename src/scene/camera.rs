//! The camera of a scene description.

use serde::{Deserialize, Serialize};

use crate::appearance::ViewDirection;
use crate::camera::{Aperture, Camera, CameraModel, CameraPose, ThinLens};
use crate::geometry::Sphere;
use crate::math::{DVec3, normalize_robust};
use crate::names::named_enum;

use super::settings::ImageSettings;

/// The camera (`[camera]`).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraDescription {
    /// Camera position: the centre of the lens or of the image plane.
    pub position: DVec3,
    /// The point at the centre of the picture.
    pub look_at: DVec3,
    /// The up direction in the picture.
    pub up: DVec3,
    /// Depth along the view axis at which camera rays start; for a panorama, the distance.
    pub near: f64,
    /// The projection: `type` and its keys.
    pub projection: ProjectionDescription,
    /// Derives position and `look_at`, whose values then do not matter, and the height of parallel
    /// rays.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fit: Option<CameraFit>,
    /// What the lens focuses on, if that is not known before the spheres are loaded: the focus
    /// distance then does not matter.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub focus_target: Option<FocusTarget>,
}

/// Where a camera goes that frames what the scene shows (`fit = true`).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraFit {
    /// From what is shown to the camera.
    pub direction: ViewDirection,
    /// The share of the width and of the height that stays free on each side; in [0, 0.49].
    pub margin: f64,
    /// The share of the width that stays free at the right, where a colour bar is drawn; in
    /// [0, 0.49]. `None` is `margin`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub right_margin: Option<f64>,
}

/// What the lens focuses on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum FocusTarget {
    /// The middle of what the camera is fitted to.
    Middle,
    /// An individually described sphere, by its index.
    Sphere(u32),
    /// A sphere of a table: the index of the table, and the id (or else the row) in it.
    TableRow(u32, u32),
    /// What the centre of the lens sees in this pixel, from the upper left corner.
    Pixel(u32, u32),
}

impl Default for CameraDescription {
    /// At (0, 0, 10), looking at the origin, pinhole with a field of view of 36 degrees, y up.
    fn default() -> Self {
        Self {
            position: DVec3::new(0.0, 0.0, 10.0),
            look_at: DVec3::ZERO,
            up: DVec3::Y,
            near: 0.0,
            projection: ProjectionDescription::default(),
            fit: None,
            focus_target: None,
        }
    }
}

/// The mapping from directions to picture positions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "kebab-case", deny_unknown_fields)]
pub enum ProjectionDescription {
    /// `type = "perspective"`.
    Perspective {
        /// Vertical field of view, in degrees.
        vertical_fov_degrees: f64,
        /// The lens; `None` is a pinhole.
        lens: Option<LensDescription>,
    },
    /// `type = "orthographic"`: parallel rays.
    Orthographic {
        /// Height of the view, in scene units.
        height: f64,
    },
    /// `type = "panoramic"`: columns are longitudes, rows are latitudes.
    Panoramic {
        /// Horizontal field of view, in degrees.
        horizontal_degrees: f64,
        /// Vertical field of view, in degrees.
        vertical_degrees: f64,
    },
}

impl Default for ProjectionDescription {
    /// A pinhole with a field of view of 36 degrees.
    fn default() -> Self {
        Self::Perspective { vertical_fov_degrees: 36.0, lens: None }
    }
}

/// The projection types, without parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ProjectionKind {
    /// [`ProjectionDescription::Perspective`].
    #[default]
    Perspective,
    /// [`ProjectionDescription::Orthographic`].
    Orthographic,
    /// [`ProjectionDescription::Panoramic`].
    Panoramic,
}

named_enum! {
    ProjectionKind {
        Perspective = "perspective",
        Orthographic = "orthographic",
        Panoramic = "panoramic",
    }
}

impl ProjectionDescription {
    /// The type of this projection.
    pub fn kind(&self) -> ProjectionKind {
        match self {
            Self::Perspective { .. } => ProjectionKind::Perspective,
            Self::Orthographic { .. } => ProjectionKind::Orthographic,
            Self::Panoramic { .. } => ProjectionKind::Panoramic,
        }
    }
}

/// A thin lens.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LensDescription {
    /// Radius of the aperture, in scene units.
    pub radius: f64,
    /// Distance to the focal plane along the view axis, given directly or by `focus_on`.
    pub focus_distance: f64,
    /// Number of aperture blades; 0 for a disk.
    pub blades: u32,
    /// Rotation of the aperture, counter-clockwise in the picture's axes, in degrees.
    pub rotation_degrees: f64,
}

impl CameraDescription {
    /// Brings equivalent cameras into one form: a lens with radius 0 becomes a pinhole, and what a
    /// fit derives keeps no value of its own.
    pub(super) fn make_canonical(&mut self) {
        if let ProjectionDescription::Perspective { lens, .. } = &mut self.projection {
            *lens = lens.filter(|lens| lens.radius > 0.0);
            if let Some(lens) = lens {
                lens.rotation_degrees += 0.0;
            }
        }
        if self.lens().is_none() {
            self.focus_target = None;
        }
        if self.fit.is_some() {
            let usual = Self::default();
            (self.position, self.look_at) = (usual.position, usual.look_at);
            if let ProjectionDescription::Orthographic { height } = &mut self.projection {
                *height = 1.0;
            }
        }
        if let (Some(_), Some(lens)) = (self.focus_target, self.lens_mut()) {
            lens.focus_distance = 1.0;
        }
    }

    /// Builds the camera for pictures of this size, in coordinates relative to `origin`. Its
    /// position and focus must be known.
    pub(super) fn build(&self, image: &ImageSettings, origin: DVec3) -> Camera {
        let pose = CameraPose {
            position: self.position - origin,
            view_direction: self.look_at - self.position,
            up: self.up,
            near: self.near,
            resolution: [image.width, image.height],
        };
        let thin = |lens: LensDescription| {
            let rotation = lens.rotation_degrees.to_radians();
            let aperture = Aperture { radius: lens.radius, blades: lens.blades, rotation };
            ThinLens { aperture, focus_distance: lens.focus_distance }
        };
        let model = match self.projection {
            ProjectionDescription::Perspective { vertical_fov_degrees, lens } => {
                let vertical_fov = vertical_fov_degrees.to_radians();
                // A lens with radius 0 is a pinhole.
                let lens = lens.filter(|lens| lens.radius > 0.0).map(thin);
                CameraModel::Perspective { vertical_fov, lens }
            }
            ProjectionDescription::Orthographic { height } => CameraModel::Orthographic { height },
            ProjectionDescription::Panoramic { horizontal_degrees, vertical_degrees } => {
                let [horizontal, vertical] =
                    [horizontal_degrees, vertical_degrees].map(f64::to_radians);
                CameraModel::Panoramic { horizontal, vertical }
            }
        };
        Camera::new(&pose, model)
    }

    /// From what the picture shows to the camera; any length.
    pub(super) fn direction_to_camera(&self) -> DVec3 {
        match self.fit {
            Some(fit) => fit.direction.towards(normalize_robust(self.up).unwrap_or(DVec3::Y)),
            None => self.position - self.look_at,
        }
    }

    /// Depth along the view axis of the sphere's nearest point to the camera.
    pub(super) fn depth_of(&self, sphere: &Sphere) -> f64 {
        let axis = (self.look_at - self.position).normalize_or_zero();
        let to_center = sphere.center - self.position;
        to_center.dot(axis) * (1.0 - sphere.radius / to_center.length())
    }

    /// The lens, if the camera has one.
    pub fn lens(&self) -> Option<&LensDescription> {
        match &self.projection {
            ProjectionDescription::Perspective { lens, .. } => lens.as_ref(),
            _ => None,
        }
    }

    /// The lens, to be changed.
    pub(super) fn lens_mut(&mut self) -> Option<&mut LensDescription> {
        match &mut self.projection {
            ProjectionDescription::Perspective { lens, .. } => lens.as_mut(),
            _ => None,
        }
    }
}
