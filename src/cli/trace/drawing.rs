//! A path drawn from the side, as SVG.
//!
//! Everything is projected, without perspective, on one upright plane: the vertical one in which the
//! path is widest. Spheres are their outlines.

mod view;

use std::fmt::Write;

use crate::integrator::{Step, Trace};
use crate::light::Source;
use crate::math::{DVec2, DVec3};
use crate::scene::{Scene, Shot};

use super::{answer, name, place, words};
use view::View;

/// More spheres than these only hide the path.
const MOST_SPHERES: usize = 400;

/// What the name of a sphere takes, about.
const LABEL: DVec2 = DVec2::new(80.0, 16.0);

const STYLE: &str = "\
text { font: 13px sans-serif; fill: #222 }\n\
.small { font-size: 11.5px; fill: #555 }\n\
.halo { paint-order: stroke; stroke: #fff; stroke-width: 3px }\n\
.sphere { fill: #eef1f4; fill-opacity: .75; stroke: #9aa5b1 }\n\
.met { fill: #d5e3f0; stroke: #4a6f94; stroke-width: 1.4 }\n\
.lamp { fill: #ffe9a8; fill-opacity: .9; stroke: #b8860b; stroke-width: 1.4 }\n\
.around { fill: none }\n\
.path { stroke: #0b3c6f; stroke-width: 2.4; fill: none }\n\
.free { stroke: #d98200; stroke-width: 1.6; fill: none }\n\
.blocked { stroke: #c0392b; stroke-width: 1.4; stroke-dasharray: 5 4; fill: none }\n\
.vertex { fill: #0b3c6f; stroke: #fff }\n";

/// A line of the drawing, in the user's coordinates.
struct Line {
    class: &'static str,
    from: DVec3,
    to: Option<DVec3>,
    /// Where it goes if it ends nowhere.
    direction: DVec3,
}

/// What the drawing shows.
#[derive(Default)]
struct Sketch {
    lines: Vec<Line>,
    /// Where the path begins.
    camera: DVec3,
    /// The camera first.
    vertices: Vec<DVec3>,
    met: Vec<u32>,
    lamps: Vec<u32>,
}

/// The drawing.
pub(super) fn svg(shot: &Shot, trace: &Trace) -> String {
    let scene = shot.scene();
    let sketch = Sketch::of(scene, trace);
    let ends = sketch.lines.iter().filter_map(|line| line.to);
    let points: Vec<DVec3> = sketch.vertices.iter().copied().chain(ends).collect();
    let view = View::of(&points, scene.description().camera.up);
    let (width, height) = (view.width, view.height + 64.0);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\">\n<style>\n{STYLE}</style>\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n\
         <clipPath id=\"view\"><rect width=\"{width}\" height=\"{}\"/></clipPath>\n\
         <g clip-path=\"url(#view)\">\n",
        view.height
    );
    let labels = draw_spheres(&mut svg, scene, &sketch, &view);
    for line in &sketch.lines {
        draw_line(&mut svg, line, &view);
    }
    svg += &labels;
    draw_vertices(&mut svg, &sketch, &view);
    svg += "</g>\n";
    draw_legend(&mut svg, shot, trace, &view);
    svg + "</svg>\n"
}

impl Sketch {
    fn of(scene: &Scene, trace: &Trace) -> Self {
        let mut sketch = Self::default();
        for (at, step) in trace.steps.iter().enumerate() {
            match step {
                Step::Camera { ray, .. } => {
                    sketch.camera = place(scene, ray.origin);
                    sketch.vertices.push(sketch.camera);
                }
                Step::Meet { hit, .. } => {
                    let point = place(scene, hit.point);
                    sketch.reach(point);
                    sketch.met.push(hit.id);
                    if scene.surface(hit.id).material.is_emissive() {
                        sketch.lamps.push(hit.id);
                    }
                }
                Step::Miss { wo, .. } => {
                    sketch.lines.extend(sketch.vertices.last().map(|&from| Line {
                        class: "path",
                        from,
                        to: None,
                        direction: -*wo,
                    }))
                }
                Step::Aim { sample, .. } => {
                    if let Source::Lamp(id) = sample.source {
                        sketch.lamps.push(id);
                    }
                    let Some((passed, _)) = answer(&trace.steps, at) else { continue };
                    let Some(&from) = sketch.vertices.last() else { continue };
                    let is_near = sample.distance.is_finite();
                    sketch.lines.push(Line {
                        class: if passed == 0.0 { "blocked" } else { "free" },
                        from,
                        to: is_near.then(|| from + sample.distance * sample.direction),
                        direction: sample.direction,
                    });
                }
                _ => {}
            }
        }
        sketch
    }

    /// Goes on to the next vertex.
    fn reach(&mut self, to: DVec3) {
        if let Some(&from) = self.vertices.last() {
            self.lines.push(Line { class: "path", from, to: Some(to), direction: DVec3::ZERO });
        }
        self.vertices.push(to);
    }
}

