//! The paper's block diagram taken literally: friction fed back around the whole linear block.
//!
//! ```text
//!   y‴ + 15 y″ + 1050 y′ + 10000 y = 10000 (u − f(y)),   f = Fc⁺ for y > 0, −Fc⁻ for y < 0
//! ```
//!
//! G2 has three more poles than zeros, so a relay around it cannot hold y at 0, and it oscillates
//! without any input. Points whose response does not have the excitation's period are refused.

use std::f64::consts::TAU;

use super::super::system::{System, reported};

/// y, y′, y″.
type State = [f64; 3];

/// Longest step of the fourth-order integration, s: 1/390 of the shortest period of the design
/// (80 rad/s).
const STEP_S: f64 = 2e-4;

/// Time after which transients have decayed to less than 1e-12, s. The slowest poles are at
/// −2.5 1/s (in open loop).
const SETTLING_S: f64 = 15.0;

/// Largest change of the state over a period, as a share of its range, of a periodic response.
const PERIODICITY_TOLERANCE: f64 = 1e-6;

/// The limit cycle without input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SelfOscillation {
    /// Its frequency, rad/s.
    pub omega_rad_s: f64,
    /// Half its peak-to-peak value.
    pub amplitude: f64,
    /// Its mean.
    pub mean: f64,
}

/// Behaviour of the topology.
#[derive(Debug, Clone, PartialEq)]
pub struct Topology {
    /// Its oscillation without input.
    pub alone: SelfOscillation,
    /// Number of points of the design with a response of the excitation's period.
    pub periodic: usize,
    /// Points refused: magnitude, and frequency in rad/s.
    pub refused: Vec<(f64, f64)>,
}

/// Simulates G2 with the friction of the paper, without input and at every point of the design.
pub(super) fn measure() -> Topology {
    let design = System::G2.draw().design;
    let (periodic, refused): (Vec<_>, Vec<_>) =
        design.into_iter().partition(|(magnitude, omega)| is_periodic(*magnitude, *omega));
    Topology { alone: alone(), periodic: periodic.len(), refused }
}

fn alone() -> SelfOscillation {
    let mut state = [1e-3, 0.0, 0.0];
    let still = |_: f64| 0.0;
    run(&mut state, &still, 0.0, SETTLING_S, &mut |_, _, _| ());
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut rises: Vec<f64> = Vec::new();
    let mut integrals: Vec<f64> = Vec::new();
    let mut integral = 0.0;
    run(&mut state, &still, 0.0, SETTLING_S, &mut |time_s, length_s, [from, to]| {
        low = low.min(to[0]);
        high = high.max(to[0]);
        // Integral of the cubic Hermite interpolant, of the same order as the steps.
        integral +=
            0.5 * length_s * (from[0] + to[0]) + length_s.powi(2) / 12.0 * (from[1] - to[1]);
        if from[0] < 0.0 && to[0] >= 0.0 {
            rises.push(time_s);
            integrals.push(integral);
        }
    });
    let periods = (rises.len() - 1) as f64;
    let span_s = rises[rises.len() - 1] - rises[0];
    SelfOscillation {
        omega_rad_s: TAU * periods / span_s,
        amplitude: 0.5 * (high - low),
        mean: (integrals[integrals.len() - 1] - integrals[0]) / span_s,
    }
}

fn is_periodic(magnitude: f64, omega: f64) -> bool {
    let input = |time_s: f64| magnitude * (omega * time_s).cos();
    let period_s = TAU / omega;
    let settling = (SETTLING_S / period_s).ceil() * period_s;
    let mut state = [1e-3, 0.0, 0.0];
    run(&mut state, &input, 0.0, settling, &mut |_, _, _| ());
    let mut range: State = [0.0; 3];
    let before = state;
    run(&mut state, &input, 0.0, period_s, &mut |_, _, [_, to]| {
        (0..3).for_each(|i| range[i] = range[i].max(to[i].abs()));
    });
    (0..3).all(|i| (state[i] - before[i]).abs() <= PERIODICITY_TOLERANCE * range[i])
}

/// Integrates from one time to another. A step in which y changes sign is divided there. `on_step`
/// is called for every part with the time at its end, its length, and the states at both ends.
fn run(
    state: &mut State,
    input: &dyn Fn(f64) -> f64,
    from_s: f64,
    to_s: f64,
    on_step: &mut dyn FnMut(f64, f64, [State; 2]),
) {
    let friction = reported(&System::G2.plant());
    let levels = [-friction["fc_minus"], friction["fc_plus"]];
    let steps = ((to_s - from_s) / STEP_S).ceil() as usize;
    let mut time_s = from_s;
    // The direction of the next step; if y = 0, that of its first derivative.
    let mut forward = if state[0] == 0.0 { state[1] > 0.0 } else { state[0] > 0.0 };
    for step in 1..=steps {
        let end_s = from_s + (to_s - from_s) * step as f64 / steps as f64;
        while time_s < end_s {
            let torque = |t: f64| input(t) - levels[usize::from(forward)];
            let advance = |length_s: f64| runge_kutta(*state, &torque, time_s, length_s);
            let left = |state: &State| if forward { state[0] < 0.0 } else { state[0] > 0.0 };
            let mut length_s = end_s - time_s;
            let mut next = advance(length_s);
            let crosses = left(&next);
            if crosses {
                let (mut within, mut beyond) = (0.0, length_s);
                // 40 bisection steps reach the rounding error of the time.
                for _ in 0..40 {
                    let middle = 0.5 * (within + beyond);
                    if left(&advance(middle)) { beyond = middle } else { within = middle }
                }
                length_s = beyond;
                next = advance(length_s);
            }
            let before = *state;
            time_s = if crosses { time_s + length_s } else { end_s };
            *state = next;
            on_step(time_s, length_s, [before, next]);
            if crosses {
                forward = !forward;
            }
        }
    }
}

/// One classical Runge–Kutta step under a torque.
fn runge_kutta(state: State, torque: &dyn Fn(f64) -> f64, time_s: f64, length_s: f64) -> State {
    let slope = |[y, rate, curvature]: State, t: f64| -> State {
        [rate, curvature, 10_000.0 * (torque(t) - y) - 1050.0 * rate - 15.0 * curvature]
    };
    let moved =
        |slope: State, h: f64| -> State { std::array::from_fn(|i| state[i] + h * slope[i]) };
    let half = 0.5 * length_s;
    let k1 = slope(state, time_s);
    let k2 = slope(moved(k1, half), time_s + half);
    let k3 = slope(moved(k2, half), time_s + half);
    let k4 = slope(moved(k3, length_s), time_s + length_s);
    std::array::from_fn(|i| state[i] + length_s / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]))
}

#[cfg(test)]
mod tests {
    use super::*;

    // A relay around a block of relative degree 3. The expected values are those of the contract,
    // and the tolerance is half a unit of their last digit.
    #[test]
    fn it_oscillates_by_itself_at_32_396_rad_per_s() {
        let found = alone();
        assert!((found.omega_rad_s - 32.396).abs() < 5e-4, "{found:?}");
        assert!((found.amplitude - 0.997).abs() < 5e-4, "{found:?}");
        assert!((found.mean + 0.039).abs() < 5e-4, "{found:?}");
    }

    // Far above its own frequency the block hardly passes the excitation, so its own oscillation
    // remains.
    #[test]
    fn an_excitation_far_above_its_own_oscillation_is_refused() {
        assert!(is_periodic(2.0, 1.0) && is_periodic(4.0, 10.0));
        assert!(!is_periodic(2.0, 80.0) && !is_periodic(4.0, 80.0));
    }
}
