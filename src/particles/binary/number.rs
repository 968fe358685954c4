//! Types of binary numbers.

/// The type of a binary number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::particles) struct Number {
    pub(in crate::particles) kind: NumberKind,
    /// True if the first byte counts most.
    pub(in crate::particles) is_big_endian: bool,
}

/// The type of a number, without the order of its bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::particles) enum NumberKind {
    U8,
    I8,
    U16,
    I16,
    U32,
    I32,
    U64,
    I64,
    F16,
    F32,
    F64,
}

impl NumberKind {
    /// Bytes of a number.
    pub(in crate::particles) fn bytes(self) -> u64 {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 | Self::F16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::U64 | Self::I64 | Self::F64 => 8,
        }
    }

    /// Returns true for floating-point numbers.
    pub(in crate::particles) fn is_float(self) -> bool {
        matches!(self, Self::F16 | Self::F32 | Self::F64)
    }

    /// Returns true if f32 holds every value.
    pub(in crate::particles) fn fits_f32(self) -> bool {
        matches!(self, Self::F16 | Self::F32 | Self::U8 | Self::I8 | Self::U16 | Self::I16)
    }

    /// Bytes of a value in memory.
    pub(in crate::particles) fn held_bytes(self) -> u64 {
        match self {
            Self::U8 => 1,
            Self::I8 | Self::U16 | Self::I16 | Self::I32 | Self::F16 | Self::F32 => 4,
            Self::U32 | Self::U64 | Self::I64 | Self::F64 => 8,
        }
    }
}

impl Number {
    /// A number whose last byte counts most.
    pub(in crate::particles) fn little(kind: NumberKind) -> Self {
        Self { kind, is_big_endian: false }
    }
}

/// An f16 as f32.
pub(super) fn half(bits: u16) -> f32 {
    let sign = if bits & 0x8000 != 0 { -1.0 } else { 1.0 };
    let (exponent, fraction) = (i32::from(bits >> 10 & 0x1f), f32::from(bits & 0x3ff));
    let power = |exponent: i32| f32::from_bits(((exponent + 127) as u32) << 23);
    sign * match exponent {
        0 => fraction * power(-24),
        31 if fraction == 0.0 => f32::INFINITY,
        31 => f32::NAN,
        _ => (1.0 + fraction / 1024.0) * power(exponent - 15),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_are_exact() {
        for (bits, value) in [
            (0x0000, 0.0),
            (0x3c00, 1.0),
            (0xc000, -2.0),
            (0x7bff, 65504.0),
            (0x0400, 6.103_515_6e-5),
            (0x0001, 5.960_464_5e-8),
            (0x3555, 0.333_251_95),
            (0x7c00, f32::INFINITY),
            (0xfc00, f32::NEG_INFINITY),
        ] {
            assert_eq!(half(bits), value, "{bits:#x}");
        }
        assert!(half(0x7e00).is_nan());
    }
}
