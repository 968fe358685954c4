//! Options, help, completions and manual pages.

use crate::desk::{Desk, SCENE};

#[test]
fn wrong_usage_has_its_own_exit_code() {
    let desk = Desk::new(SCENE);
    let cases = [
        ("", "Usage: photosphere <COMMAND>"),
        ("rendr", "unrecognized subcommand 'rendr'"),
        ("render scene.toml", "--output <FILE>"),
        ("render -o a.png", "<SCENE>"),
        ("render scene.toml -o a.png --sp 4", "unexpected argument '--sp'"),
        ("render scene.toml -o a.png --spp many", "invalid value 'many' for '--spp <N>'"),
        ("render scene.toml -o a.png --size 640", "expected WIDTHxHEIGHT, such as 640x480"),
        ("render scene.toml -o a.png --size 0x-3", "expected WIDTHxHEIGHT"),
        ("render scene.toml -o a.png --set seed", "expected KEY=VALUE, such as render.seed=7"),
        ("render scene.toml -o a.png --accel embre", "invalid value 'embre' for '--accel"),
        ("render scene.toml -o a.png --threads 0", "0 is not in 1..=4096"),
        ("render scene.toml -o a.png --threads -1", "-1 is not in 1..=4096"),
        ("crosscheck scene.toml --rays 0", "0 is not in 3..=10000000"),
        ("crosscheck scene.toml --rays -5", "-5 is not in 3..=10000000"),
        ("crosscheck scene.toml --seed -1", "-1 is not in 0..=9223372036854775807"),
        ("completions dosh", "invalid value 'dosh'"),
    ];
    for (arguments, message) in cases {
        desk.run(arguments).fails(2, &[message]);
    }
}

#[test]
fn values_that_the_scene_refuses_are_shown_in_the_option() {
    let desk = Desk::new(SCENE);
    let cases = [
        ("--spp -1", ["must be a whole number from 1 to 4294967295, not -1", "--spp -1"]),
        ("--seed -1", ["must be a whole number from 0 to 2^63 - 1, not -1", "--seed -1"]),
        ("--seed 99999999999999999999", ["from 0 to 2^63 - 1, not 99999999999999999999", ""]),
        ("--max-depth -1", ["must be a whole number from 1", "not -1"]),
        ("--spp 0", ["`render.samples_per_pixel` must be", "[command line:1:7]"]),
        ("--size 0x48", ["`image.width` must be", " 1 | --size 0x48"]),
        ("--integrator pth", ["\"pth\"", "did you mean `path`"]),
        ("--sampler sobl", ["\"sobl\"", "did you mean `sobol`"]),
        ("--set imge.width=3", ["unknown key `imge`", "did you mean `image`"]),
        ("--set materials.gras.albedo=[1,1,1]", ["no material \"gras\"", "`grass`"]),
        ("--set render.seed=[1", ["the value is not TOML", " 1 | --set render.seed=[1"]),
        ("--max-depth 0", ["`render.max_depth` must be", "--max-depth 0"]),
    ];
    for (option, parts) in cases {
        desk.run(&format!("render scene.toml -o out.png {option}")).fails(3, &parts);
    }
    assert_eq!(desk.names(), ["scene.toml"]);
}

#[cfg(not(has_embree))]
#[test]
fn embree_is_missed_with_advice() {
    let parts = &["error: this build has no `embree` intersector", "help: "];
    Desk::new(SCENE).run("render scene.toml -o out.png --accel embree").fails(5, parts);
}

#[test]
fn help_teaches_with_examples_and_lists_the_exit_codes() {
    let desk = Desk::new(SCENE);
    let help = desk.run("--help").succeeds().stdout;
    for part in ["Examples:", "photosphere render", "Exit codes:", "130  stopped by Ctrl-C"] {
        assert!(help.contains(part), "{help}");
    }
    for command in ["render", "crosscheck", "bench", "info", "doctor", "completions", "man"] {
        let help = desk.run(&format!("{command} --help")).succeeds().stdout;
        assert!(help.contains(&format!("Examples:\n  photosphere {command}")), "{help}");
    }
    let version = desk.run("--version").succeeds().stdout;
    assert_eq!(version, format!("photosphere {}\n", env!("CARGO_PKG_VERSION")));
}

#[test]
fn completions_and_manual_pages_name_the_commands() {
    let desk = Desk::new(SCENE);
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = desk.run(&format!("completions {shell}")).succeeds().stdout;
        assert!(script.contains("render") && script.contains("crosscheck"), "{shell}");
    }
    let page = desk.run("man").succeeds().stdout;
    for part in [".TH photosphere 1", "photosphere\\-render", "130  stopped by"] {
        assert!(page.contains(part), "{page}");
    }
    let page = desk.run("man render").succeeds().stdout;
    assert!(page.contains("photosphere\\-render") && page.contains("\\-\\-output"), "{page}");
    desk.run("man rendr").fails(3, &["error: there is no command `rendr`\n  help: "]);
}
