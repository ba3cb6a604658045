//! Where gain and phase stand.

use super::super::canvas::{PHONE_WIDTH, WIDTH};

/// Gain and phase beside each other or, on a phone, beneath each other.
pub(super) struct Layout {
    /// Width of the figure, pixels.
    pub(super) width: f64,
    /// Left and right side of gain and phase, pixels.
    pub(super) columns: [[f64; 2]; 2],
    /// Whether the phase stands beneath the gain.
    pub(super) stacked: bool,
}

pub(super) const WIDE: Layout =
    Layout { width: WIDTH, columns: [[56.0, 390.0], [452.0, 786.0]], stacked: false };

pub(super) const PHONE: Layout =
    Layout { width: PHONE_WIDTH, columns: [[56.0, 386.0]; 2], stacked: true };
