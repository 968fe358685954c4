//! The lines and points of the drawing of a path, in the user's coordinates.

use crate::color::Rgb;
use crate::integrator::{PathEvent, PathTrace};
use crate::light::{LightSample, LightSource};
use crate::math::DVec3;
use crate::scene::Scene;

use super::blocker::{distance_to_blocker, stands_on};
use super::spheres::{shadow_result, to_scene};

/// A line of the drawing, in the user's coordinates.
pub(super) struct Line {
    pub(super) class: &'static str,
    pub(super) from: DVec3,
    pub(super) to: Option<DVec3>,
    /// Direction of a line that escapes.
    pub(super) direction: DVec3,
}

/// Contents of the drawing.
#[derive(Default)]
pub(super) struct Sketch {
    pub(super) lines: Vec<Line>,
    /// Start of the path.
    pub(super) camera: DVec3,
    /// Vertices of the path, starting at the camera.
    pub(super) vertices: Vec<DVec3>,
    pub(super) hit_ids: Vec<u32>,
    pub(super) emitters: Vec<u32>,
    /// Where shadow rays are blocked.
    pub(super) blocked: Vec<DVec3>,
    /// Points of spheres that the path hits or samples.
    pub(super) points: Vec<(u32, DVec3)>,
}

impl Sketch {
    /// What there is to draw of a path.
    pub(super) fn of(scene: &Scene, trace: &PathTrace) -> Self {
        let mut sketch = Self::default();
        for (index, event) in trace.events.iter().enumerate() {
            match event {
                PathEvent::CameraRay { ray, .. } => {
                    sketch.camera = to_scene(scene, ray.origin);
                    sketch.vertices.push(sketch.camera);
                }
                PathEvent::Hit { hit, .. } => {
                    let point = to_scene(scene, hit.point);
                    sketch.extend(point);
                    sketch.hit_ids.push(hit.id);
                    sketch.points.push((hit.id, point));
                    if scene.sphere_material(hit.id).material.is_emissive() {
                        sketch.emitters.push(hit.id);
                    }
                }
                PathEvent::Miss { wo, .. } => {
                    sketch.lines.extend(sketch.vertices.last().map(|&from| Line {
                        class: "path",
                        from,
                        to: None,
                        direction: -*wo,
                    }))
                }
                PathEvent::LightSample { sample, .. } => {
                    sketch.add_light_sample(scene, trace, index, sample);
                }
                PathEvent::ShadowCatcher { light: Some(light), .. } => {
                    sketch.add_light_sample(scene, trace, index, &light.sample);
                }
                PathEvent::Connection { .. } => sketch.connect(scene, trace, index),
                _ => {}
            }
        }
        sketch
    }

    /// Adds the shadow ray of the light sample at event `index`, up to what blocks it.
    fn add_light_sample(
        &mut self,
        scene: &Scene,
        trace: &PathTrace,
        index: usize,
        sample: &LightSample,
    ) {
        let LightSample { source, direction, distance, .. } = *sample;
        let Some(&from) = self.vertices.last() else { return };
        if let LightSource::Emitter(id) | LightSource::FarWall(id) = source {
            self.emitters.push(id);
            self.points.push((id, from + distance * direction));
        }
        let Some((visibility, _)) = shadow_result(&trace.events, index, 0) else { return };
        let is_occluded = visibility == Rgb::ZERO;
        let blocker = is_occluded
            .then(|| {
                let way = (from - scene.spheres().origin(), direction);
                let leaving = stands_on(&trace.events[..index]);
                distance_to_blocker(scene, leaving, way, (source.sphere_id(), distance))
            })
            .flatten();
        let length = blocker.unwrap_or(distance);
        let to = length.is_finite().then(|| from + length * direction);
        self.blocked.extend(to.filter(|_| blocker.is_some()));
        let class = if is_occluded { "occluded" } else { "unoccluded" };
        self.lines.push(Line { class, from, to, direction });
    }

    /// Adds the legs of the connection at event `index`.
    fn connect(&mut self, scene: &Scene, trace: &PathTrace, index: usize) {
        let PathEvent::Connection { number, caster, source, connection, .. } = &trace.events[index]
        else {
            return;
        };
        let result = shadow_result(&trace.events, index, *number);
        let (Some((visibility, _)), Some(&vertex)) = (result, self.vertices.last()) else { return };
        self.hit_ids.push(*caster);
        let on_ball = connection.points().iter().map(|&point| (*caster, to_scene(scene, point)));
        self.points.extend(on_ball);
        let class = if visibility == Rgb::ZERO { "occluded" } else { "unoccluded" };
        let mut from = vertex;
        for &point in connection.points() {
            let to = to_scene(scene, point);
            self.lines.push(Line { class, from, to: Some(to), direction: DVec3::ZERO });
            from = to;
        }
        let direction = -connection.direction_at_y;
        let is_finite = connection.leg_at_y.is_finite();
        let to = is_finite.then(|| from + connection.leg_at_y * direction);
        if let LightSource::Emitter(id) = source {
            self.emitters.push(*id);
            self.points.extend(to.map(|to| (*id, to)));
        }
        self.lines.push(Line { class, from, to, direction });
    }

    /// Extends the path to the next vertex.
    fn extend(&mut self, to: DVec3) {
        if let Some(&from) = self.vertices.last() {
            self.lines.push(Line { class: "path", from, to: Some(to), direction: DVec3::ZERO });
        }
        self.vertices.push(to);
    }
}
