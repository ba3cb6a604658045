//! What a fit leaves: where it lies, whether it is noise, and how it is said.

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
pub(super) mod whiteness;
