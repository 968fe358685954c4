//! Text for the methods section of a paper: how a picture was made, from its own record, and what
//! to cite.

use crate::draw::text::percent;
use crate::job::{Metadata, NoiseStatus, NoiseTarget};
use crate::scene::description::{MaterialDescription, SurfaceModel};
use crate::scene::settings::{Caustics, Estimator, IntegratorSettings, SamplerKind};

/// The year of this version.
const YEAR: &str = "2026";

/// The digits of a hash that tell scenes apart in print.
const HASH_DIGITS: usize = 16;

/// Something to cite.
struct Reference {
    key: &'static str,
    kind: &'static str,
    /// Names and values, as in BibTeX.
    fields: &'static [(&'static str, &'static str)],
    /// A line of text.
    text: &'static str,
}

const AWAN_KO: Reference = Reference {
    key: "awan-ko",
    kind: "misc",
    fields: &[
        ("author", "Awan, Mamona and Ko, Kwang Hee"),
        ("title", "Ray tracing engine"),
        ("howpublished", "Gwangju Institute of Science and Technology"),
    ],
    text: "M. Awan, K. H. Ko: Ray tracing engine. Gwangju Institute of Science and Technology.",
};

const KAJIYA: Reference = Reference {
    key: "kajiya-1986",
    kind: "inproceedings",
    fields: &[
        ("author", "Kajiya, James T."),
        ("title", "The rendering equation"),
        ("booktitle", "Computer Graphics (Proceedings of SIGGRAPH 86)"),
        ("year", "1986"),
        ("pages", "143--150"),
        ("doi", "10.1145/15922.15902"),
    ],
    text: "J. T. Kajiya: The rendering equation. SIGGRAPH 1986. doi:10.1145/15922.15902",
};

const VEACH_GUIBAS: Reference = Reference {
    key: "veach-guibas-1995",
    kind: "inproceedings",
    fields: &[
        ("author", "Veach, Eric and Guibas, Leonidas J."),
        ("title", "Optimally combining sampling techniques for {M}onte {C}arlo rendering"),
        ("booktitle", "Proceedings of SIGGRAPH 95"),
        ("year", "1995"),
        ("pages", "419--428"),
        ("doi", "10.1145/218380.218498"),
    ],
    text: "E. Veach, L. J. Guibas: Optimally combining sampling techniques for Monte Carlo \
           rendering. SIGGRAPH 1995. doi:10.1145/218380.218498",
};

/// What the methods section says of a picture, and the references that it relies on. Ends with a
/// line break.
pub fn methods(metadata: &Metadata) -> String {
    let mut sentences = vec![format!(
        "The picture of {} was computed by {} with {}, using photosphere {}.",
        size(metadata),
        method(metadata),
        samples(metadata),
        version(metadata)
    )];
    sentences.extend(error(metadata));
    sentences.extend(missed(metadata));
    sentences.extend(bias(metadata));
    sentences.extend(display(metadata));
    sentences.push(format!(
        "The scene is identified by the BLAKE3 hash {}, the computation by {}.",
        short(&metadata.scene_identity.to_string()),
        short(&metadata.job_identity.to_string())
    ));
    let mut text = sentences.join(" ") + "\n";
    let references = references(metadata);
    if !references.is_empty() {
        text += "\n";
        references.iter().for_each(|reference| text += &format!("{}\n", reference.text));
    }
    text
}

/// BibTeX of the program, in the version that made the picture or in this one, and of the methods
/// of the picture.
pub fn bibtex(metadata: Option<&Metadata>) -> String {
    let version = metadata.map_or(env!("CARGO_PKG_VERSION"), |metadata| &metadata.version);
    let title = concat!("photosphere: ", env!("CARGO_PKG_DESCRIPTION"));
    let authors = env!("CARGO_PKG_AUTHORS").replace(':', " and ");
    let mut fields = vec![
        // Braces keep the name of a group whole.
        ("author", format!("{{{authors}}}")),
        ("title", title.to_owned()),
        ("version", version.to_owned()),
        ("url", env!("CARGO_PKG_REPOSITORY").to_owned()),
    ];
    if version == env!("CARGO_PKG_VERSION") {
        fields.insert(2, ("year", YEAR.to_owned()));
    }
    let fields: Vec<(&str, &str)> = fields.iter().map(|(name, value)| (*name, &**value)).collect();
    let mut text = entry("software", "photosphere", &fields);
    for Reference { key, kind, fields, .. } in metadata.map(references).unwrap_or_default() {
        text += &format!("\n{}", entry(kind, key, fields));
    }
    text
}

fn entry(kind: &str, key: &str, fields: &[(&str, &str)]) -> String {
    let width = fields.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    let lines: String =
        fields.iter().map(|(name, value)| format!("  {name:<width$} = {{{value}}},\n")).collect();
    format!("@{kind}{{{key},\n{lines}}}\n")
}

fn references(metadata: &Metadata) -> Vec<&'static Reference> {
    let render = &metadata.settings.render;
    match render.integrator {
        IntegratorSettings::Paper(_) => vec![&AWAN_KO, &KAJIYA],
        IntegratorSettings::Raycast { .. } => vec![&AWAN_KO],
        IntegratorSettings::Path | IntegratorSettings::Direct => match render.estimator {
            Estimator::Mis => vec![&KAJIYA, &VEACH_GUIBAS],
            Estimator::Light | Estimator::Bsdf => vec![&KAJIYA],
        },
        IntegratorSettings::AmbientOcclusion { .. } | IntegratorSettings::Normals => Vec::new(),
    }
}

