//! The result of a standard scene in one sentence.

use crate::verify::bench::{BackendBench, QueryKind, SECOND_BOUNCE, SuiteEntry};

use super::digits::significant;

/// Compares the two fastest intersectors at the largest number of spheres.
pub(super) fn result_sentence(entries: &[&SuiteEntry]) -> String {
    let Some(entry) = entries.iter().max_by_key(|entry| entry.spheres) else {
        return String::new();
    };
    let [closest, occluded] = QueryKind::ALL.map(|query| ranking(entry, query));
    let Some(first) = closest.first() else { return String::new() };
    let mut text = format!(
        "With {} spheres, {} traces {} million {SECOND_BOUNCE} rays per second (closest hit){}",
        entry.spheres,
        first.0,
        significant(1e-6 * first.1),
        over_the_next(&closest)
    );
    if let Some((name, rate)) = occluded.first() {
        let who = if *name == first.0 { String::new() } else { format!("{name} ") };
        let millions = significant(1e-6 * rate);
        text += &format!("; occluded, {who}{millions} million{}", over_the_next(&occluded));
    }
    text + "."
}

/// Names and rates in rays per second, the fastest first.
fn ranking(entry: &SuiteEntry, query: QueryKind) -> Vec<(&'static str, f64)> {
    let set = entry.bench.ray_set_index(SECOND_BOUNCE);
    let rate = |result: &BackendBench| {
        let rates = result.rates.get(set?).copied().flatten()?;
        Some((result.backend.name(), rates.get(query).median))
    };
    let mut rates: Vec<_> = entry.bench.results.iter().filter_map(rate).collect();
    rates.sort_by(|a, b| b.1.total_cmp(&a.1));
    rates
}

fn over_the_next(ranking: &[(&str, f64)]) -> String {
    match ranking {
        [(_, first), (name, next), ..] => {
            format!(", {} times as many as {name}", significant(first / next))
        }
        _ => String::new(),
    }
}
