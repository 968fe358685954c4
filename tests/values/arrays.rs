//! Arrays in memory are the spheres that they hold.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use photosphere::color::Rgb;
use photosphere::film::{Aov, Layer};
use photosphere::geometry::Sphere;
use photosphere::image_io::Picture;
use photosphere::job::run;
use photosphere::scene::data::{ArrayValues, Ids, SharedSlice, StridedArray};
use photosphere::scene::description::{MaterialDescription, SurfaceModel};
use photosphere::scene::settings::{Estimator, IntegratorSettings, PaperSettings};
use photosphere::scene::{Scene, Settings, SphereArrays};

use super::{balls, color_of, job, narrow, of_arrays, rows, sphere_ids, view};

fn id_of(row: usize) -> u32 {
    1000 - 7 * row as u32
}

fn one_by_one(balls: &[Sphere], colors: bool) -> Scene {
    let mut scene = view();
    let grey = scene.diffuse([0.5; 3]);
    for (row, ball) in balls.iter().enumerate() {
        let material = if colors { scene.diffuse(color_of(row)) } else { grey };
        scene.sphere(material, ball.center, ball.radius);
    }
    scene.build().expect("good spheres")
}

fn picture(scene: &Scene) -> Picture {
    let mut settings = Settings::default();
    (settings.image.width, settings.image.height) = (32, 24);
    settings.render.samples_per_pixel = 4;
    let kinds = [Aov::SphereId, Aov::Variance];
    run(scene, &job(settings, &kinds), &()).expect("renders").picture
}

fn spheres(scene: &Scene) -> Vec<Sphere> {
    let spheres = scene.spheres();
    (0..spheres.len() as u32).map(|id| spheres.sphere_as_written(id)).collect()
}

/// Fails unless both are the same spheres in the same order, and look the same.
fn must_be_same(name: &str, a: &Scene, b: &Scene) {
    let (of_a, of_b) = (a.spheres(), b.spheres());
    assert_eq!(of_a.origin(), of_b.origin(), "{name}");
    assert_eq!(spheres(a), spheres(b), "{name}");
    assert_eq!(of_a.particle_count(), of_b.particle_count(), "{name}");
    assert_eq!(of_a.rows(), of_b.rows(), "{name}");
    assert!(picture(a) == picture(b), "{name}: pictures");
}

/// An array with a first number, a stride and a length.
fn strided(values: ArrayValues, first: usize, stride: isize, len: usize) -> StridedArray {
    StridedArray { values, offset: first, stride, len }
}

fn f32s(values: Vec<f32>) -> ArrayValues {
    ArrayValues::F32(SharedSlice::new(values))
}

fn f64s(values: Vec<f64>) -> ArrayValues {
    ArrayValues::F64(SharedSlice::new(values))
}

/// The arrays of four numbers of each sphere.
fn arrays([x, y, z, radius]: [StridedArray; 4]) -> SphereArrays {
    SphereArrays { center: [x, y, z], radius, ..SphereArrays::default() }
}

/// A scene's numbers in one array of rows with something between them, from the last row to the
/// first.
fn backwards(rows: &[[f64; 4]], array: impl Fn(Vec<f64>) -> ArrayValues) -> SphereArrays {
    let padded = rows.iter().rev().flat_map(|row| [&row[..], &[f64::NAN, -1.0]].concat());
    let (values, len) = (array(padded.collect()), rows.len());
    arrays(std::array::from_fn(|column| strided(values.clone(), column + 6 * (len - 1), -6, len)))
}

fn columns(rows: &[[f64; 4]], array: impl Fn(Vec<f64>) -> ArrayValues) -> SphereArrays {
    let column = |column: usize| rows.iter().map(|row| row[column]).collect::<Vec<f64>>();
    arrays(std::array::from_fn(|at| strided(array(column(at)), 0, 1, rows.len())))
}

fn to_f32s(values: Vec<f64>) -> ArrayValues {
    f32s(values.into_iter().map(|value| value as f32).collect())
}

/// A scene's numbers in the bytes of packed structures: one byte before the four numbers of each
/// row, and one behind them.
fn structured<const N: usize>(
    rows: &[[f64; 4]],
    bytes: impl Fn(f64) -> [u8; N],
    array: impl Fn(SharedSlice<u8>) -> ArrayValues,
) -> SphereArrays {
    let mut all = Vec::new();
    for row in rows {
        all.push(255);
        all.extend(row.iter().flat_map(|&number| bytes(number)));
        all.push(255);
    }
    let values = array(SharedSlice::new(all));
    let (stride, len) = (4 * N as isize + 2, rows.len());
    arrays(std::array::from_fn(|column| strided(values.clone(), 1 + N * column, stride, len)))
}

