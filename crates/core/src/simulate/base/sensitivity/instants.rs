//! How the switching times move along a direction of differentiation.

use crate::measurement::Complex;
use crate::plant::Plant;

use super::Direction;
use crate::simulate::base::Settled;
use crate::simulate::base::spectrum::sliding_friction;
use crate::simulate::base::switching_times::{Motion, Phase};
use crate::simulate::base::turns;

/// Directions whose moves are summed side by side.
const SIDE_BY_SIDE: usize = 4;

/// What is known of each switching time, whatever the direction of differentiation.
pub(super) struct Instants(Vec<Instant>);

/// A switching time tᵢ, and the phase that ends there.
struct Instant {
    torque: f64,
    torque_rate: f64,
    /// w: steady response of 1/(s + a) to the torque.
    steady: f64,
    /// ∂w/∂a.
    steady_by_rate: f64,
    /// The slide that ends here; `None` at the end of a phase of rest.
    slide: Option<Slide>,
}

/// How the end of a slide depends on its beginning and on the parameters.
struct Slide {
    motion: Motion,
    /// E.
    kept: f64,
    /// (1 − E)/a.
    lost: f64,
    /// ∂g/∂a at fixed w.
    by_rate: f64,
    /// A of dtᵢ = A·dtᵢ₋₁ + B.
    carried: f64,
    /// ∂g/∂t at the end.
    slope: f64,
}

/// The change of τ and of w at each switching time along a direction.
struct Changes {
    torque: Vec<f64>,
    steady: Vec<f64>,
}

impl Instants {
    pub fn new(settled: &Settled<'_>) -> Self {
        let Settled { plant, lines, orbit, .. } = settled;
        let omega = std::f64::consts::TAU / orbit.period_s;
        let count = if orbit.switches() { orbit.phases.len() } else { 0 };
        let instant = |phase: &Phase| {
            let turn = Complex::from_polar(1.0, omega * phase.start_s);
            let mut at = Complex::ONE;
            let [mut value, mut rate_s, mut steady, mut steady_by_rate] = [0.0; 4];
            for (l, line) in lines.iter().enumerate() {
                let rate = l as f64 * omega;
                let torque = line * at;
                let through = through(plant, rate);
                let response = torque * through;
                value += torque.re;
                rate_s -= rate * torque.im;
                steady += response.re;
                steady_by_rate -= (response * through).re;
                at *= turn;
            }
            Instant { torque: value, torque_rate: rate_s, steady, steady_by_rate, slide: None }
        };
        let mut these: Vec<Instant> = orbit.phases.iter().take(count).map(instant).collect();
        for i in 0..count {
            let previous = orbit.before(i);
            let (start, end, motion) = orbit.span(previous);
            let Some(friction) = sliding_friction(&plant.friction, motion) else { continue };
            let (a, duration) = (plant.viscous_rate_rad_s, end - start);
            let lost = -(-a * duration).exp_m1(); // 1 − E
            let kept = 1.0 - lost;
            let slope = these[i].torque - friction;
            these[i].slide = Some(Slide {
                motion,
                kept,
                lost: lost / a,
                by_rate: these[previous].steady * duration * kept
                    + friction * (lost / a - duration * kept) / a,
                carried: kept * (these[previous].torque - friction) / slope,
                slope,
            });
        }
        Self(these)
    }

    /// Adds to ∫ f exp(−jkωt) dt what the moving switching times contribute along each direction:
    /// the jump of f at each time, times the derivative of the time.
    pub fn add_moves(
        &self,
        settled: &Settled<'_>,
        directions: &[Direction],
        friction: &mut [Vec<Complex>],
    ) {
        let orbit = &settled.orbit;
        if !orbit.switches() {
            return;
        }
        let sticks = orbit.sticks();
        let moving =
            directions.iter().zip(friction).filter(|(direction, _)| direction.moves(sticks));
        let (moves, mut friction): (Vec<Vec<f64>>, Vec<&mut Vec<Complex>>) =
            moving.map(|(direction, friction)| (self.moves(settled, direction), friction)).unzip();
        let groups = moves.chunks(SIDE_BY_SIDE).zip(friction.chunks_mut(SIDE_BY_SIDE));
        for (moves, friction) in groups {
            match moves.len() {
                1 => self.add::<1>(settled, moves, friction),
                2 => self.add::<2>(settled, moves, friction),
                _ => self.add::<SIDE_BY_SIDE>(settled, moves, friction),
            }
        }
    }

