//! What a part says of itself, as JSON.

use std::fs::File;
use std::io::BufReader;
use std::ops::Range;

use serde_json::{Value, json};

use crate::film::{BLOCK, Format, Frame, Layer, Rect, Scale};

use super::hashing::Hashing;
use super::{Bad, MAGIC, PartHead, VERSION};
use crate::output::Record;

/// The longest head: a scene's text, and some.
const LONGEST: u32 = 16 << 20;

/// The most pixels along a picture.
const WIDEST: u64 = 1 << 24;

pub(super) fn words(format: &Format, samples: &Range<u32>, records: &[Record]) -> String {
    let Rect { x, y, width, height } = format.frame.window;
    let records: Vec<Value> =
        records.iter().map(|record| json!([record.name, record.text])).collect();
    json!({
        "full_size": format.frame.full_size,
        "window": [x, y, width, height],
        "samples": [samples.start, samples.end],
        "brightest": format.scale.exponent(),
        "layers": format.layers.iter().map(|layer| layer.name()).collect::<Vec<_>>(),
        "squares": format.squares,
        "records": records,
    })
    .to_string()
}

pub(super) fn read(
    from: &mut Hashing<BufReader<File>>,
    bytes: u64,
) -> std::result::Result<PartHead, Bad> {
    let mut magic = [0; 8];
    match from.fill(&mut magic) {
        Ok(()) if magic == MAGIC => {}
        Ok(()) | Err(Bad::CutOff(_)) => return Err(Bad::NoPart),
        Err(other) => return Err(other),
    }
    let version = from.u32()?;
    if version > VERSION {
        return Err(Bad::Newer(version));
    }
    let length = from.u32()?;
    if length > LONGEST {
        return Err(Bad::Damaged("its head is too long"));
    }
    if u64::from(length) > bytes {
        return Err(Bad::CutOff(bytes));
    }
    let mut text = vec![0; length as usize];
    from.fill(&mut text)?;
    from.check_hash()?;
    let value: Value =
        serde_json::from_slice(&text).map_err(|_| Bad::Damaged("its head is no JSON"))?;
    parse(&value)
}

fn parse(value: &Value) -> std::result::Result<PartHead, Bad> {
    let incomplete = || Bad::Damaged("its head says something impossible");
    let layers = value.get("layers").and_then(Value::as_array).ok_or_else(incomplete)?;
    let layer = |name: &Value| {
        let name = name.as_str().ok_or_else(incomplete)?;
        let known = Layer::ALL.iter().find(|layer| layer.name() == name).copied();
        known
            .ok_or_else(|| Bad::Unknown(format!("it holds the layer `{name}`, which is not known")))
    };
    let layers: Vec<Layer> = layers.iter().map(layer).collect::<std::result::Result<_, Bad>>()?;
    let read = || -> Option<PartHead> {
        let full_size: [u32; 2] = numbers(value.get("full_size")?)?;
        let [x, y, width, height] = numbers(value.get("window")?)?;
        let [first_sample, end] = numbers(value.get("samples")?)?;
        let fits = |first: u32, length: u32, full: u32| {
            length > 0
                && u64::from(first) + u64::from(length) <= u64::from(full)
                && u64::from(full) <= WIDEST
        };
        let is_twice = |(at, layer): (usize, &Layer)| layers[..at].contains(layer);
        let is_good = fits(x, width, full_size[0])
            && fits(y, height, full_size[1])
            && first_sample % BLOCK == 0
            && first_sample <= end
            && !layers.iter().enumerate().any(is_twice);
        let format = Format {
            frame: Frame { full_size, window: Rect { x, y, width, height } },
            first_sample,
            scale: Scale::of_exponent(value.get("brightest")?.as_i64()?.try_into().ok()?)?,
            layers: layers.clone(),
            squares: value.get("squares")?.as_bool()?,
        };
        let record =
            |pair: &Value| Some(Record::new(pair.get(0)?.as_str()?, pair.get(1)?.as_str()?));
        let records =
            value.get("records")?.as_array()?.iter().map(record).collect::<Option<_>>()?;
        is_good.then_some(PartHead { format, samples: first_sample..end, records })
    };
    read().ok_or_else(incomplete)
}

fn numbers<const N: usize>(value: &Value) -> Option<[u32; N]> {
    let number = |value: &Value| value.as_u64()?.try_into().ok();
    let numbers: Option<Vec<u32>> = value.as_array()?.iter().map(number).collect();
    numbers?.try_into().ok()
}
