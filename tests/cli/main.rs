//! The program as its users meet it: what it prints, what it writes, and its exit codes.

#![cfg(unix)]

mod command_line;
mod desk;
mod files;
mod long_renders;
mod mistakes_in_a_scene;
mod pictures;
mod plan;
mod provenance;
mod reports;
mod reproduce;
mod stopping;
mod streams_and_signals;
mod tables;
