//! The layers that a picture may have, as users name them, and how the layers of parts become those
//! of the whole.

use super::Layer;

/// A layer of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Aov {
    /// All the light.
    Beauty,
    /// A layer that is summed.
    Mean(Layer),
    /// The sphere at the pixel's centre.
    SphereId,
    /// The material at the pixel's centre.
    MaterialId,
    /// How many samples each pixel has.
    SampleCount,
    /// The variance of the mean of the beauty.
    Variance,
    /// Which things cover how much of the pixel.
    Cryptomatte(CryptomatteKind),
}

/// The things that a Cryptomatte tells apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CryptomatteKind {
    /// Spheres.
    Sphere,
    /// Materials.
    Material,
    /// Tables of spheres.
    Table,
}

/// How a layer of two parts that differ in their samples becomes that of both.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MergeRule {
    /// Sums of samples are added, exactly, and divided by the number of samples.
    Sums,
    /// The same, divided by the number of samples that see something.
    HitSums,
    /// Sums of squares are added, exactly.
    SumsOfSquares,
    /// Numbers are added.
    Counts,
    /// The numbers of samples that see each sphere are added, and divided by the number of samples.
    Coverage,
    /// Both parts have the same: it does not depend on samples.
    Invariant,
}

/// What there is to know of a layer.
#[derive(Clone, Copy, Debug)]
pub struct AovInfo {
    /// Which.
    pub aov: Aov,
    /// Its name on the command line and in files.
    pub name: &'static str,
    /// Its channels in files, behind the name and a dot; none for one that is a channel by itself. Those
    /// of a Cryptomatte have the names that its specification gives them.
    pub channels: &'static [&'static str],
    /// How parts are put together.
    pub merge: MergeRule,
}

const RGB: &[&str] = &["R", "G", "B"];
const XYZ: &[&str] = &["X", "Y", "Z"];
const ONE: &[&str] = &[];

const fn aov_info(
    kind: Aov,
    name: &'static str,
    channels: &'static [&'static str],
    merge: MergeRule,
) -> AovInfo {
    AovInfo { aov: kind, name, channels, merge }
}

/// Every layer. docs/layers.md tells users the same.
pub const AOVS: [AovInfo; 16] = [
    aov_info(Aov::Beauty, "beauty", RGB, MergeRule::Sums),
    aov_info(Aov::Mean(Layer::Direct), "direct", RGB, MergeRule::Sums),
    aov_info(Aov::Mean(Layer::Indirect), "indirect", RGB, MergeRule::Sums),
    aov_info(Aov::Mean(Layer::Emission), "emission", RGB, MergeRule::Sums),
    aov_info(Aov::Mean(Layer::Albedo), "albedo", RGB, MergeRule::Sums),
    aov_info(Aov::Mean(Layer::Normal), "normal", XYZ, MergeRule::Sums),
    aov_info(Aov::Mean(Layer::Depth), "depth", ONE, MergeRule::HitSums),
    aov_info(Aov::Mean(Layer::Position), "position", XYZ, MergeRule::HitSums),
    aov_info(Aov::SphereId, "sphere_id", ONE, MergeRule::Invariant),
    aov_info(Aov::MaterialId, "material_id", ONE, MergeRule::Invariant),
    aov_info(Aov::SampleCount, "sample_count", ONE, MergeRule::Counts),
    aov_info(Aov::Variance, "variance", RGB, MergeRule::SumsOfSquares),
    aov_info(Aov::Mean(Layer::Alpha), "alpha", ONE, MergeRule::Sums),
    aov_info(Aov::Cryptomatte(CryptomatteKind::Sphere), "crypto_sphere", ONE, MergeRule::Coverage),
    aov_info(
        Aov::Cryptomatte(CryptomatteKind::Material),
        "crypto_material",
        ONE,
        MergeRule::Coverage,
    ),
    aov_info(Aov::Cryptomatte(CryptomatteKind::Table), "crypto_table", ONE, MergeRule::Coverage),
];

impl Aov {
    /// The albedo of the first surface.
    pub const ALBEDO: Self = Self::Mean(Layer::Albedo);

    /// The normal of the first surface.
    pub const NORMAL: Self = Self::Mean(Layer::Normal);

    /// The layers of a picture unless others are asked for.
    pub const DEFAULT: [Self; 2] = [Self::Mean(Layer::Direct), Self::Mean(Layer::Indirect)];

    /// Its row in the table.
    pub fn info(self) -> &'static AovInfo {
        AOVS.iter().find(|row| row.aov == self).unwrap_or(&AOVS[0])
    }

    /// The layer of that name.
    pub fn named(name: &str) -> Option<Self> {
        AOVS.iter().find(|row| row.name == name).map(|row| row.aov)
    }
}

impl serde::Serialize for Aov {
    fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(self.info().name)
    }
}

impl<'de> serde::Deserialize<'de> for Aov {
    fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let name = <std::borrow::Cow<'de, str>>::deserialize(from)?;
        let unknown = || serde::de::Error::custom(format_args!("there is no layer `{name}`"));
        Self::named(&name).ok_or_else(unknown)
    }
}

/// The layers that a film has to sum for a picture: light always, because it is the picture.
pub fn required_layers(kinds: &[Aov]) -> Vec<Layer> {
    let is_wanted = |layer: &Layer| match layer {
        Layer::Direct | Layer::Indirect => true,
        // Depth and position are divided by it.
        Layer::Alpha => kinds.iter().any(|kind| match kind {
            Aov::Mean(layer) => layer.is_hit_mean() || *layer == Layer::Alpha,
            _ => false,
        }),
        Layer::Coverage => kinds.iter().any(|kind| matches!(kind, Aov::Cryptomatte(_))),
        layer => kinds.contains(&Aov::Mean(*layer)),
    };
    Layer::ALL.iter().copied().filter(is_wanted).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_layer_that_is_summed_has_its_row() {
        for layer in Layer::ALL.iter().filter(|layer| **layer != Layer::Coverage) {
            let row = Aov::Mean(*layer).info();
            assert_eq!(row.name, layer.name());
            assert_eq!(row.channels.len().max(1), layer.channels());
            assert_eq!(row.merge == MergeRule::HitSums, layer.is_hit_mean());
            assert_eq!(Aov::named(row.name), Some(row.aov));
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
