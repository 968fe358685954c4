//! Pictures have equal bits for any threads, batch and order.

use photosphere::accel::Backend;

use crate::kit::{Kit, built, rendered};

#[test]
fn the_picture_has_the_same_bits_for_any_number_of_threads() {
    let small = ["image.width=60", "image.height=45", "render.samples_per_pixel=20"];
    let prepared = Kit::of_file("paper/fig4.toml", &small).prepared();
    for &backend in Backend::AVAILABLE {
        let render = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            // Embree builds with its own threads, as many as there are in the pool.
            pool.expect("threads").install(|| rendered(&prepared, backend).picture)
        };
        let one = render(1);
        for threads in [2, 7] {
            assert_eq!(one, render(threads), "{} on {threads} threads", backend.name());
        }
    }
}

#[test]
fn a_sample_does_not_depend_on_its_batch_or_order() {
    use photosphere::color::PathRadiance;
    use photosphere::integrator::{RenderContext, SampleAddress, Workspace, create};
    let kit = Kit::of_file("paper/fig4.toml", &["image.width=64", "image.height=48"]);
    for kit in kit.both_ways() {
        let prepared = kit.prepared();
        let accel = built(&prepared, Backend::BruteForce);
        let cancel = Default::default();
        let context = RenderContext::new(&prepared, &*accel, &cancel);
        let estimate = |samples: &[SampleAddress]| {
            let mut radiance = vec![PathRadiance::default(); samples.len()];
            create(&prepared).estimate(context, samples, &mut radiance, &mut Workspace::default());
            radiance.iter().map(|r| (r.direct, r.indirect)).collect::<Vec<_>>()
        };
        let address = |i: u32| SampleAddress { x: i * 7 % 64, y: i * 5 % 48, sample: i % 13 };
        let samples: Vec<_> = (0..500).map(address).collect();
        let together = estimate(&samples);
        let alone: Vec<_> = samples.iter().flat_map(|&s| estimate(&[s])).collect();
        assert_eq!(together, alone);
        let backwards: Vec<_> = samples.iter().rev().copied().collect();
        let mut again = estimate(&backwards);
        again.reverse();
        assert_eq!(together, again);
    }
}
