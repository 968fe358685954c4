//! The closed forms: each a scene of `scenes/verify/`, whose head derives the answer, and the same
//! answer as a function of what the scene says.

mod absorption;
mod cameras;
mod exchange;
mod glass;
mod lit;
mod many;
mod mirrors;
mod seen;
mod uniform;

use crate::scene::description::{Description, Dome, NamedMaterial, Surface};

/// A scene whose picture is known.
#[derive(Clone, Copy, Debug)]
pub struct Form {
    /// The scene's file name without its ending.
    pub name: &'static str,
    /// What it shows, in a few words.
    pub title: &'static str,
    /// The answer as a formula.
    pub formula: &'static str,
    /// The scene file.
    pub text: &'static str,
    /// The sphere tables beside it, by their names.
    pub tables: &'static [(&'static str, &'static [u8])],
    /// Which estimators it is for.
    pub shows: Shows,
    /// The weights of red, green and blue in what is compared; they add up to 1.
    pub(super) channels: [f64; 3],
    /// Samples of each pixel in a quick check, from each seed: a multiple of 4.
    pub samples: u32,
    /// The answer for each pixel, `None` where there is none, by quadratures of so many nodes.
    pub(super) answer: fn(&Description, usize) -> Vec<Option<f64>>,
}

/// What light a scene shows, and thus which estimators find all of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shows {
    /// Light that was scattered any number of times.
    All,
    /// Light that was scattered once at most, not counting mirrors and glass.
    Direct,
    /// No light: what the integrator shows that the scene names.
    Named(&'static str),
}

/// All channels are the same.
const GREY: [f64; 3] = [1.0 / 3.0; 3];
/// A channel in the place of another is seen.
const TOLD_APART: [f64; 3] = [1.0 / 7.0, 2.0 / 7.0, 4.0 / 7.0];

macro_rules! scene {
    ($name:literal) => {
        include_str!(concat!("../../../../scenes/verify/", $name, ".toml"))
    };
}

