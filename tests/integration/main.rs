//! Integration tests.
mod benchmark_simulator;
