//! Initial value problem: one motion from a given state, over an input that need not be periodic.

use crate::effects::Axis;

use super::integrate_period::{LOOSE_TOLERANCE, PeriodIntegration, Precision, TIGHT_TOLERANCE};
use super::mechanics::{MOST_STATES, Mechanics};
use crate::simulate::response::NoResponse;
use crate::simulate::signal::piecewise_quintic::PiecewiseQuintic;
use crate::simulate::transient::motion::InitialState;
use crate::simulate::transient::recorder::Recorder;

/// Most effort for a motion, in exact steps: a constant part and a part for each cell of the
/// torque. Bounds the time for a record of 25 000 samples to seconds.
const BASE_EFFORT: usize = 1_000_000;
const EFFORT_PER_CELL: usize = 400;

/// Largest size of θ that the tolerance refers to, in radians of a torque that is periodic in θ.
const LARGEST_RIPPLE_ANGLE: f64 = 1.0;

/// Integrates the motion; `recorder` receives every step.
///
/// # Errors
/// [`NoResponse::Endless`].
pub(in super::super) fn follow(
    axis: &Axis,
    forcing: &PiecewiseQuintic<f64>,
    initial: &InitialState,
    recorder: &mut Recorder,
) -> Result<(), NoResponse> {
    let mut mechanics = Mechanics::new(axis);
    if axis.balanced {
        mechanics.balance = initial.balance.unwrap_or_else(|| mechanics.first_balance());
    }
    match mechanics.states {
        1 => follow_states::<1>(axis, &mechanics, forcing, initial, recorder),
        2 => follow_states::<2>(axis, &mechanics, forcing, initial, recorder),
        3 => follow_states::<3>(axis, &mechanics, forcing, initial, recorder),
        4 => follow_states::<4>(axis, &mechanics, forcing, initial, recorder),
        _ => follow_states::<MOST_STATES>(axis, &mechanics, forcing, initial, recorder),
    }
}

/// The same for M states. A loose pass finds the sizes of the states, to which the tolerance of the
/// second pass refers.
fn follow_states<const M: usize>(
    axis: &Axis,
    mechanics: &Mechanics<f64>,
    forcing: &PiecewiseQuintic<f64>,
    initial: &InitialState,
    recorder: &mut Recorder,
) -> Result<(), NoResponse> {
    let (least, most) = forcing.range();
    let start = mechanics.start::<M>(forcing.cells[0].number(0.0), initial);
    let mut sizes: [f64; M] = mechanics.sizes(least.abs().max(most.abs()), forcing.period_s);
    for (size, value) in sizes.iter_mut().zip(&start) {
        *size = size.max(value.abs());
    }
    let mut effort = BASE_EFFORT + EFFORT_PER_CELL * forcing.cells.len();
    let mut run = |tolerance: f64, sizes: [f64; M], trace: Option<&mut Recorder>| {
        // All oscillations on bristles are integrated: there is no period that averages them out.
        let precision = Precision { tolerance, sizes, most_swings: usize::MAX };
        let mut pass = PeriodIntegration {
            mechanics,
            forcing,
            precision: &precision,
            sums: None,
            companion: None,
            trace,
            largest: start.map(f64::abs),
            swings: 0,
            effort: &mut effort,
        };
        pass.run(&start).map(|_| pass.largest).ok_or(NoResponse::Endless)
    };
    let largest = run(LOOSE_TOLERANCE, sizes, None)?;
    for (size, largest) in sizes.iter_mut().zip(largest) {
        *size = if largest > 0.0 { largest } else { *size };
    }
    let ripple = axis.ripple_rate();
    if let Some(i) = mechanics.position.filter(|_| ripple > 0.0) {
        sizes[i] = sizes[i].min(LARGEST_RIPPLE_ANGLE / ripple);
    }
    run(TIGHT_TOLERANCE, sizes, Some(recorder)).map(|_| ())
}
