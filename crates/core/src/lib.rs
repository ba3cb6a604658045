//! Identifies the transfer function and friction of a servo axis from its measured frequency
//! response, and diagnoses which physical effect that model lacks.
//!
//! ```text
//!   diagnose                     where the model is wrong, the cause, its gain on held-out data
//!     └─ identify                data → parameters with intervals
//!          └─ simulate           parameters → periodic response, or the motion of a record
//!               └─ effects       physical effects that the base model may lack, one file each
//!                    └─ plant · measurement      the base model, and the measured data
//!   answers · observer           requests and results; progress and cancellation
//!   singular_values              decomposition of matrices, for all of them
//! ```
//!
//! Each module depends only on the modules below it. All functions are pure and synchronous: they
//! take data, a seed and an [`observer::Observer`] and return values. The same seed gives
//! bit-identical results at any number of threads. The crate uses no runtime, clock, log, file or
//! network.
//!
//! ```
//! use servoscope_core::diagnose::diagnose;
//! use servoscope_core::identify::IdentifyRequest;
//! use servoscope_core::measurement::formats::{Source, read};
//! use servoscope_core::observer::Silent;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let bytes = b"magnitude,omega_rad_s,harmonic,re,im\n\
//!     1,2,1,0.35,-0.08\n1,8,1,0.22,-0.19\n2,2,1,1.28,-0.27\n2,8,1,0.81,-0.66\n";
//! let measurement = read(&[Source { name: "axis.csv", bytes }])?;
//! let diagnosis = diagnose(&measurement, &IdentifyRequest::default(), &Silent)?;
//! println!("{:?}: {}", diagnosis.verdict, diagnosis.discrepancy.sentence);
//! # Ok(())
//! # }
//! ```

pub mod answers;
pub mod diagnose;
pub mod effects;
pub mod identify;
pub mod measurement;
pub mod observer;
pub mod plant;
pub mod simulate;
mod singular_values;

/// The independent simulator of `servoscope-bench`, which generates data for the unit tests.
///
/// It is included as source rather than as a dependency: `servoscope-bench` depends on this crate,
/// so linking it into this crate's own tests would bring in a second copy of every type.
#[cfg(test)]
#[path = "../../bench/src/machines/mod.rs"]
#[expect(dead_code, reason = "what only the benchmark draws")]
mod machines;
