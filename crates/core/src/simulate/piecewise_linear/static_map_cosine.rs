//! The torque behind the actuator when static maps bend a cosine, in closed form.
//!
//! Static maps make u = m·cos ωt a sequence of pieces o + s·m·cos ωt, which meet
//! where the cosine passes a break. Behind the actuator, since a piece's start tᵢ,
//!
//! τ = o + s·Re T·exp(jωt) + Re Σ C·exp(λ(t − tᵢ)),   T = A(jω)·m,
//!
//! the sum being over the actuator's modes λ; what a kink excites is the
//! difference of two pieces' particular solutions, and the period closes the
//! chain of them. w, the steady response of 1/(s + a) to τ, follows in the same
//! way. u is continuous, so a kink that moves with a parameter changes nothing to
//! first order: instants of kinks are plain numbers. The time origin is a peak of
//! the cosine, whatever its phase.

use std::f64::consts::TAU;

use crate::effects::{Axis, InputMap};
use crate::measurement::Complex;
use crate::plant::{Actuator, Scalar};

use super::drive::{Mode, modes, response};
use crate::simulate::signal::complex_dual::ComplexDual;
use crate::simulate::signal::excitation::Excitation;

mod integrals;

/// Below this |(λ + a)·t| the mode's part of w is a series, which the first term
/// left out makes good to 1e-15.
const ALIKE: f64 = 0.01;

/// Most modes of an actuator.
const MODES: usize = 2;

/// Torque and steady response of one bent cosine.
pub(crate) struct BentCosine<S> {
    /// Of the cosine, rad/s.
    pub omega: f64,
    /// The pieces of a period, from a peak of the cosine on.
    pub pieces: Vec<Piece<S>>,
    /// m, input units.
    magnitude: f64,
    /// A(s).
    pub actuator: Actuator<S>,
    /// a, rad/s.
    viscous_rate: S,
    modes: Vec<Mode<S>>,
    /// 1/(λ + a) of each mode; a number only where it is used.
    through: [ComplexDual<S>; MODES],
    /// T = A(jω)·m.
    torque: ComplexDual<S>,
    /// T/(jω + a).
    steady: ComplexDual<S>,
}

/// One piece.
pub(crate) struct Piece<S> {
    /// Start, seconds.
    pub from_s: f64,
    /// Length, seconds.
    pub length_s: f64,
    /// o, input units.
    offset: S,
    /// s.
    slope: S,
    /// C of each mode.
    excited: [ComplexDual<S>; MODES],
    /// What of w dies out with exp(−at).
    free: S,
}

/// Factors by which parts of the signal have changed since a piece began.
#[derive(Clone, Copy)]
pub(crate) struct Since<S> {
    time_s: f64,
    /// exp(jωt), t counted from the origin.
    turn: Complex,
    /// exp(λt) of each mode.
    decay: [ComplexDual<S>; MODES],
    /// exp(−at).
    pub kept: S,
}

impl<S: Scalar> Since<S> {
    /// At the start of a piece.
    pub fn start(turn: Complex) -> Self {
        let one = S::constant(1.0);
        Self { time_s: 0.0, turn, decay: [ComplexDual::real(one); MODES], kept: one }
    }

    /// After a further step.
    pub fn after(self, step: &Self) -> Self {
        Self {
            time_s: self.time_s + step.time_s,
            turn: self.turn * step.turn,
            decay: std::array::from_fn(|m| self.decay[m] * step.decay[m]),
            kept: self.kept * step.kept,
        }
    }
}

/// The signals at an instant.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Signals<S> {
    /// τ.
    pub torque: S,
    /// τ', per second.
    pub rate: S,
    /// w.
    pub steady: S,
}

impl<S: Scalar> BentCosine<S> {
    /// Behind the maps and the actuator of an axis.
    pub fn new(axis: &Axis<S>, excitation: &Excitation) -> Self {
        let omega = excitation.omega_rad_s();
        let magnitude = excitation.input()[1].norm();
        let actuator = axis.plant.actuator;
        let viscous_rate = axis.plant.viscous_rate_rad_s;
        let modes = modes(&actuator);
        let torque = response(&actuator, omega).scaled(S::constant(magnitude));
        let zero = ComplexDual::real(S::constant(0.0));
        let mut through = [zero; MODES];
        for (through, mode) in through.iter_mut().zip(&modes) {
            *through = (mode.rate + ComplexDual::real(viscous_rate)).inverse();
        }
        let steady = torque * ComplexDual::new(viscous_rate, S::constant(omega)).inverse();
        let mut this = Self {
            omega,
            pieces: pieces(&axis.input_maps, magnitude, omega),
            magnitude,
            actuator,
            viscous_rate,
            modes,
            through,
            torque,
            steady,
        };
        this.excite();
        this
    }

