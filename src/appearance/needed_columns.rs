//! The columns of a file that options for the look of its particles need.

use std::collections::BTreeSet;

use crate::particles::Role;

use super::elements::ATOM_NAME;
use super::expression::Expression;
use super::named_color::named_color;
use super::options::{Appearance, ColorChoice, RadiusChoice};
use super::particle_columns::POSITION;

/// The columns that these options name or may need, of those that a file has. `None` if they name
/// one that it lacks: then all of them are needed, for the message.
pub fn needed_columns(options: &Appearance, of_file: &[&str]) -> Option<Vec<String>> {
    let mut names: BTreeSet<&str> = BTreeSet::new();
    let texts = [options.select.as_deref(), options.slice.as_deref()];
    let radius = match &options.radius {
        RadiusChoice::Expression(text) => Some(&**text),
        _ => None,
    };
    let color = match &options.color {
        ColorChoice::Named(text) => Some(&**text),
        _ => None,
    };
    let parsed: Vec<Expression> =
        texts.into_iter().chain([radius, color]).flatten().filter_map(parse).collect();
    parsed.iter().for_each(|expression| names.extend(expression.columns()));
    let is_known = |name: &&str| {
        POSITION.contains(name)
            || named_color(name).is_some()
            || of_file.iter().any(|known| known.eq_ignore_ascii_case(name))
    };
    if !names.iter().all(is_known) {
        return None;
    }
    names.extend([radius, color].into_iter().flatten());
    let is_named = |name: &&&str| names.iter().any(|wanted| wanted.eq_ignore_ascii_case(name));
    let is_needed = |name: &&&str| is_named(name) || has_role(name, options);
    Some(of_file.iter().filter(is_needed).map(|name| (*name).to_owned()).collect())
}

fn parse(text: &str) -> Option<Expression> {
    Expression::parse(text).ok()
}

/// Returns true if the look may depend on a column because of what its name means.
fn has_role(name: &str, options: &Appearance) -> bool {
    let is_auto = matches!(options.color, ColorChoice::Auto | ColorChoice::AutoOr(_));
    let is_element =
        matches!(Role::of(name), Some(Role::Element | Role::AtomicNumber | Role::Type));
    let needs_elements =
        matches!(options.radius, RadiusChoice::Auto | RadiusChoice::Vdw | RadiusChoice::Covalent)
            || is_auto
            || matches!(options.color, ColorChoice::Element | ColorChoice::Type);
    match Role::of(name) {
        Some(Role::Radius | Role::Diameter) => options.radius == RadiusChoice::Auto,
        Some(Role::Red | Role::Green | Role::Blue) => is_auto || options.color == ColorChoice::Rgb,
        _ if options.unwrap && matches!(name, "ix" | "iy" | "iz") => true,
        _ => (is_element || name == ATOM_NAME) && needs_elements,
    }
}
