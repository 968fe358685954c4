//! The paper's integrator, its samples and its options.

use photosphere::scene::settings::{
    Hemisphere, IntegratorSettings, MissPolicy, PaperSettings, PathTermination, SamplerKind,
};

use crate::scenes::{assert_told, load, with};

/// Sub-pixels and samples of the paper's integrator with these lines in `[render]`.
fn paper_samples(render: &str, options: &[&str]) -> (u32, u32) {
    let text = with("seed = 7", render);
    let render = load(&text, options).expect("a good scene").settings.render;
    let IntegratorSettings::Paper(paper) = render.integrator else { panic!("not the paper's") };
    assert_eq!(render.samples_per_pixel, paper.subpixels.pow(2) * paper.samples);
    (paper.subpixels, paper.samples)
}

#[test]
fn the_papers_samples_follow_from_all_that_is_said_of_them() {
    let switch = "render.integrator=paper";
    assert_eq!(paper_samples("integrator = \"paper\"", &[]), (2, 4));
    assert_eq!(paper_samples("integrator = \"paper\"\nsamples_per_pixel = 20", &[]), (2, 5));
    assert_eq!(paper_samples("integrator = \"paper\"\npaper.samples = 100", &[]), (2, 100));
    assert_eq!(paper_samples("samples_per_pixel = 64", &[switch]), (2, 16));
    assert_eq!(paper_samples("samples_per_pixel = 64\npaper.samples = 3", &[switch]), (2, 3));
    assert_eq!(paper_samples("samples_per_pixel = 64\npaper.subpixels = 3", &[switch]), (3, 4));
    let spp = "render.samples_per_pixel=36";
    assert_eq!(paper_samples("paper.subpixels = 3", &[switch, spp]), (3, 4));
    assert_eq!(paper_samples("integrator = \"paper\"\nsamples_per_pixel = 8", &[spp]), (2, 9));
    // What is asked for last wins over the file.
    assert_eq!(paper_samples("integrator = \"paper\"\npaper.samples = 100", &[spp]), (2, 9));
}

#[test]
fn the_papers_samples_must_not_contradict_each_other() {
    let said = |render: &str, options: &[&str], expected: &str| {
        let text = with("seed = 7", &format!("integrator = \"paper\"\n{render}"));
        assert_told(&text, options, &[expected]);
    };
    said(
        "samples_per_pixel = 10",
        &[],
        "32:21: `render.samples_per_pixel` must be a multiple of the 2 x 2 sub-pixels, not 10 \
         | try 8 or 12",
    );
    said(
        "samples_per_pixel = 20\npaper.samples = 4",
        &[],
        "32:21: `render.samples_per_pixel` is 20, but 2 x 2 sub-pixels of 4 samples make 16 \
         | `render.paper.samples` is set in test.toml:33:17; remove one of them",
    );
    said(
        "",
        &["render.paper.samples=4", "render.samples_per_pixel=36"],
        "command line:1:32: `render.samples_per_pixel` is 36, but 2 x 2 sub-pixels of 4 samples \
         make 16 | `render.paper.samples` is set in `--set render.paper.samples=4`; remove one of them",
    );
    said(
        "paper.samples = 4000000000",
        &[],
        "32:1: `render.paper` asks for 16000000000 samples per pixel, more than 2^32 - 1",
    );
}

#[test]
fn samplers_are_read_and_the_paper_keeps_independent_numbers() {
    let sampler = |lines: &str, overrides: &[&str]| {
        let text = with("seed = 7", lines);
        load(&text, overrides).expect("good").settings.render.sampler
    };
    assert_eq!(sampler("", &[]), SamplerKind::Sobol);
    assert_eq!(sampler("sampler = \"independent\"", &[]), SamplerKind::Independent);
    assert_eq!(sampler("", &["render.sampler=stratified"]), SamplerKind::Stratified);
    assert_eq!(sampler("integrator = \"paper\"", &[]), SamplerKind::Independent);
    let asked = "integrator = \"paper\"\nsampler = \"sobol\"";
    assert_eq!(sampler(asked, &[]), SamplerKind::Sobol);
}

#[test]
fn the_papers_options_are_read() {
    let text = with(
        "seed = 7",
        "integrator = \"paper\"\nmax_depth = 3\n[render.paper]\nsubpixels = 3\nsamples = 5\n\
         hemisphere = \"uniform-angle\"\nstop = \"threshold\"\nthreshold = 0.25\nmiss = \"redraw\"\n\
         jitter = 0.5\n[render.raycast]\nshadows = true",
    );
    let expected = PaperSettings {
        subpixels: 3,
        samples: 5,
        hemisphere: Hemisphere::UniformAngle,
        stop: PathTermination::Threshold(0.25),
        miss: MissPolicy::Redraw,
        jitter: 0.5,
    };
    let render = load(&text, &[]).expect("good").settings.render;
    assert_eq!(render.integrator, IntegratorSettings::Paper(expected));
    let render = load(&text, &["render.integrator=raycast"]).expect("good").settings.render;
    assert_eq!(render.integrator, IntegratorSettings::Raycast { shadows: true });
    assert_eq!(render.samples_per_pixel, 1);
}
