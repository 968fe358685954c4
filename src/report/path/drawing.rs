//! Draws a path from the side, as SVG.
//!
//! Everything is projected orthographically on the vertical plane in which the path is widest.
//! Spheres are drawn as outlines.

use crate::draw::{Canvas, SideView};
use crate::integrator::PathTrace;
use crate::math::{DVec2, DVec3};
use crate::scene::{PreparedScene, Scene};

use super::numbers::number;
use super::sketch::{Line, Sketch};
use super::spheres::{name, to_scene};

/// More spheres than this only hide the path.
const MAX_SPHERES: usize = 400;

/// Approximate size of a sphere label.
const LABEL: DVec2 = DVec2::new(80.0, 16.0);
/// Approximate width of a letter.
const LETTER: f64 = 7.2;

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
.head { stroke-dasharray: none }\n\
.vertex { fill: #0b3c6f; stroke: #fff }\n\
.cross { stroke: #c0392b; stroke-width: 2 }\n\
.bar { stroke: #222; stroke-width: 2 }\n";

/// Draws the path as SVG.
pub fn svg(prepared: &PreparedScene, trace: &PathTrace) -> String {
    let scene = prepared.scene();
    let sketch = Sketch::of(scene, trace);
    // Light that is blocked is shown, too.
    let ends = sketch.points.iter().map(|(_, point)| *point);
    let points: Vec<DVec3> = sketch.vertices.iter().copied().chain(ends).collect();
    let view = SideView::of(&points, scene.description().camera.up);
    let mut canvas = Canvas::new(view.window, 64.0, STYLE);
    let labels = draw_spheres(&mut canvas, scene, &sketch, &view);
    for line in &sketch.lines {
        draw_line(&mut canvas, line, &view);
    }
    for &point in &sketch.blocked {
        let at = view.project(point);
        for corner in [DVec2::new(4.0, 4.0), DVec2::new(4.0, -4.0)] {
            canvas.line("cross", at - corner, at + corner);
        }
    }
    for (position, name) in labels {
        canvas.text("halo", "middle", position, &name);
    }
    draw_vertices(&mut canvas, &sketch, &view);
    canvas.leave_window();
    draw_legend(&mut canvas, prepared, trace, &sketch, &view);
    canvas.finish()
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
        let is_around = spheres.sphere(id).contains(sketch.camera - spheres.origin());
        let outline = if is_around { " around" } else { "" };
        canvas.circle(&format!("{class}{outline}"), center, radius);
        if is_named(id) {
            let name = name(scene, id).trim_matches('`').to_owned();
            let on_wall = sketch.points.iter().find(|(of, _)| *of == id && is_around);
            let position = match on_wall {
                Some((_, point)) => view.wall_label_place(center, view.project(*point)),
                None => view.label_place(center, radius),
            };
            let half = 0.5 * LETTER * name.chars().count() as f64;
            let position = avoid_overlap(view.keep_in(position, half), &occupied, view.window.y);
            occupied.push(position);
            labels.push((position, name));
        }
    }
    labels
}

/// Moves a label down until it covers none of the others, or up, where it would leave the window.
/// Each of them moves it once.
fn avoid_overlap(start: DVec2, occupied: &[DVec2], height: f64) -> DVec2 {
    let moved = |step: f64| {
        let mut position = start;
        for _ in occupied {
            let overlapping =
                occupied.iter().find(|other| (position - **other).abs().cmplt(LABEL).all());
            let Some(other) = overlapping else { break };
            position.y = other.y + step * (LABEL.y + 1.0);
        }
        position
    };
    let down = moved(1.0);
    if down.y <= height - 4.0 { down } else { moved(-1.0) }
}

fn draw_line(canvas: &mut Canvas, line: &Line, view: &SideView) {
    let from = view.project(line.from);
    let to = match line.to {
        Some(to) => view.project(to),
        None => from + view.across() * view.direction(line.direction),
    };
    canvas.line(line.class, from, to);
    draw_arrow(canvas, line.class, from, to, view.window);
}

/// Draws the head of an arrow near the middle of what is seen of a line, if it is long enough.
fn draw_arrow(canvas: &mut Canvas, class: &str, from: DVec2, to: DVec2, window: DVec2) {
    let length = from.distance(to);
    let along = (to - from).normalize_or(DVec2::X);
    // A line that escapes is cut at the edge of the window.
    let is_inside = |at: f64| {
        let point = from + at * along;
        point.cmpge(DVec2::ZERO).all() && point.cmple(window).all()
    };
    let seen = (1..=64).map(|step| length * f64::from(step) / 64.0).take_while(|at| is_inside(*at));
    let Some(seen) = seen.last().filter(|seen| *seen > 28.0) else { return };
    let tip = from + (0.55 * seen + 4.0) * along;
    for side in [1.0, -1.0] {
        let back = DVec2::new(
            -9.0 * along.x - side * 4.5 * along.y,
            -9.0 * along.y + side * 4.5 * along.x,
        );
        canvas.line(&format!("{class} head"), tip, tip + back);
    }
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

/// Draws the styles of the lines that there are, the sample's position, and a scale bar of a round
/// length.
fn draw_legend(
    canvas: &mut Canvas,
    prepared: &PreparedScene,
    trace: &PathTrace,
    sketch: &Sketch,
    view: &SideView,
) {
    let mut position = DVec2::new(16.0, view.window.y + 24.0);
    let end = DVec2::new(view.window.x - 16.0, position.y);
    let unit = view.round_length();
    canvas.line("bar", end - DVec2::X * unit * view.scale, end);
    canvas.text(
        "",
        "end",
        end + DVec2::Y * 20.0,
        &format!("{} unit{}", number(unit), if unit == 1.0 { "" } else { "s" }),
    );
    let address = trace.address;
    let [r, g, b] = (trace.radiance.direct + trace.radiance.indirect).to_array();
    let [r, g, b] = [r, g, b].map(|v| number(f64::from(v)));
    let sample = format!(
        "seen from the side; pixel {}, {}, sample {}, seed {}: L_o = ({r}, {g}, {b})",
        address.x,
        address.y,
        address.sample,
        prepared.render_settings().seed
    );
    canvas.text("small", "start", position + DVec2::Y * 27.0, &sample);
    let entries = [
        ("path", "path"),
        ("unoccluded", "towards light that arrives"),
        ("occluded", "towards light that is blocked (x)"),
    ];
    let is_drawn = |(class, _): &(&str, &str)| sketch.lines.iter().any(|line| line.class == *class);
    for (class, text) in entries.into_iter().filter(is_drawn) {
        canvas.line(class, position, position + DVec2::X * 32.0);
        canvas.text("", "start", position + DVec2::new(40.0, 4.5), text);
        position.x += 64.0 + LETTER * text.len() as f64;
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
            let at = start + DVec2::new(f64::from(row), 0.0);
            let position = avoid_overlap(at, &occupied, 1000.0);
            assert_eq!(position.y, 50.0 + (LABEL.y + 1.0) * f64::from(row));
            occupied.push(position);
        }
        // Below is no place any more.
        let last = avoid_overlap(start, &occupied, 60.0 + 3.0 * LABEL.y);
        assert_eq!(last.y, 50.0 - (LABEL.y + 1.0));
    }
}
