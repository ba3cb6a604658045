//! Integration tests.

mod cli;
mod layers;
mod openapi;
mod process;
mod service;
