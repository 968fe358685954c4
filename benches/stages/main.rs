//! Each stage of a render by itself, small enough to be run before and after a change:
//!
//!     cargo bench --bench stages
//!     cargo bench --bench stages -- trace
//!
//! `photosphere bench` measures whole scenes, and with `--record` the figures of `benches/record/`.

mod build;
mod film;
mod frame;
mod shade;
mod trace;

use criterion::Criterion;

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    for bench in [build::bench, trace::bench, shade::bench, film::bench, frame::bench] {
        bench(&mut criterion);
    }
    criterion.final_summary();
}
