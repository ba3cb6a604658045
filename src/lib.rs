//! The server and the command line of servoscope: from the measured frequency response of a servo
//! axis to its transfer function, its friction, and the cause of what they leave unexplained.
//!
//! Layers, each knowing only those below it (a test enforces it):
//!
//! ```text
//!   http      cli      worker        the outside: requests, arguments, threads
//!     └────────┼─────────┘
//!           service                  use cases: joins storage and numerics
//!     ┌────────┼─────────┬─────────┐
//!   store   report       │      notify  rows · text and figures · messages to others
//!     └────────┴─────────┤
//!               servoscope_core      measurement → identification → diagnosis
//! ```
//!
//! `web` holds the files of the dashboard, which `http` serves and which asks the
//! same interface as any other client; its look is that of the report.
//!
//! `servoscope_bench` stands beside them: it draws machines, simulates them with a
//! simulator of its own, and asks the public interface of `servoscope_core` what it sees.

pub mod cli;
pub mod config;
pub mod http;
pub mod notify;
pub mod report;
pub mod service;
pub mod store;
pub mod web;
pub mod worker;
