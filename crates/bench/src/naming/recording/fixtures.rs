//! A machine for the tests.

use crate::machines::draw::{Draw, draw};
use crate::machines::simulator::Effect;

/// A machine with two effects.
pub(super) fn machine() -> Draw {
    let machine = draw(0, 3);
    let e = 0.05 * machine.plant.viscous_rate_rad_s / machine.plant.constant;
    let e = e / machine.design[0].0;
    let effects = vec![
        Effect::new("gain_asymmetry", [("gamma", 0.1)]),
        Effect::new("sensor_compression", [("e", e)]),
    ];
    Draw { effects, ..machine }
}
