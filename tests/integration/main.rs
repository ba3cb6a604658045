//! Integration tests: everything through the public interface.

mod benchmark_simulator;
mod cli;
mod layers;
mod measurements;
mod openapi;
mod process;
mod service;
mod simulation;
