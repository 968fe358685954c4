//! The AOVs (layers) of a picture, as users name them, and how the layers of partial renders merge.

use super::Layer;

/// A layer of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Aov {
    /// The full radiance.
    Beauty,
    /// A layer averaged over samples.
    Mean(Layer),
    /// Sphere at the pixel's centre.
    SphereId,
    /// Material at the pixel's centre.
    MaterialId,
    /// Number of samples of each pixel.
    SampleCount,
    /// Variance of the beauty's mean.
    Variance,
    /// Cryptomatte: coverage of the pixel by ids.
    Cryptomatte(CryptomatteKind),
}

/// The kind of ids in a Cryptomatte.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CryptomatteKind {
    /// Spheres.
    Sphere,
    /// Materials.
    Material,
    /// Tables of spheres.
    Table,
}

/// How a layer merges from two partial renders with different samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MergeRule {
    /// Sums of samples are added exactly and divided by the number of samples.
    Sums,
    /// Sums of samples are added exactly and divided by the number of samples that hit a surface.
    HitSums,
    /// Sums of squares are added exactly.
    SumsOfSquares,
    /// Sample counts are added.
    Counts,
    /// Per sphere, the numbers of samples that see it are added and divided by the number of
    /// samples.
    Coverage,
    /// Equal in both partial renders: independent of samples.
    Invariant,
}

/// Properties of an AOV.
#[derive(Clone, Copy, Debug)]
pub struct AovInfo {
    /// The AOV.
    pub aov: Aov,
    /// Name on the command line and in files.
    pub name: &'static str,
    /// Channels in files, after the name and a dot; none for an AOV that is a single channel. A
    /// Cryptomatte's channels are named by its specification.
    pub channels: &'static [&'static str],
    /// How partial renders merge.
    pub merge: MergeRule,
}

const RGB: &[&str] = &["R", "G", "B"];
const XYZ: &[&str] = &["X", "Y", "Z"];
const SCALAR: &[&str] = &[];

const fn aov_info(
    aov: Aov,
    name: &'static str,
    channels: &'static [&'static str],
    merge: MergeRule,
) -> AovInfo {
    AovInfo { aov, name, channels, merge }
}

/// Every AOV. docs/layers.md documents them for users.
pub const AOVS: [AovInfo; 18] = [
    aov_info(Aov::Beauty, "beauty", RGB, MergeRule::Sums),
    aov_info(Aov::Mean(Layer::Direct), "direct", RGB, MergeRule::Sums),
    aov_info(Aov::Mean(Layer::Indirect), "indirect", RGB, MergeRule::Sums),
    aov_info(Aov::Mean(Layer::Emission), "emission", RGB, MergeRule::Sums),
    aov_info(Aov::Mean(Layer::Albedo), "albedo", RGB, MergeRule::Sums),
    aov_info(Aov::Mean(Layer::Normal), "normal", XYZ, MergeRule::Sums),
    aov_info(Aov::Mean(Layer::Depth), "depth", SCALAR, MergeRule::HitSums),
    aov_info(Aov::Mean(Layer::Position), "position", XYZ, MergeRule::HitSums),
    aov_info(Aov::Mean(Layer::DenoisingAlbedo), "denoising_albedo", RGB, MergeRule::Sums),
    aov_info(Aov::Mean(Layer::DenoisingNormal), "denoising_normal", XYZ, MergeRule::Sums),
    aov_info(Aov::SphereId, "sphere_id", SCALAR, MergeRule::Invariant),
    aov_info(Aov::MaterialId, "material_id", SCALAR, MergeRule::Invariant),
    aov_info(Aov::SampleCount, "sample_count", SCALAR, MergeRule::Counts),
    aov_info(Aov::Variance, "variance", RGB, MergeRule::SumsOfSquares),
    aov_info(Aov::Mean(Layer::Alpha), "alpha", SCALAR, MergeRule::Sums),
    aov_info(
        Aov::Cryptomatte(CryptomatteKind::Sphere),
        "crypto_sphere",
        SCALAR,
        MergeRule::Coverage,
    ),
    aov_info(
        Aov::Cryptomatte(CryptomatteKind::Material),
        "crypto_material",
        SCALAR,
        MergeRule::Coverage,
    ),
    aov_info(Aov::Cryptomatte(CryptomatteKind::Table), "crypto_table", SCALAR, MergeRule::Coverage),
];

impl Aov {
    /// Albedo of the first surface.
    pub const ALBEDO: Self = Self::Mean(Layer::Albedo);

    /// Normal of the first surface.
    pub const NORMAL: Self = Self::Mean(Layer::Normal);

    /// What guides a denoiser: colour and normal of what is seen, also in mirrors and glass.
    pub const DENOISING: [Self; 2] =
        [Self::Mean(Layer::DenoisingAlbedo), Self::Mean(Layer::DenoisingNormal)];

    /// The default AOVs of a picture.
    pub const DEFAULT: [Self; 2] = [Self::Mean(Layer::Direct), Self::Mean(Layer::Indirect)];

    /// Returns the entry in [`AOVS`].
    pub fn info(self) -> &'static AovInfo {
        AOVS.iter().find(|info| info.aov == self).unwrap_or(&AOVS[0])
    }

    /// Returns the AOV with this name.
    pub fn named(name: &str) -> Option<Self> {
        AOVS.iter().find(|info| info.name == name).map(|info| info.aov)
    }
}

impl serde::Serialize for Aov {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.info().name)
    }
}

impl<'de> serde::Deserialize<'de> for Aov {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = <std::borrow::Cow<'de, str>>::deserialize(deserializer)?;
        let unknown = || serde::de::Error::custom(format_args!("there is no layer `{name}`"));
        Self::named(&name).ok_or_else(unknown)
    }
}

/// Returns the layers that a film must sum for the given AOVs. Direct and indirect light are always
/// included: their sum is the picture.
pub fn required_layers(aovs: &[Aov]) -> Vec<Layer> {
    let is_required = |layer: &Layer| match layer {
        Layer::Direct | Layer::Indirect => true,
        // Depth and position are divided by alpha.
        Layer::Alpha => aovs.iter().any(|aov| match aov {
            Aov::Mean(layer) => layer.is_hit_mean() || *layer == Layer::Alpha,
            _ => false,
        }),
        Layer::Coverage => aovs.iter().any(|aov| matches!(aov, Aov::Cryptomatte(_))),
        layer => aovs.contains(&Aov::Mean(*layer)),
    };
    Layer::ALL.iter().copied().filter(is_required).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_layer_that_is_summed_has_its_row() {
        for layer in Layer::ALL.iter().filter(|layer| **layer != Layer::Coverage) {
            let info = Aov::Mean(*layer).info();
            assert_eq!(info.name, layer.name());
            assert_eq!(info.channels.len().max(1), layer.channels());
            assert_eq!(info.merge == MergeRule::HitSums, layer.is_hit_mean());
            assert_eq!(Aov::named(info.name), Some(info.aov));
        }
        assert_eq!(Aov::named("shadow"), None);
    }

    #[test]
    fn a_film_sums_what_is_asked_for_and_no_more() {
        assert_eq!(required_layers(&Aov::DEFAULT), [Layer::Direct, Layer::Indirect]);
        let depth = [Aov::Mean(Layer::Depth), Aov::SphereId];
        let expected = [Layer::Direct, Layer::Indirect, Layer::Alpha, Layer::Depth];
        assert_eq!(required_layers(&depth), expected);
    }
}
