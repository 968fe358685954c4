//! Every set of vector instructions that this processor has gives the picture suite (all scenes of
//! the repository) equal bits.
//!
//! Needs the feature `faults`: `cargo test --release --features faults --test instruction_sets`.
//! Instructions are left out for the whole process, so there is one test function.
//! `scripts/try-processors.sh` renders the same scenes on emulated processors.

use std::collections::BTreeSet;
use std::io::{self, Write};
use std::path::Path;

use photosphere::accel::{Backend, KernelIsa};
use photosphere::fault::{VectorWidth, limit_vectors};
use photosphere::image_io::Picture;
use photosphere::math::Isa;

use crate::kit::{Kit, rendered};

#[path = "common/kit.rs"]
mod kit;

const WIDTHS: [VectorWidth; 3] = [VectorWidth::Portable, VectorWidth::Avx2, VectorWidth::Avx512];
const SMALL: [&str; 2] = ["image.width=32", "image.height=24"];

/// The scene files of the repository, relative to `scenes/`.
fn suite() -> BTreeSet<String> {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut found = BTreeSet::new();
    for folder in ["", "paper", "verify"] {
        for entry in scenes.join(folder).read_dir().expect("a folder of scenes") {
            let path = entry.expect("an entry").path();
            if path.extension().is_some_and(|extension| extension == "toml") {
                let path = path.strip_prefix(&scenes).expect("it is below");
                found.insert(path.to_str().expect("a plain name").to_owned());
            }
        }
    }
    assert!(found.len() > 30, "{found:?}");
    found
}

/// All that a picture shows, to the bit.
fn bits(picture: &Picture) -> Vec<u32> {
    let layers = picture.direct.iter().chain(&picture.indirect).flat_map(|color| color.to_array());
    layers.chain(picture.alpha.iter().flatten().copied()).map(f32::to_bits).collect()
}

/// The instruction sets in use: of shading, and of traversal.
fn in_use() -> [&'static str; 2] {
    [Isa::best().name(), KernelIsa::best().name()]
}

#[test]
fn all_instruction_sets_give_the_picture_suite_equal_bits() {
    for name in suite() {
        let kit = Kit::of_file(&name, &SMALL).samples(4);
        for backend in [Backend::Native, Backend::BruteForce] {
            let picture = |width| {
                limit_vectors(width);
                bits(&rendered(&kit.prepared(), backend).picture)
            };
            let portable = picture(VectorWidth::Portable);
            assert!(portable.iter().any(|bits| *bits != 0), "{name} is dark");
            for width in [VectorWidth::Avx2, VectorWidth::Avx512] {
                assert!(picture(width) == portable, "{name}, {backend:?}, {:?}", in_use());
            }
        }
    }
    let used = WIDTHS.map(|width| {
        limit_vectors(width);
        in_use()
    });
    assert_eq!(used[0], ["portable"; 2]);
    // Past the test harness, which would swallow it: what this processor lacks is not tested.
    writeln!(io::stderr(), "instruction sets for shading and traversal: {used:?}").expect("told");
}
