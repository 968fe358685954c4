//! Numbers and tables in plain text.

use std::fmt::Display;

use super::printable::printable_line;

/// Formats a table row. Each column has a width in characters: positive aligns right, negative
/// left. Longer cells shift the rest; trailing blanks are removed. Control characters are escaped.
pub fn row<const N: usize>(columns: [i32; N], cells: [&str; N]) -> String {
    let mut line = String::new();
    for (column, cell) in columns.into_iter().zip(cells) {
        let (width, cell) = (column.unsigned_abs() as usize, printable_line(cell));
        line += &if column < 0 { format!("{cell:<width$}") } else { format!("{cell:>width$}") };
    }
    format!("{}\n", line.trim_end())
}

/// Formats a line with a name and a value.
pub fn field(name: &str, value: impl Display) -> String {
    format!("{name:<12}{value}\n")
}

/// Formats a number with three digits and an SI prefix: `12.3 M`.
pub fn si(value: f64) -> String {
    let prefixes = [(1e12, " T"), (1e9, " G"), (1e6, " M"), (1e3, " k")];
    let (unit, prefix) =
        prefixes.into_iter().find(|(unit, _)| value.abs() >= *unit).unwrap_or((1.0, " "));
    let scaled = value / unit;
    let decimals = match scaled.abs() {
        x if x < 9.995 => 2,
        x if x < 99.95 => 1,
        _ => 0,
    };
    format!("{scaled:.decimals$}{prefix}")
}

/// Formats a fraction as a percentage with three digits: `1.23 %`.
pub fn percent(share: f64) -> String {
    let decimals = match 100.0 * share {
        x if x < 9.995 => 2,
        x if x < 99.95 => 1,
        _ => 0,
    };
    format!("{:.decimals$} %", 100.0 * share)
}

/// Formats a count with its noun: `3 spheres`, `1 sphere`.
pub fn count(number: usize, singular: &str) -> String {
    let plural = if number == 1 { "" } else { "s" };
    format!("{number} {singular}{plural}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_stand_in_columns() {
        assert_eq!(row([-4, 5, -3], ["a", "b", " c"]), "a       b c\n");
        assert_eq!(row([-2, 4], ["longer", ""]), "longer\n");
    }

    #[test]
    fn numbers_have_three_digits_and_a_prefix() {
        let shown = [0.0, 1.5, 999.0, 1234.0, 12.34e6, 99.96e6, 5e9].map(si);
        assert_eq!(shown, ["0.00 ", "1.50 ", "999 ", "1.23 k", "12.3 M", "100 M", "5.00 G"]);
        assert_eq!(
            [0.0123, 0.0999, 0.1234, 1.5].map(percent),
            ["1.23 %", "9.99 %", "12.3 %", "150 %"]
        );
        assert_eq!((count(1, "ray"), count(2, "ray")), ("1 ray".into(), "2 rays".into()));
    }
}