fn size(metadata: &Metadata) -> String {
    let image = &metadata.settings.image;
    let whole = format!("{} x {} pixels", image.width, image.height);
    match image.crop {
        None => whole,
        Some(crop) => format!("{} x {} of {whole}", crop.width, crop.height),
    }
}

fn method(metadata: &Metadata) -> String {
    let render = &metadata.settings.render;
    let lights = match render.estimator {
        Estimator::Mis => {
            "light and BSDF sampling combined by multiple importance sampling (Veach and Guibas \
             1995)"
        }
        Estimator::Light => "light sampling",
        Estimator::Bsdf => "BSDF sampling",
    };
    let connected = match render.caustics {
        Caustics::Connect if render.estimator != Estimator::Bsdf && may_connect(metadata) => {
            " and specular connections over polished spheres"
        }
        Caustics::Connect | Caustics::Chance => "",
    };
    match render.integrator {
        IntegratorSettings::Path => {
            format!("Monte Carlo path tracing (Kajiya 1986) with {lights}{connected},")
        }
        IntegratorSettings::Direct => {
            format!(
                "Monte Carlo ray tracing of emission and direct light with {lights}{connected},"
            )
        }
        IntegratorSettings::Paper(_) => {
            "the Monte Carlo estimator of Awan and Ko for the rendering equation (Kajiya 1986), \
             which finds light sources by hemisphere sampling,"
                .to_owned()
        }
        IntegratorSettings::Raycast { .. } => "the ray casting of Awan and Ko,".to_owned(),
        IntegratorSettings::AmbientOcclusion { distance: None } => "ambient occlusion".to_owned(),
        IntegratorSettings::AmbientOcclusion { distance: Some(distance) } => {
            format!("ambient occlusion up to a distance of {distance}")
        }
        IntegratorSettings::Normals => "showing surface normals as colours".to_owned(),
    }
}

/// Returns true if the scene has polished spheres, or is not known.
fn may_connect(metadata: &Metadata) -> bool {
    let is_polished = |material: &MaterialDescription| match material.surface {
        SurfaceModel::Mirror { .. } => true,
        SurfaceModel::Conductor { roughness, .. } | SurfaceModel::Dielectric { roughness, .. } => {
            roughness == 0.0
        }
        _ => false,
    };
    metadata.scene.as_ref().is_none_or(|scene| scene.materials.iter().any(is_polished))
}

fn samples(metadata: &Metadata) -> String {
    let samples = &metadata.samples;
    let count = |count: u32| match count {
        1 => "1 sample per pixel".to_owned(),
        count => format!("{count} samples per pixel"),
    };
    let each = match metadata.parts.is_empty() {
        false => format!("samples {} of each pixel", metadata.samples_to_string()),
        true if samples.min_count == samples.max_count => count(samples.max_count),
        true => format!(
            "between {} and {}, where the picture needed them,",
            samples.min_count,
            count(samples.max_count)
        ),
    };
    let render = &metadata.settings.render;
    let sampler = match render.sampler {
        SamplerKind::Sobol => "Owen-scrambled Sobol' points",
        SamplerKind::Stratified => "stratified points",
        SamplerKind::Independent => "independent random numbers",
    };
    format!("{each} ({sampler}, seed {})", render.seed)
}

fn version(metadata: &Metadata) -> String {
    let commit = match metadata.commit.as_str() {
        "" | "unknown" => String::new(),
        commit => match commit.split_once(' ') {
            // The tree was not that of the commit.
            Some((hash, changes)) => format!(", commit {} {changes}", short(hash)),
            None => format!(", commit {}", short(commit)),
        },
    };
    format!("{}{commit}", metadata.version)
}

fn error(metadata: &Metadata) -> Option<String> {
    let run = metadata.run.as_ref()?;
    let target = run.noise.unwrap_or(NoiseTarget::new(0.01));
    let share = target.confidence;
    // Digits without those that only the binary form has.
    let share = (1e8 * share).round() / 1e6;
    let error = run.error?;
    let (error, unit) = match target.display {
        None => (percent(error), "of the pixel's brightness"),
        Some(_) => (target.format_error(error), "as displayed"),
    };
    Some(format!("The estimated error of {share} % of the pixel values is below {error} {unit}."))
}

/// Says that the picture has not reached its target.
fn missed(metadata: &Metadata) -> Option<String> {
    let NoiseStatus { target, tiles, tiles_converged, worst_error } =
        metadata.run.as_ref()?.missed?;
    let error = |error: f64| target.format_error(error);
    let worst = worst_error.map_or(String::new(), |worst| format!(", up to {}", error(worst)));
    Some(format!(
        "The render ended before its target, an error of {}, was reached: {} of {tiles} squares of \
         16 x 16 pixels have a larger or an unknown error{worst}.",
        error(target.error),
        tiles - tiles_converged
    ))
}

fn bias(metadata: &Metadata) -> Option<String> {
    let biased = metadata.biased.join(", ");
    (!biased.is_empty()).then(|| format!("The estimate is biased by the options {biased}."))
}

fn display(metadata: &Metadata) -> Option<String> {
    let look = metadata.look.map(|look| format!("shown through the view transform {look}"));
    let converted = (!metadata.converted.is_empty()).then(|| metadata.converted.join("; "));
    let done: Vec<String> = look.into_iter().chain(converted).collect();
    (!done.is_empty()).then(|| format!("Afterwards: {}.", done.join("; ")))
}

/// The first digits of a hash.
fn short(hash: &str) -> &str {
    hash.get(..HASH_DIGITS).unwrap_or(hash)
}
