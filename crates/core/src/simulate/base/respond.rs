//! The response of the base model, and its derivatives.

use crate::effects::Wide;
use crate::measurement::Complex;
use crate::plant::{Plant, Scalar};

use super::sensitivity::{self, Differentiable};
use super::sliding_cosine::SlidingCosine;
use super::{settle_not_sliding, spectrum};
use crate::simulate::response::NoResponse;
use crate::simulate::signal::excitation::Excitation;

/// Velocity harmonics V₀ … V_H of the base model.
///
/// # Errors
/// [`NoResponse::NotPeriodic`].
pub(crate) fn respond(
    plant: &Plant,
    excitation: &Excitation,
    highest: usize,
) -> Result<Vec<Complex>, NoResponse> {
    match SlidingCosine::find(plant, excitation) {
        Some(sliding) => Ok(sliding.velocity(highest)),
        None => Ok(spectrum::velocity(&settle_not_sliding(*plant, excitation)?, highest)),
    }
}

/// The same with derivatives by the first `rows` lanes of the plant, one row for each.
///
/// # Errors
/// [`NoResponse::NotPeriodic`].
pub(crate) fn differentiate(
    variable: &Plant<Wide>,
    excitation: &Excitation,
    highest: usize,
    rows: usize,
) -> Result<(Vec<Complex>, Vec<Vec<Complex>>), NoResponse> {
    let plant = variable.map(Scalar::value);
    let (velocity, by_number) = match SlidingCosine::find(&plant, excitation) {
        Some(sliding) => {
            let velocity = sliding.velocity(highest);
            let by_number = sliding.sensitivities(excitation, &velocity);
            (velocity, by_number)
        }
        None => {
            let settled = settle_not_sliding(plant, excitation)?;
            let directions = sensitivity::parameter_directions(&plant, excitation);
            let settled = Differentiable::new(settled, highest);
            let by_number = settled.along(&directions);
            (settled.velocity, by_number)
        }
    };
    let rows = sensitivity::by_lane(variable, &velocity, &by_number, rows);
    Ok((velocity, rows))
}