/// These spheres in every layout that arrays may have.
fn layouts(balls: &[Sphere], is_f64: bool) -> Vec<(&'static str, SphereArrays)> {
    let rows = rows(balls);
    let centers: Vec<[f64; 3]> = balls.iter().map(|ball| ball.center.to_array()).collect();
    let radii: Vec<f64> = balls.iter().map(|ball| ball.radius).collect();
    let mut all = vec![
        ("f64 rows", arrays(StridedArray::columns_from(rows.clone()))),
        ("f64 centers", SphereArrays::from_centers(centers.clone(), radii.clone())),
        ("f64 columns", columns(&rows, f64s)),
        ("f64 backwards", backwards(&rows, f64s)),
        ("f64 structures", structured(&rows, f64::to_le_bytes, ArrayValues::F64Bytes)),
    ];
    if !is_f64 {
        let narrow_radii: Vec<f32> = radii.iter().map(|&radius| radius as f32).collect();
        let mixed = SphereArrays {
            radius: StridedArray::from_vec(narrow_radii.clone()),
            ..SphereArrays::from_centers(centers.clone(), radii)
        };
        all.extend([
            ("f32 rows", SphereArrays::from_rows(narrow(&rows))),
            ("f32 centers", SphereArrays::from_centers(narrow(&centers), narrow_radii)),
            ("f32 columns", columns(&rows, to_f32s)),
            ("f32 backwards", backwards(&rows, to_f32s)),
            (
                "f32 structures",
                structured(&rows, |number| (number as f32).to_le_bytes(), ArrayValues::F32Bytes),
            ),
            ("f64 centers and f32 radii", mixed),
        ]);
    }
    all
}

#[test]
fn arrays_of_any_layout_are_the_spheres_one_by_one() {
    for is_f64 in [false, true] {
        let balls = balls(is_f64);
        let expected = one_by_one(&balls, false);
        for (name, arrays) in layouts(&balls, is_f64) {
            assert_eq!(arrays.len(), balls.len());
            must_be_same(name, &of_arrays(arrays).expect("good arrays"), &expected);
        }
    }
}

#[test]
fn one_number_can_be_that_of_all_spheres() {
    let mut balls = balls(false);
    for ball in &mut balls {
        ball.center.y = 0.5;
        ball.radius = 0.25;
    }
    let expected = one_by_one(&balls, false);
    let rows = rows(&balls);
    for array in [f64s, to_f32s] {
        let mut arrays = columns(&rows, array);
        arrays.center[1] = strided(array(vec![9.0, 0.5]), 1, 0, rows.len());
        arrays.radius = StridedArray::constant(0.25f32, rows.len());
        must_be_same("stride 0", &of_arrays(arrays).expect("good arrays"), &expected);
    }
}

#[test]
fn spheres_of_an_array_can_have_colors() {
    let balls = balls(false);
    let expected = one_by_one(&balls, true);
    let colors: Vec<[f32; 3]> = (0..balls.len()).map(color_of).collect();
    let wide: Vec<[f64; 3]> = colors.iter().map(|color| color.map(f64::from)).collect();
    let flat = colors.iter().rev().flatten().copied().collect();
    let backwards = {
        let (values, len) = (f32s(flat), colors.len());
        std::array::from_fn(|at| strided(values.clone(), at + 3 * (len - 1), -3, len))
    };
    for (name, arrays) in layouts(&balls, false) {
        for arrays in [
            arrays.clone().with_colors(colors.clone()),
            arrays.clone().with_colors(wide.clone()),
            SphereArrays { color: Some(backwards.clone()), ..arrays },
        ] {
            must_be_same(name, &of_arrays(arrays).expect("good arrays"), &expected);
        }
    }
}

