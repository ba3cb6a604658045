//! servoscope: from the measured frequency response of a servo axis to its
//! transfer function and friction.
//!
//! Layers, each knowing only those below it (a test enforces it):
//!
//! ```text
//!   http      cli      worker        the outside: requests, arguments, threads
//!     └────────┼─────────┘
//!           service                  use cases: joins storage and numerics
//!     ┌────────┼─────────┐
//!   store   report    diagnose       rows · text and figures · causes
//!     │        │         │
//!     │        │      identify       data → parameters with intervals
//!     │        │         │
//!     │        │      simulate       parameters → periodic response
//!     │        │         │
//!     │        │      effects        what a base model may lack
//!     └────────┴─────────┤
//!   answers      plant · measurement what is asked, fitted and measured
//! ```
//!
//! `web` holds the files of the dashboard, which `http` serves and which asks the
//! same interface as any other client; its look is that of the report.
//!
//! `benchmark` stands beside them: it draws machines, simulates them with a
//! simulator of its own and asks the public interface what it sees. `reproduce` runs
//! the experiments of the paper with that simulator and draws what they come to.
//!
//! The numeric core (`diagnose` and below) is pure and synchronous: data, seed
//! and [`observer::Observer`] in, values out; the same seed gives the same bits
//! at any number of threads.

pub mod answers;
pub mod benchmark;
pub mod cli;
pub mod config;
pub mod diagnose;
pub mod effects;
pub mod http;
pub mod identify;
pub mod measurement;
pub mod observer;
pub mod plant;
pub mod report;
pub mod reproduce;
pub mod service;
pub mod simulate;
pub mod store;
pub mod web;
pub mod worker;
