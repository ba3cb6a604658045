//! The units of a problem, and the conversion of a plant to or from them.

use crate::plant::{Actuator, Friction, Plant};

/// The units of the problem, expressed in units of the upload.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in super::super) struct Scales {
    /// ω_ref, rad/s.
    pub omega: f64,
    /// u_ref, input units.
    pub input: f64,
    /// v_ref, velocity units.
    pub velocity: f64,
}

/// The plant with its rates, torques and velocities multiplied by these factors.
pub(super) fn rescaled(plant: &Plant, Scales { omega, input, velocity }: Scales) -> Plant {
    let friction = plant.friction;
    Plant {
        viscous_rate_rad_s: plant.viscous_rate_rad_s * omega,
        constant: plant.constant * velocity * omega / input,
        actuator: match plant.actuator {
            Actuator::Direct => Actuator::Direct,
            Actuator::FirstOrder { corner_rad_s } => {
                Actuator::FirstOrder { corner_rad_s: corner_rad_s * omega }
            }
            Actuator::SecondOrder { natural_frequency_rad_s, damping_ratio } => {
                Actuator::SecondOrder {
                    natural_frequency_rad_s: natural_frequency_rad_s * omega,
                    damping_ratio,
                }
            }
        },
        friction: Friction {
            fc_plus: friction.fc_plus * input,
            fc_minus: friction.fc_minus * input,
            fs_plus: friction.fs_plus * input,
            fs_minus: friction.fs_minus * input,
        },
    }
}
