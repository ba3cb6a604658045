//! Integration tests: everything through the public interface.

mod benchmark_simulator;
mod cli;
mod coverage;
mod discrepancy;
mod dockerfile;
mod effects;
mod identification;
mod layers;
mod limits;
mod machines;
mod measurements;
mod naming;
mod openapi;
mod process;
mod readme;
mod real_data;
mod reference;
mod report;
mod scaling;
mod search;
mod service;
mod shared_files;
mod simulation;
mod simulators;
mod validation;