    /// Adds the moves along at most D directions.
    fn add<const D: usize>(
        &self,
        settled: &Settled<'_>,
        moves: &[Vec<f64>],
        friction: &mut [&mut Vec<Complex>],
    ) {
        let Settled { plant, orbit, .. } = settled;
        let instant = |i: usize| {
            let level = |phase: usize| {
                sliding_friction(&plant.friction, orbit.phases[phase].motion)
                    .unwrap_or(self.0[i].torque)
            };
            let jump = level(orbit.before(i)) - level(i);
            let weights =
                std::array::from_fn(|d| moves.get(d).map_or(0.0, |moves| jump * moves[i]));
            (orbit.phases[i].start_s, weights)
        };
        let instants: Vec<(f64, [f64; D])> = (0..orbit.phases.len()).map(instant).collect();
        let highest = friction.first().map_or(0, |row| row.len() - 1);
        for (k, sums) in turns::sums(&instants, orbit.period_s, highest).into_iter().enumerate() {
            friction.iter_mut().zip(sums).for_each(|(row, sum)| row[k] += sum);
        }
    }

    /// The derivatives of the switching times along a direction.
    fn moves(&self, settled: &Settled<'_>, direction: &Direction) -> Vec<f64> {
        let count = settled.orbit.phases.len();
        let changes = self.changes(settled, direction);
        let links: Vec<(f64, f64)> =
            (0..count).map(|i| self.link(settled, direction, &changes, i)).collect();
        let (product, offset) =
            links.iter().fold((1.0, 0.0), |(p, b), (a_i, b_i)| (p * a_i, b * a_i + b_i));
        // After a period the derivative of the last time must be the same again.
        let mut change = offset / (1.0 - product);
        let next = |(a_i, b_i): &(f64, f64)| {
            change = a_i * change + b_i;
            change
        };
        links.iter().map(next).collect()
    }

    fn changes(&self, settled: &Settled<'_>, direction: &Direction) -> Changes {
        let Settled { plant, orbit, .. } = settled;
        let omega = std::f64::consts::TAU / orbit.period_s;
        let by_rate = |value: f64| direction.viscous_rate * value;
        let mut these = Changes {
            torque: vec![0.0; self.0.len()],
            steady: self.0.iter().map(|instant| by_rate(instant.steady_by_rate)).collect(),
        };
        if direction.lines.is_empty() {
            return these;
        }
        let through = |l: usize| through(plant, l as f64 * omega);
        let through: Vec<Complex> = (0..direction.lines.len()).map(through).collect();
        for (i, phase) in orbit.phases.iter().enumerate() {
            let turn = Complex::from_polar(1.0, omega * phase.start_s);
            let mut at = Complex::ONE;
            for (line, through) in direction.lines.iter().zip(&through) {
                let change = line * at;
                these.torque[i] += change.re;
                these.steady[i] += (change * through).re;
                at *= turn;
            }
        }
        these
    }

    /// The coefficients A and B of dtᵢ = A·dtᵢ₋₁ + B.
    fn link(
        &self,
        settled: &Settled<'_>,
        direction: &Direction,
        changes: &Changes,
        i: usize,
    ) -> (f64, f64) {
        let orbit = &settled.orbit;
        let Some(slide) = &self.0[i].slide else {
            let level = direction.breakaway(orbit.phases[i].motion);
            return (0.0, (level - changes.torque[i]) / self.0[i].torque_rate);
        };
        let change = changes.steady[i]
            - changes.steady[orbit.before(i)] * slide.kept
            - direction.sliding(slide.motion) * slide.lost
            + direction.viscous_rate * slide.by_rate;
        (slide.carried, -change / slide.slope)
    }
}

/// 1/(jω + a).
fn through(plant: &Plant, omega: f64) -> Complex {
    1.0 / Complex::new(plant.viscous_rate_rad_s, omega)
}
