//! Metals are named or given by their index.

use photosphere::material::Metal;
use photosphere::scene::description::SurfaceModel;

use crate::scenes::{assert_told, load, with};

/// The metals, as a message lists them.
const METALS: &str = "\"gold\" or \"silver\" or \"copper\" or \"aluminium\" or \"aluminum\" or \"iron\" or \"chromium\" or \"nickel\" or \"titanium\" or \"platinum\" or \"tungsten\" or \"brass\"";

#[test]
fn metals_are_named_or_given_by_their_index() {
    let metal = |keys: &str| with("type = \"diffuse\"\nalbedo = [0.2, 0.6, 0.2]", keys);
    let of = |keys: &str| {
        let text = metal(&format!("type = \"conductor\"\n{keys}"));
        load(&text, &[]).expect("a good scene").description.materials[0].surface
    };
    let gold = Metal::NAMED[0].1;
    assert_eq!(of("metal = \"gold\""), SurfaceModel::Conductor { metal: gold, roughness: 0.0 });
    let own = Metal { ior: [0.0, 1.0, 2.0].into(), extinction: [3.0, 4.0, 5.0].into() };
    let given = of("ior = [0, 1, 2]\nextinction = [3, 4, 5]\nroughness = 0.5");
    assert_eq!(given, SurfaceModel::Conductor { metal: own, roughness: 0.5 });

    let told = |keys: &str, expected: &[&str]| {
        assert_told(&metal(&format!("type = \"conductor\"\n{keys}")), &[], expected);
    };
    let expected =
        format!("11:1: `materials.grass.metal` is missing | add `metal = ...`, {METALS}");
    told("", &[&expected]);
    let wrong = format!("13:9: `materials.grass.metal` must be {METALS}, not \"golt\" ");
    told("metal = \"golt\"", &[&(wrong + "| did you mean `gold`?")]);
    told(
        "metal = \"gold\"\nextinction = [3, 4, 5]",
        &["14:14: `materials.grass.extinction` and `metal` both set the index of refraction \
           | remove `metal`, or both `ior` and `extinction`"],
    );
    told(
        "ior = [0, 1, 101]",
        &[
            "11:1: `materials.grass.extinction` is missing | add `extinction = ...`, \
             three numbers from 0 to 100",
            "13:14: `materials.grass.ior` must be three numbers from 0 to 100, not 101",
        ],
    );
    told(
        "metal = \"iron\"\nroughness = 2",
        &["14:13: `materials.grass.roughness` must be a number from 0 to 1, not 2"],
    );
}