    /// Period, seconds.
    pub fn period_s(&self) -> f64 {
        TAU / self.omega
    }

    /// The factors after so many seconds.
    pub fn lapse(&self, time_s: f64) -> Since<S> {
        let mut since = Since::start(Complex::from_polar(1.0, self.omega * time_s));
        since.time_s = time_s;
        since.kept = (self.viscous_rate * -time_s).exp();
        for (decay, mode) in since.decay.iter_mut().zip(&self.modes) {
            let exponent = mode.rate.scaled(S::constant(time_s));
            *decay = if mode.count == 1.0 {
                ComplexDual::real(exponent.re.exp())
            } else {
                exponent.exp()
            };
        }
        since
    }

    /// The signals at an instant of a piece.
    #[inline]
    pub fn at(&self, piece: &Piece<S>, time_s: f64) -> Signals<S> {
        let mut since = self.lapse(time_s - piece.from_s);
        since.turn = Complex::from_polar(1.0, self.omega * time_s);
        self.evaluate(piece, &since)
    }

    /// The piece an instant of the period lies in.
    pub fn piece_of(&self, time_s: f64) -> &Piece<S> {
        let after = self.pieces.partition_point(|piece| piece.from_s <= time_s);
        &self.pieces[after.max(1) - 1]
    }

    /// The signals where the factors are known.
    #[inline]
    pub fn evaluate(&self, piece: &Piece<S>, since: &Since<S>) -> Signals<S> {
        let turned = self.torque * since.turn;
        let mut signals = Signals {
            torque: piece.offset + piece.slope * turned.re,
            rate: piece.slope * turned.im * -self.omega,
            steady: self.driven(piece, since.turn) + piece.free * since.kept,
        };
        for (m, mode) in self.modes.iter().enumerate() {
            let left = piece.excited[m] * since.decay[m];
            signals.torque += left.re;
            signals.rate += (left * mode.rate).re;
            signals.steady += (piece.excited[m] * self.lagged(m, since)).re;
        }
        signals
    }

    /// What a piece's own drive makes of w.
    fn driven(&self, piece: &Piece<S>, turn: Complex) -> S {
        piece.offset / self.viscous_rate + piece.slope * (self.steady * turn).re
    }

    /// (exp(λt) − exp(−at))/(λ + a): 1/(s + a) of what is left of a mode.
    fn lagged(&self, mode: usize, since: &Since<S>) -> ComplexDual<S> {
        let sum = self.modes[mode].rate + ComplexDual::real(self.viscous_rate);
        if sum.value().norm() * since.time_s > ALIKE {
            return (since.decay[mode] - ComplexDual::real(since.kept)) * self.through[mode];
        }
        let z = sum.scaled(S::constant(since.time_s));
        let one = ComplexDual::real(S::constant(1.0));
        let factor = (2..7).rev().fold(one, |sum, i| {
            let share = S::constant(1.0 / f64::from(i));
            one + (sum * z).scaled(share)
        });
        factor.scaled(since.kept * since.time_s)
    }

