//! The options for particle files: view, light and surroundings. The look of the particles is
//! chosen by the keys of `[[particles]]`, which have options of their own.

use clap::Args;

use crate::appearance::{ViewDirection, parse_up};
use crate::material::Metal;
use crate::math::DVec3;
use crate::studio::{Background, MATERIALS, StudioOptions, Style};

use super::values::{explained, one_of, positive, yes_or_no};

/// How a particle file is framed and lit.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Particle files")]
pub struct StudioArgs {
    /// Where the camera stands: iso, an axis such as x or -y, or AZIMUTH,ELEVATION in degrees
    /// [default: -55,25]
    #[arg(long, value_name = "VIEW", value_parser = view, allow_hyphen_values = true)]
    view: Option<Given<ViewDirection>>,

    /// The axis that points up, such as z or -y [default: z]
    #[arg(long, value_name = "AXIS", value_parser = up, allow_hyphen_values = true)]
    up: Option<Given<DVec3>>,

    /// Enlarge the picture about its centre
    #[arg(long, value_name = "X", value_parser = positive)]
    zoom: Option<f64>,

    /// Project with parallel rays
    #[arg(long)]
    ortho: bool,

    /// Light, material and surroundings [default: studio]
    #[arg(long, value_name = "NAME", value_parser = one_of(explained(meaning)))]
    style: Option<Style>,

    /// The material: matte, lambert, satin, plastic, glossy, metal, glass, mirror, or a metal such
    /// as gold [default: that of the style]
    #[arg(long, value_name = "NAME", value_parser = material)]
    material: Option<String>,

    /// Let the particles lie on a ground: true or false, yes or no. Before a transparent
    /// background, it shows only their shadow [default: that of the style]
    #[arg(long, value_name = "BOOL", value_parser = one_of(yes_or_no()))]
    ground: Option<bool>,

    /// What is behind the particles: none (transparent), or a colour such as white or #102030
    #[arg(long, value_name = "COLOR", value_parser = background)]
    background: Option<Given<Background>>,
}

/// A value, as it was written.
#[derive(Clone, Debug)]
struct Given<T> {
    text: String,
    value: T,
}

impl StudioArgs {
    /// Returns the options as values.
    pub fn options(&self) -> StudioOptions {
        let usual = StudioOptions::default();
        StudioOptions {
            view: value(&self.view),
            up: value(&self.up).unwrap_or(usual.up),
            zoom: self.zoom.unwrap_or(usual.zoom),
            orthographic: self.ortho,
            style: self.style.unwrap_or_default(),
            material: self.material.clone(),
            ground: self.ground,
            background: value(&self.background),
            ..usual
        }
    }

    /// Returns the first option that is given.
    pub fn first_given(&self) -> Option<&'static str> {
        self.given().into_iter().find(|(_, given)| given.is_some()).map(|(option, _)| option)
    }

    /// Returns the options as command arguments.
    pub fn to_arguments(&self) -> Vec<String> {
        let mut words = Vec::new();
        for (option, value) in self.given() {
            let Some(value) = value else { continue };
            words.push(option.to_owned());
            words.extend(Some(value).filter(|value| !value.is_empty()));
        }
        words
    }

    /// Returns each option with its value as it was written; a flag has an empty one.
    fn given(&self) -> [(&'static str, Option<String>); 8] {
        fn text<T>(given: &Option<Given<T>>) -> Option<String> {
            given.as_ref().map(|given| given.text.clone())
        }
        [
            ("--view", text(&self.view)),
            ("--up", text(&self.up)),
            ("--zoom", self.zoom.map(|zoom| zoom.to_string())),
            ("--ortho", self.ortho.then(String::new)),
            ("--style", self.style.map(|style| style.name().to_owned())),
            ("--material", self.material.clone()),
            ("--ground", self.ground.map(|ground| ground.to_string())),
            ("--background", text(&self.background)),
        ]
    }
}

fn value<T: Copy>(given: &Option<Given<T>>) -> Option<T> {
    given.as_ref().map(|given| given.value)
}

fn meaning(style: Style) -> &'static str {
    match style {
        Style::Studio => "satin balls in a white studio",
        Style::Clay => "matte, in softer light",
        Style::Glossy => "polished, with a smaller light",
        Style::Paper => "matte on a white floor, as in papers on point clouds",
        Style::Flat => "colours as in the colour bar, for reading numbers",
        Style::Dark => "on a dark ground",
        Style::Glow => "particles that shine in the dark",
    }
}

fn view(text: &str) -> Result<Given<ViewDirection>, String> {
    let expected = "expected iso, an axis such as x or -y, or AZIMUTH,ELEVATION, such as -60,20, the \
                    first up to 360 degrees and the second from -90 to 90";
    given(text, ViewDirection::parse(text), expected)
}

fn up(text: &str) -> Result<Given<DVec3>, String> {
    given(text, parse_up(text), "expected an axis, such as z or -y")
}

fn background(text: &str) -> Result<Given<Background>, String> {
    let expected = "expected none, the name of a colour, or #rrggbb";
    given(text, Background::parse(text), expected)
}

fn given<T>(text: &str, value: Option<T>, expected: &str) -> Result<Given<T>, String> {
    let value = value.ok_or_else(|| expected.to_owned())?;
    Ok(Given { text: text.to_owned(), value })
}

fn material(text: &str) -> Result<String, String> {
    let metals = Metal::NAMED.iter().map(|(name, _)| *name);
    let mut known = MATERIALS.iter().map(|(name, _)| *name).chain(metals);
    match known.any(|name| name == text) {
        true => Ok(text.to_owned()),
        false => Err("expected a material such as satin or metal, or a metal such as gold".into()),
    }
}
