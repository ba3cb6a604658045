//! Residual analysis: whether the residuals of a fit are noise, and if not, where they are large.
//!
//! `statistics` and `whiteness` test them for being noise; `regions` and `patterns` find the
//! largest departures; `discrepancy` collects the results.

pub(super) mod discrepancy;
pub(super) mod groups;
pub(super) mod layout;
pub(super) mod null_distribution;
pub(super) mod patterns;
pub(super) mod regions;
pub(super) mod residual;
pub(super) mod sentence;
pub(super) mod statistics;
pub(super) mod subspace;
pub(super) mod valid_band;
pub(super) mod whiteness;