/// A scene with emission of its own for each ball: in one table, or a material for each.
fn glowing(is_table: bool, surface: SurfaceModel, opacity: f64) -> Scene {
    let balls = balls(false);
    let light = |row: usize| match row % 3 {
        0 => [0.0; 3],
        part => [0.25, 0.5, 2.0].map(|channel| channel * part as f32 + row as f32 / 64.0),
    };
    let mut scene = view();
    scene.background([0.1, 0.2, 0.3]);
    let ground = scene.diffuse([0.7; 3]);
    scene.sphere(ground, [0.0, -103.0, 0.0], 100.0);
    let material =
        |emission: Rgb| MaterialDescription { surface, emission, opacity, ..Default::default() };
    if is_table {
        // Each row replaces what the material emits.
        let own = scene.material(material(Rgb::splat(0.5)));
        let arrays = SphereArrays::from_rows(narrow(&rows(&balls)));
        scene.spheres(own, arrays.with_emission((0..balls.len()).map(light).collect()));
    } else {
        for (row, ball) in balls.iter().enumerate() {
            let own = scene.material(material(light(row).into()));
            scene.sphere(own, ball.center, ball.radius);
        }
    }
    scene.build().expect("good values")
}

/// Whatever reads the emission: paths that find it by chance or sample it, in lanes or one by one,
/// through what is partly opaque or glass; and the layer of emission.
#[test]
fn rows_with_emission_look_like_spheres_with_a_material_each() {
    let albedo = Rgb::splat(0.5);
    let glass =
        SurfaceModel::Dielectric { ior: 1.5, roughness: 0.0, priority: 0, absorption: Rgb::ZERO };
    let surfaces = [
        (SurfaceModel::Diffuse { albedo, roughness: 0.0 }, 1.0),
        (SurfaceModel::Diffuse { albedo, roughness: 0.0 }, 0.5),
        (SurfaceModel::Plastic { albedo, ior: 1.5, roughness: 0.25 }, 1.0),
        (glass, 0.5),
    ];
    for (surface, opacity) in surfaces {
        let [table, one_by_one] = [true, false].map(|is_table| glowing(is_table, surface, opacity));
        assert_eq!(table.emitter_count(), one_by_one.emitter_count());
        assert_eq!(table.emitter_count(), 40);
        assert_eq!(table.max_radiance(), one_by_one.max_radiance());
        for integrator in [
            IntegratorSettings::Path,
            IntegratorSettings::Direct,
            IntegratorSettings::Raycast { shadows: true },
            IntegratorSettings::Paper(PaperSettings::default()),
        ] {
            for estimator in [Estimator::Mis, Estimator::Light, Estimator::Bsdf] {
                let mut settings = Settings::default();
                (settings.image.width, settings.image.height) = (24, 16);
                settings.render.integrator = integrator;
                settings.render.estimator = estimator;
                settings.render.samples_per_pixel = 16;
                let layers = [Aov::SphereId, Aov::Variance, Aov::Mean(Layer::Emission)];
                let picture =
                    |scene| run(scene, &job(settings, &layers), &()).expect("renders").picture;
                let [of_table, expected] = [picture(&table), picture(&one_by_one)];
                let what = format!("{surface:?}, {integrator:?}, {estimator:?}");
                assert!(of_table == expected, "{what}");
                let is_lit = expected.direct.iter().any(|pixel| pixel.max_element() > 1.0);
                assert!(is_lit, "{what}: no emitter is in sight");
            }
        }
    }
}

#[test]
fn the_layer_of_ids_shows_the_numbers_of_an_array() {
    let balls = balls(false);
    let ids: Vec<u32> = (0..balls.len()).map(id_of).collect();
    let plain = picture(&one_by_one(&balls, false));
    let numbered = |&row: &u32| if row == u32::MAX { row } else { id_of(row as usize) };
    let expected: Vec<u32> = sphere_ids(&plain).iter().map(numbered).collect();
    assert!(expected.iter().any(|&id| id != u32::MAX));
    let in_bytes = ids.iter().rev().flat_map(|id| [&id.to_le_bytes()[..], &[7]].concat());
    let in_bytes = StridedArray {
        values: Ids::U32Bytes(SharedSlice::new(in_bytes.collect::<Vec<u8>>())),
        offset: 5 * (ids.len() - 1),
        stride: -5,
        len: ids.len(),
    };
    for (index, (name, arrays)) in layouts(&balls, false).into_iter().enumerate() {
        let arrays = match index % 2 {
            0 => arrays.with_ids(ids.clone()),
            _ => SphereArrays { ids: Some(in_bytes.clone()), ..arrays },
        };
        let scene = of_arrays(arrays).expect("good arrays");
        let shown = picture(&scene);
        assert_eq!(sphere_ids(&shown), expected, "{name}");
        assert_eq!(shown.direct, plain.direct, "{name}");
        assert_eq!(scene.name_of_row(3), format!("table 0:{}", id_of(3)), "{name}");
    }
}

