//! The values of a key that `photosphere converge --compare` compares.

use crate::scene::Override;

/// The keys that all curves of one scene may differ in.
const TABLE: &str = "render.";

/// A key of `[render]` and the values that it takes.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    key: String,
    values: Vec<String>,
}

impl Comparison {
    /// Each value with its name in the plot.
    pub fn choices(&self) -> Vec<(String, Override)> {
        let name = self.key.strip_prefix(TABLE).unwrap_or(&self.key);
        let choice = |value: &String| {
            let shown = format!("{}={value}", self.key);
            let given = Override::new(&*self.key, &**value).with_option(["--compare", &shown]);
            (format!("{name}={value}"), given)
        };
        self.values.iter().map(choice).collect()
    }
}

/// Parses `KEY=LIST`.
///
/// # Errors
/// If it is not such a list, or the key is of another table.
pub fn comparison(text: &str) -> Result<Comparison, String> {
    let (key, list) = text.split_once('=').unwrap_or((text, ""));
    let values: Vec<String> = list.split(',').map(|value| value.trim().to_owned()).collect();
    let key = key.trim().to_owned();
    if key.is_empty() || values.iter().any(String::is_empty) {
        return Err("expected KEY=LIST, such as render.max_depth=2,3,8".to_owned());
    }
    match &*key {
        "render.samples_per_pixel" => Err("for samples per pixel, use --spp 4,16,64".to_owned()),
        "render.seed" => Err("each point is a mean over seeds already: --seeds".to_owned()),
        key if !key.starts_with(TABLE) => Err(format!(
            "all curves show one scene, so they may differ only in keys of [render], such as \
             render.max_depth, not in `{key}`"
        )),
        _ => Ok(Comparison { key, values }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_of_values_has_a_name_and_an_override_for_each() {
        let choices = comparison("render.max_depth=2, 8").unwrap().choices();
        let names: Vec<&str> = choices.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["max_depth=2", "max_depth=8"]);
        assert_eq!(choices[1].1.to_string(), "--compare render.max_depth=8");
        for wrong in ["render.max_depth", "=2", "render.max_depth=2,", "materials.a.albedo=1,2"] {
            assert!(comparison(wrong).is_err(), "{wrong}");
        }
    }
}
