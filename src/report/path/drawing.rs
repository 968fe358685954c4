//! Draws a path from the side, as SVG.
//!
//! Everything is projected orthographically on the vertical plane in which the path is widest.
//! Spheres are drawn as outlines.

use crate::color::Rgb;
use crate::draw::{Canvas, SideView};
use crate::integrator::{PathEvent, PathTrace};
use crate::light::LightSource;
use crate::math::{DVec2, DVec3};
use crate::scene::{PreparedScene, Scene};

use super::spheres::{name, shadow_result, to_scene};
use super::text::number;

/// More spheres than this only hide the path.
const MAX_SPHERES: usize = 400;

/// Approximate size of a sphere label.
const LABEL: DVec2 = DVec2::new(80.0, 16.0);

const STYLE: &str = "\
text { font: 13px sans-serif; fill: #222 }\n\
.small { font-size: 11.5px; fill: #555 }\n\
.halo { paint-order: stroke; stroke: #fff; stroke-width: 3px }\n\
.sphere { fill: #eef1f4; fill-opacity: .75; stroke: #9aa5b1 }\n\
.hit { fill: #d5e3f0; stroke: #4a6f94; stroke-width: 1.4 }\n\
.emitter { fill: #ffe9a8; fill-opacity: .9; stroke: #b8860b; stroke-width: 1.4 }\n\
.around { fill: none }\n\
.path { stroke: #0b3c6f; stroke-width: 2.4; fill: none }\n\
.unoccluded { stroke: #d98200; stroke-width: 1.6; fill: none }\n\
.occluded { stroke: #c0392b; stroke-width: 1.4; stroke-dasharray: 5 4; fill: none }\n\
.vertex { fill: #0b3c6f; stroke: #fff }\n\
.bar { stroke: #222; stroke-width: 2 }\n";

/// A line of the drawing, in the user's coordinates.
struct Line {
    class: &'static str,
    from: DVec3,
    to: Option<DVec3>,
    /// Direction of a line that escapes.
    direction: DVec3,
}

/// Contents of the drawing.
#[derive(Default)]
struct Sketch {
    lines: Vec<Line>,
    /// Start of the path.
    camera: DVec3,
    /// Vertices of the path, starting at the camera.
    vertices: Vec<DVec3>,
    hit_ids: Vec<u32>,
    emitters: Vec<u32>,
}

/// Draws the path as SVG.
pub fn svg(prepared: &PreparedScene, trace: &PathTrace) -> String {
    let scene = prepared.scene();
    let sketch = Sketch::of(scene, trace);
    let ends = sketch.lines.iter().filter_map(|line| line.to);
    let points: Vec<DVec3> = sketch.vertices.iter().copied().chain(ends).collect();
    let view = SideView::of(&points, scene.description().camera.up);
    let mut canvas = Canvas::new(view.window, 64.0, STYLE);
    let labels = draw_spheres(&mut canvas, scene, &sketch, &view);
    for line in &sketch.lines {
        draw_line(&mut canvas, line, &view);
    }
    for (position, name) in labels {
        canvas.text("halo", "middle", position, &name);
    }
    draw_vertices(&mut canvas, &sketch, &view);
    canvas.leave_window();
    draw_legend(&mut canvas, prepared, trace, &view);
    canvas.finish()
}

impl Sketch {
    fn of(scene: &Scene, trace: &PathTrace) -> Self {
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
                    if let LightSource::Emitter(id) | LightSource::FarWall(id) = sample.source {
                        sketch.emitters.push(id);
                    }
                    let Some((visibility, _)) = shadow_result(&trace.events, index, 0) else {
                        continue;
                    };
                    let Some(&from) = sketch.vertices.last() else { continue };
                    let is_finite = sample.distance.is_finite();
                    sketch.lines.push(Line {
                        class: if visibility == Rgb::ZERO { "occluded" } else { "unoccluded" },
                        from,
                        to: is_finite.then(|| from + sample.distance * sample.direction),
                        direction: sample.direction,
                    });
                }
                PathEvent::Connection { .. } => sketch.connect(scene, trace, index),
                _ => {}
            }
        }
        sketch
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
        if let LightSource::Emitter(id) = source {
            self.emitters.push(*id);
        }
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

