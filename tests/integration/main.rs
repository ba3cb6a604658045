//! Integration tests: everything through the public interface.

mod benchmark_simulator;
mod measurements;
mod simulation;
