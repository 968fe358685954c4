//! What `photosphere bench` found, for people and for programs.

use serde_json::{Map, Value, json};

use crate::accel::{Choice, Chosen};
use crate::verify::bench::page::Measured;
use crate::verify::bench::{BackendBench, Figure, Rates, Rounds, SECOND_BOUNCE, Swept, WholeBench};

use super::print;

/// What was measured.
pub(super) struct Report<'a> {
    pub(super) spheres: usize,
    pub(super) rounds: Rounds,
    pub(super) measured: &'a Measured,
}

impl Report<'_> {
    fn choice(&self) -> Chosen {
        Choice::Auto.choose_for(self.spheres)
    }

    pub(super) fn in_words(&self) -> String {
        let spheres = print::count(self.spheres, "sphere");
        let threads = print::count(rayon::current_num_threads(), "thread");
        let Rounds { count, batch } = self.rounds;
        let Chosen { backend, reason } = self.choice();
        let mut text = format!(
            "{spheres}, {threads}, {}; --accel auto takes {} ({reason})\n\n\
             {:<12}{:>10}{:>8}{:>18}\n",
            print::count(batch, "ray") + " a call",
            backend.name(),
            "",
            "build (s)",
            "+-",
            "bytes per sphere",
        );
        for result in &self.measured.results {
            text += &format!(
                "{:<12}{:>10.3}{:>8}{:>18.1}   {}\n",
                result.backend.name(),
                result.build_s.median,
                spread(result.build_s),
                result.bytes_per_sphere,
                result.details
            );
        }
        text += &format!(
            "\nrays per second of all threads: median of {}, and the spread of half of them\n",
            print::count(count, "round")
        );
        for (kind, name) in self.measured.kinds.iter().enumerate() {
            text += &head(name, "other ids");
            for result in &self.measured.results {
                text += &self.row(result, kind);
            }
        }
        text + &self.batches() + &self.scaling() + &self.renders()
    }

    /// One backend's rates for one kind of rays, and how they compare with the first backend's.
    fn row(&self, result: &BackendBench, kind: usize) -> String {
        let name = result.backend.name();
        let Some(rates) = result.rates[kind] else {
            return format!("{name:<14}{:>10}\n", "-");
        };
        let first = self.measured.results[0].rates[kind].unwrap_or(rates);
        let both = [(rates.closest, first.closest), (rates.occluded, first.occluded)];
        row(name, both, &rates.other_ids.to_string())
    }

    fn batches(&self) -> String {
        let mut text = String::new();
        for swept in &self.measured.batches {
            let setting =
                format!("{SECOND_BOUNCE} rays, {}", print::count(swept.setting.batch, "ray"));
            text += &format!("\n{setting} a call{}", head("", ""));
            text += &self.rows_of(swept, |_| swept.rates[0]);
        }
        text
    }

    fn scaling(&self) -> String {
        let Some(one) = self.measured.scaling.first() else { return String::new() };
        let mut text = String::new();
        for swept in &self.measured.scaling {
            let threads = print::count(swept.setting.threads, "thread");
            let gain = swept.arithmetic.median / one.arithmetic.median;
            text += &format!(
                "\n{SECOND_BOUNCE} rays, {threads}; ratios to one thread; that of pure arithmetic is \
                 {gain:.2}{}",
                head("", "")
            );
            text += &self.rows_of(swept, |backend| one.rates[backend]);
        }
        text
    }

    /// Rates under a setting, and for each backend what they are compared with.
    fn rows_of(&self, swept: &Swept, with: impl Fn(usize) -> [Figure; 2]) -> String {
        let backends = self.measured.results.iter().zip(&swept.rates).enumerate();
        let rows = backends.map(|(i, (result, [closest, occluded]))| {
            let with = with(i);
            row(result.backend.name(), [(*closest, with[0]), (*occluded, with[1])], "")
        });
        rows.collect()
    }

    fn renders(&self) -> String {
        let Some(first) = self.measured.renders.first() else { return String::new() };
        let mut text = format!(
            "\n{:<14}{:>10}{:>8}{:>8}{:>14}{:>12}{:>16}\n",
            "render", "seconds", "+-", "ratio", "intersector", "rays/s", "other pixels"
        );
        for render in &self.measured.renders {
            let Figure { median, .. } = render.seconds;
            text += &format!(
                "{:<14}{:>10}{:>8}{:>8.2}{:>14}{:>12}{:>16}\n",
                render.backend.name(),
                format!("{median:.3}"),
                spread(render.seconds),
                median / first.seconds.median,
                print::percent(render.inside.median),
                print::si(render.rays as f64 / median),
                render.other_pixels
            );
        }
        text
    }

    pub(super) fn in_json(&self) -> Value {
        let Chosen { backend: auto, reason } = self.choice();
        let Measured { results, batches, scaling, renders, .. } = self.measured;
        json!({
            "spheres": self.spheres,
            "threads": rayon::current_num_threads(),
            "rounds": self.rounds.count,
            "batch": self.rounds.batch,
            "auto": { "accel": auto.name(), "reason": reason },
            "backends": results.iter().map(|result| self.backend(result)).collect::<Vec<_>>(),
            "batches": batches.iter().map(|swept| self.swept(swept)).collect::<Vec<_>>(),
            "scaling": scaling.iter().map(|swept| self.swept(swept)).collect::<Vec<_>>(),
            "renders": renders.iter().map(whole).collect::<Vec<_>>(),
        })
    }

    fn backend(&self, result: &BackendBench) -> Value {
        let rates = |kind: usize| {
            result.rates[kind].map(|Rates { closest, occluded, other_ids }| {
                let (closest, occluded) = (rate(closest), rate(occluded));
                json!({ "closest": closest, "occluded": occluded, "other_ids": other_ids })
            })
        };
        let kinds = self.measured.kinds.iter().enumerate();
        let rays: Map<String, Value> =
            kinds.map(|(kind, name)| (name.replace(' ', "_"), json!(rates(kind)))).collect();
        json!({
            "accel": result.backend.name(),
            "details": result.details,
            "build_s": result.build_s.median,
            "build_spread": result.build_s.spread(),
            "bytes_per_sphere": result.bytes_per_sphere,
            "rays": rays,
        })
    }

    fn swept(&self, swept: &Swept) -> Value {
        let named = self.measured.results.iter().zip(&swept.rates);
        let rates: Map<String, Value> = named
            .map(|(result, [closest, occluded])| {
                let rates = json!({ "closest": rate(*closest), "occluded": rate(*occluded) });
                (result.backend.name().to_owned(), rates)
            })
            .collect();
        json!({
            "threads": swept.setting.threads,
            "batch": swept.setting.batch,
            "second_bounce": rates,
            "arithmetic_passes_per_s": swept.arithmetic.median,
        })
    }
}

