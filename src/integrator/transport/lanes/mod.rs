//! Fast path: shades vertices in lanes.
//!
//! The vertices of a stage are sorted by kind of surface: a `VertexBatch` stores vertices of one
//! kind as a structure of arrays and shades them in stages, whose loops over the lanes compile to
//! vector instructions (see [`crate::math::Isa`]). The loop bodies are the functions that the
//! scalar code calls for a single path ([`super::shade`]), so both give the same bits. What only a
//! few surfaces do, such as evaluating a rough metal, is computed lane by lane in between.
//!
//! Partly transparent surfaces and straight boundaries fall back to the scalar code, and so do
//! paths that are recorded or have no Sobol numbers.

mod arrive;
mod connection_lanes;
mod connections;
mod finish;
mod horizon;
mod kernels;
mod light;
mod stages;
mod vertex_batch;
mod vertex_kind;

pub(in super::super) use vertex_batch::VertexBatches;
