//! What cameras must show whatever they look at, and crops.

use photosphere::color::Rgb;
use photosphere::math::Rect;
use photosphere::scene::MaterialHandle;
use photosphere::scene::description::{
    LensDescription, MaterialDescription, ProjectionDescription, SurfaceModel,
};
use photosphere::scene::settings::{FilterKind, ImageSettings, IntegratorSettings, SamplerKind};

use crate::kit::Kit;

/// A lens before an opening of this radius, in focus at this distance.
fn lens(radius: f64, focus_distance: f64, blades: u32) -> LensDescription {
    LensDescription { radius, focus_distance, blades, rotation_degrees: 0.0 }
}

/// 36 degrees through a lens.
fn through(lens: LensDescription) -> ProjectionDescription {
    ProjectionDescription::Perspective { vertical_fov_degrees: 36.0, lens: Some(lens) }
}

/// Every camera, for a point in focus at this distance.
fn cameras(distance: f64) -> [ProjectionDescription; 6] {
    [
        ProjectionDescription::Perspective { vertical_fov_degrees: 50.0, lens: None },
        through(lens(0.3, 2.0, 0)),
        through(LensDescription { rotation_degrees: 20.0, ..lens(0.3, distance, 5) }),
        ProjectionDescription::Orthographic { height: 2.0 },
        ProjectionDescription::Panoramic { horizontal_degrees: 360.0, vertical_degrees: 180.0 },
        ProjectionDescription::Panoramic { horizontal_degrees: 90.0, vertical_degrees: 100.0 },
    ]
}

fn filtered(kit: &mut Kit, filter: FilterKind) {
    let image = &mut kit.settings.image;
    *image = ImageSettings {
        filter,
        filter_radius: ImageSettings::default_filter_radius(filter),
        ..*image
    };
}

/// A black surface that glows.
fn glowing(kit: &mut Kit, emission: [f32; 3]) -> MaterialHandle {
    let surface = SurfaceModel::Diffuse { albedo: Rgb::ZERO, roughness: 0.0 };
    let emission = emission.into();
    kit.scene.material(MaterialDescription { surface, emission, ..Default::default() })
}

/// Inside of a black ball that glows.
fn glow() -> Kit {
    let mut kit = Kit::new(5, 4, 16);
    kit.scene.camera([1.0, 2.0, 3.0], [0.0, 1.0, 0.0]);
    let wall = glowing(&mut kit, [0.75, 0.5, 0.25]);
    kit.scene.sphere(wall, [0.0; 3], 1000.0);
    kit
}

#[test]
fn every_camera_filter_and_sampler_shows_a_constant_as_it_is() {
    for camera in cameras(11f64.sqrt()) {
        for (_, filter) in FilterKind::NAMES {
            for (_, sampler) in SamplerKind::NAMES {
                let mut kit = glow();
                kit.scene.description.camera.projection = camera;
                kit.settings.render.sampler = *sampler;
                filtered(&mut kit, *filter);
                let constant = Rgb::new(0.75, 0.5, 0.25);
                let shown = kit.picture();
                let is_constant = shown.direct.iter().all(|&light| light == constant);
                assert!(is_constant, "{camera:?} {filter:?} {sampler:?}");
            }
        }
    }
}

#[test]
fn every_camera_knows_the_glass_that_its_rays_start_in() {
    // Around the middle of a ball of glass no ray is trapped: light has n^2 times its radiance
    // there.
    let mut inside = glow();
    let glass = inside.scene.glass(1.5);
    inside.scene.sphere(glass, [1.0, 2.0, 3.0], 9.0);
    for camera in cameras(11f64.sqrt()) {
        let mut kit = inside.clone();
        kit.scene.description.camera.projection = camera;
        filtered(&mut kit, FilterKind::Tent);
        let shown = kit.picture();
        for pixel in 0..shown.len() {
            let green = shown.beauty(pixel).y;
            assert!((green - 0.5 * 2.25).abs() < 1e-5, "{camera:?}: {green}");
        }
    }
    // A plane of parallel rays that reaches out of the glass on both sides: the rays of the middle
    // pixel start within it, near enough to its middle that none is trapped.
    (inside.settings.image.width, inside.settings.image.height) = (9, 1);
    inside.scene.description.camera.projection =
        ProjectionDescription::Orthographic { height: 8.0 };
    let shown = inside.picture();
    for (pixel, expected) in [(0, 0.5), (4, 0.5 * 2.25), (8, 0.5)] {
        assert!((shown.beauty(pixel).y - expected).abs() < 1e-5, "{pixel}");
    }
}

#[test]
fn a_closed_lens_is_the_pinhole_bit_by_bit() {
    let small = ["image.width=24", "image.height=18", "render.samples_per_pixel=4"];
    let mut kit = Kit::of_file("paper/fig4.toml", &small);
    let with_lens = |kit: &Kit, lens: LensDescription| {
        kit.clone().with(|kit| kit.scene.description.camera.projection = through(lens)).picture()
    };
    assert_eq!(with_lens(&kit, lens(0.0, 3.0, 6)), kit.picture());
    // Almost closed, nearly all pixels are nearly the same.
    kit.settings.render.integrator = IntegratorSettings::Normals;
    let (sharp, almost) = (kit.picture(), with_lens(&kit, lens(1e-9, 3.0, 0)));
    let differ = |i: &usize| (sharp.direct[*i] - almost.direct[*i]).abs().max_element() > 1e-5;
    assert_eq!((0..sharp.len()).filter(differ).count(), 0);
}

