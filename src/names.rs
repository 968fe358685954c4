//! Enums with names, each written once: the scene format, options, files and messages all use it.

/// An enum whose every variant has a name.
pub trait Named: Copy + PartialEq + 'static {
    /// Every variant with its name.
    const NAMES: &'static [(&'static str, Self)];
}

/// Gives an enum its names: the constant `NAMES`, `name()`, `named()`, and their use by serde.
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

            /// The variant of that name.
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
                        "`{name}` is no {}",
                        stringify!($type)
                    ))
                })
            }
        }
    };
}
pub(crate) use named_enum;
