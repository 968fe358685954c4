//! Text for the methods section of a paper.

use crate::desk::{Desk, SCENE};

#[test]
fn a_methods_sentence_is_made_of_the_record() {
    let desk = Desk::new(SCENE);
    let render = "render scene.toml --accel native --quiet";
    desk.run(&format!("{render} -o a.png -o a.exr --spp 64 --seed 7 --tone agx")).succeeds();
    let info = desk.run("info a.png --json").succeeds().json();
    let text = desk.run("cite a.png").succeeds().stdout;
    let hash = |name: &str| info[name].as_str().expect("a hash")[..16].to_owned();
    for part in [
        "The picture of 16 x 12 pixels was computed by Monte Carlo path tracing (Kajiya 1986)",
        "multiple importance sampling (Veach and Guibas 1995)",
        "with 64 samples per pixel (Owen-scrambled Sobol' points, seed 7)",
        &format!("using photosphere {}", env!("CARGO_PKG_VERSION")),
        "The estimated error of 95 % of the pixel values is below ",
        "biased by the options max_depth = 6.",
        "Afterwards: shown through the view transform agx.",
        &format!("BLAKE3 hash {}", hash("scene-identity")),
        &format!("the computation by {}", hash("job-identity")),
        "doi:10.1145/218380.218498",
    ] {
        assert!(text.contains(part), "`{part}` is not in\n{text}");
    }
    assert!(!text.contains("specular connections"), "nothing is polished: {text}");
    assert!(!desk.run("cite a.exr").succeeds().stdout.contains("view transform"));
    let options = "--integrator paper";
    desk.run(&format!("{render} -o p.png {options}")).succeeds();
    let text = desk.run("cite p.png").succeeds().stdout;
    assert!(text.contains("Awan and Ko") && !text.contains("Veach"), "{text}");
}

/// A figure whose target was out of reach is not cited as one that reached it.
#[test]
fn a_target_that_was_missed_is_told() {
    let desk = Desk::new(SCENE);
    let render = "render scene.toml --accel native --quiet";
    desk.run(&format!("{render} -o a.png -o a.part --noise 0.01% --max-spp 64"));
    for file in ["a.png", "a.part"] {
        let text = desk.run(&format!("cite {file}")).succeeds().stdout;
        let told = "The render ended before its target, an error of 0.01";
        assert!(text.contains(told) && text.contains("of 1 squares"), "{text}");
        let told = desk.run(&format!("info {file}")).succeeds();
        assert!(told.row("missed").starts_with("the noise target of 0.01"), "{}", told.stdout);
    }
    desk.run(&format!("{render} -o b.png --noise 50%")).succeeds();
    let text = desk.run("cite b.png").succeeds().stdout;
    assert!(text.contains("The estimated error") && !text.contains("target"), "{text}");
    assert!(!desk.run("info b.png").succeeds().stdout.contains("missed"));
}

#[test]
fn bibtex_is_of_the_program_and_of_the_methods() {
    let desk = Desk::new(SCENE);
    let text = desk.run("cite --bibtex").succeeds().stdout;
    assert!(text.starts_with("@software{photosphere,\n  author  = {{"), "{text}");
    let version = format!("  version = {{{}}},\n", env!("CARGO_PKG_VERSION"));
    assert!(text.contains(&version) && !text.contains("kajiya"), "{text}");
    desk.run("render scene.toml --accel native --quiet -o a.part").succeeds();
    let text = desk.run("cite a.part --bibtex").succeeds().stdout;
    assert!(text.contains("@inproceedings{kajiya-1986,"), "{text}");
    assert_eq!(text.matches('{').count(), text.matches('}').count());
    desk.run("cite").fails(2, &["<PICTURE>"]);
    let parts = ["`scene.toml` is no picture", "cite takes a picture that photosphere wrote"];
    desk.run("cite scene.toml").fails(3, &parts);
}

/// The file that reference managers read says what the program says.
#[test]
fn the_citation_file_agrees_with_the_program() {
    let text = include_str!("../../CITATION.cff");
    for line in [
        format!("version: {}", env!("CARGO_PKG_VERSION")),
        format!("title: \"photosphere: {}\"", env!("CARGO_PKG_DESCRIPTION")),
        format!("  - name: \"{}\"", env!("CARGO_PKG_AUTHORS")),
        format!("repository-code: \"{}\"", env!("CARGO_PKG_REPOSITORY")),
    ] {
        assert!(text.lines().any(|given| given == line), "`{line}` is not in CITATION.cff");
    }
}