/// Spheres one by one, and tables in f32, in f64 and in f32 again, the middle one with ids.
#[test]
fn several_tables_lie_behind_each_other() {
    let balls = balls(false);
    let expected = one_by_one(&balls, true);
    let mut scene = view();
    scene.diffuse([0.5; 3]);
    for (row, ball) in balls[..10].iter().enumerate() {
        let own = scene.diffuse(color_of(row));
        scene.sphere(own, ball.center, ball.radius);
    }
    let grey = scene.diffuse([0.5; 3]);
    let colors = |from: usize, to: usize| (from..to).map(color_of).collect::<Vec<_>>();
    let narrow_rows = |from: usize, to: usize| narrow(&rows(&balls[from..to]));
    let ids: Vec<u32> = (20..45).map(id_of).collect();
    let wide = columns(&rows(&balls[20..45]), f64s);
    scene
        .spheres(grey, SphereArrays::from_rows(narrow_rows(10, 20)).with_colors(colors(10, 20)))
        .spheres(grey, wide.with_colors(colors(20, 45)).with_ids(ids))
        .spheres(grey, SphereArrays::from_rows(narrow_rows(45, 60)).with_colors(colors(45, 60)));
    let scene = scene.build().expect("good arrays");
    assert_eq!(spheres(&scene), spheres(&expected));
    assert_eq!(scene.spheres().rows(), expected.spheres().rows());
    let (shown, plain) = (picture(&scene), picture(&expected));
    assert_eq!(shown.direct, plain.direct);
    assert_eq!(shown.indirect, plain.indirect);
    let in_the_middle = |row: u32| (20..45).contains(&row);
    let numbered = |&row: &u32| if in_the_middle(row) { id_of(row as usize) } else { row };
    let ids: Vec<u32> = sphere_ids(&plain).iter().map(numbered).collect();
    assert_eq!(sphere_ids(&shown), ids);
    assert!(sphere_ids(&plain).iter().any(|&row| in_the_middle(row)));
}

/// Four good spheres, with one thing changed.
fn flawed(change: impl FnOnce(&mut SphereArrays)) -> String {
    let mut arrays = SphereArrays::from_rows(vec![[0.0, 1.0, 2.0, 0.5]; 4])
        .with_colors(vec![[0.5f32; 3]; 4])
        .with_emission(vec![[0.5f32; 3]; 4])
        .with_ids(vec![1, 2, 3, 4]);
    change(&mut arrays);
    let error = of_arrays(arrays).expect_err("it must be refused");
    error.to_string()
}

#[test]
fn arrays_that_cannot_be_are_refused() {
    let good = f32s(vec![0.5; 4]);
    let array = |first, stride, len| strided(good.clone(), first, stride, len);
    let is_refused = |words: &str, change: &dyn Fn(&mut SphereArrays)| {
        let told = flawed(change);
        assert!(told.contains(words), "{told:?} does not tell {words:?}");
    };
    is_refused("4 radii, but 3 numbers in its column x", &|a| a.center[0] = array(0, 1, 3));
    is_refused("2 radii, but 4 numbers in its column y", &|a| a.radius = array(0, 1, 2));
    is_refused("4 radii, but 1 numbers in its column g", &|a| {
        a.color.as_mut().expect("colours")[1] = array(0, 1, 1);
    });
    is_refused("4 radii, but 3 numbers in its column emission_r", &|a| {
        a.emission.as_mut().expect("emission")[0] = array(0, 1, 3);
    });
    is_refused("4 radii, but 3 ids", &|a| a.ids = Some(StridedArray::of_ids(vec![1, 2, 3])));
    is_refused("the ids of `sphere_tables.0` reach beyond", &|a| {
        let ids = a.ids.as_mut().expect("ids");
        ids.stride = 2;
    });
    // The last number would end one byte behind the array.
    let bytes = SharedSlice::new(vec![0u8; 19]);
    is_refused("column z of", &|a| {
        a.center[2] = strided(ArrayValues::F32Bytes(bytes.clone()), 0, 5, 4);
        a.center[2].offset = 1;
    });
    is_refused("column z of", &|a| {
        a.center[2] = strided(ArrayValues::F64Bytes(bytes.clone()), 0, 4, 4);
    });
    is_refused("the ids of", &|a| {
        a.ids = Some(StridedArray {
            values: Ids::U32Bytes(bytes.clone()),
            offset: 1,
            stride: 5,
            len: 4,
        });
    });
    is_refused("has no spheres", &|a| *a = SphereArrays::default());
    for (first, stride) in [(1, 1), (4, 0), (0, 2), (2, -1), (0, -1), (usize::MAX, 1)] {
        let beyond = array(first, stride, 4);
        is_refused("column z of", &|a| a.center[2] = beyond.clone());
        is_refused("reaches beyond its array", &|a| a.radius = beyond.clone());
    }
    for stride in [isize::MAX, isize::MIN] {
        is_refused("reaches beyond its array", &|a| a.center[2] = array(0, stride, 4));
    }
    is_refused("the id 2^32 - 1", &|a| {
        a.ids = Some(StridedArray::of_ids(vec![1, 2, u32::MAX, 4]));
    });
}

