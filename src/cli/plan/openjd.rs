//! Plans as job templates of the Open Job Description specification, version 2023-09.
//!
//! A template has one task per shard, and a merge step that runs after all of them. It is JSON,
//! which the specification permits as well as YAML.

use serde_json::{Value, json};

use crate::error::{Error, Result};

use super::commands::ShardPlan;
use super::script::without_controls;
use crate::cli::args::Division;

/// The maximum number of values of a task parameter in the specification.
const MOST_TASKS: usize = 1024;
/// The maximum length of a job name, in characters.
const LONGEST_NAME: usize = 128;
/// Placeholder in commands for the folder of the files.
const FOLDER: &str = "{{Param.Folder}}";

/// Returns the template as JSON text.
///
/// # Errors
/// If there are more shards than a template can have tasks, or a name contains a template
/// placeholder.
pub(super) fn template(plan: &ShardPlan) -> Result<String> {
    if plan.shards.len() > MOST_TASKS {
        return Err(Error::input(format!(
            "a job template has at most {MOST_TASKS} tasks, too few for {} shards",
            plan.shards.len()
        ))
        .with_help("use fewer shards, or --format slurm"));
    }
    let mut names = [&plan.name, &plan.scene].into_iter().chain(&plan.options).chain(&plan.outputs);
    if let Some(name) = names.find(|name| name.contains("{{")) {
        return Err(Error::input(format!("`{name}` contains `{{{{`, which a template replaces"))
            .with_help("rename the file, or change the value"));
    }
    let shown = match plan.division {
        Division::Samples => "Samples",
        Division::Crop => "Crop",
    };
    let shards: Vec<String> = plan.shards.iter().map(ToString::to_string).collect();
    let render = in_folder(plan).render(&format!("{{{{Task.Param.{shown}}}}}"));
    let template = json!({
        "specificationVersion": "jobtemplate-2023-09",
        "name": without_controls(&plan.name).chars().take(LONGEST_NAME).collect::<String>(),
        "description": "Planned by photosphere: shards, then the merge. Every task can be run again.",
        "parameterDefinitions": parameters(),
        "steps": [
            {
                "name": "Shards",
                "parameterSpace": {
                    "taskParameterDefinitions": [
                        { "name": shown, "type": "STRING", "range": shards },
                    ],
                },
                "script": script(&render),
            },
            {
                "name": "Merge",
                "dependencies": [{ "dependsOn": "Shards" }],
                "script": script(&in_folder(plan).merge()),
            },
        ],
    });
    Ok(format!("{template:#}\n"))
}

fn parameters() -> Value {
    json!([
        {
            "name": "Folder",
            "type": "PATH",
            "objectType": "DIRECTORY",
            "dataFlow": "INOUT",
            "default": ".",
            "description": "The folder where relative names start: those of the scene, the parts and the picture. By default the folder of this template.",
        },
        {
            "name": "Program",
            "type": "STRING",
            "default": "photosphere",
            "description": "The program: a name in PATH, or a path.",
        },
    ])
}

/// Returns the script of a task. A cancelled task is notified first, so that it saves its samples.
fn script(words: &[String]) -> Value {
    let run = json!({
        "command": "{{Param.Program}}",
        "args": words,
        "cancelation": { "mode": "NOTIFY_THEN_TERMINATE", "notifyPeriodInSeconds": 30 },
    });
    json!({ "actions": { "onRun": run } })
}

/// Returns the plan with all relative paths placed in the job's folder.
fn in_folder(plan: &ShardPlan) -> ShardPlan {
    let placed = |name: &String| match name.starts_with('/') {
        true => name.clone(),
        false => format!("{FOLDER}/{name}"),
    };
    ShardPlan {
        name: plan.name.clone(),
        scene: placed(&plan.scene),
        outputs: plan.outputs.iter().map(placed).collect(),
        division: plan.division,
        shards: plan.shards.clone(),
        options: plan.options.clone(),
        merge_options: plan.merge_options.clone(),
    }
}
