//! Signals over time and their Fourier integrals, shared by all simulation methods.

mod bessel;
pub(super) mod complex_dual;
pub(super) mod excitation;
pub(super) mod exponential_integrator;
pub(super) mod fourier;
pub(super) mod grid;
pub(super) mod piecewise_quintic;
pub(super) mod root_finding;
pub(super) mod samples;
