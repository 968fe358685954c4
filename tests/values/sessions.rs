//! A session can be looked at while it runs, stopped, resumed and extended.

use std::cell::Cell;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Mutex;
use std::time::Duration;

use photosphere::film::{Aov, CryptomatteKind};
use photosphere::image_io::AtomicFile;
use photosphere::image_io::ChannelValues;
use photosphere::job::{
    Checkpoint, Job, Observer, RenderProgress, RenderResult, RunOutcome, Session, SessionOptions,
    StopReason,
};
use photosphere::scene::settings::SamplerKind;
use photosphere::scene::{Scene, Settings, SphereArrays};

use super::{balls, color_of, job, narrow, of_arrays, rows, sphere_ids, view};

/// Balls from an array over a ground, with light from everywhere: built anew each time.
fn session_scene() -> Scene {
    let mut scene = view();
    let grey = scene.diffuse([0.5; 3]);
    scene.sphere(grey, [0.0, -105.0, 0.0], 100.0);
    let colors = (0..60).map(color_of).collect();
    scene.spheres(grey, SphereArrays::from_rows(narrow(&rows(&balls(false)))).with_colors(colors));
    scene.build().expect("good spheres")
}

fn session_job(samples: u32) -> Job {
    let mut settings = Settings::default();
    (settings.image.width, settings.image.height) = (48, 36);
    settings.render.samples_per_pixel = samples;
    settings.render.sampler = SamplerKind::Sobol;
    job(settings, &[Aov::SphereId, Aov::Variance, Aov::SampleCount])
}

const SAMPLES: u32 = 800;

fn opened(samples: u32) -> Session {
    Session::new(&session_scene(), session_job(samples), SessionOptions::default()).expect("opens")
}

fn resumed(checkpoint: &Path, samples: u32) -> Session {
    let checkpoint = Checkpoint::open(checkpoint).expect("a checkpoint");
    let job = session_job(samples);
    Session::resume(&session_scene(), job, checkpoint, SessionOptions::default()).expect("resumes")
}

fn finished(session: &Session) -> RenderResult {
    let reached = session.run(&()).expect("renders");
    assert_eq!(reached.stop_reason, StopReason::Finished);
    session.result(reached)
}

/// Fails unless the picture and what is known of it are the same, whatever happened in between.
fn must_be_outcome(what: &str, found: &RenderResult, expected: &RenderResult) {
    assert!(found.picture == expected.picture, "{what}: another picture");
    assert_eq!(found.samples, expected.samples, "{what}");
    assert_eq!(found.error, expected.error, "{what}");
}

/// Runs a session on another thread, and looks at it as soon as there is something to be seen.
fn looked_at(session: &Session, look: impl FnOnce()) -> RunOutcome {
    std::thread::scope(|scope| {
        let running = scope.spawn(|| session.run(&()));
        while session.progress().samples_done == 0 {
            assert!(!running.is_finished(), "it ended without a sample");
            std::thread::sleep(Duration::from_millis(1));
        }
        look();
        running.join().expect("no panic").expect("renders")
    })
}

#[test]
fn a_session_can_be_looked_at_while_it_runs_and_changes_nothing_by_that() {
    let expected = finished(&opened(SAMPLES));
    let session = opened(SAMPLES);
    assert_eq!((session.progress().samples_done, session.estimate_error()), (0, None));
    let reached = looked_at(&session, || {
        let mut last = 0;
        for _ in 0..5 {
            let progress = session.progress();
            assert!(progress.samples_done >= last && progress.rate > 0.0);
            assert_eq!(progress.samples_total, 48 * 36 * u64::from(SAMPLES));
            last = progress.samples_done;
            let picture = session.picture();
            assert_eq!((picture.width, picture.height, picture.non_finite()), (48, 36, 0));
            assert_eq!(sphere_ids(&picture), sphere_ids(&expected.picture));
            assert!(picture.mean().y > 0.0 && session.preview().mean().y > 0.0);
            assert!(session.estimate_error().is_none_or(|error| error > 0.0));
            assert!(session.metadata().run.is_some());
        }
    });
    assert_eq!(reached.stop_reason, StopReason::Finished);
    assert!(session.estimate_error().is_some_and(|error| error > 0.0));
    must_be_outcome("looked at", &session.result(reached), &expected);
}

