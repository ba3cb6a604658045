//! Motion under a bent cosine, its harmonics and their derivatives.
//!
//! As for the base model the motion is its switching instants, here found with
//! τ and w in closed form (`periodic::follow`), and x' = −a·x + τ − f gives
//! Vₖ = K·(Tₖ − Fₖ)/(jkω + a). The instants' derivatives follow from the equation
//! each of them solves: a slide from t_s ends where
//! w − w(t_s)·E − σ·(1 − E)/a = 0, E = exp(−a(t − t_s)), a rest where τ meets the
//! static level. Each depends on the instant before; the period closes the chain.

use crate::effects::{Axis, Wide};
use crate::measurement::Complex;
use crate::plant::{Actuator, Dual, Plant, Scalar};

use super::static_map_cosine::{BentCosine, Since, closed};
use crate::simulate::base::periodic;
use crate::simulate::base::periodic::Course;
use crate::simulate::base::spectrum::{PhaseIntegrals, sliding_friction, weight};
use crate::simulate::base::switching_times::{Motion, SwitchingTimes};
use crate::simulate::response::NoResponse;
use crate::simulate::shooting;
use crate::simulate::signal::complex_dual::ComplexDual;
use crate::simulate::signal::excitation::Excitation;
use crate::simulate::signal::samples::within_period;

/// Cells of a period, at least.
const CELLS: f64 = 16.0;

/// Time constants after which what rings at a kink is a millionth of it.
const RINGING: f64 = 14.0;

/// Radians of the actuator's own oscillation in one cell, at most.
const RADIANS_PER_CELL: f64 = 1.2;

/// Whether this is the way to the response of an axis.
pub(crate) fn applies<S: Scalar>(axis: &Axis<S>, excitation: &Excitation) -> bool {
    axis.rate_limit.is_none()
        && axis.is_piecewise_linear()
        && axis.damps_alike()
        && excitation.is_pure_cosine()
        && excitation.input()[1] != Complex::new(0.0, 0.0)
}

/// Velocity harmonics of the periodic motion.
pub(crate) fn respond(
    axis: &Axis,
    excitation: &Excitation,
    highest: usize,
) -> Result<Vec<Complex>, NoResponse> {
    let bent = BentCosine::new(axis, excitation);
    let orbit = orbit(axis, &bent)?;
    let mut velocity: Vec<Complex> =
        velocity(axis, &bent, &orbit, highest).into_iter().map(ComplexDual::value).collect();
    lead(excitation, &mut velocity);
    Ok(velocity)
}

/// The same with derivatives by the first `rows` lanes of the axis.
pub(crate) fn differentiate(
    axis: &Axis<Wide>,
    values: &Axis,
    excitation: &Excitation,
    highest: usize,
    rows: usize,
) -> Result<(Vec<Complex>, Vec<Vec<Complex>>), NoResponse> {
    let orbit = orbit(values, &BentCosine::new(values, excitation))?;
    if rows <= 8 {
        let narrow = shooting::narrowed::<8>(axis, 0, rows);
        Ok(along::<Dual<8>>(&narrow, excitation, &orbit, highest, rows))
    } else {
        Ok(along(axis, excitation, &orbit, highest, rows))
    }
}

fn along<S: Scalar>(
    axis: &Axis<S>,
    excitation: &Excitation,
    orbit: &SwitchingTimes,
    highest: usize,
    rows: usize,
) -> (Vec<Complex>, Vec<Vec<Complex>>) {
    let harmonics = velocity(axis, &BentCosine::new(axis, excitation), orbit, highest);
    let mut values: Vec<Complex> = harmonics.iter().map(|v| v.value()).collect();
    let lane = |lane: usize| harmonics.iter().map(|v| v.lane(lane)).collect();
    let mut sensitivities: Vec<Vec<Complex>> = (0..rows).map(lane).collect();
    lead(excitation, &mut values);
    sensitivities.iter_mut().for_each(|row| lead(excitation, row));
    (values, sensitivities)
}

