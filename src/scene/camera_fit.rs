//! Places a camera that is fitted to what the scene shows, and focuses a lens on what was named.
//!
//! A scene shows its tables, and its single spheres except lamps, shadow catchers and those so much
//! larger than all the rest that they must be a ground or a wall.

use rayon::prelude::*;

use crate::appearance::{FramedCamera, Framing, Legend, Projection, frame};
use crate::camera::Camera;
use crate::error::Result;
use crate::geometry::Sphere;
use crate::math::{DVec3, normalize_robust};

use super::camera::{CameraDescription, CameraFit, FocusTarget, ProjectionDescription};
use super::scene::Scene;
use super::settings::ImageSettings;
use super::validation_errors::{KeyPath, ValidationErrors};

/// A single sphere with a radius this many times the extent of everything smaller is a ground or a
/// wall.
const MIN_GROUND_SCALE: f64 = 10.0;

/// The widest angle that a fitted panorama gives to what it shows, in degrees.
const WIDEST_PANORAMIC_VIEW: f64 = 90.0;

/// The largest margin of a fitted camera.
const MAX_MARGIN: f64 = 0.49;

/// An axis-aligned box: its lowest and its highest corner.
#[derive(Clone, Copy)]
struct Bounds([DVec3; 2]);

impl Bounds {
    const NOTHING: Self = Self([DVec3::INFINITY, DVec3::NEG_INFINITY]);

    fn of(sphere: &Sphere) -> Self {
        Self([sphere.center - sphere.radius, sphere.center + sphere.radius])
    }

    fn merge(self, other: Self) -> Self {
        Self([self.0[0].min(other.0[0]), self.0[1].max(other.0[1])])
    }

    fn is_empty(self) -> bool {
        self.0[0].x > self.0[1].x
    }

    /// Half of the diagonal.
    fn extent(self) -> f64 {
        0.5 * self.0[0].distance(self.0[1])
    }

    fn middle(self) -> DVec3 {
        0.5 * (self.0[0] + self.0[1])
    }
}

/// The spheres that a scene shows, in coordinates relative to their origin.
struct Subjects<'a> {
    scene: &'a Scene,
    /// For each single sphere, true if it is not shown.
    left_out: Vec<bool>,
    bounds: Bounds,
}

impl<'a> Subjects<'a> {
    fn of(scene: &'a Scene) -> Self {
        let description = scene.description();
        let origin = scene.spheres().origin();
        let singles = &description.spheres;
        let is_hidden = |row: usize| {
            let single = &singles[row];
            single.shadow_catcher || scene.materials()[single.material].is_emissive()
        };
        let is_in_table = |id: &u32| scene.spheres().row(*id) as usize >= singles.len();
        let bounds_of = |id| Bounds::of(&scene.spheres().sphere(id));
        let ids = (0..scene.spheres().len() as u32).into_par_iter();
        let tables =
            ids.filter(is_in_table).map(bounds_of).reduce(|| Bounds::NOTHING, Bounds::merge);
        let mut shown: Vec<usize> = (0..singles.len()).filter(|&row| !is_hidden(row)).collect();
        if shown.is_empty() && tables.is_empty() {
            shown = (0..singles.len()).collect();
        }
        shown.sort_by(|&a, &b| singles[a].radius.total_cmp(&singles[b].radius));
        let single = |row: &usize| Bounds::of(&singles[*row].sphere().relative_to(origin));
        // With each sphere, the bounds of all that are smaller.
        let mut smaller = vec![tables];
        smaller.extend(shown.iter().scan(tables, |bounds, row| {
            *bounds = bounds.merge(single(row));
            Some(*bounds)
        }));
        while let Some(&largest) = shown.last() {
            let rest = smaller[shown.len() - 1];
            if rest.is_empty() || singles[largest].radius <= MIN_GROUND_SCALE * rest.extent() {
                break;
            }
            shown.pop();
        }
        let mut left_out = vec![true; singles.len()];
        shown.iter().for_each(|&row| left_out[row] = false);
        Self { scene, left_out, bounds: smaller[shown.len()] }
    }

