//! The program as its users meet it: what it prints, what it writes, and its exit codes.

mod bench_page;
#[cfg(unix)]
mod cite;
#[cfg(unix)]
mod command_line;
mod compare;
mod converge;
#[cfg(unix)]
mod convert;
#[cfg(unix)]
mod denoise;
mod desk;
#[cfg(unix)]
mod files;
mod foreign_checkpoints;
mod fuzz_seeds;
mod generate;
#[cfg(unix)]
mod hostile;
#[cfg(unix)]
mod kill;
#[cfg(unix)]
mod long_renders;
#[cfg(target_os = "linux")]
mod memory_plan;
#[cfg(unix)]
mod mistakes_in_a_scene;
mod no_effect;
#[cfg(unix)]
mod overlays;
#[cfg(unix)]
mod particle_mistakes;
#[cfg(unix)]
mod particles;
#[cfg(unix)]
mod pictures;
#[cfg(unix)]
mod plan;
#[cfg(unix)]
mod provenance;
#[cfg(unix)]
#[path = "../common/python.rs"]
mod python;
#[cfg(unix)]
mod reports;
#[cfg(unix)]
mod reproduce;
#[cfg(unix)]
mod standard_streams;
#[cfg(unix)]
mod stopping;
#[cfg(unix)]
mod streams_and_signals;
#[cfg(unix)]
mod tables;
mod trace;
#[cfg(unix)]
mod verify;
