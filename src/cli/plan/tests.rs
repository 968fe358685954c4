use std::path::Path;

use super::*;
use crate::cli::args::{Cli, Command};
use crate::scene::read_text;
use clap::Parser;

/// 64 x 48 pixels with 96 samples each.
const SCENE: &str = r#"
format = 1
image = { width = 64, height = 48 }
camera = { position = [0.0, 0.0, 5.0], look_at = [0.0, 0.0, 0.0], vertical_fov_degrees = 40.0 }
render = { integrator = "path", samples_per_pixel = 96 }

[materials.m]
type = "diffuse"
albedo = [0.5, 0.5, 0.5]

[[spheres]]
center = [0.0, 0.0, 0.0]
radius = 1.0
material = "m"
"#;

fn plan(words: &[&str]) -> ShardPlan {
    let words = ["photosphere", "plan"].iter().chain(words);
    let Command::Plan(args) = Cli::try_parse_from(words).unwrap().command else { panic!() };
    let division = division(&args.stop, args.by).unwrap();
    let file = read_text("a.toml", SCENE, Path::new(""), &args.overrides()).unwrap();
    ShardPlan::new(&args, &outputs(&args), division, &file.settings, "native").unwrap()
}

fn lines(script: &str) -> Vec<&str> {
    script.lines().filter(|line| line.starts_with('"')).collect()
}

#[test]
fn the_options_of_the_picture_reach_every_shard_and_those_of_the_file_the_merge() {
    let options = ["--size", "64x48", "--set", "materials.m.albedo=[0.1, 0.2, 0.3]"];
    let files = ["--layers", "normal", "--no-run-figures"];
    let plan = plan(&[&["a b/it's.toml", "--shards", "2"], &options[..], &files].concat());
    let script = script::shell(&plan).unwrap();
    let shard = |range: &str| {
        format!(
            "\"${{PHOTOSPHERE:-photosphere}}\" render \"a b/it's.toml\" --size 64x48 --set \
             'materials.m.albedo=[0.1, 0.2, 0.3]' --accel native --checkpoint-every 60s --layers \
             normal --samples {range} -o \"it's.samples-{range}.part\" --quiet"
        )
    };
    let merge = "\"${PHOTOSPHERE:-photosphere}\" merge \"it's.samples-0..48.part\" \
                 \"it's.samples-48..96.part\" -o \"it's.exr\" --no-run-figures --quiet";
    assert_eq!(lines(&script), [shard("0..48").as_str(), shard("48..96").as_str(), merge]);
}

#[test]
fn a_divided_picture_takes_the_place_of_its_crop() {
    let options = ["a.toml", "-o", "out/b.png", "--by", "crop", "--shards", "2"];
    let script = script::shell(&plan(&[&options[..], &["--crop", "0,0,64,40"]].concat())).unwrap();
    let [first, second, merge] = lines(&script).try_into().unwrap();
    assert!(first.contains("--crop '0,0,64,16' -o 'out/b.crop-0,0,64,16.part' "), "{script}");
    assert!(!second.contains("64,40 --"), "{script}");
    let end = " 'out/b.crop-0,16,64,40.part' -o out/b.png --crop '0,0,64,40' --quiet";
    assert!(merge.ends_with(end), "{script}");
    let set = ["--set", "image.crop=[0, 0, 64, 40]"];
    let script = script::shell(&plan(&[&options[..], &set].concat())).unwrap();
    assert!(!script.contains("image.crop"), "{script}");
}

#[test]
fn a_noise_target_is_shared_out_by_pixels() {
    let options = ["a.toml", "-o", "a.part", "--shards", "2", "--noise", "2%", "--max-spp", "256"];
    let script = script::shell(&plan(&options)).unwrap();
    let [first, _, merge] = lines(&script).try_into().unwrap();
    let middle = " --max-spp 256 --noise 0.02 --confidence 0.95 --accel native ";
    assert!(first.contains(middle), "{script}");
    assert!(first.contains("--crop '0,0,64,16' -o 'a.all.crop-0,0,64,16.part' "), "{script}");
    assert!(merge.ends_with(" -o a.part --quiet"), "{script}");
}

#[test]
fn names_are_never_taken_for_options() {
    let script = script::shell(&plan(&["--shards=1", "-o=-b.exr", "--", "-a.toml"])).unwrap();
    let [shard, merge] = lines(&script).try_into().unwrap();
    assert!(shard.contains(" render ./-a.toml "), "{script}");
    assert!(merge.contains(" merge ./-b.samples-0..96.part -o ./-b.exr "), "{script}");
}

#[test]
fn a_slurm_script_knows_its_tasks_and_the_merge() {
    let script = script::slurm(&plan(&["my scene.toml", "--shards", "3"])).unwrap();
    for line in ["#SBATCH --array=0-2", "#SBATCH --job-name=photosphere-my-scene"] {
        assert!(script.lines().any(|l| l == line), "`{line}` is not in\n{script}");
    }
    assert!(script.contains("\n2) exec \"${PHOTOSPHERE:-photosphere}\" render"), "{script}");
    assert!(script.contains("\n3) exec \"${PHOTOSPHERE:-photosphere}\" merge"), "{script}");
}

#[test]
fn a_template_has_a_task_per_shard_and_places_files_in_its_folder() {
    let text = openjd::template(&plan(&["/s/a.toml", "--shards", "3"])).unwrap();
    let template: serde_json::Value = serde_json::from_str(&text).unwrap();
    let shards = &template["steps"][0];
    let values = &shards["parameterSpace"]["taskParameterDefinitions"][0]["range"];
    assert_eq!(*values, serde_json::json!(["0..32", "32..64", "64..96"]));
    let arguments = shards["script"]["actions"]["onRun"]["args"].as_array().unwrap();
    let has = |word: &str| arguments.iter().any(|argument| argument == word);
    assert!(has("/s/a.toml") && has("{{Task.Param.Samples}}"), "{text}");
    assert!(has("{{Param.Folder}}/a.samples-{{Task.Param.Samples}}.part"), "{text}");

    let error = openjd::template(&plan(&["{{a}}.toml", "--shards", "3"])).unwrap_err().to_string();
    assert_eq!(error, "`{{a}}` contains `{{`, which a template replaces");
}