    /// Frames them with the field of view of a perspective, or with parallel rays.
    fn frame(&self, camera: &CameraDescription, fit: &CameraFit, aspect: f64) -> FramedCamera {
        let vertical_fov_degrees = match camera.projection {
            ProjectionDescription::Perspective { vertical_fov_degrees, .. } => {
                Some(vertical_fov_degrees)
            }
            _ => None,
        };
        let framing = Framing {
            view: fit.direction,
            up: normalize_robust(camera.up).expect("it was validated"),
            vertical_fov_degrees,
            zoom: 1.0,
            aspect,
            margins: [fit.margin, fit.right_margin.unwrap_or(fit.margin), fit.margin, fit.margin],
        };
        let spheres = self.scene.spheres();
        let is_shown = |id: &u32| {
            let row = spheres.row(*id) as usize;
            !self.left_out.get(row).is_some_and(|left_out| *left_out)
        };
        let first = (0..spheres.len() as u32).find(is_shown).unwrap_or(0);
        // Those that are not shown are replaced by one that is.
        let sphere = |index: usize| {
            let id = Some(index as u32).filter(is_shown).unwrap_or(first);
            let Sphere { center, radius } = spheres.sphere(id);
            (center, radius)
        };
        frame(&framing, spheres.len(), sphere).expect("a scene has spheres, all of them finite")
    }
}

impl CameraFit {
    /// Leaves room for a legend at the right, unless it is known what stays free there.
    pub(super) fn leave_room_for(&mut self, legend: &Legend) {
        // Something must be left of the picture.
        let most = 0.9 - self.margin;
        let with_legend = || (self.margin + legend.room()).min(most).min(MAX_MARGIN);
        if legend.room() > 0.0 && self.right_margin.is_none() {
            self.right_margin = Some(with_legend());
        }
    }
}

impl Scene {
    /// The camera for pictures of this size: that of the description, with position, view and focus
    /// where it leaves them to be derived from the spheres.
    ///
    /// # Errors
    /// If what the lens is to focus on is not there, or is not in front of the camera.
    pub fn camera(&self, image: &ImageSettings) -> Result<CameraDescription> {
        let mut problems = ValidationErrors::default();
        let camera = self.place_camera(image, &mut problems);
        problems.into_result()?;
        Ok(camera)
    }

    /// The camera for pictures of this size, in coordinates relative to the spheres' origin.
    ///
    /// # Errors
    /// As [`Self::camera`].
    pub fn built_camera(&self, image: &ImageSettings) -> Result<Camera> {
        Ok(self.camera(image)?.build(image, self.spheres().origin()))
    }

    /// The lowest and the highest corner of a box around what the scene shows: tables, and single
    /// spheres except lamps, shadow catchers and grounds. In the user's coordinates.
    pub fn subject_bounds(&self) -> [DVec3; 2] {
        let Bounds(corners) = Subjects::of(self).bounds;
        corners.map(|corner| corner + self.spheres().origin())
    }

    /// The camera as in [`Self::camera`]; problems are added to `problems`.
    pub(super) fn place_camera(
        &self,
        image: &ImageSettings,
        problems: &mut ValidationErrors,
    ) -> CameraDescription {
        let mut camera = self.description().camera;
        if let Some(fit) = camera.fit.take() {
            self.fit_camera(&mut camera, &fit, image);
        }
        if let Some(target) = camera.focus_target.take() {
            match self.focus_depth(&camera, target, image) {
                Ok(depth) => {
                    if let Some(lens) = camera.lens_mut() {
                        lens.focus_distance = depth;
                    }
                }
                Err(message) => {
                    let key = match target {
                        FocusTarget::Pixel(..) => "focus_on_pixel",
                        _ => "focus_on",
                    };
                    problems.add(KeyPath::root("camera").key(key), message);
                }
            }
        }
        camera
    }

