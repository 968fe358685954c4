//! The table of closed forms.

use super::LightTransport::{Caustic, Connected, Direct, Global, Integrator};
use super::{ClosedForm, DISTINCT_CHANNELS, GREY};
use super::{
    absorption, cameras, caustics, direct_light, exchange, first_hits, glass, many_lights, mirrors,
    on_axis, uniform, visibility,
};

/// A grey closed form: name (also of its scene), title, formula, light transport, samples per pixel
/// in a quick check, and the function for its exact solution.
macro_rules! form {
    ($name:literal, $title:literal, $formula:literal, $transport:expr, $samples:literal, $solution:path) => {
        ClosedForm {
            name: $name,
            title: $title,
            formula: $formula,
            scene_toml: include_str!(concat!("../../../../scenes/verify/", $name, ".toml")),
            tables: &[],
            transport: $transport,
            channels: GREY,
            samples: $samples,
            solution: $solution,
        }
    };
}

/// All closed forms.
pub static CLOSED_FORMS: &[ClosedForm] = &[
    form!("furnace", "a closed furnace", "L = Le / (1 - a)", Global, 4, uniform::furnace),
    form!(
        "furnace-cut-short",
        "a furnace whose paths have three edges",
        "L = Le (1 + a + a²)",
        Global,
        4,
        uniform::furnace_cut_short
    ),
    form!(
        "furnace-with-contents",
        "white, mirror and nested glass balls vanish in a furnace",
        "L = Le / (1 - a)",
        Global,
        4,
        uniform::furnace
    ),
    form!(
        "furnace-with-rough-contents",
        "rough balls of all materials vanish in a furnace",
        "L = Le / (1 - a)",
        Global,
        4,
        uniform::furnace
    ),
    form!(
        "inside-a-lamp",
        "a diffuse ball inside a glowing sphere",
        "L = a Le on the ball, Le beside it",
        Direct,
        4,
        direct_light::inside_an_emitter
    ),
    form!(
        "sphere-light",
        "a lone ball under an emitter, through its horizon",
        "L = a Le F, F the form factor of a sphere cut by the horizon",
        Direct,
        16,
        direct_light::sphere_light
    ),
    form!(
        "translucent-lamp",
        "a lone ball under an emitter with some opacity",
        "L = a Le F (1 - (1 - o)²)",
        Direct,
        16,
        direct_light::sphere_light
    ),
    form!(
        "occluder",
        "an occluding ball before an emitter",
        "L = a Le (sin²σ cosθ - sin²σ' cosθ') where the emitter's disc holds the other",
        Direct,
        16,
        direct_light::occluder
    ),
    form!(
        "thin-occluder",
        "a ball before an emitter, with some opacity",
        "L = a Le (F - (1 - (1 - o)²) F')",
        Direct,
        16,
        direct_light::occluder
    ),
    form!(
        "exchange",
        "light exchanged between two balls",
        "L = Le + a b Le ∫ F(Q(α)) 2 sinα cosα dα",
        Global,
        64,
        exchange::exchange
    ),
    form!(
        "mirror-before-the-eye",
        "a lit ball seen in a mirror ball",
        "L = ρ a Le F at the point that the mirror shows",
        Direct,
        16,
        mirrors::mirror_before_camera
    ),
    form!(
        "mirror-before-the-lamp",
        "a mirror ball between a point and its emitter",
        "L = a Le (1 - sin²σ + ρ (sin²σ - sin²α'))",
        Direct,
        64,
        mirrors::mirror_before_light
    ),
    form!(
        "glass-in-a-field",
        "glass balls in a uniform field",
        "L = L0 in every pixel, for any index of refraction",
        Direct,
        4,
        uniform::background
    ),
    form!(
        "rough-glass-in-a-field",
        "rough glass balls in a uniform field",
        "L = L0 in every pixel, for any roughness",
        Global,
        4,
        uniform::background
    ),
    form!(
        "lamp-in-glass",
        "an emitter in a ball of glass",
        "L = (1 - F(t)) Le / n²",
        Direct,
        16,
        glass::emitter_in_glass
    ),
    form!(
        "lamp-over-a-mirror",
        "a small emitter, directly and over a mirror ball",
        "L = a Le (s cos t + ρ/π ∫ cos dω)",
        Connected,
        16,
        caustics::over_a_mirror
    ),
    form!(
        "wide-lamp-over-a-mirror",
        "a wide emitter, directly and over a mirror ball",
        "L = a Le (s cos t + ρ/π ∫ cos dω)",
        Direct,
        1024,
        caustics::over_a_mirror
    ),
    form!(
        "lamp-out-of-glass",
        "a small emitter in a glass ball, from outside",
        "L = a Le / (π n²) ∫ (1 - F) cos dω",
        Connected,
        16,
        caustics::out_of_glass
    ),
    form!(
        "lamp-through-glass",
        "a wide emitter behind a glass ball",
        "L = a Le ∫ (1 - F)² d(sin²θ)",
        Caustic,
        64,
        on_axis::through_glass
    ),
    form!(
        "lamp-seen-from-glass",
        "a wide emitter, from inside a glass ball",
        "L = a Le n² ∫ (1 - F) d(sin²θ)",
        Direct,
        64,
        on_axis::from_glass
    ),
    form!(
        "absorption",
        "absorption along the chords of a glass ball",
        "L = L0 (F + (1 - F)² q / (1 - F q)), q = exp(-2 a R cos t)",
        Direct,
        8,
        absorption::absorption
    ),
    form!(
        "orthographic",
        "the lone ball under its emitter through parallel rays",
        "L = a Le F",
        Direct,
        16,
        direct_light::sphere_light
    ),
    form!(
        "panorama",
        "a ball and its emitter all around",
        "L = a Le F on the ball, Le on the emitter",
        Direct,
        16,
        direct_light::sphere_light
    ),
    form!(
        "lens",
        "an emitter out of the focus of a lens",
        "L = Le / s² ∫ area(p) 2 p / A² dp",
        Direct,
        4096,
        cameras::lens
    ),
    form!(
        "lamp-in-dark-glass",
        "an emitter in a ball of glass that absorbs",
        "L = (1 - F(t)) Le exp(-k l) / n²",
        Direct,
        16,
        glass::emitter_in_glass
    ),
    form!(
        "fog",
        "a diffuse ball in fog that bends no light",
        "L = a Le exp(-k s) ∫ exp(-k l(t)) 2 cos t d(cos t) on the ball, Le exp(-k s) beside it",
        Direct,
        16,
        absorption::fog
    ),
    form!(
        "trapped-light",
        "an emitter in the ring of totally reflected light",
        "L = Le",
        Direct,
        4,
        uniform::emitter
    ),
    form!(
        "sun-and-sky",
        "a ball under a sun and a sky that is brighter above",
        "L = a (Lh + ⅔ g n_y + F E / (π sin² s))",
        Direct,
        16,
        direct_light::sun_and_sky
    ),
    form!(
        "protruding-cap",
        "an emitter that sticks out of a wall by a millionth of its radius",
        "L = Le π a² / s², a the radius of the circle in which they intersect",
        Direct,
        1024,
        visibility::protruding_cap
    ),
    form!(
        "bubble",
        "a camera in a bubble whose wall is a billionth of its radius",
        "L = L0",
        Direct,
        4,
        uniform::background
    ),
    form!(
        "horizon",
        "the horizon of the Earth at a height of 2 m",
        "L = L0 (½ + ½ tan d / tan(v/2)), cos d = R / (R + h)",
        Direct,
        1024,
        visibility::horizon
    ),
    form!(
        "low-horizon",
        "the horizon of the Earth at a height of 0.2 m",
        "L = L0 (½ + ½ tan d / tan(v/2)), cos d = R / (R + h)",
        Direct,
        1024,
        visibility::horizon
    ),
    form!(
        "narrow-gap",
        "a gap of 1e-6 between two balls of radius 10",
        "L = L0 g / s",
        Direct,
        1024,
        visibility::narrow_gap
    ),
    ClosedForm {
        tables: &[("many-lamps.f32", many_lights::LIGHT_TABLE)],
        ..form!(
            "many-lamps",
            "three thousand emitters",
            "L = a Le (F₀ + F₁ + ... + F₂₉₉₉)",
            Direct,
            16,
            many_lights::many_lights
        )
    },
    form!(
        "shadow-catcher",
        "the shadow of a ball on a ground that the camera does not see",
        "L = Lb (1 - F), F the form factor of the ball, cut by the horizon",
        Direct,
        16,
        first_hits::shadow_catcher
    ),
    form!(
        "openness",
        "how open the points of two balls are",
        "1 - F, F the form factor of the other ball",
        Integrator("ambient-occlusion"),
        16,
        first_hits::ambient_occlusion
    ),
    ClosedForm {
        channels: DISTINCT_CHANNELS,
        ..form!(
            "normals",
            "the normals of balls",
            "½ + ½ n",
            Integrator("normals"),
            16,
            first_hits::normals
        )
    },
];
