//! Work of fixed size: the benches measure how long it takes, and the example `instructions` lets
//! the instructions of some of it be counted.
//!
//! - `axes`: an axis with an effect, at the points of a design.
//! - `tables`: tables to identify and to diagnose.

pub mod axes;
pub mod tables;
