//! The layers that a picture may have, as users name them, and how the layers of parts become those
//! of the whole.

use super::Layer;

/// A layer of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
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
    Cryptomatte(By),
}

/// The things that a Cryptomatte tells apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum By {
    /// Spheres.
    Sphere,
    /// Materials.
    Material,
    /// Tables of spheres.
    Table,
}

/// How a layer of two parts that differ in their samples becomes that of both.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Merge {
    /// Sums of samples are added, exactly, and divided by the number of samples.
    Sums,
    /// The same, divided by the number of samples that see something.
    SumsOfHits,
    /// Sums of squares are added, exactly.
    Squares,
    /// Numbers are added.
    Counts,
    /// The numbers of samples that see each sphere are added, and divided by the number of samples.
    Coverage,
    /// Both parts have the same: it does not depend on samples.
    Same,
}

/// What there is to know of a layer.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Which.
    pub kind: Kind,
    /// Its name on the command line and in files.
    pub name: &'static str,
    /// Its channels in files, behind the name and a dot; none for one that is a channel by itself. Those
    /// of a Cryptomatte have the names that its specification gives them.
    pub channels: &'static [&'static str],
    /// How parts are put together.
    pub merge: Merge,
}

const RGB: &[&str] = &["R", "G", "B"];
const XYZ: &[&str] = &["X", "Y", "Z"];
const ONE: &[&str] = &[];

const fn row(
    kind: Kind,
    name: &'static str,
    channels: &'static [&'static str],
    merge: Merge,
) -> Row {
    Row { kind, name, channels, merge }
}

/// Every layer. docs/layers.md tells users the same.
pub const KINDS: [Row; 16] = [
    row(Kind::Beauty, "beauty", RGB, Merge::Sums),
    row(Kind::Mean(Layer::Direct), "direct", RGB, Merge::Sums),
    row(Kind::Mean(Layer::Indirect), "indirect", RGB, Merge::Sums),
    row(Kind::Mean(Layer::Emission), "emission", RGB, Merge::Sums),
    row(Kind::Mean(Layer::Albedo), "albedo", RGB, Merge::Sums),
    row(Kind::Mean(Layer::Normal), "normal", XYZ, Merge::Sums),
    row(Kind::Mean(Layer::Depth), "depth", ONE, Merge::SumsOfHits),
    row(Kind::Mean(Layer::Position), "position", XYZ, Merge::SumsOfHits),
    row(Kind::SphereId, "sphere_id", ONE, Merge::Same),
    row(Kind::MaterialId, "material_id", ONE, Merge::Same),
    row(Kind::SampleCount, "sample_count", ONE, Merge::Counts),
    row(Kind::Variance, "variance", RGB, Merge::Squares),
    row(Kind::Mean(Layer::Alpha), "alpha", ONE, Merge::Sums),
    row(Kind::Cryptomatte(By::Sphere), "crypto_sphere", ONE, Merge::Coverage),
    row(Kind::Cryptomatte(By::Material), "crypto_material", ONE, Merge::Coverage),
    row(Kind::Cryptomatte(By::Table), "crypto_table", ONE, Merge::Coverage),
];

impl Kind {
    /// Those of a picture where nothing else is said.
    pub const USUAL: [Self; 2] = [Self::Mean(Layer::Direct), Self::Mean(Layer::Indirect)];

    /// Its row in the table.
    pub fn row(self) -> &'static Row {
        KINDS.iter().find(|row| row.kind == self).unwrap_or(&KINDS[0])
    }

    /// The layer of that name.
    pub fn named(name: &str) -> Option<Self> {
        KINDS.iter().find(|row| row.name == name).map(|row| row.kind)
    }
}

impl serde::Serialize for Kind {
    fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(self.row().name)
    }
}

impl<'de> serde::Deserialize<'de> for Kind {
    fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let name = <std::borrow::Cow<'de, str>>::deserialize(from)?;
        let unknown = || serde::de::Error::custom(format_args!("there is no layer `{name}`"));
        Self::named(&name).ok_or_else(unknown)
    }
}

/// The layers that a film has to sum for a picture: light always, because it is the picture.
pub fn summed_for(kinds: &[Kind]) -> Vec<Layer> {
    let is_wanted = |layer: &Layer| match layer {
        Layer::Direct | Layer::Indirect => true,
        // Depth and position are divided by it.
        Layer::Alpha => kinds.iter().any(|kind| match kind {
            Kind::Mean(layer) => layer.is_of_hits() || *layer == Layer::Alpha,
            _ => false,
        }),
        Layer::Coverage => kinds.iter().any(|kind| matches!(kind, Kind::Cryptomatte(_))),
        layer => kinds.contains(&Kind::Mean(*layer)),
    };
    Layer::ALL.iter().copied().filter(is_wanted).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_layer_that_is_summed_has_its_row() {
        for layer in Layer::ALL.iter().filter(|layer| **layer != Layer::Coverage) {
            let row = Kind::Mean(*layer).row();
            assert_eq!(row.name, layer.name());
            assert_eq!(row.channels.len().max(1), layer.channels());
            assert_eq!(row.merge == Merge::SumsOfHits, layer.is_of_hits());
            assert_eq!(Kind::named(row.name), Some(row.kind));
        }
        assert_eq!(Kind::named("shadow"), None);
    }

    #[test]
    fn a_film_sums_what_is_asked_for_and_no_more() {
        assert_eq!(summed_for(&Kind::USUAL), [Layer::Direct, Layer::Indirect]);
        let depth = [Kind::Mean(Layer::Depth), Kind::SphereId];
        let expected = [Layer::Direct, Layer::Indirect, Layer::Alpha, Layer::Depth];
        assert_eq!(summed_for(&depth), expected);
    }
}
