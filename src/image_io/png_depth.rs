//! How finely a PNG file stores display values.

use crate::names::named_enum;

/// Bits per channel of a PNG file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PngDepth {
    /// 256 levels, as screens show them.
    #[default]
    Eight,
    /// 65536 levels, for programs that change brightness or colours afterwards.
    Sixteen,
}

named_enum! { PngDepth { Eight = "8", Sixteen = "16" } }
