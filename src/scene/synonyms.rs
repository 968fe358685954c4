//! What users of other programs type, and what it is called here.

/// Keys of other programs, each with the table that they would stand in (empty: any) and what to
/// write instead.
const KEYS: &[(&str, &[&str], &str)] = &[
    ("camera", &["fov", "fovy", "vfov", "fov_y", "field_of_view", "angle"], "vertical_fov_degrees"),
    ("camera", &["eye", "from", "origin", "location", "look_from", "lookfrom", "pos"], "position"),
    (
        "camera",
        &["target", "lookat", "look", "at", "center", "centre", "look_to", "focal_point"],
        "look_at",
    ),
    ("camera", &["vup", "view_up", "up_vector"], "up"),
    ("camera", &["aperture", "lens_radius"], "aperture_radius"),
    ("camera", &["fstop", "f_stop", "fnumber"], "f_number"),
    ("camera", &["focal_distance", "focus_dist", "focus"], "focus_distance"),
    ("camera", &["projection", "model", "kind"], "type"),
    ("camera", &["ortho_scale", "parallel_scale"], "height"),
    ("camera", &["zoom"], "vertical_fov_degrees, or height of parallel rays"),
    ("image", &["size", "resolution", "res", "resx", "xres"], "width and height"),
    (
        "materials",
        &["color", "colour", "rgb", "diffuse", "kd", "Kd", "reflectance", "base_color"],
        "albedo",
    ),
    (
        "materials",
        &["emit", "emittance", "radiance", "light", "emission_color", "glow"],
        "emission",
    ),
    ("materials", &["index", "eta", "refractive_index", "int_ior", "n"], "ior"),
    ("materials", &["alpha", "transparency", "opacity_factor"], "opacity"),
    ("materials", &["shininess", "glossiness", "alpha_g", "fuzz"], "roughness"),
    ("materials", &["bsdf", "model", "kind", "material"], "type"),
    ("spheres", &["position", "pos", "location", "origin", "xyz", "centre", "point"], "center"),
    ("spheres", &["r", "size", "rad", "scale"], "radius"),
    (
        "spheres",
        &["color", "colour", "albedo", "emission", "bsdf"],
        "material, and the colour in [materials.NAME]",
    ),
    ("background", &["color", "colour", "emission", "intensity", "ambient"], "radiance"),
    (
        "background",
        &["hdri", "hdr", "environment", "envmap", "texture", "file"],
        "[background.image] with file",
    ),
    (
        "render",
        &["samples", "spp", "sample_count", "sampleCount", "num_samples"],
        "samples_per_pixel",
    ),
    (
        "render",
        &["bounces", "max_bounces", "depth", "maxDepth", "maxdepth", "rrDepth"],
        "max_depth",
    ),
    (
        "",
        &["sphere", "objects", "shapes", "shape", "balls", "primitives", "geometry"],
        "[[spheres]]",
    ),
    ("", &["material", "bsdfs", "bsdf"], "[materials.NAME]"),
    (
        "",
        &["lights", "emitter", "emitters", "lamp", "lamps"],
        "emission in [materials.NAME], or [light] with preset",
    ),
    (
        "",
        &["sky", "environment", "envmap", "world", "sun"],
        "[background.sky], [background.sun] or [background.image]",
    ),
    ("", &["film", "resolution", "output", "picture"], "[image]"),
    ("", &["settings", "options"], "[render]"),
    ("", &["integrator"], "integrator in [render]"),
    ("", &["sampler"], "sampler in [render]"),
    ("", &["paper"], "[render.paper]"),
    ("", &["sensor", "view"], "[camera]"),
    ("", &["tables", "table", "points", "cloud"], "[[sphere_tables]] or [[particles]]"),
];

/// Values of other programs, and what to write instead.
const VALUES: &[(&[&str], &str)] = &[
    (&["lambertian", "lambert", "matte", "oren-nayar", "OrenNayar"], "diffuse"),
    (&["glass", "transparent", "refractive", "thindielectric"], "dielectric"),
    (&["roughdielectric", "frosted"], "dielectric, with roughness"),
    (&["metal", "metallic", "roughconductor"], "conductor"),
    (&["specular", "reflective", "perfect_mirror"], "mirror"),
    (&["emissive", "light", "area", "diffuse_light", "emission", "lamp"], "diffuse, with emission"),
    (&["disney", "pbr", "uber", "standard", "openpbr"], "principled"),
    (&["glossy", "coated", "roughplastic", "coateddiffuse"], "plastic"),
    (&["pinhole", "thinlens", "thin-lens", "persp"], "perspective"),
    (&["ortho", "parallel"], "orthographic"),
    (&["spherical", "equirectangular", "latlong", "environment", "360"], "panoramic"),
    (&["pathtracing", "path-tracing", "pt", "gi", "volpath"], "path"),
    (&["ao", "ambient_occlusion"], "ambient-occlusion"),
    (&["random", "uniform"], "independent"),
    (&["halton", "qmc", "ldsampler", "zsobol"], "sobol"),
    (&["jittered", "multijitter"], "stratified"),
    (&["mis"], "path, with estimator = \"mis\""),
    (&["light", "nee"], "path, with estimator = \"light\""),
    (&["bsdf", "unidirectional"], "path, with estimator = \"bsdf\""),
    (&["nee", "next-event", "direct"], "light"),
    (&["brdf", "hemisphere", "chance"], "bsdf"),
];

/// What the key of another program is called in the table with this path, as `materials.glass`.
pub(super) fn key(table: &str, word: &str) -> Option<String> {
    let first = table.split('.').next().unwrap_or_default();
    let is_meant = |(of, words, _): &&(&str, &[&str], &str)| *of == first && words.contains(&word);
    KEYS.iter().find(is_meant).map(|(_, _, ours)| format!("here it is called {ours}"))
}

/// What the value of another program is called.
pub(super) fn value<'k>(word: &str, known: impl Iterator<Item = &'k str>) -> Option<String> {
    let known: Vec<&str> = known.collect();
    let is_choice = |ours: &str| ours.split(',').next().is_some_and(|name| known.contains(&name));
    let mut meant = VALUES.iter().filter(|(words, _)| words.contains(&word));
    let (_, ours) = meant.find(|(_, ours)| is_choice(ours))?;
    Some(format!("here it is called {ours}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_other_programs_are_known() {
        assert_eq!(key("camera", "fov").as_deref(), Some("here it is called vertical_fov_degrees"));
        assert_eq!(key("materials.red", "color").as_deref(), Some("here it is called albedo"));
        assert_eq!(key("spheres.0", "color").map(|help| help.contains("material")), Some(true));
        assert_eq!(key("", "objects").as_deref(), Some("here it is called [[spheres]]"));
        assert_eq!(key("camera", "objects"), None);
        let models = || ["diffuse", "dielectric"].into_iter();
        assert_eq!(value("lambertian", models()).as_deref(), Some("here it is called diffuse"));
        assert_eq!(value("metal", models()), None, "it is no choice here");
        let estimator = value("mis", ["direct", "path"].into_iter());
        assert_eq!(estimator.as_deref(), Some("here it is called path, with estimator = \"mis\""));
    }

    #[test]
    fn no_word_is_listed_twice() {
        for (table, words, _) in KEYS {
            for word in *words {
                let count =
                    KEYS.iter().filter(|(of, words, _)| of == table && words.contains(word));
                assert_eq!(count.count(), 1, "{table}.{word}");
            }
        }
    }
}
