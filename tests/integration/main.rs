//! Integration tests: everything through the public interface.

mod benchmark_simulator;
mod coverage;
mod identification;
mod limits;
mod machines;
mod reference;
mod scaling;
mod search;
mod simulation;
mod simulators;
