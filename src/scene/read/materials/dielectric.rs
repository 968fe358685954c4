//! `type = "dielectric"`.

use crate::color::Rgb;
use crate::material::GLASSES;
use crate::scene::description::Surface;
use crate::scene::document::Table;
use crate::scene::values::{Choice, Color, Limits, Node, Number, Read, Unfit, Whole};

use super::ROUGHNESS;

/// Indices of refraction: below 1 as well, for bubbles told relative to what is around them.
const IOR: Number = Number(Limits::FromTo(0.1, 10.0));

/// What a medium absorbs, per unit length.
const ABSORPTION: Color = Color(Limits::FromTo(0.0, 1e15));

pub(super) fn read(table: &Table<'_>) -> Option<Surface> {
    let ior = index(table);
    let roughness = table.optional("roughness", ROUGHNESS).unwrap_or(0.0);
    let priority = table.optional("priority", Whole(i32::MIN..=i32::MAX)).unwrap_or(0);
    let absorption = table.optional("absorption", ABSORPTION).unwrap_or(Rgb::ZERO);
    Some(Surface::Dielectric { ior: ior?, roughness, priority, absorption })
}

/// What is expected where there is neither a number nor a name.
struct OrGlass(Number);

impl Read for OrGlass {
    type Output = f64;

    fn expects(&self) -> String {
        format!("{}, or `glass = ...`, the name of a glass", self.0.expects())
    }

    fn read(&self, node: &Node<'_>) -> Result<f64, Unfit> {
        self.0.read(node)
    }
}

/// The index of refraction, as a number or by the name of a glass.
fn index(table: &Table<'_>) -> Option<f64> {
    let [glass, ior] = ["glass", "ior"].map(|key| table.span_of(key));
    match (glass, ior) {
        (None, None) => return table.required("ior", OrGlass(IOR)),
        (None, Some(_)) => return table.required("ior", IOR),
        _ => (),
    }
    let glass = table.optional("glass", Choice(&GLASSES));
    if table.optional("ior", IOR).is_some() {
        let message = format!("`{}` says again what `glass` says already", table.path_to("ior"));
        let help = "remove one of them".to_owned();
        table.report().add(table.wrong("ior", message).help(help));
    }
    glass
}