/// Draws the spheres in view, largest first, and returns their labels, which belong on top.
fn draw_spheres(
    canvas: &mut Canvas,
    scene: &Scene,
    sketch: &Sketch,
    view: &SideView,
) -> Vec<(DVec2, String)> {
    let spheres = scene.spheres();
    let is_named = |id: u32| sketch.hit_ids.contains(&id) || sketch.emitters.contains(&id);
    let projected = |id: u32| {
        let sphere = spheres.sphere(id);
        let center = view.project(to_scene(scene, sphere.center));
        (id, center, sphere.radius * view.scale)
    };
    let in_view = |&(id, center, radius): &(u32, DVec2, f64)| {
        is_named(id) || radius > 0.7 && view.touches(center, radius)
    };
    let mut circles: Vec<_> = (0..spheres.len() as u32).map(projected).filter(in_view).collect();
    circles.sort_by(|a, b| is_named(b.0).cmp(&is_named(a.0)).then(b.2.total_cmp(&a.2)));
    circles.truncate(MAX_SPHERES);
    circles.sort_by(|a, b| b.2.total_cmp(&a.2));
    let mut labels = Vec::new();
    let mut occupied = vertex_labels(sketch, view);
    for (id, center, radius) in circles {
        let class = match (sketch.emitters.contains(&id), sketch.hit_ids.contains(&id)) {
            (true, _) => "emitter",
            (_, true) => "hit",
            _ => "sphere",
        };
        // A sphere around the camera would cover everything, so only its outline is drawn.
        let outline = match spheres.sphere(id).contains(sketch.camera - spheres.origin()) {
            true => " around",
            false => "",
        };
        canvas.circle(&format!("{class}{outline}"), center, radius);
        if is_named(id) {
            let position = avoid_overlap(view.label_place(center, radius), &occupied);
            occupied.push(position);
            labels.push((position, name(scene, id).trim_matches('`').to_owned()));
        }
    }
    labels
}

/// Moves a label down until it covers none of the others. Each of them moves it once.
fn avoid_overlap(mut position: DVec2, occupied: &[DVec2]) -> DVec2 {
    for _ in occupied {
        let overlapping =
            occupied.iter().find(|other| (position - **other).abs().cmplt(LABEL).all());
        let Some(other) = overlapping else { break };
        position.y = other.y + LABEL.y + 1.0;
    }
    position
}

fn draw_line(canvas: &mut Canvas, line: &Line, view: &SideView) {
    let from = view.project(line.from);
    let to = match line.to {
        Some(to) => view.project(to),
        None => from + view.across() * view.direction(line.direction),
    };
    canvas.line(line.class, from, to);
}

/// Positions of the vertex labels: away from the incoming path, and above the camera.
fn vertex_labels(sketch: &Sketch, view: &SideView) -> Vec<DVec2> {
    let points: Vec<DVec2> = sketch.vertices.iter().map(|&point| view.project(point)).collect();
    let label = |(k, position): (usize, &DVec2)| {
        let direction = match points[..k].last() {
            None => DVec2::new(0.0, -0.9),
            Some(previous) => (*position - *previous).normalize_or(DVec2::Y),
        };
        *position + 15.0 * direction + DVec2::new(0.0, 4.0)
    };
    points.iter().enumerate().map(label).collect()
}

fn draw_vertices(canvas: &mut Canvas, sketch: &Sketch, view: &SideView) {
    for (k, label) in vertex_labels(sketch, view).into_iter().enumerate() {
        let text = if k == 0 { "camera, x₀".to_owned() } else { format!("x{}", subscript(k)) };
        canvas.circle("vertex", view.project(sketch.vertices[k]), 4.0);
        canvas.text("halo", "middle", label, &text);
    }
}

/// Draws the line styles, the sample's position, and a scale bar of a round length.
fn draw_legend(canvas: &mut Canvas, prepared: &PreparedScene, trace: &PathTrace, view: &SideView) {
    let mut position = DVec2::new(16.0, view.window.y + 24.0);
    let end = DVec2::new(view.window.x - 16.0, position.y);
    let unit = view.round_length();
    canvas.line("bar", end - DVec2::X * unit * view.scale, end);
    canvas.text("", "end", end + DVec2::Y * 20.0, &format!("{} units", number(unit)));
    let address = trace.address;
    let [r, g, b] = (trace.radiance.direct + trace.radiance.indirect).to_array();
    let [r, g, b] = [r, g, b].map(|v| number(f64::from(v)));
    let sample = format!(
        "pixel {}, {}, sample {}, seed {}: L_o = ({r}, {g}, {b})",
        address.x,
        address.y,
        address.sample,
        prepared.render_settings().seed
    );
    canvas.text("small", "start", position + DVec2::Y * 27.0, &sample);
    let entries = [
        ("path", "path"),
        ("unoccluded", "light that arrives"),
        ("occluded", "light that is occluded"),
    ];
    for (class, text) in entries {
        canvas.line(class, position, position + DVec2::X * 32.0);
        canvas.text("", "start", position + DVec2::new(40.0, 4.5), text);
        position.x += 64.0 + 7.2 * text.len() as f64;
    }
}

fn subscript(number: usize) -> String {
    let digit = |c: char| char::from_u32(c as u32 - '0' as u32 + '₀' as u32).unwrap_or(c);
    number.to_string().chars().map(digit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_in_one_place_stand_below_each_other() {
        let start = DVec2::new(100.0, 50.0);
        let mut occupied = vec![DVec2::new(300.0, 50.0)];
        for row in 0..4 {
            let position = avoid_overlap(start + DVec2::new(f64::from(row), 0.0), &occupied);
            assert_eq!(position.y, 50.0 + (LABEL.y + 1.0) * f64::from(row));
            occupied.push(position);
        }
    }
}
