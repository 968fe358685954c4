//! A session can be looked at while it runs, stopped, resumed and extended.

use std::path::Path;
use std::time::Duration;

use photosphere::film::Kind;
use photosphere::image_io::WholeFile;
use photosphere::job::{Checkpoint, End, Job, Opening, Outcome, Reached, Session};
use photosphere::scene::settings::SamplerKind;
use photosphere::scene::{Scene, Settings, SphereArrays};

use super::{balls, color_of, job, narrow, of_arrays, rows, sphere_ids, view};

/// Balls from an array over a ground, with light from everywhere: built anew each time.
fn session_scene() -> Scene {
    let mut scene = view();
    let grey = scene.diffuse([0.5; 3]);
    scene.sphere(grey, [0.0, -105.0, 0.0], 100.0);
    let colors = (0..60).map(color_of).collect();
    scene.spheres(grey, SphereArrays::of_rows(narrow(&rows(&balls(false)))).with_colors(colors));
    scene.build().expect("good spheres")
}

fn session_job(samples: u32) -> Job {
    let mut settings = Settings::default();
    (settings.image.width, settings.image.height) = (48, 36);
    settings.render.samples_per_pixel = samples;
    settings.render.sampler = SamplerKind::Sobol;
    job(settings, &[Kind::SphereId, Kind::Variance, Kind::SampleCount])
}

const SAMPLES: u32 = 800;

fn opened(samples: u32) -> Session {
    Session::new(&session_scene(), session_job(samples), Opening::default()).expect("opens")
}

fn resumed(checkpoint: &Path, samples: u32) -> Session {
    let checkpoint = Checkpoint::open(checkpoint).expect("a checkpoint");
    let job = session_job(samples);
    Session::resume(&session_scene(), job, checkpoint, Opening::default()).expect("resumes")
}

fn finished(session: &Session) -> Outcome {
    let reached = session.run(&()).expect("renders");
    assert_eq!(reached.end, End::Finished);
    session.outcome(reached)
}

/// Fails unless the picture and what is known of it are the same, whatever happened in between.
fn must_be_outcome(what: &str, found: &Outcome, expected: &Outcome) {
    assert!(found.picture == expected.picture, "{what}: another picture");
    assert_eq!(found.samples, expected.samples, "{what}");
    assert_eq!(found.error, expected.error, "{what}");
}

/// Runs a session on another thread, and looks at it as soon as there is something to be seen.
fn looked_at(session: &Session, look: impl FnOnce()) -> Reached {
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
    assert_eq!((session.progress().samples_done, session.error()), (0, None));
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
            assert!(session.error().is_none_or(|error| error > 0.0));
            assert!(session.metadata().run.is_some());
        }
    });
    assert_eq!(reached.end, End::Finished);
    assert!(session.error().is_some_and(|error| error > 0.0));
    must_be_outcome("looked at", &session.outcome(reached), &expected);
}

#[test]
fn a_stopped_session_is_resumed_to_the_same_bits_and_extended() {
    let expected = finished(&opened(SAMPLES));
    let folder = tempfile::tempdir().expect("a folder");
    let [on_the_way, at_the_end, whole] =
        ["a.part", "b.part", "c.part"].map(|name| folder.path().join(name));
    let write = |session: &Session, path: &Path, reached: Option<&Reached>| {
        let file = WholeFile::new(path).expect("can be written");
        session.write_checkpoint(&file, reached).expect("written");
    };

    let session = opened(SAMPLES);
    let reached = looked_at(&session, || {
        write(&session, &on_the_way, None);
        session.stop();
    });
    let done = session.progress().samples_done;
    assert!(reached.end == End::Stopped && done > 0 && done < expected.samples, "{reached:?}");
    write(&session, &at_the_end, Some(&reached));
    let stopped = session.outcome(reached);
    assert_eq!(stopped.samples, done);

    for path in [&on_the_way, &at_the_end] {
        let session = resumed(path, SAMPLES);
        assert!(session.progress().samples_done > 0);
        let outcome = finished(&session);
        must_be_outcome("resumed", &outcome, &expected);
        // A checkpoint on the way may tell of fewer rays than were traced for its samples.
        assert!(outcome.rays == expected.rays || path == &on_the_way);
        write(&session, &whole, Some(&Reached { end: End::Finished, noise: None, error: None }));
    }
    // More samples than were asked for at first, from half-way and from the end.
    let more = finished(&opened(SAMPLES + 100));
    assert!(more.picture != expected.picture);
    for path in [&at_the_end, &whole] {
        must_be_outcome("extended", &finished(&resumed(path, SAMPLES + 100)), &more);
    }
    // Fewer than there are.
    let checkpoint = Checkpoint::open(&whole).expect("a checkpoint");
    let fewer = Session::resume(&session_scene(), session_job(16), checkpoint, Opening::default());
    let told = fewer.err().expect("it has more").to_string();
    assert!(told.contains("it has samples up to 800, more than the 16"), "{told}");
}

#[test]
fn a_checkpoint_of_another_scene_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.part");
    let session = opened(16);
    let reached = session.run(&()).expect("renders");
    let file = WholeFile::new(&path).expect("can be written");
    session.write_checkpoint(&file, Some(&reached)).expect("written");
    // One number of one array differs.
    let mut other = balls(false);
    other[17].radius *= 2.0;
    let other = of_arrays(SphereArrays::of_rows(narrow(&rows(&other)))).expect("good arrays");
    let checkpoint = Checkpoint::open(&path).expect("a checkpoint");
    let told = Session::resume(&other, session_job(16), checkpoint, Opening::default());
    let told = told.err().expect("it is of another scene").to_string();
    assert!(told.contains("it is of another render"), "{told}");
}
