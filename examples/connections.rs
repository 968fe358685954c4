//! Draws each kind of specular connection: all paths from x over a glass ball to y, in their plane.
//!
//!     cargo run --release --example connections > docs/pictures/connections.svg

#![allow(clippy::print_stdout, reason = "a program that prints a drawing")]

use photosphere::draw::Canvas;
use photosphere::geometry::Sphere;
use photosphere::light::specular::{SpecularPath, Target};
use photosphere::math::{DVec2, DVec3};

const BALL: Sphere = Sphere { center: DVec3::ZERO, radius: 1.0 };
const IOR: f64 = 1.5;
/// Pixels per radius, and size of a panel.
const SCALE: f64 = 46.0;
const PANEL: DVec2 = DVec2::new(250.0, 270.0);

const STYLE: &str = "\
text { font: 13px sans-serif; fill: #222 }\n\
.ball { fill: #d5e3f0; stroke: #4a6f94; stroke-width: 1.4 }\n\
.center { fill: #4a6f94 }\n\
.axis { stroke: #9aa5b1; stroke-dasharray: 4 4; fill: none }\n\
.path { stroke: #d98200; stroke-width: 1.6; fill: none }\n\
.end { fill: #0b3c6f; stroke: #fff }\n";

/// A panel: its name, kind, and the two points in the plane.
const PANELS: [(&str, SpecularPath, DVec2, DVec2); 5] = [
    ("off the outside", SpecularPath::Reflection, DVec2::new(-2.1, 1.5), DVec2::new(1.9, 1.9)),
    ("through, k = 0", SpecularPath::Through, DVec2::new(-0.15, 2.3), DVec2::new(0.0, -2.2)),
    ("through, k = 1", SpecularPath::ThroughReflected, DVec2::new(-0.3, 2.4), DVec2::new(0.4, 2.3)),
    ("out of the ball", SpecularPath::Outward, DVec2::new(-0.4, 0.5), DVec2::new(1.9, 1.6)),
    ("into the ball", SpecularPath::Inward, DVec2::new(-1.9, 1.4), DVec2::new(0.3, -0.4)),
];

fn main() {
    let size = DVec2::new(PANEL.x * PANELS.len() as f64, PANEL.y);
    let mut canvas = Canvas::new(size, 0.0, STYLE);
    for (index, (name, kind, x, y)) in PANELS.into_iter().enumerate() {
        let middle = DVec2::new(PANEL.x * (index as f64 + 0.5), 0.5 * PANEL.y);
        draw(&mut canvas, middle, (name, kind), [x, y]);
    }
    canvas.leave_window();
    print!("{}", canvas.finish());
}

fn draw(canvas: &mut Canvas, middle: DVec2, (name, kind): (&str, SpecularPath), ends: [DVec2; 2]) {
    let to_page = |p: DVec2| middle + DVec2::new(p.x, -p.y) * SCALE;
    canvas.circle("ball", to_page(DVec2::ZERO), SCALE);
    for end in ends {
        canvas.line("axis", to_page(DVec2::ZERO), to_page(end));
    }
    let [x, y] = ends.map(|end| DVec3::new(end.x, end.y, 0.0));
    for found in kind.connect(&BALL, IOR, x, Target::Point(y)).iter() {
        let on_ball = found.points().iter().map(|point| DVec2::new(point.x, point.y));
        let path: Vec<DVec2> = [ends[0]].into_iter().chain(on_ball).chain([ends[1]]).collect();
        path.windows(2).for_each(|leg| canvas.line("path", to_page(leg[0]), to_page(leg[1])));
    }
    canvas.circle("center", to_page(DVec2::ZERO), 2.0);
    for (name, end) in ["x", "y"].into_iter().zip(ends) {
        canvas.circle("end", to_page(end), 4.0);
        canvas.text("", "start", to_page(end) + DVec2::new(8.0, 4.0), name);
    }
    canvas.text("", "middle", middle + DVec2::new(0.0, 0.5 * PANEL.y - 6.0), name);
}
