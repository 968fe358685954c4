//! The value of `camera.direction`: a direction by name, or as three numbers.

use serde_json::{Value, json};
use toml::de::DeValue;

use crate::appearance::ViewDirection;
use crate::math::DVec3;

use super::value_types::{
    COORDINATES, InvalidValue, NonEmptyString, ParseValue, SpannedValue, ValueType,
};

/// A direction by name, or as three numbers.
pub(super) struct DirectionValue;

impl ParseValue for DirectionValue {
    type Output = ViewDirection;

    fn expects(&self) -> String {
        "\"iso\", an axis such as \"-y\", \"AZIMUTH,ELEVATION\" in degrees, the first up to 360 and the \
         second from -90 to 90, or three numbers"
            .into()
    }

    fn parse(&self, node: &SpannedValue<'_>) -> Result<ViewDirection, InvalidValue> {
        if let DeValue::Array(_) = node.get_ref() {
            let direction = COORDINATES.parse(node)?;
            return match direction == DVec3::ZERO {
                true => Err(InvalidValue::new(node, "[0, 0, 0]")),
                false => Ok(ViewDirection::Towards(direction)),
            };
        }
        let text = NonEmptyString.parse(node)?;
        ViewDirection::parse(&text).ok_or_else(|| InvalidValue::new(node, format!("{text:?}")))
    }
}

impl ValueType for DirectionValue {
    fn check(&self, value: &ViewDirection) -> Result<(), String> {
        match value {
            ViewDirection::Towards(direction) if *direction == DVec3::ZERO => {
                Err("[0, 0, 0]".to_owned())
            }
            ViewDirection::Towards(direction) => COORDINATES.check(direction),
            ViewDirection::Axis(index, _) if *index > 2 => Err(format!("the axis {index}")),
            ViewDirection::Axis(..) => Ok(()),
            ViewDirection::Angles { azimuth, elevation } => {
                let is_good = azimuth.abs() <= 360.0 && elevation.abs() <= 90.0;
                if is_good { Ok(()) } else { Err(format!("{azimuth},{elevation}")) }
            }
        }
    }

    fn schema(&self) -> Value {
        json!({ "anyOf": [{ "type": "string", "minLength": 1 }, COORDINATES.schema()] })
    }
}
