//! Machines drawn at random, measured with a simulator of their own.
//!
//! Whoever fits a model with the simulator that made the data learns nothing about
//! that simulator's errors. [`simulator`] therefore steps the equations through time
//! in the plainest way and shares no code with the `simulate` and `effects` of
//! `servoscope-core`; [`draw`] makes machines, designs and noisy measurements with it.

pub mod draw;
pub mod responses;
pub mod simulator;