    /// Finds what kinks excite, from piece to piece and around the period.
    fn excite(&mut self) {
        let count = self.pieces.len();
        let lapses: Vec<Since<S>> =
            self.pieces.iter().map(|piece| self.lapse(piece.length_s)).collect();
        // Every piece but the first begins where the one before it ends.
        let kinks: Vec<(usize, Complex)> = (1..=count)
            .map(|i| i % count)
            .map(|i| (i, Complex::from_polar(1.0, self.omega * self.pieces[i].from_s)))
            .collect();
        for m in 0..self.modes.len() {
            let Mode { rate, residue, count: twins } = self.modes[m];
            let residue = residue.scaled(S::constant(twins));
            let by_offset = residue * rate.inverse();
            // The mode's answer to cos ωt is (ω·sin ωt − λ·cos ωt)/(ω² + λ²).
            let size =
                (rate * rate + ComplexDual::real(S::constant(self.omega * self.omega))).inverse();
            let by_slope = (residue * size).scaled(S::constant(self.magnitude));
            let links = kinks.iter().zip(&self.pieces).zip(&lapses);
            let links: Vec<_> = links
                .map(|(((next, turn), before), lapse)| {
                    let here = &self.pieces[*next];
                    let wave = rate.scaled(S::constant(turn.re))
                        + ComplexDual::real(S::constant(-self.omega * turn.im));
                    let jump = by_offset.scaled(here.offset - before.offset)
                        + (by_slope * wave).scaled(here.slope - before.slope);
                    (lapse.decay[m], jump)
                })
                .collect();
            for (piece, state) in self.pieces.iter_mut().zip(closed(&links)) {
                piece.excited[m] = state;
            }
        }
        let links = kinks.iter().zip(&self.pieces).zip(&lapses);
        let links: Vec<_> = links
            .map(|(((next, turn), before), lapse)| {
                let lagged = (0..self.modes.len())
                    .map(|m| (before.excited[m] * self.lagged(m, lapse)).re)
                    .fold(S::constant(0.0), |sum, part| sum + part);
                let driven = self.driven(before, *turn) - self.driven(&self.pieces[*next], *turn);
                (ComplexDual::real(lapse.kept), ComplexDual::real(driven + lagged))
            })
            .collect();
        for (piece, state) in self.pieces.iter_mut().zip(closed(&links)) {
            piece.free = state.re;
        }
    }
}

impl<S> Piece<S> {
    /// End, seconds.
    pub fn end_s(&self) -> f64 {
        self.from_s + self.length_s
    }
}

/// Periodic states of the chain sᵢ₊₁ = fᵢ·sᵢ + gᵢ, given all (fᵢ, gᵢ).
pub(crate) fn closed<S: Scalar>(links: &[(ComplexDual<S>, ComplexDual<S>)]) -> Vec<ComplexDual<S>> {
    let (zero, one) = (ComplexDual::real(S::constant(0.0)), ComplexDual::real(S::constant(1.0)));
    let (kept, gained) =
        links.iter().fold((one, zero), |(kept, state), (f, g)| (kept * *f, state * *f + *g));
    let first = gained * (one - kept).inverse();
    links
        .iter()
        .scan(first, |state, (f, g)| {
            let here = *state;
            *state = here * *f + *g;
            Some(here)
        })
        .collect()
}

/// The pieces of a cosine behind static maps, from a peak to the next.
fn pieces<S: Scalar>(maps: &[InputMap<S>], magnitude: f64, omega: f64) -> Vec<Piece<S>> {
    let (zero, one) = (S::constant(0.0), S::constant(1.0));
    // Stretches of u with the offset and slope they leave the maps with, ascending.
    let mut stretches = vec![(-magnitude, magnitude, zero, one)];
    for map in maps {
        let mut mapped = Vec::with_capacity(stretches.len() + map.breaks.len());
        for (low, high, offset, slope) in stretches {
            let (o, s) = (offset.value(), slope.value());
            let mut cuts = vec![low];
            cuts.extend(
                map.breaks.iter().map(|at| (at.value() - o) / s).filter(|u| *u > low && *u < high),
            );
            cuts.push(high);
            cuts.sort_by(f64::total_cmp);
            for cut in cuts.windows(2) {
                let middle = o + s * 0.5 * (cut[0] + cut[1]);
                let index = map.breaks.iter().filter(|at| at.value() < middle).count();
                let (added, factor) = map.piece(index);
                mapped.push((cut[0], cut[1], added + factor * offset, factor * slope));
            }
        }
        stretches = mapped;
    }
    let zeros = [ComplexDual::real(zero); MODES];
    let angle = |u: f64| (u / magnitude).clamp(-1.0, 1.0).acos();
    let falling =
        stretches.iter().rev().map(|(low, high, o, s)| (angle(*high), angle(*low), *o, *s));
    let rising =
        stretches.iter().map(|(low, high, o, s)| (TAU - angle(*low), TAU - angle(*high), *o, *s));
    falling
        .chain(rising)
        .filter(|(from, to, ..)| to > from)
        .map(|(from, to, offset, slope)| Piece {
            from_s: from / omega,
            length_s: (to - from) / omega,
            offset,
            slope,
            excited: zeros,
            free: zero,
        })
        .collect()
}

#[cfg(test)]
mod tests;
