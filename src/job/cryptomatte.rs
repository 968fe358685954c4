//! Cryptomatte: the coverage of each pixel by spheres, materials or tables, so that a compositor
//! can pick them by name (J. Friedman and A. C. Jones, "Fully Automatic ID Mattes with Support for
//! Motion Blur and Transparency", SIGGRAPH 2015; specification version 1.2.1).
//!
//! An id is the hash of a name. The ids of a pixel are ranked by coverage, the fraction of its
//! samples that hit them first. Each layer of four channels holds two ids.

use std::collections::{BTreeMap, HashMap};

use crate::color::NO_ROW;
use crate::film::{CryptomatteKind, Film};
use crate::image_io::{ChannelValues, ImageChannel, Picture};
use crate::scene::Scene;

/// Number of ids written per pixel, those with the largest coverage; two per layer.
const RANKS: usize = 6;

/// With more names than this no manifest is written, as the specification permits.
const MAX_MANIFEST_NAMES: usize = 100_000;

/// Adds the Cryptomatte layers and their attributes to a picture.
pub(super) fn add_layers(picture: &mut Picture, scene: &Scene, film: &Film, kind: CryptomatteKind) {
    let Some(coverage) = film.coverage() else { return };
    let mut matte_ids = MatteIds { scene, kind, ids: HashMap::new(), hashes: BTreeMap::new() };
    let counts = film.counts();
    let mut ranked = vec![[[0.0f32; 2]; RANKS]; counts.len()];
    for ((ranked, rows), samples) in ranked.iter_mut().zip(coverage).zip(counts) {
        let ranking = matte_ids.ranked_coverage(&rows);
        for (rank, (id, count)) in ranked.iter_mut().zip(ranking) {
            *rank = [f32::from_bits(id), (f64::from(count) / f64::from(samples)) as f32];
        }
    }
    let name = layer_name(kind);
    for layer in 0..RANKS / 2 {
        for (channel, letter) in ["R", "G", "B", "A"].into_iter().enumerate() {
            let (rank, value) = (2 * layer + channel / 2, channel % 2);
            let values = ranked.iter().map(|ranked| ranked[rank][value]).collect();
            let name = format!("{name}{layer:02}.{letter}");
            picture.channels.push(ImageChannel { name, values: ChannelValues::Float(values) });
        }
    }
    picture.attributes.extend(attributes(name, &matte_ids.hashes));
}

/// Name prefix of the layers.
fn layer_name(kind: CryptomatteKind) -> &'static str {
    match kind {
        CryptomatteKind::Sphere => "CryptoSphere",
        CryptomatteKind::Material => "CryptoMaterial",
        CryptomatteKind::Table => "CryptoTable",
    }
}

/// The file attributes that describe the layers.
fn attributes(name: &str, hashes: &BTreeMap<String, u32>) -> Vec<(String, String)> {
    // The key is the first seven digits of the hash of the layer name.
    let key = &format!("{:08x}", cryptomatte_id(name))[..7];
    let mut attributes = vec![
        ("name", name.to_owned()),
        ("hash", "MurmurHash3_32".to_owned()),
        ("conversion", "uint32_to_float32".to_owned()),
    ];
    if hashes.len() <= MAX_MANIFEST_NAMES {
        let digits = hashes.iter().map(|(name, hash)| (name.clone(), format!("{hash:08x}").into()));
        attributes.push(("manifest", serde_json::Value::Object(digits.collect()).to_string()));
    }
    let full = |(end, text): (&str, String)| (format!("cryptomatte/{key}/{end}"), text);
    attributes.into_iter().map(full).collect()
}

/// Ids of the names used so far.
struct MatteIds<'a> {
    scene: &'a Scene,
    kind: CryptomatteKind,
    /// The id of each row.
    ids: HashMap<u32, u32>,
    /// The id of each name.
    hashes: BTreeMap<String, u32>,
}

impl MatteIds<'_> {
    /// The ids of a pixel with their sample counts, largest count first.
    fn ranked_coverage(&mut self, rows: &[(u32, u32)]) -> Vec<(u32, u32)> {
        let mut ranking: Vec<(u32, u32)> = Vec::new();
        for &(row, count) in rows.iter().filter(|(row, _)| *row != NO_ROW) {
            let id = self.id(row);
            match ranking.iter_mut().find(|(known, _)| *known == id) {
                Some((_, total)) => *total += count,
                None => ranking.push((id, count)),
            }
        }
        ranking.sort_by_key(|&(id, count)| (std::cmp::Reverse(count), id));
        ranking
    }

    fn id(&mut self, row: u32) -> u32 {
        if let Some(id) = self.ids.get(&row) {
            return *id;
        }
        let name = match self.kind {
            CryptomatteKind::Sphere => self.scene.name_of_row(row),
            CryptomatteKind::Material => {
                let material = self.scene.material_of_row(row);
                self.scene.description().materials[material].name.clone()
            }
            CryptomatteKind::Table => self.scene.table_of_row(row),
        };
        let id = cryptomatte_id(&name);
        self.hashes.insert(name, id);
        self.ids.insert(row, id);
        id
    }
}

/// The bits of the float that encodes a name: its hash, with one exponent bit flipped if the float
/// would be 0, denormal, infinite or NaN.
fn cryptomatte_id(name: &str) -> u32 {
    let hash = murmur3(name.as_bytes());
    match hash >> 23 & 0xff {
        0 | 0xff => hash ^ 1 << 23,
        _ => hash,
    }
}

/// MurmurHash3, 32 bits, seed 0 (A. Appleby, 2011, public domain).
fn murmur3(bytes: &[u8]) -> u32 {
    let mix = |word: u32| word.wrapping_mul(0xcc9e_2d51).rotate_left(15).wrapping_mul(0x1b87_3593);
    let words = bytes.chunks_exact(4);
    let tail = words.remainder().iter().rev().fold(0, |word, &byte| word << 8 | u32::from(byte));
    let hash = words.fold(0u32, |hash, word| {
        let word = u32::from_le_bytes([word[0], word[1], word[2], word[3]]);
        (hash ^ mix(word)).rotate_left(13).wrapping_mul(5).wrapping_add(0xe654_6b64)
    });
    let mut hash = hash ^ mix(tail) ^ bytes.len() as u32;
    hash = (hash ^ hash >> 16).wrapping_mul(0x85eb_ca6b);
    hash = (hash ^ hash >> 13).wrapping_mul(0xc2b2_ae35);
    hash ^ hash >> 16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hashes_are_those_of_others() {
        // Values from Python's `mmh3`.
        assert_eq!(murmur3(b""), 0);
        assert_eq!(murmur3(b"test"), 0xba6b_d213);
        assert_eq!(murmur3(b"Hello, world!"), 0xc036_3e43);
    }

    #[test]
    fn every_id_is_an_ordinary_float() {
        for number in 0..100_000 {
            let id = f32::from_bits(cryptomatte_id(&format!("spheres.{number}")));
            assert!(id.is_normal(), "{number}");
        }
    }
}
