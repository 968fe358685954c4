//! The fuzz targets as programs for libFuzzer.

pub mod mutate;
mod targets;

pub use libfuzzer_sys;

/// Runs the target of this name.
///
/// # Panics
/// On a finding.
pub fn run(name: &str, input: &[u8]) {
    targets::run(name, input);
}

/// Makes the calling thread the only one that runs parallel loops. On a busy machine, handing each
/// of them over to another thread takes longer than the loop.
///
/// # Panics
/// If a loop has run before.
pub fn run_loops_here() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread();
    pool.build_global().expect("nothing has run before");
}

/// Makes the program of a target.
#[macro_export]
macro_rules! fuzz {
    ($name:literal) => {
        $crate::libfuzzer_sys::fuzz_target!(init: $crate::run_loops_here(), |input: &[u8]| {
            $crate::run($name, input);
        });
    };
}

/// Makes the program of a target whose input is mostly text.
#[macro_export]
macro_rules! fuzz_text {
    ($name:literal) => {
        $crate::fuzz!($name);
        $crate::libfuzzer_sys::fuzz_mutator!(|data: &mut [u8],
                                              size: usize,
                                              max_size: usize,
                                              seed: u32| {
            $crate::mutate::text(data, size, max_size, seed)
        });
    };
}
