//! Periodic motion under a pure cosine torque Re T·exp(jωt).
//!
//! With the phase φ = ωt + arg T, torque and friction divided by |T|, and z = x·ω/|T|, the equation
//! while sliding is z' = −α·z + cos φ − f, where α = a/ω. A period has at most one slide in each
//! direction. With symmetric friction c and no rest, the forward slide starts where
//! w(φ) = −(c/α)·tanh(απ/2), with w = sin(φ + atan α)/√(1 + α²). From this guess Newton's method
//! finds the starts of both slides. If there is no such motion, the slides are followed one by one
//! from rest. A slide that starts from rest does not depend on what came before, so that such a
//! motion soon repeats.

use std::f64::consts::{PI, TAU};

use crate::measurement::Complex;
use crate::plant::Plant;

use super::switching_times::{Motion, Phase, SwitchingTimes};
use crate::simulate::response::NoResponse;
use crate::simulate::signal::root_finding::newton;

/// Dimensionless α = a/ω, and Coulomb (c) and static (s) levels divided by |T|.
struct Normalised {
    alpha: f64,
    c_plus: f64,
    c_minus: f64,
    s_plus: f64,
    s_minus: f64,
}

/// Most phases followed from rest; beyond that the motion counts as not periodic.
const MOST_HALF_CYCLES: usize = 4000;

/// The motion reached from rest under the torque Re T·exp(jωt).
pub(crate) fn orbit(
    plant: &Plant,
    torque: Complex,
    omega: f64,
) -> Result<SwitchingTimes, NoResponse> {
    let amplitude = torque.norm();
    let period_s = TAU / omega;
    let friction = plant.friction;
    if amplitude <= friction.fs_plus.min(friction.fs_minus) {
        return Ok(SwitchingTimes::constant(period_s, Motion::Stuck));
    }
    let normalised = Normalised {
        alpha: plant.viscous_rate_rad_s / omega,
        c_plus: friction.fc_plus / amplitude,
        c_minus: friction.fc_minus / amplitude,
        s_plus: friction.fs_plus / amplitude,
        s_minus: friction.fs_minus / amplitude,
    };
    // With Fs = Fc any two motions approach each other, so that there is only one periodic motion
    // and any method may find it. Otherwise only the motion reached from rest counts.
    let unique = friction.fs_plus == friction.fc_plus && friction.fs_minus == friction.fc_minus;
    let phases = match normalised.first_guess().filter(|_| unique) {
        Some(guess) => normalised.slide_through(guess),
        None => None,
    };
    let mut phases = match phases {
        Some(phases) => phases,
        None => normalised.reached_from_rest()?,
    };
    let lead = torque.arg();
    for phase in &mut phases {
        phase.start_s = (phase.start_s - lead) / omega;
    }
    Ok(SwitchingTimes { period_s, phases })
}

impl Normalised {
    /// w(φ): steady response of the linear lag 1/(d/dφ + α) to cos φ.
    fn steady(&self, sin: f64, cos: f64) -> f64 {
        (self.alpha * cos + sin) / (self.alpha * self.alpha + 1.0)
    }

    /// Start of the forward slide if friction were symmetric at its mean level.
    fn first_guess(&self) -> Option<f64> {
        let level = 0.5 * (self.c_plus + self.c_minus);
        let sine = -level / self.alpha
            * (0.5 * self.alpha * PI).tanh()
            * (1.0 + self.alpha * self.alpha).sqrt();
        (sine > -1.0).then(|| sine.asin() - self.alpha.atan())
    }

    /// Newton's method for the starts of both slides; `None` where there is no motion without rest.
    fn slide_through(&self, forward_guess: f64) -> Option<Vec<Phase>> {
        let (mut forward, mut backward) = (forward_guess, forward_guess + PI);
        for _ in 0..12 {
            let (sin_f, cos_f) = forward.sin_cos();
            let (sin_b, cos_b) = backward.sin_cos();
            let (w_f, w_b) = (self.steady(sin_f, cos_f), self.steady(sin_b, cos_b));
            // `lost` is 1 − exp(−α·duration); `end` is z at the end of a slide, which must be 0.
            let lost_f = -(-self.alpha * (backward - forward)).exp_m1();
            let lost_b = -(-self.alpha * (forward + TAU - backward)).exp_m1();
            let end_f = w_b - w_f * (1.0 - lost_f) - self.c_plus * lost_f / self.alpha;
            let end_b = w_f - w_b * (1.0 - lost_b) + self.c_minus * lost_b / self.alpha;
            // Jacobian of (end_f, end_b) with respect to (forward, backward).
            let j11 = -(1.0 - lost_f) * (cos_f - self.c_plus);
            let j12 = cos_b - self.c_plus;
            let j21 = cos_f + self.c_minus;
            let j22 = -(1.0 - lost_b) * (cos_b + self.c_minus);
            let determinant = j11 * j22 - j12 * j21;
            let step_f = (end_f * j22 - end_b * j12) / determinant;
            let step_b = (end_b * j11 - end_f * j21) / determinant;
            let longest = step_f.abs().max(step_b.abs());
            if longest.is_nan() {
                return None;
            }
            let damping = if longest > 0.5 { 0.5 / longest } else { 1.0 };
            forward -= damping * step_f;
            backward -= damping * step_b;
            // After a Newton step the error is of the order of the step squared.
            if longest < 1e-8 {
                return self.possible(forward, backward).then(|| {
                    vec![
                        Phase { start_s: forward, motion: Motion::Forward },
                        Phase { start_s: backward, motion: Motion::Backward },
                    ]
                });
            }
        }
        None
    }

