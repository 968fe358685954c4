//! Plans as scripts for a shell and for Slurm.

use std::fmt::Write;

use crate::cli::print;
use crate::error::{Error, Result};

use super::commands::ShardPlan;

/// The program as the scripts call it.
const PROGRAM: &str = r#""${PHOTOSPHERE:-photosphere}""#;

/// Returns a script with one command per line, which stops at the first failure.
///
/// # Errors
/// If a name cannot be quoted.
pub(super) fn shell(plan: &ShardPlan) -> Result<String> {
    let mut text = format!(
        "#!/bin/sh\n\
         # {}: {}, in any order and on any machine, then the merge.\n\
         # Each may be run again: a finished shard does nothing, an interrupted one resumes.\n\
         set -e\n",
        without_controls(&plan.name),
        print::count(plan.shards.len(), "shard"),
    );
    for shard in &plan.shards {
        line(&mut text, format_args!("{}", command(&plan.render(&shard.to_string()))?));
    }
    line(&mut text, format_args!("{}", command(&plan.merge())?));
    Ok(text)
}

/// Returns a script with three roles. Run by hand, it submits itself twice: as an array job of the
/// shards, and as the merge that waits for it. Run by Slurm, the task number selects the shard or
/// the merge.
///
/// # Errors
/// If a name cannot be quoted.
pub(super) fn slurm(plan: &ShardPlan) -> Result<String> {
    let merge = plan.shards.len();
    let last = merge - 1;
    let name: String =
        plan.name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).collect();
    let mut text = format!(
        r#"#!/bin/bash
# Submit with `bash THIS_FILE`, in the folder of the plan; options after it go to sbatch, as in
# `bash THIS_FILE --time=2:00:00 --cpus-per-task=16`. Repeat it after a failure: finished shards do
# nothing, others resume.
#SBATCH --job-name=photosphere-{name}
#SBATCH --array=0-{last}
#SBATCH --output=photosphere-{name}-%A_%a.log
#SBATCH --open-mode=append
#SBATCH --requeue
#SBATCH --signal=B:TERM@60
set -euo pipefail
# As many threads as Slurm gives processors.
export RAYON_NUM_THREADS=${{SLURM_CPUS_ON_NODE:-0}}
case ${{SLURM_ARRAY_TASK_ID:-submit}} in
submit)
    shards=$(sbatch --parsable "$@" "$0")
    merge=$(sbatch --parsable --dependency="afterok:${{shards%%;*}}" --kill-on-invalid-dep=yes --array={merge} "$@" "$0")
    echo "shards ${{shards%%;*}}, merge ${{merge%%;*}}"
    ;;
"#
    );
    for (task, shard) in plan.shards.iter().enumerate() {
        let command = command(&plan.render(&shard.to_string()))?;
        line(&mut text, format_args!("{task}) exec {command} ;;"));
    }
    line(&mut text, format_args!("{merge}) exec {} ;;\nesac", command(&plan.merge())?));
    Ok(text)
}

fn line(text: &mut String, words: std::fmt::Arguments<'_>) {
    text.write_fmt(format_args!("{words}\n")).expect("a string takes all that is written to it");
}

/// Returns the program and its arguments, quoted for a POSIX shell.
fn command(words: &[String]) -> Result<String> {
    let words = shlex::try_join(words.iter().map(String::as_str));
    let words = words.map_err(|e| Error::input(format!("a name cannot be quoted: {e}")))?;
    Ok(format!("{PROGRAM} {words}"))
}

/// Removes control characters: a line break would end a comment.
pub(super) fn without_controls(name: &str) -> String {
    name.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}
