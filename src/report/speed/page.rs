//! Draws benchmark results: one scene as bars, the standard scenes as a page.

use std::fmt;

use crate::draw::page::{details, element, escape, facts, page_of, table};
use crate::draw::text::count;
use crate::draw::{Axes, Bar, BarGroup, Course, Line, Mark, Panel, Value, bars, lines};
use crate::error::Result;
use crate::generate::Arrangement;

use super::digits::significant;
use super::sentence::result_sentence;

use crate::verify::bench::{
    BackendBench, Quartiles, QueryKind, RenderBench, SECOND_BOUNCE, SceneBench, SuiteEntry,
    SweepResult,
};

impl fmt::Display for QueryKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Closest => "closest hit",
            Self::Occluded => "occluded",
        })
    }
}

/// Converts a figure to a value of a drawing.
impl From<Quartiles> for Value {
    fn from(Quartiles { median, low, high }: Quartiles) -> Self {
        Self { middle: median, low, high }
    }
}

impl SceneBench {
    /// Draws all figures as bars.
    ///
    /// # Errors
    /// If the drawing fails.
    pub fn to_svg(&self, title: &str, subtitle: &str) -> Result<String> {
        let mut groups = self.ray_set_groups();
        for sweep_result in &self.batch_sweep {
            let rays = count(sweep_result.point.batch, "ray");
            groups.extend(self.sweep_groups(sweep_result, &format!("{rays} a call")));
        }
        for sweep_result in &self.thread_sweep {
            groups.extend(
                self.sweep_groups(sweep_result, &count(sweep_result.point.threads, "thread")),
            );
        }
        let render_bar = |render: &RenderBench| Bar {
            name: render.backend.name().to_owned(),
            value: render.seconds.into(),
            words: format!("{} s", significant(render.seconds.median)),
            color: render.backend as usize,
        };
        let render_bars = self.renders.iter().map(render_bar).collect();
        groups.push(BarGroup { name: "render, seconds".to_owned(), bars: render_bars });
        groups.retain(|group| !group.bars.is_empty());
        bars(title, subtitle, &groups)
    }

    fn ray_set_groups(&self) -> Vec<BarGroup> {
        let group = |(set, query): (usize, QueryKind)| {
            let rate = |result: &BackendBench| Some(result.rates[set]?.get(query));
            let name = format!("{} rays, {query}", self.ray_sets[set]);
            self.group(name, &self.results.iter().map(rate).collect::<Vec<_>>())
        };
        let ray_sets = 0..self.ray_sets.len();
        ray_sets.flat_map(|set| QueryKind::ALL.map(|query| group((set, query)))).collect()
    }

    fn sweep_groups(&self, sweep_result: &SweepResult, setting: &str) -> [BarGroup; 2] {
        QueryKind::ALL.map(|query| {
            let rate = |rates: &[Quartiles; 2]| Some(rates[query as usize]);
            let name = format!("{SECOND_BOUNCE} rays, {query}, {setting}");
            self.group(name, &sweep_result.rates.iter().map(rate).collect::<Vec<_>>())
        })
    }

    /// Rates of the intersectors, where known.
    fn group(&self, name: String, rates: &[Option<Quartiles>]) -> BarGroup {
        let bar = |(result, rate): (&BackendBench, &Option<Quartiles>)| {
            let value = (*rate)?;
            let words = format!("{} M rays/s", significant(value.median / 1e6));
            let name = result.backend.name().to_owned();
            Some(Bar { name, value: value.into(), words, color: result.backend as usize })
        };
        let bars = self.results.iter().zip(rates).filter_map(bar).collect();
        BarGroup { name, bars }
    }
}

const HOW_TO_READ: &str = "Rays per second over all threads, against the number of spheres. \
    Intersectors are interleaved, so that other load on the machine affects all of them equally; each \
    figure is the median over the rounds, and the thin line is the interquartile range. Second-bounce \
    rays come first: they are incoherent, so caches do not help. Compare only figures of one page.";

/// Renders one page with all results; `about` comes first.
///
/// # Errors
/// If a drawing fails.
pub fn page(about: &[(&str, String)], entries: &[SuiteEntry]) -> Result<String> {
    let title = "photosphere: speed of the intersectors";
    let mut body = element("h1", "", title);
    body += &facts(about);
    body += &element("p", "class=soft", HOW_TO_READ);
    let charts = Charts::of(entries);
    for &(name, arrangement) in Arrangement::NAMES {
        let scene_entries: Vec<&SuiteEntry> =
            entries.iter().filter(|entry| entry.arrangement == arrangement).collect();
        if !scene_entries.is_empty() {
            body += &element("h2", "", name);
            body += &element("p", "class=verdict", &escape(&result_sentence(&scene_entries)));
            body += &charts.section(&scene_entries)?;
            body += &element("div", "class=\"scroll figures\"", &figures(&scene_entries));
        }
    }
    Ok(page_of(title, &body))
}

