//! From the measured frequency response of a servo axis to its transfer function and friction, and
//! to the physical cause of what they leave unexplained.
//!
//! ```text
//!   diagnose                     what the model gets wrong, the cause, and the gain on data held out
//!     └─ identify                data → parameters with intervals
//!          └─ simulate           parameters → periodic response, or the motion of a record
//!               └─ effects       what a base model may lack, one file each
//!                    └─ plant · measurement      the base model, and what is measured
//!   answers · observer           what is asked and answered; progress and cancelling
//! ```
//!
//! Each module knows only those beneath it. Everything is pure and synchronous: data, seed and
//! [`observer::Observer`] in, values out. The same seed gives the same bits at any number of
//! threads. There is no runtime, clock, log, file or network in it.
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

/// The independent simulator of `servoscope-bench`, which makes the data of the unit tests here.
/// It is compiled into them from its source: that crate depends on this one, and a crate that is
/// linked back into the tests of its own dependency brings a second copy of every type.
#[cfg(test)]
#[path = "../../bench/src/machines/mod.rs"]
#[expect(dead_code, reason = "what only the benchmark draws")]
mod machines;
