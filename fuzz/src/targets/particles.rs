//! Particle files. A file that is read has as many values in each column as it has particles, all
//! positions are finite, and a survey agrees; one that is not read has a message.

use std::path::Path;

use photosphere::particles::{Format, Particles, ReadRequest, read_bytes, survey_bytes};

/// Bytes that a reader may take, more than any input of a fuzzer needs.
const MEMORY: u64 = 256 << 20;

/// Reads bytes as a format, or as what they look like. Returns true if they are accepted.
pub fn read(format: Option<Format>, input: &[u8]) -> bool {
    let request = ReadRequest { format, memory_limit: Some(MEMORY), ..ReadRequest::default() };
    let name = Path::new("input");
    let survey = survey_bytes(name, input, &request);
    if let Err(error) = &survey {
        assert!(!error.to_string().is_empty());
    }
    match read_bytes(name, input, &request) {
        Ok(particles) => {
            check(&particles);
            let survey = survey.expect("what is read can be surveyed");
            let count = particles.len() as u64;
            // Alternate locations are left out.
            assert!(survey.count.is_none_or(|told| told == count));
            true
        }
        Err(error) => {
            assert!(error.to_string().contains("input"), "{error}");
            false
        }
    }
}

fn check(particles: &Particles) {
    let rows = particles.len();
    for row in 0..rows {
        assert!(particles.positions.get(row).is_finite());
    }
    for column in &particles.columns {
        assert_eq!(column.data.len(), rows, "{}", column.name);
        if rows > 0 {
            column.data.show(rows - 1);
        }
        if let Some([low, high]) = column.range() {
            assert!(low <= high);
        }
    }
}