/// Returns a figure of an intersector on a scene, if there is one.
type FigureOf<'a> = &'a dyn Fn(&SuiteEntry, &BackendBench) -> Option<Quartiles>;

/// Lines of a value against the number of spheres, one per intersector.
fn lines_of(entries: &[&SuiteEntry], value: FigureOf<'_>) -> Vec<Line> {
    let mut chart_lines: Vec<Line> = Vec::new();
    for entry in entries {
        for result in &entry.bench.results {
            let Some(y) = value(entry, result) else { continue };
            // A value of zero, such as the size of the brute-force tree, has no place on a
            // logarithmic axis.
            if y.median <= 0.0 {
                continue;
            }
            let mark = Mark { x: Value::exact(entry.spheres as f64), y: y.into() };
            let name = result.backend.name();
            match chart_lines.iter_mut().find(|line| line.name == name) {
                Some(line) => line.marks.push(mark),
                None => {
                    let color = result.backend as usize;
                    let (name, marks, course) = (name.to_owned(), vec![mark], Course::Through);
                    chart_lines.push(Line { name, marks, course, color });
                }
            }
        }
    }
    chart_lines
}

fn millions(
    set: &str,
    query: QueryKind,
) -> impl Fn(&SuiteEntry, &BackendBench) -> Option<Quartiles> {
    move |entry, result| {
        Some(result.rates[entry.bench.ray_set_index(set)?]?.get(query).scaled(1e-6))
    }
}

fn build_seconds(_: &SuiteEntry, result: &BackendBench) -> Option<Quartiles> {
    (result.bytes_per_sphere > 0.0).then_some(result.build_s)
}

fn bytes(_: &SuiteEntry, result: &BackendBench) -> Option<Quartiles> {
    Some(Quartiles::from_single(result.bytes_per_sphere))
}

/// Axes that the charts of all scenes share.
struct Charts {
    ray_sets: Vec<&'static str>,
    rates: Option<Axes>,
    build: Option<Axes>,
    bytes: Option<Axes>,
}

impl Charts {
    fn of(entries: &[SuiteEntry]) -> Self {
        let all: Vec<&SuiteEntry> = entries.iter().collect();
        let ray_sets = entries.first().map_or(Vec::new(), |entry| entry.bench.ray_sets.clone());
        let mut rates = Vec::new();
        for set in &ray_sets {
            rates.extend(QueryKind::ALL.map(|q| lines_of(&all, &millions(set, q))));
        }
        let axes = |name, lines: &[Vec<Line>]| {
            let marks = lines.iter().flatten().flat_map(|line| &line.marks);
            let (xs, ys) = (marks.clone().map(|m| m.x.middle), marks.map(|m| m.y.middle));
            Axes::around(["spheres", name], xs, ys)
        };
        Self {
            ray_sets,
            rates: axes("million rays per second", &rates),
            build: axes("seconds", &[lines_of(&all, &build_seconds)]),
            bytes: axes("bytes per sphere", &[lines_of(&all, &bytes)]),
        }
    }

    /// All charts of a scene: two kinds of figures visible, the rest collapsed.
    fn section(&self, entries: &[&SuiteEntry]) -> Result<String> {
        let mut visible = String::new();
        let mut collapsed = String::new();
        for &set in &self.ray_sets {
            let text = if set == SECOND_BOUNCE { &mut visible } else { &mut collapsed };
            for query in QueryKind::ALL {
                let title = format!("{set} rays, {query}");
                *text += &chart(&title, &self.rates, entries, &millions(set, query))?;
            }
        }
        visible += &chart("build", &self.build, entries, &build_seconds)?;
        visible += &chart("memory", &self.bytes, entries, &bytes)?;
        let pairs = |charts: &str| element("div", "class=pairs", charts);
        Ok(pairs(&visible) + &details("other rays", &pairs(&collapsed)))
    }
}

/// Returns an empty string if there is nothing to draw.
fn chart(
    title: &str,
    axes: &Option<Axes>,
    entries: &[&SuiteEntry],
    value: FigureOf<'_>,
) -> Result<String> {
    let chart_lines = lines_of(entries, value);
    match axes {
        Some(axes) if !chart_lines.is_empty() => {
            lines(title, &Panel { axes: axes.clone(), lines: chart_lines })
        }
        _ => Ok(String::new()),
    }
}

