//! Verification and benchmarks as part of the product: checks of every result and measurements of
//! speed, for users and for the tests.

pub mod bench;
pub mod check;
pub mod chi2;
mod chi2_checks;
pub mod closed_forms;
mod connections;
pub mod converge;
pub mod crosscheck;
mod double_double;
pub mod ground_truth;
pub mod intersector_checks;
mod materials;
pub mod metrics;
mod quadrature;
pub mod rays;
pub mod statistics;
mod suite;

pub use suite::{all_checks, all_checks_on};
