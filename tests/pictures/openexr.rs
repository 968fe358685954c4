//! Other programs read our OpenEXR files: OpenEXR's own Python package finds every channel with its
//! values, and another's decoder of Cryptomattes the names and masks.
//!
//! The interpreter is `target/python/bin/python`, which `scripts/setup-python.sh` makes, or the one
//! in `PHOTOSPHERE_PYTHON`. Without the packages the tests say so and check nothing.

use std::path::{Path, PathBuf};
use std::process::Command;

use tempfile::TempDir;

use crate::python::python;

/// Prints, for every channel, its type and all its values' bits, then the text attributes.
const READ: &str = r#"
import sys, OpenEXR
part = OpenEXR.File(sys.argv[1], separate_channels=True)
for name, channel in sorted(part.channels().items()):
    pixels = channel.pixels
    print(name, pixels.dtype, pixels.shape[1], pixels.shape[0], pixels.tobytes().hex())
for name, value in sorted(part.header().items()):
    if isinstance(value, str):
        print("=", name, repr(value))
"#;

/// Prints every name that a Cryptomatte lists, with the mean of its mask.
const DECODE: &str = r#"
import sys, numpy
from cryptomatte_api import Cryptomatte
for matte in Cryptomatte.load(sys.argv[1]):
    metadata = matte.metadata() if callable(matte.metadata) else matte.metadata
    kind = metadata.name() if callable(metadata.name) else metadata.name
    for name, mask in matte.masks().items():
        print(kind, name, float(numpy.mean(mask, dtype=numpy.float64)))
"#;

/// A Python that can import the packages.
fn python_with(packages: &str) -> Option<PathBuf> {
    python(packages, &["-c", &format!("import {packages}")])
}

fn output_of(command: &mut Command) -> String {
    let output = command.output().expect("the program starts");
    let words = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{words}");
    String::from_utf8(output.stdout).expect("text")
}

fn rendered(layers: &str) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("a.exr");
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cornell-spheres.toml");
    let mut command = Command::new(env!("CARGO_BIN_EXE_photosphere"));
    command.arg("render").arg(scene).arg("-o").arg(&file);
    let options = ["--size", "24x18", "--spp", "16", "--accel", "native", "--quiet"];
    output_of(command.args(options).args(["--layers", layers]));
    (folder, file)
}

#[test]
fn its_own_package_reads_every_layer() {
    let Some(python) = python_with("OpenEXR") else { return };
    let layers = "direct,indirect,emission,albedo,normal,depth,position,sphere_id,material_id,\
                  sample_count,variance,alpha";
    let (_folder, file) = rendered(layers);
    let read = output_of(Command::new(python).args(["-c", READ]).arg(&file));
    let ours = exr::prelude::read_first_flat_layer_from_file(&file).expect("our own file");
    let channels = &ours.layer_data.channel_data.list;
    assert_eq!(channels.len(), 29);
    for channel in channels {
        let (kind, bytes): (&str, Vec<u8>) = match &channel.sample_data {
            exr::prelude::FlatSamples::F32(values) => {
                ("float32", values.iter().flat_map(|value| value.to_le_bytes()).collect())
            }
            exr::prelude::FlatSamples::U32(values) => {
                ("uint32", values.iter().flat_map(|value| value.to_le_bytes()).collect())
            }
            exr::prelude::FlatSamples::F16(_) => panic!("nothing is f16"),
        };
        let digits: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
        let line = format!("{} {kind} 24 18 {digits}", channel.name);
        assert!(read.lines().any(|read| read == line), "{}", channel.name);
    }
    let samples = r#"= photosphere:samples '{"first":0,"min_count":16,"max_count":16}'"#;
    assert!(read.contains(samples), "attributes are read too");
    assert!(read.contains(r#"= photosphere:layers '["direct","indirect","emission","#));
}

#[test]
fn a_decoder_of_others_finds_the_names_of_a_cryptomatte() {
    let Some(python) = python_with("OpenEXR, cryptomatte_api") else { return };
    let (_folder, file) = rendered("crypto_sphere,crypto_material,crypto_table,albedo");
    let read = output_of(Command::new(python).args(["-c", DECODE]).arg(&file));
    let share = |kind: &str, name: &str| -> f64 {
        let begin = format!("{kind} {name} ");
        let line = read.lines().find_map(|line| line.strip_prefix(&begin));
        line.unwrap_or_else(|| panic!("{begin}is not in\n{read}")).parse().expect("a number")
    };
    // Everything in that closed room is a sphere of the scene file.
    assert!((share("CryptoTable", "spheres") - 1.0).abs() < 1e-6, "{read}");
    let sum = |kind: &str| -> f64 {
        let shares = read.lines().filter(|line| line.starts_with(&format!("{kind} ")));
        shares.filter_map(|line| line.rsplit(' ').next()?.parse::<f64>().ok()).sum()
    };
    for kind in ["CryptoSphere", "CryptoMaterial", "CryptoTable"] {
        assert!((sum(kind) - 1.0).abs() < 1e-6, "{kind}: {}\n{read}", sum(kind));
    }
    assert!(share("CryptoMaterial", "glass") > 0.01, "{read}");
    assert_eq!(share("CryptoSphere", "glass ball"), share("CryptoMaterial", "glass"), "{read}");
}
