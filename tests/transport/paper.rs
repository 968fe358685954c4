//! What the paper says of its figures, measured on our reconstruction of its scenes.
//!
//! P- and A-numbers are those of `docs/paper-checklist.md`. Ratios come from 32 seeds; they must
//! differ by four standard errors (a false alarm is less likely than 1e-3 each).

use photosphere::accel::Backend;
use photosphere::color::Rgb;
use photosphere::geometry::SurfaceHit;
use photosphere::image_io::Picture;
use photosphere::material::Model;
use photosphere::math::{DVec3, Frame, Hit};
use photosphere::sampling::Hemisphere;
use photosphere::scene::description::SphereDescription;
use photosphere::scene::settings::IntegratorSettings;
use photosphere::scene::{PreparedScene, Scene};

use crate::kit::{ALLOWED, Judged, Kit, MeanEstimate, SEEDS, built, rendered};

const SMALL: [&str; 3] = ["image.width=96", "image.height=72", "render.samples_per_pixel=16"];

fn ball<'a>(scene: &'a Scene, name: &str) -> (u32, &'a SphereDescription) {
    let rows = &scene.description().spheres;
    let row =
        rows.iter().position(|s| s.name.as_deref() == Some(name)).expect("named in the scene");
    let id = scene.spheres().rows().iter().position(|&r| r == row as u32).expect("an id");
    (id as u32, &rows[row])
}

/// What the camera sees through the centre of every pixel.
fn first_hits(prepared: &PreparedScene) -> Vec<Option<SurfaceHit>> {
    let (image, spheres) = (prepared.image_settings(), prepared.scene().spheres());
    let accel = built(prepared, Backend::BruteForce);
    let pixels = (0..image.height).flat_map(|y| (0..image.width).map(move |x| (x, y)));
    let rays: Vec<_> = pixels
        .map(|(x, y)| {
            prepared.camera().generate_ray(f64::from(x) + 0.5, f64::from(y) + 0.5, [0.0; 2])
        })
        .collect();
    let asked: Vec<_> = rays.iter().map(|ray| spheres.to_query(ray)).collect();
    let mut hits = vec![Hit::MISS; asked.len()];
    accel.closest(&asked, &mut hits);
    rays.iter().zip(hits).map(|(ray, hit)| spheres.resolve_hit(ray, hit)).collect()
}

/// The mean over the pixels that show the lower half of a ball.
fn lower_half(
    prepared: &PreparedScene,
    picture: &Picture,
    name: &str,
    layer: fn(&Picture, usize) -> Rgb,
) -> Rgb {
    let (id, _) = ball(prepared.scene(), name);
    let shows =
        |hit: &Option<SurfaceHit>| hit.is_some_and(|hit| hit.id == id && hit.normal.y < 0.0);
    let hits = first_hits(prepared);
    let pixels: Vec<usize> = (0..hits.len()).filter(|&i| shows(&hits[i])).collect();
    assert!(pixels.len() > 50);
    pixels.iter().map(|&i| layer(picture, i)).sum::<Rgb>() / pixels.len() as f32
}

/// A picture of the paper, small.
fn small(path: &str) -> PreparedScene {
    Kit::of_file(path, &SMALL).prepared()
}

/// Green over red in the light that falls on the lower half of a ball, over seeds.
fn green_tint(path: &str, name: &str) -> MeanEstimate {
    let mut prepared = small(path);
    let mut value = |seed: u64| {
        prepared.set_seed(seed);
        let picture = rendered(&prepared, Backend::BruteForce).picture;
        let radiance = lower_half(&prepared, &picture, name, Picture::beauty);
        let (id, _) = ball(prepared.scene(), name);
        let Model::Diffuse(diffuse) = prepared.scene().sphere_material(id).material.model else {
            panic!("the balls of figure 2 are diffuse")
        };
        let arriving = radiance / diffuse.albedo;
        f64::from(arriving.y / arriving.x)
    };
    MeanEstimate::from_values(&(0..SEEDS).map(&mut value).collect::<Vec<_>>())
}

