//! What was measured by [`super::bench`], drawn: one scene as bars, and the standard scenes as a page.

use crate::error::Result;
use crate::generate::Arrangement;

use super::bench::{BackendBench, Rate, RayKind};
use super::chart::{Bar, Group, Line, bars, lines};
use super::report::html::{element, escape, page_of, table};

/// One standard scene, and what was measured on it.
#[derive(Clone, Debug)]
pub struct Entry {
    /// How its spheres are arranged.
    pub arrangement: Arrangement,
    /// How many there are.
    pub spheres: u64,
    /// What the kinds of rays are called.
    pub kinds: Vec<&'static str>,
    /// One for each intersector.
    pub results: Vec<BackendBench>,
}

/// A question that rays are asked with, and how its rate is found.
const QUESTIONS: [(&str, fn(&super::bench::Rates) -> Rate); 2] =
    [("closest hit", |rates| rates.closest), ("occluded", |rates| rates.occluded)];

/// Draws what was measured on one scene.
///
/// # Errors
/// When the drawing fails.
pub fn drawing(
    title: &str,
    subtitle: &str,
    kinds: &[RayKind],
    results: &[BackendBench],
) -> Result<String> {
    let group = |kind: usize, (question, rate): (&str, fn(&super::bench::Rates) -> Rate)| {
        let bar = |(color, result): (usize, &BackendBench)| {
            let Rate { median, spread } = rate(result.rates[kind].as_ref()?);
            let words = format!("{} M rays/s", significant(median / 1e6));
            let name = result.backend.name().to_owned();
            Some(Bar { name, value: median, spread, words, color })
        };
        let name = format!("{} rays, {question}", kinds[kind].name);
        Group { name, bars: results.iter().enumerate().filter_map(bar).collect() }
    };
    let groups: Vec<Group> = (0..kinds.len())
        .flat_map(|kind| QUESTIONS.map(|question| group(kind, question)))
        .filter(|group| !group.bars.is_empty())
        .collect();
    bars(title, subtitle, &groups)
}

/// One page of all that was measured; `facts` are told first.
///
/// # Errors
/// When a drawing fails.
pub fn page(facts: &[(&str, String)], entries: &[Entry]) -> Result<String> {
    let title = "photosphere: speed of the intersectors";
    let mut body = element("h1", "", title);
    let fact = |(name, value): &(&str, String)| vec![escape(name), escape(value)];
    body += &table(&["", ""], facts.iter().map(fact)).replace("<th></th>\n", "");
    body += &element("p", "class=soft", HOW_TO_READ);
    for (name, arrangement) in Arrangement::NAMES {
        let of_scene: Vec<&Entry> =
            entries.iter().filter(|entry| entry.arrangement == arrangement).collect();
        if let Some(first) = of_scene.first() {
            body += &element("h2", "", name);
            for kind in 0..first.kinds.len() {
                for question in QUESTIONS {
                    body += &plot(&of_scene, kind, question)?;
                }
            }
            body += &figures(&of_scene);
        }
    }
    Ok(page_of(title, &body))
}

const HOW_TO_READ: &str = "Rays per second of all threads together, against the number of spheres. \
    Intersectors take turns, so that a busy machine hinders all alike; each figure is the median over \
    the rounds. Compare figures of one page only.";

/// One kind of rays and question against the number of spheres; nothing where there are no such rays.
fn plot(
    entries: &[&Entry],
    kind: usize,
    (question, rate): (&str, fn(&super::bench::Rates) -> Rate),
) -> Result<String> {
    let mut drawn: Vec<Line> = Vec::new();
    for entry in entries {
        for result in &entry.results {
            let Some(rates) = &result.rates[kind] else { continue };
            let point = (entry.spheres as f64, rate(rates).median);
            let name = result.backend.name();
            match drawn.iter_mut().find(|line| line.name == name) {
                Some(line) => line.points.push(point),
                None => {
                    let color = drawn.len();
                    drawn.push(Line { name: name.to_owned(), points: vec![point], color });
                }
            }
        }
    }
    if drawn.is_empty() {
        return Ok(String::new());
    }
    let title = format!("{} rays, {question}", entries[0].kinds[kind]);
    lines(&title, "spheres", "rays per second", &drawn)
}

/// Build times and memory.
fn figures(entries: &[&Entry]) -> String {
    let rows = entries.iter().flat_map(|entry| {
        entry.results.iter().map(|result| {
            vec![
                entry.spheres.to_string(),
                escape(result.backend.name()),
                significant(result.build_s),
                significant(result.bytes_per_sphere),
                other_ids(result),
                escape(&result.details),
            ]
        })
    });
    let head =
        ["spheres", "intersector", "build (s)", "bytes per sphere", "other ids", "how it works"];
    table(&head, rows)
}

/// How many of the rays that were compared have another id than with the first intersector.
fn other_ids(result: &BackendBench) -> String {
    result.rates.iter().flatten().map(|rates| rates.other_ids).sum::<usize>().to_string()
}

/// Three significant digits.
fn significant(value: f64) -> String {
    let digits = if value > 0.0 { 2 - libm::log10(value).floor() as i32 } else { 0 };
    format!("{value:.*}", digits.clamp(0, 9) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::Backend;
    use crate::verify::bench::Rates;

    fn result(backend: Backend, median: f64) -> BackendBench {
        let rate = |factor: f64| Rate { median: factor * median, spread: 0.05 };
        let rates = Rates { closest: rate(1.0), occluded: rate(2.0), other_ids: 3 };
        BackendBench {
            backend,
            details: "a <tree>".into(),
            build_s: 0.01234,
            bytes_per_sphere: 34.56,
            rates: vec![Some(rates), None],
        }
    }

    fn results(median: f64) -> Vec<BackendBench> {
        vec![result(Backend::Native, median), result(Backend::BruteForce, median / 10.0)]
    }

    #[test]
    fn a_scene_is_drawn_with_every_figure_that_there_is() {
        let kinds = ["camera", "shadow"].map(|name| RayKind { name, rays: Vec::new() });
        let svg = drawing("a scene", "3 spheres", &kinds, &results(1.5e6)).unwrap();
        for text in ["camera rays, closest hit", "native", "1.50 M rays/s", "0.300 M rays/s"] {
            assert!(svg.contains(text), "{text}");
        }
        assert!(!svg.contains("shadow"), "there were no such rays");
    }

    #[test]
    fn the_page_has_a_plot_for_each_kind_and_question_and_stands_alone() {
        let entry = |spheres: u64| Entry {
            arrangement: Arrangement::Gas,
            spheres,
            kinds: vec!["camera", "shadow"],
            results: results(1e9 / spheres as f64),
        };
        let facts = [("processor", "a & b".to_owned())];
        let page = page(&facts, &[entry(3), entry(100), entry(1000)]).unwrap();
        assert_eq!(page.matches("<svg").count(), 2);
        for text in ["<h2>gas</h2>", "a &amp; b", "0.0123", "34.6", "a &lt;tree&gt;", "<!doctype"] {
            assert!(page.contains(text), "{text}");
        }
        assert!(!page.contains("clusters"), "nothing was measured of them");
    }

    #[test]
    fn figures_have_three_digits() {
        let shown = [0.0, 0.001_234, 9.876, 123.4, 98_765.0].map(significant);
        assert_eq!(shown, ["0", "0.00123", "9.88", "123", "98765"]);
    }
}
