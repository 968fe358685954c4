//! One scene, one picture, to the bit: whatever the threads, the passes and the order.

#[path = "common/render.rs"]
mod common;

use std::sync::atomic::{AtomicUsize, Ordering};

use common::{scene, scene_file};
use photosphere::accel::{Accel, Backend, BuildOptions, Cancel};
use photosphere::film::{Film, Layer};
use photosphere::render::{RenderOptions, Session, format_of};
use photosphere::scene::Scene;

const SMALL: &[&str] =
    &["image.width=37", "image.height=22", "render.samples_per_pixel=41", "render.max_depth=6"];

fn small() -> Scene {
    scene(&scene_file("cornell-spheres.toml"), SMALL)
}

fn accel(scene: &Scene) -> Box<dyn Accel> {
    Backend::Native.build(scene.spheres(), &BuildOptions::default()).expect("builds")
}

/// All that a film tells, to the bit.
fn bits(film: &Film) -> Vec<u32> {
    let layers = [Layer::Direct, Layer::Indirect].map(|layer| film.mean(layer).expect("kept"));
    let all = layers.into_iter().chain(film.variance()).flatten().flatten();
    all.map(f32::to_bits).chain(film.counts()).collect()
}

/// A film that `work` filled on so many threads.
fn filled(scene: &Scene, threads: usize, work: impl Fn(&Session<'_>) + Sync + Send) -> Film {
    let film = Film::new(&format_of(scene)).expect("a small film");
    let (accel, options) =
        (accel(scene), RenderOptions { cancel: Cancel::default(), progress: &|_| {} });
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    pool.install(|| work(&Session::new(scene, &*accel, &film, &options)));
    film
}

fn all_at_once(session: &Session<'_>) {
    assert!(session.advance(41, &|_| true).expect("not too bright"));
    assert_eq!(session.samples_done(), 37 * 22 * 41);
}

#[test]
fn threads_do_not_change_a_bit() {
    let scene = small();
    let one = bits(&filled(&scene, 1, all_at_once));
    for threads in [2, 7] {
        assert!(bits(&filled(&scene, threads, all_at_once)) == one, "{threads} threads");
    }
}

/// After a request to stop no job begins, and what is in flight is not finished: at most those are kept that
/// were being added just then, one on each thread.
#[test]
fn a_request_to_stop_is_followed_by_no_new_work() {
    let scene = small();
    let accel = accel(&scene);
    for threads in [1, 2, 7] {
        let (film, cancel) = (Film::new(&format_of(&scene)).expect("small"), Cancel::default());
        let reports = AtomicUsize::new(0);
        let stop_at_the_fifth = |_| {
            if reports.fetch_add(1, Ordering::SeqCst) + 1 == 5 {
                cancel.cancel();
            }
        };
        let options = RenderOptions { cancel: cancel.clone(), progress: &stop_at_the_fifth };
        let session = Session::new(&scene, &*accel, &film, &options);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let ended = pool.install(|| session.advance(41, &|_| true)).expect("not too bright");
        let reports = reports.load(Ordering::SeqCst);
        assert!(!ended && (5..5 + threads).contains(&reports), "{reports} of {threads} threads");
        // Every job reports once: 1024 samples, or four tiles of 64 pixels with less at the edges.
        assert!(film.samples() <= reports as u64 * 1024, "{}", film.samples());
    }
}

#[test]
fn neither_passes_nor_the_order_of_tiles_change_a_bit() {
    let scene = small();
    let whole = bits(&filled(&scene, 2, all_at_once));
    let backwards_and_in_bits = |session: &Session<'_>| {
        let tiles = session.film().frame().tiles();
        for tile in (0..tiles).rev() {
            let end = 1 + 7 * (tile as u32 % 6);
            assert!(session.advance(end, &|one| one == tile).expect("not too bright"));
        }
        assert!(session.advance(33, &|tile| tile % 3 == 1).expect("not too bright"));
        all_at_once(session);
    };
    assert!(bits(&filled(&scene, 2, backwards_and_in_bits)) == whole);
}

#[test]
fn a_stopped_film_is_finished_by_another_session() {
    let scene = small();
    let whole = bits(&filled(&scene, 2, all_at_once));
    let accel = accel(&scene);
    for stop_after in [1, 4, 9, 17] {
        let film = Film::new(&format_of(&scene)).expect("a small film");
        let (cancel, jobs) = (Cancel::default(), AtomicUsize::new(0));
        let progress = |_| {
            if jobs.fetch_add(1, Ordering::Relaxed) == stop_after {
                cancel.cancel();
            }
        };
        let options = RenderOptions { cancel: cancel.clone(), progress: &progress };
        let session = Session::new(&scene, &*accel, &film, &options);
        assert!(!session.advance(41, &|_| true).expect("not too bright"));
        let half = film.samples();
        assert!(half > 0 && half < 37 * 22 * 41);

        let options = RenderOptions { cancel: Cancel::default(), progress: &|_| {} };
        all_at_once(&Session::new(&scene, &*accel, &film, &options));
        assert!(bits(&film) == whole, "stopped after {half} samples");
    }
}