#[test]
fn the_scene_is_the_one_described() {
    // P33, A13: three spheres, two of equal size, one on the huge one, and an emitter out of the
    // picture.
    for figure in 2..=7 {
        let prepared =
            Kit::of_file(&format!("paper/fig{figure}.toml"), &["image.width=640"]).prepared();
        let scene = prepared.scene();
        let (_, ground) = ball(scene, "ground");
        let (_, resting) = ball(scene, "resting ball");
        let (_, floating) = ball(scene, "floating ball");
        let (emitter, emitter_row) = ball(scene, "lamp");
        assert_eq!(scene.spheres().len(), 4);
        assert_eq!(resting.radius, floating.radius);
        let gap = resting.center.distance(ground.center) - ground.radius - resting.radius;
        assert!(gap.abs() < 1e-9, "touches the ground, gap {gap}");
        let distance = |center: DVec3| center.distance(emitter_row.center);
        assert!(distance(floating.center) < distance(resting.center), "one is near the lamp");
        assert!(first_hits(&prepared).iter().flatten().all(|hit| hit.id != emitter), "lamp unseen");
        assert!(first_hits(&prepared).iter().any(Option::is_none), "only a part is in view");
    }
}

#[test]
fn figures_5_to_7_are_the_papers_own_estimator_with_1_10_and_100_samples() {
    // P17, P39.
    for (figure, expected) in [(5, 1), (6, 10), (7, 100)] {
        let settings = Kit::of_file(&format!("paper/fig{figure}.toml"), &[]).settings;
        let render = settings.render;
        let IntegratorSettings::Paper(paper) = render.integrator else {
            panic!("the paper's estimator")
        };
        assert_eq!((paper.subpixels, paper.samples), (2, expected));
        assert_eq!(render.samples_per_pixel, 4 * expected);
        assert_eq!((settings.image.width, settings.image.height), (640, 480));
    }
}

#[test]
fn the_ground_tints_the_nearer_ball_more() {
    // P35. In figure 3 the ground has another colour, and the tint follows (P37).
    let figure = "paper/fig2.toml";
    let (near, far) = (green_tint(figure, "resting ball"), green_tint(figure, "floating ball"));
    println!("green over red: nearer {near:?}, farther {far:?}");
    let joint = near.standard_error.hypot(far.standard_error);
    assert!(near.mean - far.mean > ALLOWED * joint);
    assert!(far.mean > 1.0 + ALLOWED * far.standard_error, "the farther is tinted as well");
    let brown = green_tint("paper/fig3.toml", "resting ball");
    println!("over a brown ground: {brown:?}");
    assert!(brown.mean < 1.0 - ALLOWED * brown.standard_error);
}

#[test]
fn the_blue_ball_is_lit_from_below_and_stays_blue() {
    // P36.
    let prepared = small("paper/fig2.toml");
    let picture = rendered(&prepared, Backend::BruteForce).picture;
    let indirect = lower_half(&prepared, &picture, "floating ball", |p, i| p.indirect[i]);
    assert!(indirect.min_element() > 0.0, "{indirect}");
    let all = lower_half(&prepared, &picture, "floating ball", Picture::beauty);
    assert!(all.z > all.x && all.z > all.y, "{all}");
}

#[test]
fn the_mirror_ball_reflects_by_the_closed_form() {
    // P8, P38, A11: d - 2 (d.n) n, and not straight back.
    let prepared = small("paper/fig4.toml");
    let scene = prepared.scene();
    let (mirror, row) = ball(scene, "resting ball");
    let center = row.center - scene.spheres().origin();
    let mut seen = 0;
    for hit in first_hits(&prepared).into_iter().flatten().filter(|hit| hit.id == mirror) {
        let d = (hit.point - prepared.camera().position()).normalize();
        let n = (hit.point - center) / row.radius;
        let frame = Frame::from_z(hit.facing_normal());
        let surface = scene.sphere_material(hit.id);
        let bsdf = surface.material.bsdf(None, 1.0, Hemisphere::Cosine);
        let sample = bsdf.sample(frame.to_local(-d), 0.5, [0.5, 0.5], &|| [0.5, 0.5]);
        let sample = sample.expect("reflects");
        let expected = d - 2.0 * d.dot(n) * n;
        assert!((frame.to_world(sample.wi) - expected).length() < 1e-6);
        assert_eq!(sample.weight, Rgb::splat(0.95));
        seen += 1;
    }
    assert!(seen > 100);
}

#[test]
fn the_picture_does_not_grow_with_the_number_of_subpixels() {
    // A3: the sum over 4 N paths is divided by 4 N. Divided by N it would be four times too bright.
    let mean = |subpixels: u32| {
        let small = ["image.width=16", "image.height=12", "render.integrator=paper"];
        let samples = "render.samples_per_pixel=144";
        let subpixels = format!("render.paper.subpixels={subpixels}");
        let options = [&small[..], &[&subpixels, samples]].concat();
        Kit::of_file("paper/fig2.toml", &options).estimate(Backend::BruteForce)
    };
    let (one, four, nine) = (mean(1), mean(2), mean(3));
    four.must_agree(one, "4 sub-pixels");
    nine.must_agree(one, "9 sub-pixels");
}
