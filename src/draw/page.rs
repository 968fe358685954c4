//! HTML elements, tables and self-contained pages. SVG uses the same elements.

const STYLE: &str = include_str!("style.css");

/// Creates a complete, self-contained page.
pub fn page_of(title: &str, body: &str) -> String {
    let head = element("title", "", &escape(title))
        + &element("style", "", STYLE)
        + "<meta name=viewport content=\"width=device-width, initial-scale=1\">\n";
    format!(
        "<!doctype html>\n<html lang=en>\n<meta charset=utf-8>\n{head}<body>\n{body}</body>\n</html>\n"
    )
}

/// Escapes text for HTML.
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            _ => escaped.push(c),
        }
    }
    escaped
}

/// Wraps markup in an element.
pub fn element(tag: &str, attributes: &str, inner: &str) -> String {
    let space = if attributes.is_empty() { "" } else { " " };
    format!("<{tag}{space}{attributes}>{inner}</{tag}>\n")
}

/// Creates a table from header texts and cell markup.
pub fn table(head: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let head: String = head.iter().map(|word| element("th", "", &escape(word))).collect();
    let row = |cells: Vec<String>| {
        let cells: String = cells.iter().map(|cell| element("td", "", cell)).collect();
        element("tr", "", &cells)
    };
    let rows: String = rows.map(row).collect();
    let inner = element("thead", "", &element("tr", "", &head)) + &element("tbody", "", &rows);
    element("div", "class=scroll", &element("table", "", &inner))
}

/// Creates a table of names and values, without a header.
pub fn facts(facts: &[(&str, String)]) -> String {
    let fact = |(name, value): &(&str, String)| vec![escape(name), escape(value)];
    table(&[], facts.iter().map(fact))
}

/// Creates a collapsed section with a summary.
pub fn details(summary: &str, inner: &str) -> String {
    element("details", "", &(element("summary", "", summary) + inner))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_in_a_text_is_shown_and_not_obeyed() {
        assert_eq!(escape("a<b> & \"c\""), "a&lt;b&gt; &amp; &quot;c&quot;");
        assert_eq!(element("p", "", "x"), "<p>x</p>\n");
        let table = table(&["<"], [vec!["<b>x</b>".to_owned()]].into_iter());
        assert!(table.contains("<th>&lt;</th>") && table.contains("<td><b>x</b></td>"));
    }
}