#[test]
fn a_stopped_session_is_resumed_to_the_same_bits_and_extended() {
    let expected = finished(&opened(SAMPLES));
    let folder = tempfile::tempdir().expect("a folder");
    let [on_the_way, at_the_end, whole] =
        ["a.part", "b.part", "c.part"].map(|name| folder.path().join(name));
    let write = |session: &Session, path: &Path, reached: Option<&RunOutcome>| {
        let file = AtomicFile::new(path).expect("can be written");
        session.write_checkpoint(&file, reached).expect("written");
    };

    let session = opened(SAMPLES);
    let reached = looked_at(&session, || {
        write(&session, &on_the_way, None);
        session.stop();
    });
    let done = session.progress().samples_done;
    assert!(
        reached.stop_reason == StopReason::Stopped && done > 0 && done < expected.samples,
        "{reached:?}"
    );
    write(&session, &at_the_end, Some(&reached));
    let stopped = session.result(reached);
    assert_eq!(stopped.samples, done);

    for path in [&on_the_way, &at_the_end] {
        let session = resumed(path, SAMPLES);
        assert!(session.progress().samples_done > 0);
        let outcome = finished(&session);
        must_be_outcome("resumed", &outcome, &expected);
        // A checkpoint on the way may tell of fewer rays than were traced for its samples.
        assert!(outcome.rays == expected.rays || path == &on_the_way);
        write(
            &session,
            &whole,
            Some(&RunOutcome { stop_reason: StopReason::Finished, noise: None, error: None }),
        );
    }
    // More samples than were asked for at first, from half-way and from the end.
    let more = finished(&opened(SAMPLES + 100));
    assert!(more.picture != expected.picture);
    for path in [&at_the_end, &whole] {
        must_be_outcome("extended", &finished(&resumed(path, SAMPLES + 100)), &more);
    }
    // Fewer than there are.
    let checkpoint = Checkpoint::open(&whole).expect("a checkpoint");
    let fewer =
        Session::resume(&session_scene(), session_job(16), checkpoint, SessionOptions::default());
    let told = fewer.err().expect("it has more").to_string();
    assert!(told.contains("it has samples up to 800, more than the 16"), "{told}");
}

#[test]
fn a_session_runs_once_at_a_time_and_goes_on_after_a_stop() {
    let expected = finished(&opened(SAMPLES));
    let session = opened(SAMPLES);
    for _ in 0..3 {
        let before = session.progress().samples_done;
        let reached = std::thread::scope(|scope| {
            let running = scope.spawn(|| session.run(&()));
            while session.progress().samples_done == before && !running.is_finished() {
                std::thread::sleep(Duration::from_millis(1));
            }
            if !running.is_finished() {
                let told = session.run(&()).expect_err("it is running").to_string();
                assert!(told.contains("already running"), "{told}");
            }
            session.stop();
            running.join().expect("no panic").expect("renders")
        });
        if reached.stop_reason == StopReason::Finished {
            break;
        }
        assert_eq!(reached.stop_reason, StopReason::Stopped);
    }
    // A stop that came after the end of a run would be one of the next.
    while session.run(&()).expect("renders").stop_reason != StopReason::Finished {}
    let reached = session.run(&()).expect("nothing is left to render");
    must_be_outcome("in several runs", &session.result(reached), &expected);
}

#[test]
fn a_session_is_extended_to_the_bits_of_one_render() {
    let expected = finished(&opened(SAMPLES + 100));
    let mut session = opened(100);
    finished(&session);
    session.extend(session_job(SAMPLES + 100)).expect("more samples");
    must_be_outcome("extended", &finished(&session), &expected);
    let mut other = session_job(SAMPLES + 200);
    other.settings.render.seed = 3;
    for (job, why) in [(session_job(16), "more than the 16"), (other, "`render.seed` is 0, not 3")]
    {
        let told = session.extend(job).expect_err(why).to_string();
        assert!(told.starts_with("cannot extend the render: ") && told.contains(why), "{told}");
    }
    must_be_outcome("refused to change", &finished(&session), &expected);
}

/// The layers of a picture that is taken while others add to the film are of the same samples.
#[test]
fn a_snapshot_of_a_running_session_is_consistent() {
    let mut job = session_job(SAMPLES);
    job.layers = vec![Aov::SampleCount, Aov::Cryptomatte(CryptomatteKind::Sphere)];
    let session = Session::new(&session_scene(), job, SessionOptions::default()).expect("opens");
    looked_at(&session, || {
        for _ in 0..20 {
            let (picture, metadata) = session.snapshot();
            let channel = |name: &str| -> Vec<f64> {
                let plane = picture.channels.iter().find(|plane| plane.name == name).expect(name);
                match &plane.values {
                    ChannelValues::Float(values) => values.iter().map(|v| f64::from(*v)).collect(),
                    ChannelValues::Uint(values) => values.iter().map(|v| f64::from(*v)).collect(),
                }
            };
            let counts = channel("sample_count");
            let (fewest, most) = counts.iter().fold((f64::MAX, 0.0f64), |(fewest, most), count| {
                (fewest.min(*count), most.max(*count))
            });
            let said = metadata.samples;
            assert_eq!((f64::from(said.min_count), f64::from(said.max_count)), (fewest, most));
            let shares = ["CryptoSphere00.G", "CryptoSphere00.A"].map(channel);
            for (pixel, count) in counts.iter().enumerate().filter(|(_, count)| **count > 0.0) {
                for share in &shares {
                    // A whole number of the pixel's samples sees the sphere.
                    let seen = share[pixel] * count;
                    assert!((seen - seen.round()).abs() < 1e-3, "{seen} of {count}");
                }
            }
        }
    });
}

