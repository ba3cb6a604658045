//! Bands in which a model is not to be used, shaded and said.

use servoscope_core::answers::ValidBand;

use super::canvas::{Anchor, Canvas, Font, Trace};
use super::panel::{Key, Look, Panel};
use super::text;

/// Text within a band that is not valid.
pub(super) const BAND: Font = Font { size: 10.5, class: "m" };

/// Bands in which the model departs, Hz.
pub(super) fn invalid(band: Option<&ValidBand>) -> Vec<[f64; 2]> {
    let departures = band.map_or(&[][..], |band| &band.departures);
    departures.iter().map(|departure| [departure.from_hz, departure.to_hz]).collect()
}

/// The entry of the legend that shows and hides them.
pub(super) fn key() -> Key {
    Key::new(Look::Shade("invalid"), "key", "model not valid").toggling("invalid")
}

/// Shades them in a panel, with their name where there is room for it and it is `named`.
pub(super) fn shade(canvas: &mut Canvas, panel: &Panel, bands: &[[f64; 2]], named: bool) {
    for band in bands {
        let sides =
            band.map(|hz| panel.x.at(hz).unwrap_or(panel.left).clamp(panel.left, panel.right));
        // A single frequency is a band of some width, too.
        let [left, right] = [sides[0].min(sides[1] - 2.0), sides[1].max(sides[0] + 2.0)];
        canvas.open_trace("", panel.sides(), Trace { keys: "invalid", ..Trace::default() });
        canvas.rectangle("invalid", [left, panel.top, right, panel.bottom], "");
        let label = "not valid";
        if named && right - left > text::width(label, BAND.size) + 4.0 {
            let middle = 0.5 * (left + right);
            canvas.text(middle, panel.top + 14.0, BAND, Anchor::Middle, label);
        }
        canvas.close();
    }
}
