//! Renders tiny pictures of any scene. Every pixel is a number, and equal for two intersectors.

use std::path::Path;

use photosphere::accel::{Backend, BuildOptions};
use photosphere::film::{AOVS, Aov};
use photosphere::image_io::{ChannelValues, Picture};
use photosphere::job::render_with_accel;
use photosphere::scene::settings::IntegratorSettings;
use photosphere::scene::{PreparedScene, Scene, Settings};
use photosphere::task::CancelToken;

use super::{accepted, read_scene};

/// Bounds on what one input may cost.
const MAX_SPHERES: u64 = 500;
const MAX_SIDE: u32 = 5;
const MAX_SAMPLES: u32 = 4;
const MAX_DEPTH: u32 = 12;

/// The input is the text of a scene. Its size and samples are limited.
pub(super) fn render(input: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(input) else { return false };
    let Some(file) = read_scene(text, Path::new("nowhere"), &[]) else { return false };
    if file.size().spheres > MAX_SPHERES {
        return false;
    }
    let Some((scene, settings)) = accepted(file.build()) else { return false };
    all_pictures_agree(&scene, settings)
}

/// Renders with brute force and with the native intersector. False if the scene cannot be rendered.
pub(super) fn all_pictures_agree(scene: &Scene, settings: Settings) -> bool {
    let settings = limited(settings);
    let Some(prepared) = accepted(PreparedScene::new(scene, settings)) else { return false };
    let aovs: Vec<Aov> = AOVS.iter().map(|info| info.aov).collect();
    let render = |backend: Backend| {
        let accel = backend.build(scene.spheres(), &BuildOptions::default())?;
        render_with_accel(&prepared, &*accel, &aovs, &CancelToken::default())
    };
    match (render(Backend::BruteForce), render(Backend::Native)) {
        (Ok(reference), Ok(native)) => {
            assert_eq!(reference.picture.non_finite(), 0, "pixels are not finite");
            assert_eq!(bits(&reference.picture), bits(&native.picture), "the pictures differ");
            assert_eq!((reference.rays, reference.samples), (native.rays, native.samples));
            true
        }
        (Err(reference), Err(native)) => {
            assert_eq!(reference.to_string(), native.to_string());
            super::refused(&reference)
        }
        (reference, native) => panic!("only one can render it: {reference:?}, {native:?}"),
    }
}

/// The settings with a picture of few pixels and samples.
pub(super) fn limited(mut settings: Settings) -> Settings {
    let image = &mut settings.image;
    (image.width, image.height) = (image.width.min(MAX_SIDE), image.height.min(MAX_SIDE));
    image.crop = None;
    let render = &mut settings.render;
    render.samples_per_pixel = render.samples_per_pixel.min(MAX_SAMPLES);
    render.max_depth = Some(render.max_depth.map_or(MAX_DEPTH, |depth| depth.min(MAX_DEPTH)));
    if let IntegratorSettings::Paper(paper) = &mut render.integrator {
        (paper.subpixels, paper.samples) = (paper.subpixels.min(2), paper.samples.min(2));
        render.samples_per_pixel = paper.subpixels * paper.subpixels * paper.samples;
    }
    settings
}

/// Every value of a picture, channel by channel.
fn bits(picture: &Picture) -> Vec<(&str, Vec<u32>)> {
    let color = |pixels: &[photosphere::color::Rgb]| {
        pixels.iter().flat_map(|pixel| pixel.to_array().map(f32::to_bits)).collect()
    };
    let mut all = vec![("direct", color(&picture.direct)), ("indirect", color(&picture.indirect))];
    let alpha = picture.alpha.iter().flatten().map(|alpha| alpha.to_bits()).collect();
    all.push(("alpha", alpha));
    all.extend(picture.channels.iter().map(|channel| {
        let bits = match &channel.values {
            ChannelValues::Float(values) => values.iter().map(|value| value.to_bits()).collect(),
            ChannelValues::Uint(values) => values.clone(),
        };
        (&*channel.name, bits)
    }));
    all
}
