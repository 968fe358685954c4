//! Develops a film into a picture with the requested AOVs.

use rayon::prelude::*;

use crate::accel::Accel;
use crate::color::NO_ROW;
use crate::film::{Aov, Film, FilmFrame, Layer};
use crate::geometry::PathRay;
use crate::image_io::{ChannelValues, ImageChannel, Picture};
use crate::math::Hit;
use crate::scene::{PreparedScene, Scene};

use super::cryptomatte;

/// Develops a film of the prepared scene into a picture with the layers `aovs`.
pub fn develop(prepared: &PreparedScene, accel: &dyn Accel, film: &Film, aovs: &[Aov]) -> Picture {
    let scene = prepared.scene();
    let needs_ids = |aov: &Aov| matches!(aov, Aov::SphereId | Aov::MaterialId);
    let rows = match aovs.iter().any(needs_ids) {
        true => primary_hit_rows(prepared, accel, film.frame()),
        false => Vec::new(),
    };
    let scene_ids = |aov: Aov| {
        let material = |&row: &u32| match row {
            NO_ROW => NO_ROW,
            row => scene.material_of_row(row) as u32,
        };
        let id = |&row: &u32| if row == NO_ROW { NO_ROW } else { scene.id_of_row(row) };
        match aov {
            Aov::MaterialId => rows.iter().map(material).collect(),
            _ => rows.iter().map(id).collect(),
        }
    };
    let transparent = scene.description().background.transparent;
    let mut picture = assemble(film, aovs, transparent, &scene_ids);
    for aov in aovs {
        if let Aov::Cryptomatte(kind) = aov {
            cryptomatte::add_layers(&mut picture, scene, film, *kind);
        }
    }
    picture
}

/// Returns true if an AOV needs the scene (ids or names) and not only the samples.
pub fn needs_scene(aov: Aov) -> bool {
    matches!(aov, Aov::SphereId | Aov::MaterialId | Aov::Cryptomatte(_))
}

/// Develops a film into a picture without the scene, for AOVs that do not need it. `transparent` is
/// the scene's background setting.
pub fn develop_without_scene(film: &Film, aovs: &[Aov], transparent: bool) -> Picture {
    assemble(film, aovs, transparent, &|_| Vec::new())
}

fn assemble(
    film: &Film,
    aovs: &[Aov],
    transparent: bool,
    scene_ids: &dyn Fn(Aov) -> Vec<u32>,
) -> Picture {
    let mut picture = film.picture();
    let has_alpha = aovs.contains(&Aov::Mean(Layer::Alpha));
    if !transparent && !has_alpha {
        // Alpha was accumulated only for other layers.
        picture.alpha = None;
    }
    let is_missing = |layer: &Layer| !aovs.contains(&Aov::Mean(*layer));
    let missing = [Layer::Direct, Layer::Indirect].into_iter().filter(is_missing);
    picture.hidden_layers = missing.map(Layer::name).collect();
    for aov in aovs {
        picture.channels.extend(aov_planes(film, *aov, scene_ids));
    }
    picture
}

/// The channels of an AOV, except those that the picture already has.
fn aov_planes(film: &Film, aov: Aov, scene_ids: &dyn Fn(Aov) -> Vec<u32>) -> Vec<ImageChannel> {
    let uint_channel =
        |values: Vec<u32>| vec![ImageChannel::new(aov.info().name, ChannelValues::Uint(values))];
    match aov {
        Aov::Beauty
        | Aov::Mean(Layer::Direct | Layer::Indirect | Layer::Alpha | Layer::Coverage)
        | Aov::Cryptomatte(_) => Vec::new(),
        Aov::Mean(layer) => split_channels(aov, film.mean(layer)),
        Aov::Variance => split_channels(aov, film.variance()),
        Aov::SampleCount => uint_channel(film.counts()),
        Aov::SphereId | Aov::MaterialId => uint_channel(scene_ids(aov)),
    }
}

/// One plane per channel.
fn split_channels(aov: Aov, values: Option<Vec<[f32; 3]>>) -> Vec<ImageChannel> {
    let (info, values) = (aov.info(), values.unwrap_or_default());
    let plane = |name: String, axis: usize| ImageChannel {
        name,
        values: ChannelValues::Float(values.iter().map(|value| value[axis]).collect()),
    };
    if info.channels.is_empty() {
        return vec![plane(info.name.to_owned(), 0)];
    }
    let channels = info.channels.iter().enumerate();
    channels.map(|(axis, channel)| plane(format!("{}.{channel}", info.name), axis)).collect()
}

/// For each pixel, the row of the first sphere hit by the ray through the pixel centre and the lens
/// centre. Spheres with opacity 0 are skipped.
fn primary_hit_rows(prepared: &PreparedScene, accel: &dyn Accel, frame: &FilmFrame) -> Vec<u32> {
    let window = frame.window;
    let pixel_row = |y: u32| {
        let center = |x: u32| {
            prepared.camera().generate_ray(f64::from(x) + 0.5, f64::from(y) + 0.5, [0.5; 2])
        };
        trace_primary_rows(
            prepared.scene(),
            accel,
            (window.x..window.x + window.width).map(center).collect(),
        )
    };
    (window.y..window.y + window.height).into_par_iter().flat_map_iter(pixel_row).collect()
}

fn trace_primary_rows(scene: &Scene, accel: &dyn Accel, mut rays: Vec<PathRay>) -> Vec<u32> {
    let spheres = scene.spheres();
    let mut rows = vec![NO_ROW; rays.len()];
    let mut active: Vec<usize> = (0..rays.len()).collect();
    while !active.is_empty() {
        let queries: Vec<_> = active.iter().map(|&index| spheres.to_query(&rays[index])).collect();
        let mut hits = vec![Hit::MISS; queries.len()];
        accel.closest(&queries, &mut hits);
        let mut results = hits.into_iter();
        active.retain(|&index| {
            let hit = results.next().and_then(|hit| spheres.resolve_hit(&rays[index], hit));
            let Some(hit) = hit else { return false };
            if scene.sphere_material(hit.id).material.opacity > 0.0 {
                rows[index] = spheres.row(hit.id);
                return false;
            }
            let continued = hit.spawn_ray(rays[index].direction);
            continued.inspect(|ray| rays[index] = *ray).is_some()
        });
    }
    rows
}