#[test]
fn numbers_that_cannot_be_are_refused() {
    let is_refused = |column: &str, number: f64| {
        for array in [f64s, to_f32s] {
            let bad = strided(array(vec![0.5, 0.5, number, 0.5]), 0, 1, 4);
            let told = flawed(|arrays| {
                let color = arrays.color.as_mut().expect("colours");
                let emission = arrays.emission.as_mut().expect("emission");
                match column {
                    "x" => arrays.center[0] = bad,
                    "radius" => arrays.radius = bad,
                    "b" => color[2] = bad,
                    _ => emission[2] = bad,
                }
            });
            let words = format!("row 2 (the first is 0) has {column} = ");
            assert!(told.contains(&words) && told.contains("it must be from"), "{told}");
        }
    };
    for number in [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e30] {
        is_refused("x", number);
    }
    for number in [f64::NAN, f64::INFINITY, -0.5, 0.0] {
        is_refused("radius", number);
    }
    for number in [f64::NAN, f64::INFINITY, -0.25, 1.5] {
        is_refused("b", number);
    }
    for number in [f64::NAN, f64::INFINITY, -0.25, 1e16] {
        is_refused("emission_b", number);
    }
}

/// An array that knows whether another one was let go of when it was last looked at.
struct Owner {
    values: Vec<f64>,
    /// Counts the owners that are gone.
    gone: Arc<AtomicUsize>,
    /// How many were gone at the last look.
    seen: Arc<AtomicUsize>,
}

impl AsRef<[f64]> for Owner {
    fn as_ref(&self) -> &[f64] {
        self.seen.store(self.gone.load(Ordering::SeqCst), Ordering::SeqCst);
        &self.values
    }
}

impl Drop for Owner {
    fn drop(&mut self) {
        self.gone.fetch_add(1, Ordering::SeqCst);
    }
}

#[test]
fn arrays_are_let_go_of_one_after_the_other() {
    let gone = Arc::new(AtomicUsize::new(0));
    let last_seen: [Arc<AtomicUsize>; 3] = Default::default();
    let mut scene = view();
    let grey = scene.diffuse([0.5; 3]);
    for (index, seen) in last_seen.iter().enumerate() {
        let values = vec![index as f64, 0.0, 0.0, 0.25];
        let owner = Owner { values, gone: Arc::clone(&gone), seen: Arc::clone(seen) };
        let values = ArrayValues::F64(SharedSlice::new(owner));
        scene.spheres(grey, arrays(std::array::from_fn(|at| strided(values.clone(), at, 4, 1))));
    }
    let kept = scene.build().expect("good arrays");
    assert_eq!(gone.load(Ordering::SeqCst), 0, "the builder has them");
    let built = scene.into_scene().expect("good arrays");
    assert_eq!(gone.load(Ordering::SeqCst), 3, "the scene does not need them");
    let seen = last_seen.map(|seen| seen.load(Ordering::SeqCst));
    assert_eq!(seen, [0, 1, 2], "each is gone before the next is read");
    must_be_same("built twice", &kept, &built);
}

/// However many there are said to be.
#[test]
fn more_spheres_than_a_scene_can_hold_are_refused() {
    for (len, tables) in [(usize::MAX, 1), (usize::MAX, 2), (usize::MAX / 2 + 1, 2), (1 << 32, 1)] {
        let mut scene = view();
        let grey = scene.diffuse([0.5; 3]);
        scene.sphere(grey, [0.0; 3], 1.0);
        for _ in 0..tables {
            let [x, y, z, radius] = [(); 4].map(|()| StridedArray::constant(0.5f32, len));
            scene.spheres(grey, arrays([x, y, z, radius]));
        }
        let told = scene.build().expect_err("too many").to_string();
        assert!(told.contains("than the 4294967293 that a scene can hold"), "{told}");
    }
}