/// Placeholder for a missing figure.
const MISSING: &str = "–";

/// Table of all figures.
fn figures(entries: &[&SuiteEntry]) -> String {
    let ray_sets = entries.first().map_or(&[][..], |entry| &entry.bench.ray_sets);
    let mut header = vec!["spheres", "intersector", "build (s)", "bytes per sphere"];
    header.extend(ray_sets);
    header.extend(["other ids", "details"]);
    let rows = entries.iter().flat_map(|entry| {
        entry.bench.results.iter().map(|result| {
            let mut row = vec![
                entry.spheres.to_string(),
                escape(result.backend.name()),
                build_seconds(entry, result).map_or(MISSING.to_owned(), |s| significant(s.median)),
                significant(result.bytes_per_sphere),
            ];
            row.extend(result.rates.iter().map(|rates| {
                rates.map_or(MISSING.to_owned(), |rates| {
                    let [closest, occluded] =
                        QueryKind::ALL.map(|query| significant(1e-6 * rates.get(query).median));
                    format!("{closest} / {occluded}")
                })
            }));
            row.extend([differing_ids(result), escape(&result.details)]);
            row
        })
    });
    let unit = "Rates in millions of rays per second, closest hit / occluded.";
    element("p", "class=soft", unit) + &table(&header, rows)
}

/// Number of compared rays whose hit id differs from the first intersector's.
fn differing_ids(result: &BackendBench) -> String {
    result.rates.iter().flatten().map(|rates| rates.differing_ids).sum::<usize>().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::Backend;
    use crate::verify::bench::{Rates, SweepPoint};

    fn figure(median: f64) -> Quartiles {
        Quartiles::from_single(median)
    }

    fn result(backend: Backend, median: f64) -> BackendBench {
        let (closest, occluded) = (figure(median), figure(2.0 * median));
        BackendBench {
            backend,
            details: "a <tree>".into(),
            build_s: figure(0.01234),
            bytes_per_sphere: 34.56,
            rates: vec![Some(Rates { closest, occluded, differing_ids: 3 }), None],
        }
    }

    fn measured(median: f64) -> SceneBench {
        let results =
            vec![result(Backend::Native, median), result(Backend::BruteForce, median / 10.0)];
        SceneBench { ray_sets: vec![SECOND_BOUNCE, "shadow"], results, ..Default::default() }
    }

    #[test]
    fn a_scene_is_drawn_with_every_figure_that_there_is() {
        let rates = vec![[figure(4e6), figure(5e6)]; 2];
        let setting = SweepPoint { threads: 2, batch: 1 };
        let sweep_result = vec![SweepResult { point: setting, rates, arithmetic: figure(1.0) }];
        let render = RenderBench {
            backend: Backend::Native,
            seconds: figure(12.34),
            intersector_fraction: figure(0.9),
            rays: 1,
            samples: 1,
            differing_pixels: 0,
        };
        let measured = SceneBench {
            batch_sweep: sweep_result.clone(),
            thread_sweep: sweep_result,
            renders: vec![render],
            ..measured(1.5e6)
        };
        let svg = measured.to_svg("a scene", "3 spheres").unwrap();
        for text in [
            "second bounce rays, closest hit",
            "native",
            "1.50 M rays/s",
            "0.300 M rays/s",
            "occluded, 1 ray a call",
            "occluded, 2 threads",
            "5.00 M rays/s",
            "12.3 s",
        ] {
            assert!(svg.contains(text), "{text}");
        }
        assert!(!svg.contains("shadow"), "there were no such rays");
    }

    #[test]
    fn the_page_has_a_chart_for_each_figure_and_stands_alone() {
        let entry = |spheres: u64| SuiteEntry {
            arrangement: Arrangement::Gas,
            spheres,
            bench: measured(1e9 / spheres as f64),
        };
        let facts = [("processor", "a & b".to_owned())];
        let page = page(&facts, &[entry(3), entry(100), entry(1000)]).unwrap();
        assert_eq!(page.matches("<svg").count(), 4);
        for text in ["<h2>gas</h2>", "a &amp; b", "0.0123", "34.6", "a &lt;tree&gt;", "<!doctype"] {
            assert!(page.contains(text), "{text}");
        }
        assert!(page.contains("1.00 / 2.00"), "a cell of the table");
        assert!(!page.contains("clusters"), "nothing was measured of them");
        let sentence = "With 1000 spheres, native traces 1.00 million second bounce rays per second \
                        (closest hit), 10.0 times as many as brute-force; occluded, 2.00 million, \
                        10.0 times as many as brute-force.";
        assert!(page.contains(sentence), "the result in words");
    }
}