/// All closed forms.
pub static FORMS: &[Form] = &[
    Form {
        name: "furnace",
        title: "a closed furnace",
        formula: "L = Le / (1 - a)",
        text: scene!("furnace"),
        tables: &[],
        shows: Shows::All,
        channels: GREY,
        samples: 4,
        answer: uniform::furnace,
    },
    Form {
        name: "furnace-cut-short",
        title: "a furnace whose paths have three edges",
        formula: "L = Le (1 + a + a²)",
        text: scene!("furnace-cut-short"),
        tables: &[],
        shows: Shows::All,
        channels: GREY,
        samples: 4,
        answer: uniform::furnace_cut_short,
    },
    Form {
        name: "furnace-with-contents",
        title: "white, mirror and nested glass balls vanish in a furnace",
        formula: "L = Le / (1 - a)",
        text: scene!("furnace-with-contents"),
        tables: &[],
        shows: Shows::All,
        channels: GREY,
        samples: 4,
        answer: uniform::furnace,
    },
    Form {
        name: "furnace-with-rough-contents",
        title: "rough balls of all materials vanish in a furnace",
        formula: "L = Le / (1 - a)",
        text: scene!("furnace-with-rough-contents"),
        tables: &[],
        shows: Shows::All,
        channels: GREY,
        samples: 4,
        answer: uniform::furnace,
    },
    Form {
        name: "inside-a-lamp",
        title: "a matt ball inside a glowing sphere",
        formula: "L = a Le on the ball, Le beside it",
        text: scene!("inside-a-lamp"),
        tables: &[],
        shows: Shows::Direct,
        channels: GREY,
        samples: 4,
        answer: lit::inside_a_lamp,
    },
    Form {
        name: "sphere-light",
        title: "a lone ball under a lamp, through its horizon",
        formula: "L = a Le F, F the form factor of a sphere cut by the horizon",
        text: scene!("sphere-light"),
        tables: &[],
        shows: Shows::Direct,
        channels: GREY,
        samples: 16,
        answer: lit::sphere_light,
    },
    Form {
        name: "occluder",
        title: "an occluding ball before a lamp",
        formula: "L = a Le (sin²σ cosθ - sin²σ' cosθ') where the lamp's disc holds the other",
        text: scene!("occluder"),
        tables: &[],
        shows: Shows::Direct,
        channels: GREY,
        samples: 16,
        answer: lit::occluder,
    },
    Form {
        name: "thin-occluder",
        title: "a ball before a lamp, with some opacity",
        formula: "L = a Le (F - (1 - (1 - o)²) F')",
        text: scene!("thin-occluder"),
        tables: &[],
        shows: Shows::Direct,
        channels: GREY,
        samples: 16,
        answer: lit::occluder,
    },
    Form {
        name: "exchange",
        title: "light exchanged between two balls",
        formula: "L = Le + a b Le ∫ F(Q(α)) 2 sinα cosα dα",
        text: scene!("exchange"),
        tables: &[],
        shows: Shows::All,
        channels: GREY,
        samples: 64,
        answer: exchange::exchange,
    },
    Form {
        name: "mirror-before-the-eye",
        title: "a lit ball seen in a mirror ball",
        formula: "L = ρ a Le F at the point that the mirror shows",
        text: scene!("mirror-before-the-eye"),
        tables: &[],
        shows: Shows::Direct,
        channels: GREY,
        samples: 16,
        answer: mirrors::before_the_eye,
    },
    Form {
        name: "mirror-before-the-lamp",
        title: "a mirror ball between a point and its lamp",
        formula: "L = a Le (1 - sin²σ + ρ (sin²σ - sin²α'))",
        text: scene!("mirror-before-the-lamp"),
        tables: &[],
        shows: Shows::Direct,
        channels: GREY,
        samples: 64,
        answer: mirrors::before_the_lamp,
    },
    Form {
        name: "glass-in-a-field",
        title: "glass balls in a uniform field",
        formula: "L = L0 in every pixel, for any index of refraction",
        text: scene!("glass-in-a-field"),
        tables: &[],
        shows: Shows::Direct,
        channels: GREY,
        samples: 4,
        answer: uniform::background,
    },
    Form {
        name: "rough-glass-in-a-field",
        title: "rough glass balls in a uniform field",
        formula: "L = L0 in every pixel, for any roughness",
        text: scene!("rough-glass-in-a-field"),
        tables: &[],
        shows: Shows::All,
        channels: GREY,
        samples: 4,
        answer: uniform::background,
    },
    Form {
        name: "lamp-in-glass",
        title: "a lamp in a ball of glass",
        formula: "L = (1 - F(t)) Le / n²",
        text: scene!("lamp-in-glass"),
        tables: &[],
        shows: Shows::Direct,
        channels: GREY,
        samples: 16,
        answer: glass::lamp_in_glass,
    },
    Form {
        name: "absorption",
        title: "absorption along the chords of a glass ball",
        formula: "L = L0 (F + (1 - F)² q / (1 - F q)), q = exp(-2 a R cos t)",
        text: scene!("absorption"),
        tables: &[],
        shows: Shows::Direct,
        channels: GREY,
        samples: 8,
        answer: absorption::absorption,
    },
    Form {
        name: "orthographic",
        title: "the lone ball under its lamp through parallel rays",
        formula: "L = a Le F",
        text: scene!("orthographic"),
        tables: &[],
        shows: Shows::Direct,
        channels: GREY,
        samples: 16,
        answer: lit::sphere_light,
    },
    Form {
        name: "panorama",
        title: "a ball and its lamp all around",
        formula: "L = a Le F on the ball, Le on the lamp",
        text: scene!("panorama"),
        tables: &[],
        shows: Shows::Direct,
        channels: GREY,
        samples: 16,
        answer: lit::sphere_light,
    },
    Form {
        name: "lens",
        title: "a lamp out of the focus of a lens",
        formula: "L = Le / s² ∫ area(p) 2 p / A² dp",
        text: scene!("lens"),
        tables: &[],
        shows: Shows::Direct,
        channels: GREY,
        samples: 4096,
        answer: cameras::lens,
    },
    Form {
        name: "lamp-in-dark-glass",
        title: "a lamp in a ball of glass that absorbs",
        formula: "L = (1 - F(t)) Le exp(-k l) / n²",
        text: scene!("lamp-in-dark-glass"),
        tables: &[],
        shows: Shows::Direct,
        channels: GREY,
        samples: 16,
        answer: glass::lamp_in_glass,
    },
    Form {
        name: "sun-and-sky",
        title: "a ball under a sun and a sky that is brighter above",
        formula: "L = a (Lh + ⅔ g n_y + F E / (π sin² s))",
        text: scene!("sun-and-sky"),
        tables: &[],
        shows: Shows::Direct,
        channels: GREY,
        samples: 16,
        answer: lit::sun_and_sky,
    },
    Form {
        name: "many-lamps",
        title: "three thousand lamps",
        formula: "L = a Le (F₀ + F₁ + ... + F₂₉₉₉)",
        text: scene!("many-lamps"),
        tables: &[("many-lamps.f32", many::LAMPS)],
        shows: Shows::Direct,
        channels: GREY,
        samples: 16,
        answer: many::many_lamps,
    },
    Form {
        name: "openness",
        title: "how open the points of two balls are",
        formula: "1 - F, F the form factor of the other ball",
        text: scene!("openness"),
        tables: &[],
        shows: Shows::Named("ambient-occlusion"),
        channels: GREY,
        samples: 16,
        answer: seen::openness,
    },
    Form {
        name: "normals",
        title: "the normals of balls",
        formula: "½ + ½ n",
        text: scene!("normals"),
        tables: &[],
        shows: Shows::Named("normals"),
        channels: TOLD_APART,
        samples: 16,
        answer: seen::normals,
    },
];

/// A material by its name.
fn material<'a>(scene: &'a Description, name: &str) -> &'a NamedMaterial {
    let found = scene.materials.iter().find(|material| material.name == name);
    found.expect("the scenes of this program have the materials that their answers are made of")
}

/// The radiance of an even background.
fn field_radiance(scene: &Description) -> f64 {
    match scene.background.dome {
        Dome::Constant { radiance } => f64::from(radiance.y),
        _ => f64::NAN,
    }
}

/// The emission of a grey lamp.
fn emission(scene: &Description, name: &str) -> f64 {
    f64::from(material(scene, name).emission.y)
}

/// The albedo or reflectance of a grey surface.
fn albedo(scene: &Description, name: &str) -> f64 {
    match &material(scene, name).surface {
        Surface::Diffuse { albedo: share, .. } | Surface::Mirror { reflectance: share, .. } => {
            f64::from(share.y)
        }
        _ => 0.0,
    }
}

/// The same answer for every pixel.
fn everywhere(scene: &Description, value: f64) -> Vec<Option<f64>> {
    vec![Some(value); (scene.image.width * scene.image.height) as usize]
}
