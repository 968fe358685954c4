//! Writes a scene as text.

use std::fmt::Write;

use crate::appearance::{FramedCamera, Projection};
use crate::color::Rgb;
use crate::math::DVec3;

use super::style::{MATERIALS, StyleValues};

/// Everything that the text of a scene says.
pub(super) struct Composition<'a> {
    pub(super) size: [u32; 2],
    pub(super) camera: FramedCamera,
    pub(super) up: DVec3,
    /// Unit vector towards the key light.
    pub(super) key_direction: DVec3,
    pub(super) style: StyleValues,
    /// `None` is transparent.
    pub(super) backdrop: Option<Rgb>,
    /// The ground: centre and radius.
    pub(super) ground: Option<(DVec3, f64)>,
    pub(super) material: &'a str,
    /// Keys of `[[particles]]` with their values in TOML.
    pub(super) particles: Vec<(String, String)>,
    pub(super) samples: u32,
}

impl Composition<'_> {
    /// The text.
    pub(super) fn text(&self) -> String {
        let mut text = String::from("format = 1\n");
        self.write(&mut text).expect("a string takes any text");
        text
    }

    fn write(&self, to: &mut String) -> std::fmt::Result {
        let [width, height] = self.size;
        write!(to, "\n[image]\nwidth = {width}\nheight = {height}\n")?;
        let FramedCamera { position, look_at, up, projection } = self.camera;
        writeln!(to, "\n[camera]")?;
        if let Projection::Orthographic(height) = projection {
            writeln!(to, "type = \"orthographic\"\nheight = {height:?}")?;
        }
        writeln!(to, "position = {}", vector(position))?;
        writeln!(to, "look_at = {}\nup = {}", vector(look_at), vector(up))?;
        if let Projection::Perspective(fov) = projection {
            writeln!(to, "vertical_fov_degrees = {fov:?}")?;
        }
        self.write_light(to)?;
        writeln!(to, "\n[materials.particles]\n{}", material(self.material))?;
        if let Some((center, radius)) = self.ground {
            let albedo = color(self.style.ground_albedo(self.backdrop.unwrap_or(Rgb::ONE)));
            writeln!(to, "\n[materials.ground]\ntype = \"diffuse\"\nalbedo = {albedo}")?;
            writeln!(to, "\n[[spheres]]\nname = \"ground\"\ncenter = {}", vector(center))?;
            writeln!(to, "radius = {radius:?}\nmaterial = \"ground\"")?;
            if self.backdrop.is_none() {
                // Of what is transparent, only the shadow can be seen.
                writeln!(to, "shadow_catcher = true")?;
            }
        }
        writeln!(to, "\n[[particles]]")?;
        for (key, value) in &self.particles {
            writeln!(to, "{key} = {value}")?;
        }
        writeln!(to, "material = \"particles\"")?;
        writeln!(to, "\n[render]\nsamples_per_pixel = {}", self.samples)?;
        if let Some(depth) = self.style.max_depth {
            writeln!(to, "max_depth = {depth}")?;
        }
        Ok(())
    }

    fn write_light(&self, to: &mut String) -> std::fmt::Result {
        writeln!(to, "\n[background]\nup = {}", vector(self.up))?;
        if self.backdrop.is_none() {
            writeln!(to, "transparent = true")?;
        }
        let horizon = self.backdrop.unwrap_or(Rgb::splat(self.style.backdrop as f32));
        let zenith = color(Rgb::splat(self.style.zenith as f32));
        writeln!(to, "\n[background.gradient]\nzenith = {zenith}\nhorizon = {}", color(horizon))?;
        if self.style.key > 0.0 {
            let irradiance = color(Rgb::splat(self.style.key_irradiance() as f32));
            writeln!(to, "\n[background.sun]\ndirection = {}", vector(self.key_direction))?;
            writeln!(to, "angular_diameter_degrees = {:?}", self.style.key_diameter)?;
            writeln!(to, "irradiance = {irradiance}")?;
        }
        Ok(())
    }
}

fn vector(v: DVec3) -> String {
    let [x, y, z] = v.to_array().map(|x| x + 0.0);
    format!("[{x:?}, {y:?}, {z:?}]")
}

fn color(rgb: Rgb) -> String {
    let [r, g, b] = rgb.to_array();
    format!("[{r:?}, {g:?}, {b:?}]")
}

/// The keys of a material; a name that is none of ours is a metal.
fn material(name: &str) -> String {
    match MATERIALS.iter().find(|(known, _)| *known == name) {
        Some((_, keys)) => (*keys).to_owned(),
        None => format!("type = \"conductor\"\nmetal = \"{name}\"\nroughness = 0.3"),
    }
}

/// A text as a TOML string.
pub(super) fn toml_string(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => quoted.extend(['\\', c]),
            c if c.is_control() => {
                let _ = write!(quoted, "\\u{:04X}", u32::from(c));
            }
            c => quoted.push(c),
        }
    }
    quoted + "\""
}