    /// Whether the torque exceeds the static level at both reversals, which are in the right order.
    fn possible(&self, forward: f64, backward: f64) -> bool {
        forward.cos() > self.s_plus
            && backward.cos() < -self.s_minus
            && backward > forward
            && backward < forward + TAU
    }

    /// Follows the motion from rest until it repeats; returns one period of it.
    fn reached_from_rest(&self) -> Result<Vec<Phase>, NoResponse> {
        let (start, motion) = self.breakaway(-PI);
        let mut phases = vec![Phase { start_s: start, motion }];
        while phases.len() < MOST_HALF_CYCLES {
            let Phase { start_s, motion } = phases[phases.len() - 1];
            let end = self.end_of_slide(start_s, motion);
            let cos = end.cos();
            let (next_start, next_motion) = match motion {
                Motion::Forward if cos < -self.s_minus => (end, Motion::Backward),
                Motion::Backward if cos > self.s_plus => (end, Motion::Forward),
                _ => {
                    phases.push(Phase { start_s: end, motion: Motion::Stuck });
                    self.breakaway(end)
                }
            };
            let rested = phases[phases.len() - 1].motion == Motion::Stuck;
            if let Some(period) = self.repeats(&phases, next_start, next_motion, rested) {
                return Ok(period);
            }
            phases.push(Phase { start_s: next_start, motion: next_motion });
        }
        Err(NoResponse::NotPeriodic { periods: MOST_HALF_CYCLES / 2 })
    }

    /// The last period of `phases`, if the slide that starts at `start` repeats the slide of a
    /// period ago. `rested`: whether the axis rests just before `start`.
    fn repeats(
        &self,
        phases: &[Phase],
        start: f64,
        motion: Motion,
        rested: bool,
    ) -> Option<Vec<Phase>> {
        let earlier = phases.iter().rposition(|phase| phase.motion == motion)?;
        let change = start - phases[earlier].start_s - TAU;
        let last_period = &phases[earlier..];
        if rested || last_period.iter().any(|phase| phase.motion == Motion::Stuck) {
            // Both slides start from rest at the same torque level: their phases are equal to
            // rounding.
            return (change.abs() < 1e-9 && rested).then(|| last_period.to_vec());
        }
        if change.abs() < 1e-4
            && let Some(polished) = self.slide_through(start)
            && (polished[0].start_s - start).rem_euclid(TAU) < 1e-2
        {
            return Some(polished);
        }
        (change.abs() < 1e-12).then(|| last_period.to_vec())
    }

    /// The first phase from `from` on at which the torque exceeds a static level, and the direction
    /// in which the axis then moves.
    fn breakaway(&self, from: f64) -> (f64, Motion) {
        let next = |phase: f64| {
            let after = (phase - from).rem_euclid(TAU);
            // If rounding puts it just before `from`, it is at `from`, not a period later.
            from + if after > TAU - 1e-9 { after - TAU } else { after }
        };
        let forward = (self.s_plus < 1.0).then(|| next(-self.s_plus.acos()));
        let backward = (self.s_minus < 1.0).then(|| next(PI - self.s_minus.acos()));
        match (forward, backward) {
            (Some(f), Some(b)) if f <= b => (f, Motion::Forward),
            (Some(f), None) => (f, Motion::Forward),
            (_, Some(b)) => (b, Motion::Backward),
            (None, None) => unreachable!("the amplitude exceeds one of the static levels"),
        }
    }

    /// End of a slide that starts at `start` with v = 0.
    ///
    /// z stays positive while the torque exceeds the friction. From then until the torque exceeds
    /// it again, z falls as long as it is positive, so that the end is its only zero there.
    fn end_of_slide(&self, start: f64, motion: Motion) -> f64 {
        // By symmetry, a backward slide is a forward slide shifted by half a period.
        let (shift, level) = match motion {
            Motion::Backward => (PI, self.c_minus),
            _ => (0.0, self.c_plus),
        };
        let start = start - shift;
        let turn = level.min(1.0).acos();
        let low = start + (turn - start).rem_euclid(TAU);
        let high = low + TAU - 2.0 * turn;
        let (sin, cos) = start.sin_cos();
        let at_start = self.steady(sin, cos);
        let first = (start + PI).clamp(low + 0.1 * (high - low), high - 0.1 * (high - low));
        let falling = |end: f64| {
            let (sin, cos) = end.sin_cos();
            let lost = -(-self.alpha * (end - start)).exp_m1();
            let z = self.steady(sin, cos) - at_start * (1.0 - lost) - level * lost / self.alpha;
            (-z, -(cos - level - self.alpha * z))
        };
        let end = newton([low, high], first, 80, falling, |step| {
            step.length.min(step.bracket) < 1e-15 * step.to.abs().max(1.0)
        });
        end + shift
    }
}