/// Draws the spheres in view, the large ones first, and returns their labels, which belong on top.
fn draw_spheres(svg: &mut String, scene: &Scene, sketch: &Sketch, view: &View) -> String {
    let spheres = scene.spheres();
    let is_named = |id: u32| sketch.met.contains(&id) || sketch.lamps.contains(&id);
    let projected = |id: u32| {
        let sphere = spheres.sphere(id);
        let center = view.project(place(scene, sphere.center));
        (id, center, sphere.radius * view.scale)
    };
    let in_view = |&(id, center, radius): &(u32, DVec2, f64)| {
        is_named(id) || radius > 0.7 && view.touches(center, radius)
    };
    let mut circles: Vec<_> = (0..spheres.len() as u32).map(projected).filter(in_view).collect();
    circles.sort_by(|a, b| is_named(b.0).cmp(&is_named(a.0)).then(b.2.total_cmp(&a.2)));
    circles.truncate(MOST_SPHERES);
    circles.sort_by(|a, b| b.2.total_cmp(&a.2));
    let mut labels = String::new();
    let mut taken = vertex_labels(sketch, view);
    for (id, center, radius) in circles {
        let class = match (sketch.lamps.contains(&id), sketch.met.contains(&id)) {
            (true, _) => "lamp",
            (_, true) => "met",
            _ => "sphere",
        };
        // What the camera stands in would cover everything: its outline must do.
        let around = match spheres.sphere(id).contains(sketch.camera - spheres.origin()) {
            true => " around",
            false => "",
        };
        view.circle(svg, &format!("{class}{around}"), center, radius);
        if is_named(id) {
            let at = below_all(view.label_place(center, radius), &taken);
            taken.push(at);
            let name = escaped(name(scene, id).trim_matches('`'));
            put(
                &mut labels,
                format_args!(
                    "<text class=\"halo\" text-anchor=\"middle\" x=\"{:.1}\" y=\"{:.1}\">{name}</text>\n",
                    at.x, at.y
                ),
            );
        }
    }
    labels
}

/// The place of a label, moved down until it covers none of the others, each of which moves it once.
fn below_all(mut at: DVec2, others: &[DVec2]) -> DVec2 {
    for _ in others {
        let covered = others.iter().find(|other| (at - **other).abs().cmplt(LABEL).all());
        let Some(other) = covered else { break };
        at.y = other.y + LABEL.y + 1.0;
    }
    at
}

fn draw_line(svg: &mut String, line: &Line, view: &View) {
    let from = view.project(line.from);
    let to = match line.to {
        Some(to) => view.project(to),
        None => from + view.across() * view.direction(line.direction),
    };
    put(
        svg,
        format_args!(
            "<path class=\"{}\" d=\"M{:.2} {:.2}L{:.2} {:.2}\"/>\n",
            line.class, from.x, from.y, to.x, to.y
        ),
    );
}

/// Where the names of the vertices stand: away from where the path comes from, the camera's above it.
fn vertex_labels(sketch: &Sketch, view: &View) -> Vec<DVec2> {
    let places: Vec<DVec2> = sketch.vertices.iter().map(|&point| view.project(point)).collect();
    let label = |(k, at): (usize, &DVec2)| {
        let away = match places[..k].last() {
            None => DVec2::new(0.0, -0.9),
            Some(before) => (*at - *before).normalize_or(DVec2::Y),
        };
        *at + 15.0 * away + DVec2::new(0.0, 4.0)
    };
    places.iter().enumerate().map(label).collect()
}

fn draw_vertices(svg: &mut String, sketch: &Sketch, view: &View) {
    for (k, label) in vertex_labels(sketch, view).into_iter().enumerate() {
        let at = view.project(sketch.vertices[k]);
        let text = if k == 0 { "camera, x₀".to_owned() } else { format!("x{}", subscript(k)) };
        put(
            svg,
            format_args!(
                "<circle class=\"vertex\" cx=\"{:.2}\" cy=\"{:.2}\" r=\"4\"/>\n\
                 <text class=\"halo\" text-anchor=\"middle\" x=\"{:.1}\" y=\"{:.1}\">{text}</text>\n",
                at.x, at.y, label.x, label.y
            ),
        );
    }
}

fn draw_legend(svg: &mut String, shot: &Shot, trace: &Trace, view: &View) {
    let y = view.height + 24.0;
    let entries =
        [("path", "path"), ("free", "light arrives"), ("blocked", "something is in the way")];
    let mut x = 16.0;
    for (class, text) in entries {
        put(
            svg,
            format_args!(
                "<path class=\"{class}\" d=\"M{x} {y}h32\"/><text x=\"{}\" y=\"{}\">{text}</text>\n",
                x + 40.0,
                y + 4.5
            ),
        );
        x += 64.0 + 7.2 * text.len() as f64;
    }
    let address = trace.address;
    let [r, g, b] = (trace.radiance.direct + trace.radiance.indirect).to_array();
    let [r, g, b] = [r, g, b].map(|v| words::number(f64::from(v)));
    put(
        svg,
        format_args!(
            "<text class=\"small\" x=\"16\" y=\"{}\">pixel {}, {}, sample {}, seed {}: \
             L_o = ({r}, {g}, {b})</text>\n",
            y + 27.0,
            address.x,
            address.y,
            address.sample,
            shot.render().seed
        ),
    );
    let unit = view.round_length();
    let (end, bar) = (view.width - 16.0, unit * view.scale);
    put(
        svg,
        format_args!(
            "<path d=\"M{:.1} {y}h{bar:.1}\" stroke=\"#222\" stroke-width=\"2\"/>\
             <text text-anchor=\"end\" x=\"{end}\" y=\"{}\">{} long</text>\n",
            end - bar,
            y + 20.0,
            words::number(unit)
        ),
    );
}

fn subscript(number: usize) -> String {
    let digit = |c: char| char::from_u32(c as u32 - '0' as u32 + '₀' as u32).unwrap_or(c);
    number.to_string().chars().map(digit).collect()
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

fn put(svg: &mut String, text: std::fmt::Arguments<'_>) {
    svg.write_fmt(text).expect("a string takes all that is written to it");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_in_one_place_stand_below_each_other() {
        let place = DVec2::new(100.0, 50.0);
        let mut taken = vec![DVec2::new(300.0, 50.0)];
        for row in 0..4 {
            let at = below_all(place + DVec2::new(f64::from(row), 0.0), &taken);
            assert_eq!(at.y, 50.0 + (LABEL.y + 1.0) * f64::from(row));
            taken.push(at);
        }
    }
}