fn head(name: &str, last: &str) -> String {
    format!(
        "\n{name:<14}{:>10}{:>8}{:>8}{:>12}{:>8}{:>8}{last:>12}\n",
        "closest", "+-", "ratio", "occluded", "+-", "ratio"
    )
}

/// Two rates, each with what it is compared with.
fn row(name: &str, rates: [(Figure, Figure); 2], last: &str) -> String {
    let [closest, occluded] = rates.map(|(rate, with)| {
        (print::si(rate.median), spread(rate), format!("{:.2}", rate.median / with.median))
    });
    format!(
        "{name:<14}{:>10}{:>8}{:>8}{:>12}{:>8}{:>8}{last:>12}",
        closest.0, closest.1, closest.2, occluded.0, occluded.1, occluded.2
    )
    .trim_end()
    .to_owned()
        + "\n"
}

fn spread(figure: Figure) -> String {
    format!("{:.0} %", 100.0 * figure.spread())
}

fn rate(rate: Figure) -> Value {
    json!({ "rays_per_s": rate.median, "spread": rate.spread() })
}

fn whole(render: &WholeBench) -> Value {
    json!({
        "accel": render.backend.name(),
        "seconds": render.seconds.median,
        "spread": render.seconds.spread(),
        "intersector_share": render.inside.median,
        "rays": render.rays,
        "samples": render.samples,
        "other_pixels": render.other_pixels,
    })
}
