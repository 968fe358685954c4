//! Enums with names, each defined once and used by the scene format, options, files and messages;
//! and the known word nearest to a mistyped one.

mod suggest;

pub use suggest::did_you_mean;

/// An enum with a name for every variant.
pub trait Named: Copy + PartialEq + 'static {
    /// Every variant with its name.
    const NAMES: &'static [(&'static str, Self)];
}

/// Implements the names of an enum: the constant `NAMES`, `name()`, `named()`, and serde support.
macro_rules! named_enum {
    ($type:ident { $($variant:ident = $name:literal),+ $(,)? }) => {
        #[allow(unreachable_pub, reason = "some of the enums are a room's own")]
        impl $type {
            /// Every variant with its name.
            pub const NAMES: &'static [(&'static str, Self)] = &[$(($name, Self::$variant)),+];

            /// The variant's name.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name,)+
                }
            }

            /// Returns the variant with this name.
            pub fn named(name: &str) -> Option<Self> {
                Self::NAMES.iter().find(|(known, _)| *known == name).map(|(_, variant)| *variant)
            }
        }

        impl $crate::names::Named for $type {
            const NAMES: &'static [(&'static str, Self)] = Self::NAMES;
        }

        impl serde::Serialize for $type {
            fn serialize<S: serde::Serializer>(&self, to: S) -> std::result::Result<S::Ok, S::Error> {
                to.serialize_str(self.name())
            }
        }

        impl<'de> serde::Deserialize<'de> for $type {
            fn deserialize<D: serde::Deserializer<'de>>(from: D) -> std::result::Result<Self, D::Error> {
                let name = <std::borrow::Cow<'de, str>>::deserialize(from)?;
                Self::named(&name).ok_or_else(|| {
                    serde::de::Error::custom(format_args!(
                        "`{name}` is not a {}",
                        stringify!($type)
                    ))
                })
            }
        }
    };
}
pub(crate) use named_enum;