/// A wall of two halves, seen from 5 away: two balls so large that they are flat, one glowing.
/// Their surfaces cross where x = 0, between the fourth and the fifth of eight columns.
fn wall(lens: Option<LensDescription>) -> Kit {
    let mut kit = Kit::new(8, 6, 64);
    kit.scene.camera([0.0, 0.0, 5.0], [0.0; 3]);
    kit.scene.description.camera.projection =
        ProjectionDescription::Perspective { vertical_fov_degrees: 20.0, lens };
    let dark = kit.scene.diffuse([0.0; 3]);
    let bright = glowing(&mut kit, [1.0; 3]);
    kit.scene.sphere(dark, [-1.0, 0.0, -1e6], 1e6).sphere(bright, [1.0, 0.0, -1e6], 1e6);
    kit
}

/// How far away a scene file is in focus whose camera is that of the wall, and whose first sphere,
/// `ground`, can be the wall's dark half.
fn focus(options: &[&str]) -> f64 {
    let camera =
        ["camera.position=[0, 0, 5]", "camera.look_at=[0, 0, 0]", "camera.aperture_radius=0.4"];
    let kit = Kit::of_file("paper/fig4.toml", &[&camera[..], options].concat());
    match kit.scene.description.camera.projection {
        ProjectionDescription::Perspective { lens: Some(lens), .. } => lens.focus_distance,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_plane_in_focus_does_not_depend_on_the_aperture() {
    let pinhole = wall(None).picture();
    for pixel in 0..pinhole.len() {
        let expected = if pixel % 8 < 4 { 0.0 } else { 1.0 };
        assert_eq!(pinhole.beauty(pixel).x, expected);
    }
    // The lens is focused on the wall: on `look_at`, by distance, or by the name of a sphere.
    let half = ["camera.focus_on=ground", "spheres.0.center=[-1, 0, -1e6]", "spheres.0.radius=1e6"];
    for distance in [focus(&[]), 5.0, focus(&half)] {
        for blades in [0, 7] {
            let shown = wall(Some(lens(0.4, distance, blades))).picture();
            assert_eq!(shown, pinhole, "{distance}, {blades}");
        }
    }
    let blurred = wall(Some(lens(0.4, 3.0, 0))).picture();
    let grey = |pixel: &usize| blurred.beauty(*pixel).x > 0.0 && blurred.beauty(*pixel).x < 1.0;
    assert!((0..blurred.len()).filter(grey).count() > 9, "both columns at the edge");
    assert!((blurred.mean().x - 0.5).abs() < 0.05);
}

#[test]
fn parallel_rays_are_those_of_a_camera_far_away() {
    let options = ["image.width=40", "image.height=30", "render.integrator=normals"];
    let mut kit = Kit::of_file("paper/fig4.toml", &options);
    kit.scene.camera([0.0, 1.0, 1e6], [0.0, 1.0, 0.0]);
    kit.scene.field_of_view(2.0 * (2e-6f64).atan().to_degrees());
    let far = kit.picture();
    kit.scene.description.camera.projection = ProjectionDescription::Orthographic { height: 4.0 };
    let parallel = kit.picture();
    let differ =
        |pixel: &usize| (parallel.direct[*pixel] - far.direct[*pixel]).abs().max_element() > 1e-4;
    let different = (0..far.len()).filter(differ).count();
    assert!(different == 0, "{different} of {}", far.len());
    assert!(far.direct.iter().any(|&color| color != far.direct[0]));
}

#[test]
fn a_crop_has_the_bits_of_the_whole_picture() {
    let small = ["image.width=37", "image.height=23", "image.filter=gaussian"];
    let lens = ["camera.aperture_radius=0.1", "render.samples_per_pixel=20"];
    for integrator in ["path", "direct", "paper", "ambient-occlusion", "normals", "raycast"] {
        let integrator = format!("render.integrator={integrator}");
        let options = [&small[..], &lens, &[&integrator]].concat();
        let mut kit = Kit::of_file("paper/fig4.toml", &options);
        let whole = kit.picture();
        for [x0, y0, x1, y1] in
            [[0, 0, 37, 23], [5, 7, 30, 8], [36, 22, 37, 23], [11, 2, 19, 21usize]]
        {
            let [x, y, width, height] = [x0, y0, x1 - x0, y1 - y0].map(|pixels| pixels as u32);
            let crop = Rect { x, y, width, height };
            kit.settings.image.crop = Some(crop);
            let part = kit.picture();
            assert_eq!((part.width, part.height), (x1 - x0, y1 - y0));
            for y in y0..y1 {
                let row = (y - y0) * part.width..(y - y0 + 1) * part.width;
                let same = y * 37 + x0..y * 37 + x1;
                assert_eq!(part.direct[row.clone()], whole.direct[same.clone()], "{crop}");
                assert_eq!(part.indirect[row], whole.indirect[same], "{crop}");
            }
        }
    }
}

#[test]
fn focus_on_finds_the_point_of_a_sphere_that_is_nearest() {
    assert_eq!(focus(&[]), 5.0);
    assert_eq!(focus(&["camera.focus_distance=7"]), 7.0);
    let aside = ["camera.focus_on=ground", "spheres.0.center=[4, 0, 2]", "spheres.0.radius=1"];
    // The centre is 5 away at a cosine of 3/5; the nearest point 4.
    assert!((focus(&aside) - 4.0 * 0.6).abs() < 1e-12);
}
