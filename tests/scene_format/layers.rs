//! Glass is named or given by its index; the principled material has other renderers' parameters.

use photosphere::color::Rgb;
use photosphere::material::{NAMED_IORS, PrincipledParameters};
use photosphere::scene::description::SurfaceModel;

use crate::scenes::{assert_told, load, with};

fn material(keys: &str) -> String {
    with("type = \"diffuse\"\nalbedo = [0.2, 0.6, 0.2]", keys)
}

fn surface(keys: &str) -> SurfaceModel {
    load(&material(keys), &[]).expect("a good scene").description.materials[0].surface
}

#[test]
fn glass_is_named_or_given_by_its_index() {
    let of = |keys: &str| surface(&format!("type = \"dielectric\"\n{keys}"));
    let glass = |ior, roughness| SurfaceModel::Dielectric {
        ior,
        roughness,
        priority: 0,
        absorption: Rgb::ZERO,
    };
    for (name, ior) in NAMED_IORS {
        assert_eq!(of(&format!("glass = \"{name}\"")), glass(ior, 0.0));
    }
    assert_eq!(of("ior = 1.25\nroughness = 0.5"), glass(1.25, 0.5));

    let told = |keys: &str, expected: &str| {
        assert_told(&material(&format!("type = \"dielectric\"\n{keys}")), &[], &[expected]);
    };
    told(
        "",
        "11:1: `materials.grass.ior` is missing | add `ior = ...`, a number from 0.1 to 10, or \
         `glass = ...`, the name of a glass",
    );
    told(
        "ior = 1.5\nglass = \"bk7\"",
        "13:7: `materials.grass.ior` and `glass` both set the index of refraction | remove one of them",
    );
    told(
        "ior = 1.5\nroughnes = 0.1",
        "14:1: unknown key `materials.grass.roughnes` | did you mean `roughness`?",
    );
    told(
        "ior = 1.5\nroughness = -0.1",
        "14:13: `materials.grass.roughness` must be a number from 0 to 1, not -0.1",
    );
}

#[test]
fn a_wrong_name_of_a_glass_is_told_with_the_right_ones() {
    let names: Vec<_> = NAMED_IORS.iter().map(|(name, _)| format!("\"{name}\"")).collect();
    let expected = format!(
        "13:9: `materials.grass.glass` must be {}, not \"diamnd\" | did you mean `diamond`?",
        names.join(" or ")
    );
    assert_told(&material("type = \"dielectric\"\nglass = \"diamnd\""), &[], &[&expected]);
}

#[test]
fn a_principled_material_has_only_a_base_color_that_must_be_told() {
    let of = |keys: &str| surface(&format!("type = \"principled\"\n{keys}"));
    let plain = PrincipledParameters {
        base_color: Rgb::new(0.25, 0.5, 0.75),
        metallic: 0.0,
        roughness: 0.5,
        specular: 0.5,
        ior: 1.5,
        coat: 0.0,
        coat_roughness: 0.0,
        transmission: 0.0,
    };
    let color = "base_color = [0.25, 0.5, 0.75]";
    assert_eq!(of(color), SurfaceModel::Principled(plain));
    let all = "metallic = 0.125\nroughness = 0.25\nspecular = 1\nior = 1.25\ncoat = 0.75\n\
               coat_roughness = 0.625\ntransmission = 0.375";
    let told = PrincipledParameters {
        metallic: 0.125,
        roughness: 0.25,
        specular: 1.0,
        ior: 1.25,
        coat: 0.75,
        coat_roughness: 0.625,
        transmission: 0.375,
        ..plain
    };
    assert_eq!(of(&format!("{color}\n{all}")), SurfaceModel::Principled(told));

    let keys = "type = \"principled\"\nmetalic = 1\ntransmission = 2\nior = 0.9";
    assert_told(
        &material(keys),
        &[],
        &[
            "11:1: `materials.grass.base_color` is missing \
             | add `base_color = ...`, three numbers from 0 to 1",
            "13:1: unknown key `materials.grass.metalic` | did you mean `metallic`?",
            "14:16: `materials.grass.transmission` must be a number from 0 to 1, not 2",
            "15:7: `materials.grass.ior` must be a number from 1 to 10, not 0.9",
        ],
    );
}
