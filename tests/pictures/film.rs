//! One scene, one picture, to the bit: whatever the threads, the passes and the order.

use photosphere::accel::{Accel, Backend, ErrorBound};
use photosphere::film::{Aov, Film, Layer};
use photosphere::job::{Counters, ProgressiveRenderer, format_for_scene};
use photosphere::math::{Hit, Ray};
use photosphere::scene::PreparedScene;
use photosphere::task::CancelToken;

use crate::kit::{Kit, built};

const SMALL: &[&str] =
    &["image.width=37", "image.height=22", "render.samples_per_pixel=41", "render.max_depth=6"];
/// Samples of the picture.
const ALL: u64 = 37 * 22 * 41;

fn small() -> PreparedScene {
    Kit::of_file("cornell-spheres.toml", SMALL).prepared()
}

fn accel(prepared: &PreparedScene) -> Box<dyn Accel> {
    built(prepared, Backend::Native)
}

fn empty_film(prepared: &PreparedScene) -> Film {
    Film::new(&format_for_scene(prepared, &Aov::DEFAULT)).expect("a small film")
}

fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    pool.install(work)
}

/// All that a film tells, to the bit.
fn bits(film: &Film) -> Vec<u32> {
    let layers = [Layer::Direct, Layer::Indirect].map(|layer| film.mean(layer).expect("kept"));
    let all = layers.into_iter().chain(film.variance()).flatten().flatten();
    all.map(f32::to_bits).chain(film.counts()).collect()
}

/// A film that `work` filled on so many threads.
fn filled(
    prepared: &PreparedScene,
    threads: usize,
    work: impl Fn(&ProgressiveRenderer<'_>) + Sync + Send,
) -> Film {
    let (film, accel, cancel) = (empty_film(prepared), accel(prepared), CancelToken::default());
    let counters = Counters::new(&film, ALL);
    on_threads(threads, || {
        work(&ProgressiveRenderer::new(prepared, &*accel, &film, &counters, &cancel))
    });
    film
}

fn all_at_once(passes: &ProgressiveRenderer<'_>) {
    assert!(passes.render_to_sample(41, &|_| true).expect("not too bright"));
    assert_eq!(passes.counters().samples_done(), ALL);
}

/// An intersector that asks the render to stop, in the midst of a job, once so many samples are
/// done.
struct Stopping<'a> {
    inner: &'a dyn Accel,
    counters: &'a Counters,
    cancel: &'a CancelToken,
    after: u64,
}

impl Accel for Stopping<'_> {
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
        if self.counters.samples_done() >= self.after {
            self.cancel.cancel();
        }
        self.inner.closest(rays, hits);
    }

    fn occluded(&self, rays: &[Ray], occluded: &mut [bool]) {
        self.inner.occluded(rays, occluded);
    }

    fn error_bound(&self) -> ErrorBound {
        self.inner.error_bound()
    }

    fn bytes(&self) -> usize {
        self.inner.bytes()
    }
}

/// Asks a render to stop once so many samples are done. Returns the film, of which not all is
/// there.
fn stopped(prepared: &PreparedScene, threads: usize, after: u64) -> Film {
    let (film, accel, cancel) = (empty_film(prepared), accel(prepared), CancelToken::default());
    let counters = Counters::new(&film, ALL);
    let accel = Stopping { inner: &*accel, counters: &counters, cancel: &cancel, after };
    let passes = ProgressiveRenderer::new(prepared, &accel, &film, &counters, &cancel);
    let ended =
        on_threads(threads, || passes.render_to_sample(41, &|_| true)).expect("not too bright");
    assert!(!ended && counters.samples_done() == film.sample_count());
    film
}

#[test]
fn threads_do_not_change_a_bit() {
    let prepared = small();
    let one = bits(&filled(&prepared, 1, all_at_once));
    for threads in [2, 7] {
        assert!(bits(&filled(&prepared, threads, all_at_once)) == one, "{threads} threads");
    }
}

/// After a request to stop no job begins, and what is in flight is not finished: at most those are
/// kept that were being added just then, one on each of the other threads.
#[test]
fn a_request_to_stop_is_followed_by_no_new_work() {
    // A job adds 1024 samples, or those of some tiles of 64 pixels with less at the edges.
    const JOB: u64 = 1024;
    let prepared = small();
    for threads in [1, 2, 7] {
        let after = 4 * JOB;
        let samples = stopped(&prepared, threads, after).sample_count();
        // The job that got there, and one on each of the other threads.
        let most = after + threads as u64 * JOB;
        assert!((after..most).contains(&samples), "{samples} of {threads} threads");
    }
}

#[test]
fn neither_passes_nor_the_order_of_tiles_change_a_bit() {
    let prepared = small();
    let whole = bits(&filled(&prepared, 2, all_at_once));
    let backwards_and_in_bits = |passes: &ProgressiveRenderer<'_>| {
        let tiles = passes.film().frame().tile_count();
        for tile in (0..tiles).rev() {
            let end = 1 + 7 * (tile as u32 % 6);
            assert!(passes.render_to_sample(end, &|one| one == tile).expect("not too bright"));
        }
        assert!(passes.render_to_sample(33, &|tile| tile % 3 == 1).expect("not too bright"));
        all_at_once(passes);
    };
    assert!(bits(&filled(&prepared, 2, backwards_and_in_bits)) == whole);
}

#[test]
fn a_stopped_film_is_finished_by_another_session() {
    let prepared = small();
    let whole = bits(&filled(&prepared, 2, all_at_once));
    for jobs in [1, 4, 9, 17] {
        let film = stopped(&prepared, 2, jobs * 1024);
        let half = film.sample_count();
        assert!(half > 0 && half < ALL);

        let (accel, cancel, counters) =
            (accel(&prepared), CancelToken::default(), Counters::new(&film, ALL));
        all_at_once(&ProgressiveRenderer::new(&prepared, &*accel, &film, &counters, &cancel));
        assert!(bits(&film) == whole, "stopped after {half} samples");
    }
}
