//! The limits that keys of several tables share.

use crate::math::MAX_COORDINATE;
use crate::scene::value_types::{Color, Number, NumberRange};

/// The largest radiance.
pub(in crate::scene) const MAX_RADIANCE: f64 = 1e15;
/// The smallest radius; its square is still a normal f32 number.
pub(in crate::scene) const MIN_RADIUS: f64 = 1e-15;
/// The most pixels along one side.
pub(super) const MAX_IMAGE_SIDE: u32 = 65_536;

/// A length that is not 0.
pub(super) const LENGTH: Number = Number(NumberRange::LeftOpen(0.0, MAX_COORDINATE));
pub(super) const RADIANCE: Color = Color(NumberRange::Closed(0.0, MAX_RADIANCE));
/// Three shares of light.
pub(super) const UNIT_COLOR: Color = Color(NumberRange::Closed(0.0, 1.0));
/// A share that is one number.
pub(super) const UNIT_INTERVAL: Number = Number(NumberRange::Closed(0.0, 1.0));
pub(super) const ANGLE: Number = Number(NumberRange::Closed(-360.0, 360.0));
pub(super) const SCALE: Number = Number(NumberRange::Closed(0.0, 1e6));