/// Whoever looks on may fail: the render goes on.
#[test]
fn an_observer_that_panics_does_not_end_the_render() {
    #[derive(Default)]
    struct Clumsy(Mutex<Vec<String>>);
    impl Observer for Clumsy {
        fn wants_progress(&self) -> bool {
            true
        }
        fn on_progress(&self, _: &RenderProgress) -> ControlFlow<()> {
            panic!("the observer fails, as this test wants it");
        }
        fn on_warning(&self, text: &str) {
            self.0.lock().expect("no panic while it is held").push(text.to_owned());
        }
    }
    // Long enough for a word on the progress.
    let session = opened(16_000);
    let clumsy = Clumsy::default();
    let reached = std::thread::scope(|scope| {
        let running = scope.spawn(|| session.run(&clumsy));
        while clumsy.0.lock().expect("no panic").is_empty() && !running.is_finished() {
            std::thread::sleep(Duration::from_millis(1));
        }
        session.stop();
        running.join().expect("the panic stays in there").expect("renders")
    });
    assert_eq!(reached.stop_reason, StopReason::Stopped);
    let told = clumsy.0.into_inner().expect("no panic");
    assert_eq!(told, ["reporting the progress failed in an unexpected way; please report this"]);
    assert!(session.result(reached).samples > 0);
}

#[test]
fn an_observer_stops_a_render_after_a_while() {
    struct Impatient(Cell<u32>);
    impl Observer for Impatient {
        fn wants_progress(&self) -> bool {
            true
        }
        fn on_progress(&self, _: &RenderProgress) -> ControlFlow<()> {
            self.0.set(self.0.get() + 1);
            if self.0.get() < 3 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        }
    }
    let impatient = Impatient(Cell::new(0));
    let job = session_job(100_000);
    let result = photosphere::job::run(&session_scene(), &job, &impatient).expect("renders");
    assert_eq!((result.stop_reason, impatient.0.get()), (StopReason::Stopped, 3));
    assert!(result.samples < 48 * 36 * 100_000);
}

#[test]
fn a_job_resumed_from_bytes_is_the_uninterrupted_one() {
    let expected = finished(&opened(SAMPLES));
    let session = opened(SAMPLES);
    let mut on_the_way = Vec::new();
    let reached = looked_at(&session, || {
        on_the_way = session.checkpoint_bytes(None).expect("encoded");
        session.stop();
    });
    assert_eq!(reached.stop_reason, StopReason::Stopped);
    let at_the_end = session.checkpoint_bytes(Some(&reached)).expect("encoded");
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.part");
    let file = AtomicFile::new(&path).expect("can be written");
    session.write_checkpoint(&file, Some(&reached)).expect("written");
    assert!(std::fs::read(&path).expect("is there") == at_the_end, "files hold other bytes");
    for bytes in [on_the_way, at_the_end.clone()] {
        let checkpoint = Checkpoint::from_bytes(bytes).expect("a checkpoint");
        assert_eq!(checkpoint.path(), None);
        let (job, opening) = (session_job(SAMPLES), SessionOptions::default());
        let session = Session::resume(&session_scene(), job, checkpoint, opening).expect("resumes");
        assert!(session.progress().samples_done > 0);
        must_be_outcome("resumed from bytes", &finished(&session), &expected);
    }
    let told = Checkpoint::from_bytes(at_the_end[..100].to_vec()).expect_err("cut off").to_string();
    assert_eq!(told, "cannot read the checkpoint: it is truncated after 100 bytes");
}

#[test]
fn a_header_that_could_not_be_read_again_is_refused_before_the_render() {
    let command = Some("x".repeat(17 << 20));
    let opening = SessionOptions { command, ..SessionOptions::default() };
    let mut session = Session::new(&session_scene(), session_job(16), opening).expect("opens");
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.part");
    let file = AtomicFile::new(&path).expect("can be written");
    let refused = [
        session.autosave(file.clone(), Duration::from_secs(60)),
        session.write_checkpoint(&file, None),
        session.checkpoint_bytes(None).map(drop),
    ];
    for refusal in refused {
        let told = refusal.expect_err("too long").to_string();
        assert!(told.starts_with("the header of the checkpoint has "), "{told}");
    }
    assert!(!path.exists());
}

#[test]
fn a_checkpoint_of_another_scene_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.part");
    let session = opened(16);
    let reached = session.run(&()).expect("renders");
    let file = AtomicFile::new(&path).expect("can be written");
    session.write_checkpoint(&file, Some(&reached)).expect("written");
    // One number of one array differs.
    let mut other = balls(false);
    other[17].radius *= 2.0;
    let other = of_arrays(SphereArrays::from_rows(narrow(&rows(&other)))).expect("good arrays");
    let checkpoint = Checkpoint::open(&path).expect("a checkpoint");
    let told = Session::resume(&other, session_job(16), checkpoint, SessionOptions::default());
    let told = told.err().expect("it is of another scene").to_string();
    assert!(told.contains("it belongs to another render"), "{told}");
}
