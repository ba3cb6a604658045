//! Integration tests: everything through the public interface.

mod benchmark_simulator;
mod cli;
mod dockerfile;
mod layers;
mod measurements;
mod openapi;
mod process;
mod readme;
mod real_data;
mod service;
mod shared_files;
mod simulation;
