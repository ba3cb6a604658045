//! An initial value problem: one motion from a given state to the end of an input that need not
//! repeat.

use crate::effects::Axis;

use super::integrate_period::{LOOSE, PeriodIntegration, Precision, TIGHT};
use super::mechanics::{MOST_STATES, Mechanics};
use crate::simulate::response::NoResponse;
use crate::simulate::signal::piecewise_quintic::PiecewiseQuintic;
use crate::simulate::transient::motion::InitialState;
use crate::simulate::transient::recorder::Recorder;

/// Effort for a motion, in exact steps, and what is added for each cell: it bounds a record
/// of 25 000 samples to seconds.
const EFFORT: usize = 1_000_000;
const EFFORT_PER_CELL: usize = 400;

/// Radians of a ripple within which the error of θ is a share.
const RIPPLE: f64 = 1.0;

/// Follows the motion and lets `recorder` see every step of it.
pub(in super::super) fn follow(
    axis: &Axis,
    wave: &PiecewiseQuintic<f64>,
    initial: &InitialState,
    recorder: &mut Recorder,
) -> Result<(), NoResponse> {
    let mut mechanics = Mechanics::new(axis);
    if axis.balanced {
        mechanics.balance = initial.balance.unwrap_or_else(|| mechanics.first_balance());
    }
    match mechanics.states {
        1 => of_states::<1>(axis, &mechanics, wave, initial, recorder),
        2 => of_states::<2>(axis, &mechanics, wave, initial, recorder),
        3 => of_states::<3>(axis, &mechanics, wave, initial, recorder),
        _ => of_states::<MOST_STATES>(axis, &mechanics, wave, initial, recorder),
    }
}

fn of_states<const M: usize>(
    axis: &Axis,
    mechanics: &Mechanics<f64>,
    wave: &PiecewiseQuintic<f64>,
    initial: &InitialState,
    recorder: &mut Recorder,
) -> Result<(), NoResponse> {
    let (least, most) = wave.range();
    let start = mechanics.start::<M>(wave.cells[0].number(0.0), initial);
    let mut sizes: [f64; M] = mechanics.sizes(least.abs().max(most.abs()), wave.period_s);
    for (size, value) in sizes.iter_mut().zip(&start) {
        *size = size.max(value.abs());
    }
    let mut effort = EFFORT + EFFORT_PER_CELL * wave.cells.len();
    let mut run = |tolerance: f64, sizes: [f64; M], trace: Option<&mut Recorder>| {
        // Every swing on bristles counts: there is no period over which they average out.
        let precision = Precision { tolerance, sizes, most_swings: usize::MAX };
        let mut pass = PeriodIntegration {
            mechanics,
            wave,
            precision: &precision,
            sums: None,
            trace,
            largest: start.map(f64::abs),
            swings: 0,
            effort: &mut effort,
        };
        pass.run(&start).map(|_| pass.largest).ok_or(NoResponse::Endless)
    };
    let largest = run(LOOSE, sizes, None)?;
    for (size, largest) in sizes.iter_mut().zip(largest) {
        *size = if largest > 0.0 { largest } else { *size };
    }
    let ripple = axis.ripple_rate();
    if let Some(i) = mechanics.position.filter(|_| ripple > 0.0) {
        sizes[i] = sizes[i].min(RIPPLE / ripple);
    }
    run(TIGHT, sizes, Some(recorder)).map(|_| ())
}
