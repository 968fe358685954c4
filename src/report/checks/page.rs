//! Self-contained HTML report of a suite.

use crate::draw::Cells;
use crate::draw::page::{details, element, escape, facts, page_of, table};

use crate::verify::check::{CheckGroup, CheckResult, FAMILY_SIGNIFICANCE};
use crate::verify::closed_forms::{CLOSED_FORMS, ClosedForm};

use super::entry::CheckEntry;

/// Renders the page. `about` comes first: what was checked, where and how.
pub fn page(about: &[(&str, String)], judged: &[CheckEntry<'_>]) -> String {
    let failed: Vec<CheckEntry<'_>> =
        judged.iter().copied().filter(|(_, outcome)| !outcome.passed).collect();
    let mut body = element("h1", "", "photosphere: verification report");
    body += &verdict(judged.len(), failed.len());
    body += &facts(about);
    body += &summary(judged);
    body += &how_to_read(judged);
    if !failed.is_empty() {
        body += &element("h2", "", "What failed");
        body += &failed.iter().map(with_pictures).collect::<String>();
    }
    for group in CheckGroup::ALL {
        let of_group: Vec<CheckEntry<'_>> =
            judged.iter().copied().filter(|(check, _)| check.group == group).collect();
        if !of_group.is_empty() {
            body += &section(group, &of_group);
        }
    }
    page_of("photosphere: verification report", &body)
}

fn verdict(total: usize, failed: usize) -> String {
    if failed == 0 {
        element("p", "class=verdict", &format!("All {total} checks passed."))
    } else {
        let words = format!("{failed} of {total} checks FAILED.");
        element("p", "class=\"verdict failed\"", &words)
    }
}

/// One row per group.
fn summary(judged: &[CheckEntry<'_>]) -> String {
    let row = |group: CheckGroup| {
        let of_group: Vec<_> = judged.iter().filter(|(check, _)| check.group == group).collect();
        let passed = of_group.iter().filter(|(_, outcome)| outcome.passed).count();
        let largest = of_group.iter().map(|(_, outcome)| outcome).max_by(|a, b| {
            (a.statistic / a.limit.max(1.0)).total_cmp(&(b.statistic / b.limit.max(1.0)))
        })?;
        let link = format!("<a href=\"#{}\">{}</a>", anchor(group), group.name());
        let count = format!("{passed} of {}", of_group.len());
        Some(vec![link, mark(passed == of_group.len(), &count), statistic(largest)])
    };
    table(&["group", "passed", "largest statistic"], CheckGroup::ALL.into_iter().filter_map(row))
}

fn how_to_read(judged: &[CheckEntry<'_>]) -> String {
    let limit = judged.iter().find(|(_, outcome)| outcome.is_random);
    let limit = limit.map_or(0.0, |(_, outcome)| outcome.limit);
    let words = format!(
        "What is exact must have no wrong answer. What is random is judged by how far off it is, in \
         standard deviations of a normal distribution (σ): a right program is beyond 2 σ in one \
         check of 22, and that is no sign of an error. The limit of {limit:.2} σ makes the whole \
         family of {} checks fail by chance with a probability of at most {FAMILY_SIGNIFICANCE}. A \
         failure by chance would be a single check a little over the limit; with other samples \
         (a quick or a full run in place of this one) it would not come back. An error is far beyond the \
         limit, or comes back.",
        judged.len()
    );
    element("p", "class=soft", &words)
}

fn section(group: CheckGroup, judged: &[CheckEntry<'_>]) -> String {
    let heading = element("h2", &format!("id={}", anchor(group)), about(group));
    heading
        + &match group {
            CheckGroup::ClosedForms => {
                CLOSED_FORMS.iter().map(|form| closed_form(form, judged)).collect::<String>()
            }
            _ => listing(judged) + &all_pictures(judged),
        }
}

fn anchor(group: CheckGroup) -> String {
    group.name().replace(' ', "-")
}

fn about(group: CheckGroup) -> &'static str {
    match group {
        CheckGroup::Crosscheck => "Intersectors against arithmetic of twice the digits",
        CheckGroup::ChiSquare => "Sampling routines against their densities",
        CheckGroup::Materials => "Energy and reciprocity of the materials",
        CheckGroup::ClosedForms => "Renders against answers known on paper",
    }
}

/// A table of checks.
fn listing(judged: &[CheckEntry<'_>]) -> String {
    let row = |(check, outcome): &CheckEntry<'_>| {
        vec![mark(outcome.passed, &check.name), statistic(outcome), escape(&outcome.detail)]
    };
    table(&["check", "statistic", "figures"], judged.iter().map(row))
}

/// A closed form with its images, its derivation, and the variants rendered.
fn closed_form(form: &ClosedForm, judged: &[CheckEntry<'_>]) -> String {
    let is_of_form = |(check, _): &CheckEntry<'_>| check.closed_form == Some(form.name);
    let of_form: Vec<CheckEntry<'_>> = judged.iter().copied().filter(is_of_form).collect();
    let Some((first, outcome)) = of_form.first() else { return String::new() };
    let passed = of_form.iter().filter(|(_, outcome)| outcome.passed).count();
    let count = format!("{passed} of {} ways", of_form.len());
    let mut text = element("h3", "", &escape(form.title));
    text += &element(
        "p",
        "",
        &format!(
            "<code>{}</code><br>{} <span class=soft>({})</span>",
            escape(form.formula),
            mark(passed == of_form.len(), &count),
            escape(&format!("scenes/verify/{}.toml", form.name)),
        ),
    );
    let figures: String = outcome.images.iter().map(Cells::figure).collect();
    let shown = format!(
        "The pictures are those of {}: {}<br>{}",
        escape(&first.name),
        escape(&outcome.detail),
        statistic(outcome)
    );
    text += &element("div", "", &figures);
    text += &element("p", "class=soft", &shown);
    text += &details("the derivation", &element("pre", "", &escape(&derivation(form))));
    text + &details("every way", &listing(&of_form))
}

/// The comments at the head of the scene file.
fn derivation(form: &ClosedForm) -> String {
    let lines = form.scene_toml.lines().take_while(|line| line.starts_with('#'));
    lines
        .map(|line| line.trim_start_matches("# ").trim_start_matches('#'))
        .collect::<Vec<_>>()
        .join("\n")
}

/// The images of all checks that have some, collapsed.
fn all_pictures(judged: &[CheckEntry<'_>]) -> String {
    let seen = judged.iter().filter(|(_, outcome)| !outcome.images.is_empty());
    let each: String = seen.map(with_pictures).collect();
    if each.is_empty() { each } else { details("pictures", &each) }
}

fn with_pictures((check, outcome): &CheckEntry<'_>) -> String {
    let figures: String = outcome.images.iter().map(Cells::figure).collect();
    let words = format!(
        "{}<br>{} <span class=soft>{}</span>",
        mark(outcome.passed, &check.name),
        statistic(outcome),
        escape(&outcome.detail)
    );
    element("p", "", &words) + &element("div", "", &figures)
}

/// Marks a text as success or failure, with a sign besides the colour.
fn mark(passed: bool, text: &str) -> String {
    let (class, sign) = if passed { ("good", "✓") } else { ("bad", "✗") };
    format!("<span class={class}>{sign}</span> {}", escape(text))
}

/// The statistic with a bar up to its limit.
fn statistic(outcome: &CheckResult) -> String {
    let CheckResult { statistic, limit, is_random, .. } = outcome;
    if !is_random {
        return format!("<span class=nobr>{statistic:.0} wrong</span>");
    }
    let share = 100.0 * (statistic / limit).min(1.0);
    let class = if statistic > limit { "bar over" } else { "bar" };
    format!(
        "<span class=nobr><span class=\"{class}\"><i style=\"width:{share:.0}%\"></i></span>\
         {statistic:.2} σ of {limit:.2}</span>"
    )
}
