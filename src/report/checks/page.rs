//! Self-contained HTML report of a suite.

use crate::draw::Cells;
use crate::draw::page::{details, element, escape, facts, page_of, table};

use crate::verify::check::{CheckGroup, CheckResult, FAMILY_SIGNIFICANCE};
use crate::verify::closed_forms::{CLOSED_FORMS, ClosedForm};

use super::entry::CheckEntry;

/// The groups, those first that show the most to somebody who has not seen them before.
const READING_ORDER: [CheckGroup; CheckGroup::ALL.len()] = [
    CheckGroup::ClosedForms,
    CheckGroup::Connections,
    CheckGroup::Materials,
    CheckGroup::ChiSquare,
    CheckGroup::Crosscheck,
];

/// Renders the page. `about` comes first: what was checked, where and how.
pub fn page(about: &[(&str, String)], entries: &[CheckEntry<'_>]) -> String {
    let failed: Vec<CheckEntry<'_>> =
        entries.iter().copied().filter(|(_, result)| !result.passed).collect();
    let mut body = element("h1", "", "photosphere: verification report");
    body += &verdict(entries.len(), failed.len());
    body += &facts(about);
    body += &summary(entries);
    body += &how_to_read(entries);
    if !failed.is_empty() {
        body += &element("h2", "", "Failed checks");
        body += &failed.iter().map(entry_figures).collect::<String>();
    }
    for group in READING_ORDER {
        let group_entries: Vec<CheckEntry<'_>> =
            entries.iter().copied().filter(|(check, _)| check.group == group).collect();
        if !group_entries.is_empty() {
            body += &section(group, &group_entries);
        }
    }
    page_of("photosphere: verification report", &body)
}

fn verdict(total: usize, failed: usize) -> String {
    if failed == 0 {
        element("p", "class=verdict", &format!("All {total} checks passed."))
    } else {
        let text = format!("{failed} of {total} checks FAILED.");
        element("p", "class=\"verdict failed\"", &text)
    }
}

/// One row per group.
fn summary(entries: &[CheckEntry<'_>]) -> String {
    let row = |group: CheckGroup| {
        let group_entries: Vec<_> =
            entries.iter().filter(|(check, _)| check.group == group).collect();
        let passed = group_entries.iter().filter(|(_, result)| result.passed).count();
        let largest = group_entries.iter().map(|(_, result)| result).max_by(|a, b| {
            (a.statistic / a.limit.max(1.0)).total_cmp(&(b.statistic / b.limit.max(1.0)))
        })?;
        let link = format!("<a href=\"#{}\">{}</a>", anchor(group), group.name());
        let count = format!("{passed} of {}", group_entries.len());
        Some(vec![link, mark(passed == group_entries.len(), &count), statistic(largest)])
    };
    table(&["group", "passed", "largest statistic"], READING_ORDER.into_iter().filter_map(row))
}

fn how_to_read(entries: &[CheckEntry<'_>]) -> String {
    let limit = entries.iter().find(|(_, result)| result.is_random);
    let limit = limit.map_or(0.0, |(_, result)| result.limit);
    let text = format!(
        "Exact checks must have no errors. The statistic of a random check is in standard deviations \
         of a normal distribution (σ), corrected for the number of groups of pixels that a check compares; the \
         raw t of the whole picture and the largest of its groups stand beside it, in standard errors \
         that the seeds estimate. What a sample that no seed happens to have would explain is no error. In a correct program the statistic exceeds 2 σ in one check of 22, which is \
         no sign of an error. The limit of {limit:.2} σ keeps the probability that any of the {} checks \
         fails by chance at {FAMILY_SIGNIFICANCE} or less. A chance failure is a single check slightly \
         over its limit that passes with other samples (a quick or a full run in place of this one). A \
         real error is far beyond the limit, or recurs.",
        entries.len()
    );
    element("p", "class=soft", &text)
}

fn section(group: CheckGroup, entries: &[CheckEntry<'_>]) -> String {
    let heading = element("h2", &format!("id={}", anchor(group)), about(group));
    heading
        + &match group {
            CheckGroup::ClosedForms => {
                CLOSED_FORMS.iter().map(|form| closed_form(form, entries)).collect::<String>()
            }
            _ => {
                let all = format!("all {} checks", entries.len());
                details(&all, &listing(entries)) + &all_figures(entries)
            }
        }
}

fn anchor(group: CheckGroup) -> String {
    group.name().replace(' ', "-")
}

fn about(group: CheckGroup) -> &'static str {
    match group {
        CheckGroup::Crosscheck => "Intersectors against double-double arithmetic",
        CheckGroup::ChiSquare => "Sampling routines against their pdfs",
        CheckGroup::Materials => "Energy conservation and reciprocity of the materials",
        CheckGroup::Connections => "Connections over polished balls against chance",
        CheckGroup::ClosedForms => "Renders against closed-form solutions",
    }
}

/// A table of checks.
fn listing(entries: &[CheckEntry<'_>]) -> String {
    let row = |(check, result): &CheckEntry<'_>| {
        vec![mark(result.passed, &check.name), statistic(result), escape(&result.detail)]
    };
    table(&["check", "statistic", "figures"], entries.iter().map(row))
}

/// A closed form with its images, its derivation, and the variants rendered.
fn closed_form(form: &ClosedForm, entries: &[CheckEntry<'_>]) -> String {
    let is_of_form = |(check, _): &CheckEntry<'_>| check.closed_form == Some(form.name);
    let form_entries: Vec<CheckEntry<'_>> = entries.iter().copied().filter(is_of_form).collect();
    let Some((first, result)) = form_entries.first() else { return String::new() };
    let passed = form_entries.iter().filter(|(_, result)| result.passed).count();
    let count = format!("{passed} of {} variants", form_entries.len());
    let mut text = element("h3", "", &escape(form.title));
    text += &element(
        "p",
        "",
        &format!(
            "<code>{}</code><br>{} <span class=soft>({})</span>",
            escape(form.formula),
            mark(passed == form_entries.len(), &count),
            escape(&format!("scenes/verify/{}.toml", form.name)),
        ),
    );
    let figures: String = result.images.iter().map(Cells::figure).collect();
    let caption = format!(
        "Images of {}: {}<br>{}",
        escape(&first.name),
        escape(&result.detail),
        statistic(result)
    );
    text += &element("div", "", &figures);
    text += &element("p", "class=soft", &caption);
    text += &details("the derivation", &element("pre", "", &escape(&derivation(form))));
    text + &details("all variants", &listing(&form_entries))
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
fn all_figures(entries: &[CheckEntry<'_>]) -> String {
    let with_images = entries.iter().filter(|(_, result)| !result.images.is_empty());
    let figures: String = with_images.map(entry_figures).collect();
    if figures.is_empty() { figures } else { details("images", &figures) }
}

fn entry_figures((check, result): &CheckEntry<'_>) -> String {
    let figures: String = result.images.iter().map(Cells::figure).collect();
    let text = format!(
        "{}<br>{} <span class=soft>{}</span>",
        mark(result.passed, &check.name),
        statistic(result),
        escape(&result.detail)
    );
    element("p", "", &text) + &element("div", "", &figures)
}

/// Marks a text as success or failure, with a sign besides the colour.
fn mark(passed: bool, text: &str) -> String {
    let (class, sign) = if passed { ("good", "✓") } else { ("bad", "✗") };
    format!("<span class={class}>{sign}</span> {}", escape(text))
}

/// The statistic with a bar up to its limit.
fn statistic(result: &CheckResult) -> String {
    let CheckResult { statistic, limit, is_random, .. } = result;
    if !is_random {
        return format!("<span class=nobr>{statistic:.0} errors</span>");
    }
    let share = 100.0 * (statistic / limit).min(1.0);
    let class = if statistic > limit { "bar over" } else { "bar" };
    format!(
        "<span class=nobr><span class=\"{class}\"><i style=\"width:{share:.0}%\"></i></span>\
         {statistic:.2} σ of {limit:.2}</span>"
    )
}
