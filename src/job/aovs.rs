//! From a film to a picture with the layers that are asked for.

use rayon::prelude::*;

use crate::accel::Accel;
use crate::color::NOTHING;
use crate::film::{Film, Frame, Kind, Layer};
use crate::geometry::PathRay;
use crate::image_io::{Picture, Plane, Values};
use crate::math::Hit;
use crate::scene::{Scene, Shot};

use super::cryptomatte;

/// The picture of a film of this shot, with these layers.
pub fn picture(shot: &Shot, accel: &dyn Accel, film: &Film, kinds: &[Kind]) -> Picture {
    let scene = shot.scene();
    let wants_ids = |kind: &Kind| matches!(kind, Kind::SphereId | Kind::MaterialId);
    let rows = match kinds.iter().any(wants_ids) {
        true => rows_at_centres(shot, accel, film.frame()),
        false => Vec::new(),
    };
    let of_scene = |kind: Kind| {
        let material = |&row: &u32| match row {
            NOTHING => NOTHING,
            row => scene.material_of_row(row) as u32,
        };
        let id = |&row: &u32| if row == NOTHING { NOTHING } else { scene.id_of_row(row) };
        match kind {
            Kind::MaterialId => rows.iter().map(material).collect(),
            _ => rows.iter().map(id).collect(),
        }
    };
    let transparent = scene.description().background.transparent;
    let mut picture = assembled(film, kinds, transparent, &of_scene);
    for kind in kinds {
        if let Kind::Cryptomatte(by) = kind {
            cryptomatte::add(&mut picture, scene, film, *by);
        }
    }
    picture
}

/// Whether a layer is about the scene itself and not about samples alone: its ids, or its names.
pub fn needs_scene(kind: Kind) -> bool {
    matches!(kind, Kind::SphereId | Kind::MaterialId | Kind::Cryptomatte(_))
}

/// The same without the scene, for layers that do not need it; `transparent` is what the scene says of
/// its background.
pub fn picture_of_sums(film: &Film, kinds: &[Kind], transparent: bool) -> Picture {
    assembled(film, kinds, transparent, &|_| Vec::new())
}

fn assembled(
    film: &Film,
    kinds: &[Kind],
    transparent: bool,
    of_scene: &dyn Fn(Kind) -> Vec<u32>,
) -> Picture {
    let mut picture = film.picture();
    let wants_alpha = kinds.contains(&Kind::Mean(Layer::Alpha));
    if !transparent && !wants_alpha {
        // It was summed for others.
        picture.alpha = None;
    }
    let is_missing = |layer: &Layer| !kinds.contains(&Kind::Mean(*layer));
    let missing = [Layer::Direct, Layer::Indirect].into_iter().filter(is_missing);
    picture.left_out = missing.map(Layer::name).collect();
    for kind in kinds {
        picture.planes.extend(planes(film, *kind, of_scene));
    }
    picture
}

/// The channels of a layer, but for those that a picture has by itself.
fn planes(film: &Film, kind: Kind, of_scene: &dyn Fn(Kind) -> Vec<u32>) -> Vec<Plane> {
    let whole = |values: Vec<u32>| vec![Plane::new(kind.row().name, Values::Whole(values))];
    match kind {
        Kind::Beauty
        | Kind::Mean(Layer::Direct | Layer::Indirect | Layer::Alpha | Layer::Coverage)
        | Kind::Cryptomatte(_) => Vec::new(),
        Kind::Mean(layer) => spread(kind, film.mean(layer)),
        Kind::Variance => spread(kind, film.variance()),
        Kind::SampleCount => whole(film.counts()),
        Kind::SphereId | Kind::MaterialId => whole(of_scene(kind)),
    }
}

/// A plane for each channel.
fn spread(kind: Kind, values: Option<Vec<[f32; 3]>>) -> Vec<Plane> {
    let (row, values) = (kind.row(), values.unwrap_or_default());
    let plane = |name: String, axis: usize| Plane {
        name,
        values: Values::Float(values.iter().map(|value| value[axis]).collect()),
    };
    if row.channels.is_empty() {
        return vec![plane(row.name.to_owned(), 0)];
    }
    let channels = row.channels.iter().enumerate();
    channels.map(|(axis, channel)| plane(format!("{}.{channel}", row.name), axis)).collect()
}

/// The row of the sphere that the ray through each pixel's centre, and the lens's, meets first. Spheres
/// that are never there do not count.
fn rows_at_centres(shot: &Shot, accel: &dyn Accel, frame: &Frame) -> Vec<u32> {
    let window = frame.window;
    let line = |y: u32| {
        let center = |x: u32| shot.camera().ray(f64::from(x) + 0.5, f64::from(y) + 0.5, [0.5; 2]);
        rows_along(shot.scene(), accel, (window.x..window.x + window.width).map(center).collect())
    };
    (window.y..window.y + window.height).into_par_iter().flat_map_iter(line).collect()
}

fn rows_along(scene: &Scene, accel: &dyn Accel, mut rays: Vec<PathRay>) -> Vec<u32> {
    let spheres = scene.spheres();
    let mut rows = vec![NOTHING; rays.len()];
    let mut active: Vec<usize> = (0..rays.len()).collect();
    while !active.is_empty() {
        let questions: Vec<_> = active.iter().map(|&at| spheres.ask(&rays[at])).collect();
        let mut hits = vec![Hit::MISS; questions.len()];
        accel.closest(&questions, &mut hits);
        let mut answers = hits.into_iter();
        active.retain(|&at| {
            let hit = answers.next().and_then(|hit| spheres.answer(&rays[at], hit));
            let Some(hit) = hit else { return false };
            if scene.surface(hit.id).material.opacity > 0.0 {
                rows[at] = spheres.row(hit.id);
                return false;
            }
            let behind = hit.leave(rays[at].direction);
            behind.inspect(|ray| rays[at] = *ray).is_some()
        });
    }
    rows
}
