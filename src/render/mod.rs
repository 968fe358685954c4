//! Renders a scene on all threads: a [`Session`] fills a film, and [`render`] does all of it at once.

mod adaptive;
mod cryptomatte;
mod layers;
mod noise;
mod plan;
mod session;
mod squares;

pub use adaptive::{FIRST_DECISION, Standing, error_so_far, half_widths, render_to};
pub use layers::{needs_scene, picture, picture_of_sums};
pub use noise::Target;
pub use plan::{MemoryPlan, Step};
pub use session::Session;

use crate::accel::{Accel, Cancel};
use crate::error::Result;
use crate::film::{Film, Format, Frame, Kind, Layer, Picture, Rect, Scale, summed_for};
use crate::integrator::Tally;
use crate::scene::Scene;
use crate::scene::description::Description;

/// How to render.
pub struct RenderOptions<'a> {
    /// Set from elsewhere to stop early.
    pub cancel: Cancel,
    /// Called now and then, from any thread.
    pub progress: &'a (dyn Fn(Progress) + Sync),
}

/// How far a render is.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Samples finished.
    pub samples_done: u64,
    /// Samples asked for.
    pub samples_total: u64,
}

/// A rendered picture.
#[derive(Debug)]
pub struct Outcome {
    /// The picture.
    pub picture: Picture,
    /// Samples rendered.
    pub samples: u64,
    /// Rays traced, shadow rays included.
    pub rays: u64,
    /// Whether all samples were rendered.
    pub complete: bool,
    /// What the user should know about the picture.
    pub warnings: Vec<String>,
}

/// Renders the scene on the current rayon thread pool. Cancelled, it gives the picture so far.
///
/// # Errors
/// When there is no memory for the picture, or a pixel is too bright for the film.
pub fn render(scene: &Scene, accel: &dyn Accel, options: &RenderOptions<'_>) -> Result<Outcome> {
    render_layers(scene, accel, &Kind::USUAL, options)
}

/// The same with a choice of layers.
///
/// # Errors
/// Like [`render`].
pub fn render_layers(
    scene: &Scene,
    accel: &dyn Accel,
    kinds: &[Kind],
    options: &RenderOptions<'_>,
) -> Result<Outcome> {
    let film = Film::new(&format_with(scene, kinds))?;
    let session = Session::new(scene, accel, &film, options);
    let complete = session.advance(scene.description().render.samples_per_pixel, &|_| true)?;
    let picture = picture(scene, accel, &film, kinds);
    Ok(session.outcome(scene, complete, picture))
}

impl Session<'_> {
    /// What came of the work on a scene; `complete` if it is done.
    pub fn outcome(&self, scene: &Scene, complete: bool, picture: Picture) -> Outcome {
        Outcome {
            samples: self.samples_done(),
            rays: self.tally().rays,
            complete,
            warnings: warnings(scene, &self.tally(), self.film()),
            picture,
        }
    }
}

/// The film of the usual picture of a scene, from the first sample on.
pub fn format_of(scene: &Scene) -> Format {
    format_with(scene, &Kind::USUAL)
}

/// The film of a picture with these layers, from the first sample on.
pub fn format_with(scene: &Scene, kinds: &[Kind]) -> Format {
    format_of_description(scene.description(), Scale::of_brightest(scene.brightest()), kinds)
}

/// The same, before the scene's lamps are known.
fn format_of_description(description: &Description, scale: Scale, kinds: &[Kind]) -> Format {
    let mut layers = summed_for(kinds);
    if description.background.transparent && !layers.contains(&Layer::Alpha) {
        layers.push(Layer::Alpha);
    }
    let window = description.image.window();
    Format {
        frame: Frame {
            full_size: [description.image.width, description.image.height],
            window: Rect { x: window.x, y: window.y, width: window.width, height: window.height },
        },
        first_sample: 0,
        scale,
        layers,
        squares: true,
    }
}

/// What the user should know about a film of a scene.
pub fn warnings(scene: &Scene, tally: &Tally, film: &Film) -> Vec<String> {
    let mut warnings = Vec::new();
    if scene.description().render.clamp_indirect.is_some() {
        let options = scene.description().render.biases().join(", ");
        warnings.push(format!("the picture is biased by {options}"));
    }
    if let Some((count, [x, y])) = film.left_out() {
        warnings.push(format!(
            "{count} samples were infinite or not a number and were left out, such as in column {x}, \
             row {y}: please report this"
        ));
    }
    if tally.media_overflows > 0 {
        let count = tally.media_overflows;
        warnings.push(format!("{count} paths were inside more than 8 dielectric spheres at once"));
    }
    if tally.cut_off > 0 {
        let count = tally.cut_off;
        warnings.push(format!("{count} paths were cut off after 10000 edges, which loses light"));
    }
    warnings
}