    fn fit_camera(&self, camera: &mut CameraDescription, fit: &CameraFit, image: &ImageSettings) {
        let subjects = Subjects::of(self);
        let origin = self.spheres().origin();
        let aspect = f64::from(image.width) / f64::from(image.height);
        let framed = subjects.frame(camera, fit, aspect);
        camera.up = framed.up;
        (camera.position, camera.look_at) = (framed.position + origin, framed.look_at + origin);
        match &mut camera.projection {
            ProjectionDescription::Perspective { .. } => {}
            ProjectionDescription::Orthographic { height } => {
                if let Projection::Orthographic(framed) = framed.projection {
                    *height = framed;
                }
            }
            ProjectionDescription::Panoramic { horizontal_degrees, vertical_degrees } => {
                let angle = horizontal_degrees.min(*vertical_degrees).min(WIDEST_PANORAMIC_VIEW);
                let half = 0.5 * (1.0 - 2.0 * fit.margin) * angle.to_radians();
                let distance = subjects.bounds.extent() / libm::sin(half);
                let towards = (framed.position - framed.look_at).normalize();
                camera.look_at = subjects.bounds.middle() + origin;
                camera.position = camera.look_at + towards * distance;
            }
        }
    }

    /// Depth along the view axis of what the lens is to focus on.
    fn focus_depth(
        &self,
        camera: &CameraDescription,
        target: FocusTarget,
        image: &ImageSettings,
    ) -> std::result::Result<f64, String> {
        let to_user = self.spheres().origin();
        let single = |index: u32| self.description().spheres[index as usize].sphere();
        let sphere = match target {
            FocusTarget::Middle => return Ok(camera.position.distance(camera.look_at)),
            FocusTarget::Pixel(x, y) => return self.depth_in_pixel(camera, [x, y], image),
            FocusTarget::Sphere(index) => single(index),
            FocusTarget::TableRow(table, id) => {
                let row = self.row_with_id(table as usize, id).ok_or_else(|| {
                    let name = self.description().name_of_table(table as usize);
                    format!("`camera.focus_on` names the row {id}, which `{name}` does not have")
                })?;
                let ids = (0..self.spheres().len() as u32).into_par_iter();
                let id = ids.find_any(|&id| self.spheres().row(id) == row).ok_or_else(|| {
                    "the sphere of `camera.focus_on` is the same as another, and left out"
                        .to_owned()
                })?;
                let Sphere { center, radius } = self.spheres().sphere(id);
                Sphere { center: center + to_user, radius }
            }
        };
        let depth = camera.depth_of(&sphere);
        match depth > 0.0 {
            true => Ok(depth),
            false => {
                Err("the sphere of `camera.focus_on` is not in front of the camera".to_owned())
            }
        }
    }

    /// Depth of the surface that the centre of the lens sees in the middle of a pixel.
    fn depth_in_pixel(
        &self,
        camera: &CameraDescription,
        [x, y]: [u32; 2],
        image: &ImageSettings,
    ) -> std::result::Result<f64, String> {
        let (width, height) = (image.width, image.height);
        if x >= width || y >= height {
            return Err(format!(
                "`camera.focus_on_pixel` is [{x}, {y}], but the picture has {width} x {height} pixels"
            ));
        }
        let mut pinhole = *camera;
        if let ProjectionDescription::Perspective { lens, .. } = &mut pinhole.projection {
            *lens = None;
        }
        let built = pinhole.build(image, self.spheres().origin());
        let ray = built.generate_ray(f64::from(x) + 0.5, f64::from(y) + 0.5, [0.5; 2]);
        let hit = |id| {
            let sphere = self.spheres().sphere(id);
            sphere.first_root(ray.origin, ray.direction, ray.t_min, f64::INFINITY)
        };
        let ids = (0..self.spheres().len() as u32).into_par_iter();
        let nearest = ids.filter_map(hit).reduce(|| f64::INFINITY, f64::min);
        let axis = (camera.look_at - camera.position).normalize();
        match nearest.is_finite() {
            true => Ok(nearest * ray.direction.dot(axis)),
            false => {
                Err(format!("`camera.focus_on_pixel`: there is no sphere in the pixel [{x}, {y}]"))
            }
        }
    }
}