/// Turns harmonics from a time origin at the cosine's peak to that of the input.
fn lead(excitation: &Excitation, harmonics: &mut [Complex]) {
    let phase = excitation.input()[1].arg();
    if phase != 0.0 {
        for (k, harmonic) in harmonics.iter_mut().enumerate() {
            *harmonic *= Complex::from_polar(1.0, k as f64 * phase);
        }
    }
}

fn orbit(axis: &Axis, bent: &BentCosine<f64>) -> Result<SwitchingTimes, NoResponse> {
    let plant = Plant { friction: axis.levels(), ..axis.plant };
    periodic::follow(&plant, &Cells::new(bent), bent.period_s())
}

/// A bent cosine in cells.
struct Cells<'a> {
    bent: &'a BentCosine<f64>,
    /// Their ends, seconds.
    times: Vec<f64>,
    /// τ and w there.
    nodes: Vec<(f64, f64)>,
    cells: Vec<Cell>,
}

struct Cell {
    piece: usize,
    kept: f64,
    rate_at_end: f64,
}

impl<'a> Cells<'a> {
    fn new(bent: &'a BentCosine<f64>) -> Self {
        let smooth_s = bent.period_s() / CELLS;
        // Until when a piece rings, and how long its cells may be until then.
        let (until_s, ringing_s) = match bent.actuator {
            Actuator::SecondOrder { natural_frequency_rad_s: wn, damping_ratio: zeta } => {
                (RINGING / (zeta * wn), smooth_s.min(RADIANS_PER_CELL / wn))
            }
            _ => (0.0, smooth_s),
        };
        let mut these = Self { bent, times: vec![0.0], nodes: Vec::new(), cells: Vec::new() };
        for (index, piece) in bent.pieces.iter().enumerate() {
            let mut since = Since::start(Complex::from_polar(1.0, bent.omega * piece.from_s));
            if index == 0 {
                let start = bent.evaluate(piece, &since);
                these.nodes.push((start.torque, start.steady));
            }
            let ringing = piece.length_s.min(until_s);
            let stretches = [(0.0, ringing, ringing_s), (ringing, piece.length_s, smooth_s)];
            for (from_s, to_s, longest_s) in stretches.into_iter().filter(|(from, to, _)| to > from)
            {
                let count = ((to_s - from_s) / longest_s).ceil();
                let step = bent.lapse((to_s - from_s) / count);
                for n in 1..=count as usize {
                    since = since.after(&step);
                    let end = bent.evaluate(piece, &since);
                    let share = n as f64 / count;
                    these.times.push(piece.from_s + from_s + (to_s - from_s) * share);
                    these.nodes.push((end.torque, end.steady));
                    these.cells.push(Cell { piece: index, kept: step.kept, rate_at_end: end.rate });
                }
            }
        }
        these
    }
}

impl Course for Cells<'_> {
    fn cells(&self) -> usize {
        self.cells.len()
    }

    fn time(&self, n: usize) -> f64 {
        self.times[n]
    }

    fn kept(&self, cell: usize) -> f64 {
        self.cells[cell].kept
    }

    fn node(&self, n: usize) -> (f64, f64) {
        self.nodes[n]
    }

    fn rate_at_end(&self, cell: usize) -> f64 {
        self.cells[cell].rate_at_end
    }

    fn torque(&self, cell: usize, time_s: f64) -> (f64, f64) {
        let signals = self.bent.at(&self.bent.pieces[self.cells[cell].piece], time_s);
        (signals.torque, signals.rate)
    }

    fn both(&self, cell: usize, time_s: f64) -> (f64, f64) {
        let signals = self.bent.at(&self.bent.pieces[self.cells[cell].piece], time_s);
        (signals.torque, signals.steady)
    }
}

/// V₀ … V_H of a motion.
fn velocity<S: Scalar>(
    axis: &Axis<S>,
    bent: &BentCosine<S>,
    orbit: &SwitchingTimes,
    highest: usize,
) -> Vec<ComplexDual<S>> {
    let zero = ComplexDual::real(S::constant(0.0));
    if !orbit.switches() && orbit.sticks() {
        return vec![zero; highest + 1];
    }
    let levels = axis.levels();
    let spans = PhaseIntegrals::new(orbit, highest);
    let sliding = spans.forward.iter().zip(&spans.backward);
    // ∫ f exp(−jkωt) dt.
    let mut friction: Vec<ComplexDual<S>> = sliding
        .map(|(forward, backward)| {
            ComplexDual::real(levels.fc_plus) * *forward
                - ComplexDual::real(levels.fc_minus) * *backward
        })
        .collect();
    for (start, end, motion) in (0..orbit.phases.len()).map(|i| orbit.span(i)) {
        if motion == Motion::Stuck {
            for span in within_period((start, end), orbit.period_s) {
                bent.add_integrals(span, &mut friction);
            }
        }
    }
    if S::LANES > 0 && orbit.switches() {
        add_moves(axis, bent, orbit, &mut friction);
    }
    let torque = bent.lines(highest);
    let velocity = |(k, (torque, friction)): (usize, (ComplexDual<S>, ComplexDual<S>))| {
        let s_plus_a =
            ComplexDual::new(axis.plant.viscous_rate_rad_s, S::constant(k as f64 * bent.omega));
        let share = S::constant(weight(k, orbit.period_s));
        let force = (torque - friction.scaled(share)).scaled(axis.plant.constant);
        force * s_plus_a.inverse()
    };
    torque.into_iter().zip(friction).enumerate().map(velocity).collect()
}

/// Adds what the moving instants contribute to ∫ f exp(−jkωt) dt.
fn add_moves<S: Scalar>(
    axis: &Axis<S>,
    bent: &BentCosine<S>,
    orbit: &SwitchingTimes,
    friction: &mut [ComplexDual<S>],
) {
    let (levels, a) = (axis.levels(), axis.plant.viscous_rate_rad_s);
    let phases = &orbit.phases;
    let signals: Vec<_> =
        phases.iter().map(|p| bent.at(bent.piece_of(p.start_s), p.start_s)).collect();
    let links: Vec<_> = (0..phases.len())
        .map(|i| {
            let previous = orbit.before(i);
            let (start, end, motion) = orbit.span(previous);
            let (first, last) = (signals[previous], signals[i]);
            let (zero, one) = (S::constant(0.0), S::constant(1.0));
            let Some(level) = sliding_friction(&levels, motion) else {
                let level = if phases[i].motion == Motion::Forward {
                    levels.fs_plus
                } else {
                    -levels.fs_minus
                };
                let change = (level - last.torque) * (1.0 / last.rate.value());
                return (ComplexDual::real(zero), ComplexDual::real(change));
            };
            let kept = (a * (start - end)).exp();
            let x = last.steady - first.steady * kept - level * (one - kept) / a;
            let per_rate = 1.0 / (last.torque.value() - level.value());
            let by_previous = kept.value() * (first.torque.value() - level.value()) * per_rate;
            (ComplexDual::real(S::constant(by_previous)), ComplexDual::real(-x * per_rate))
        })
        .collect();
    let moves = closed(&links);
    for i in 0..phases.len() {
        // States of the chain stand before their link: the next is this instant's.
        let moved = moves[(i + 1) % phases.len()].re;
        let held = |phase: usize| {
            let sliding = sliding_friction(&levels, phases[phase].motion);
            sliding.unwrap_or(signals[i].torque).value()
        };
        let jump = moved * (held(orbit.before(i)) - held(i));
        let turn = Complex::from_polar(1.0, -bent.omega * phases[i].start_s);
        let mut at = Complex::new(1.0, 0.0);
        for sum in friction.iter_mut() {
            *sum = *sum + ComplexDual::new(jump * at.re, jump * at.im);
            at *= turn;
        }
    }
}

#[cfg(test)]
mod tests;
