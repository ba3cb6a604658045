//! Periodic motion under a pure cosine torque Re T·exp(jωt).
//!
//! With the phase φ = ωt + arg T, torque and friction divided by |T|, and z = x·ω/|T|, the equation
//! while sliding is z' = −α·z + cos φ − f, where α = a/ω. A period has at most one slide in each
//! direction. Newton's method finds the starts of both slides (`two_slides`). If there is no motion
//! without rest, the slides are followed one by one from rest. A slide that starts from rest does not
//! depend on what came before, so that such a motion soon repeats.

use std::f64::consts::{PI, TAU};

use crate::measurement::Complex;
use crate::plant::Plant;

use super::switching_times::{Motion, Phase, SwitchingTimes};
use super::two_slides::{Normalised, TwoSlides, lost_in};
use crate::simulate::response::NoResponse;
use crate::simulate::signal::root_finding::newton;

/// Most phases followed from rest; beyond that the motion counts as not periodic.
const MOST_HALF_CYCLES: usize = 4000;

/// The motion reached from rest under the torque Re T·exp(jωt).
pub(crate) fn orbit(
    plant: &Plant,
    torque: Complex,
    omega: f64,
) -> Result<SwitchingTimes, NoResponse> {
    match two_slides(plant, torque.norm(), omega) {
        Some((_, slides)) => Ok(from_phases(phases_of(&slides), torque, omega)),
        None => orbit_with_rest(plant, torque, omega),
    }
}

/// The motion without rest under a torque of this amplitude, if it is the one reached from rest.
///
/// With Fs = Fc any two motions approach each other, so that there is only one periodic motion and
/// any method may find it. Otherwise only the motion reached from rest counts.
pub(super) fn two_slides(
    plant: &Plant,
    amplitude: f64,
    omega: f64,
) -> Option<(Normalised, TwoSlides)> {
    let friction = &plant.friction;
    let unique = friction.fs_plus == friction.fc_plus && friction.fs_minus == friction.fc_minus;
    if !unique || amplitude <= friction.fs_plus.min(friction.fs_minus) {
        return None;
    }
    let axis = Normalised::new(plant.viscous_rate_rad_s, friction, amplitude, omega);
    axis.two_slides().map(|slides| (axis, slides))
}

/// The motion reached from rest where [`two_slides`] finds none.
pub(super) fn orbit_with_rest(
    plant: &Plant,
    torque: Complex,
    omega: f64,
) -> Result<SwitchingTimes, NoResponse> {
    let (amplitude, friction) = (torque.norm(), &plant.friction);
    if amplitude <= friction.fs_plus.min(friction.fs_minus) {
        return Ok(SwitchingTimes::constant(TAU / omega, Motion::Stuck));
    }
    let axis = Normalised::new(plant.viscous_rate_rad_s, friction, amplitude, omega);
    Ok(from_phases(FromRest::new(&axis).motion()?, torque, omega))
}

/// Phases of ωt + arg T become times.
fn from_phases(mut phases: Vec<Phase>, torque: Complex, omega: f64) -> SwitchingTimes {
    let lead = torque.arg();
    for phase in &mut phases {
        phase.start_s = (phase.start_s - lead) / omega;
    }
    SwitchingTimes { period_s: TAU / omega, phases }
}

fn phases_of(slides: &TwoSlides) -> Vec<Phase> {
    let forward = slides.forward.sin.atan2(slides.forward.cos);
    vec![
        Phase { start_s: forward, motion: Motion::Forward },
        Phase { start_s: forward + slides.forward.length, motion: Motion::Backward },
    ]
}

/// The motion from rest, followed slide by slide.
struct FromRest<'a> {
    axis: &'a Normalised,
    /// Phases from which on the torque exceeds a static level, forward and backward, in the first
    /// turn; `None` where it never does.
    breakaways: [Option<f64>; 2],
    /// acos of the Coulomb levels: where the torque falls below them.
    turns: [f64; 2],
}

impl<'a> FromRest<'a> {
    fn new(axis: &'a Normalised) -> Self {
        let Normalised { c_plus, c_minus, s_plus, s_minus, .. } = *axis;
        let breakaways =
            [(s_plus < 1.0).then(|| -s_plus.acos()), (s_minus < 1.0).then(|| PI - s_minus.acos())];
        Self { axis, breakaways, turns: [c_plus, c_minus].map(|level| level.min(1.0).acos()) }
    }

    /// Follows the motion from rest until it repeats; returns one period of it.
    fn motion(&self) -> Result<Vec<Phase>, NoResponse> {
        let Normalised { s_plus, s_minus, .. } = *self.axis;
        let (start, motion) = self.breakaway(-PI);
        let mut phases = vec![Phase { start_s: start, motion }];
        while phases.len() < MOST_HALF_CYCLES {
            let Phase { start_s, motion } = phases[phases.len() - 1];
            let end = self.end_of_slide(start_s, motion);
            let cos = end.cos();
            let (next_start, next_motion) = match motion {
                Motion::Forward if cos < -s_minus => (end, Motion::Backward),
                Motion::Backward if cos > s_plus => (end, Motion::Forward),
                _ => {
                    phases.push(Phase { start_s: end, motion: Motion::Stuck });
                    self.breakaway(end)
                }
            };
            if let Some(first) = self.repeats(&mut phases, next_start, next_motion) {
                phases.drain(..first);
                return Ok(phases);
            }
            phases.push(Phase { start_s: next_start, motion: next_motion });
        }
        Err(NoResponse::NotPeriodic { periods: MOST_HALF_CYCLES / 2 })
    }

    /// Where the last period of `phases` begins, if the slide that starts at `start` repeats the
    /// slide of a period ago. Two slides that are nearly repeated are replaced by those that are.
    fn repeats(&self, phases: &mut Vec<Phase>, start: f64, motion: Motion) -> Option<usize> {
        let rested = phases[phases.len() - 1].motion == Motion::Stuck;
        let earlier = phases.iter().rposition(|phase| phase.motion == motion)?;
        let change = start - phases[earlier].start_s - TAU;
        if rested || phases[earlier..].iter().any(|phase| phase.motion == Motion::Stuck) {
            // Both slides start from rest at the same torque level: their phases are equal to
            // rounding.
            return (change.abs() < 1e-9 && rested).then_some(earlier);
        }
        if change.abs() < 1e-4
            && let Some(polished) = self.axis.two_slides_near(start.sin(), start.cos())
            && (phases_of(&polished)[0].start_s - start).rem_euclid(TAU) < 1e-2
        {
            *phases = phases_of(&polished);
            return Some(0);
        }
        (change.abs() < 1e-12).then_some(earlier)
    }

    /// The first phase from `from` on at which the torque exceeds a static level, and the direction
    /// in which the axis then moves.
    fn breakaway(&self, from: f64) -> (f64, Motion) {
        let next = |phase: f64| {
            let after = (phase - from).rem_euclid(TAU);
            // If rounding puts it just before `from`, it is at `from`, not a period later.
            from + if after > TAU - 1e-9 { after - TAU } else { after }
        };
        match self.breakaways.map(|phase| phase.map(next)) {
            [Some(f), Some(b)] if f <= b => (f, Motion::Forward),
            [Some(f), None] => (f, Motion::Forward),
            [_, Some(b)] => (b, Motion::Backward),
            [None, None] => unreachable!("the amplitude exceeds one of the static levels"),
        }
    }

    /// End of a slide that starts at `start` with v = 0.
    ///
    /// z stays positive while the torque exceeds the friction. From then until the torque exceeds
    /// it again, z falls as long as it is positive, so that the end is its only zero there.
    fn end_of_slide(&self, start: f64, motion: Motion) -> f64 {
        // By symmetry, a backward slide is a forward slide shifted by half a period.
        let (shift, level, turn) = match motion {
            Motion::Backward => (PI, self.axis.c_minus, self.turns[1]),
            _ => (0.0, self.axis.c_plus, self.turns[0]),
        };
        let alpha = self.axis.alpha;
        let start = start - shift;
        let low = start + (turn - start).rem_euclid(TAU);
        let high = low + TAU - 2.0 * turn;
        let (sin, cos) = start.sin_cos();
        let at_start = self.axis.steady(sin, cos);
        let first = (start + PI).clamp(low + 0.1 * (high - low), high - 0.1 * (high - low));
        let falling = |end: f64| {
            let (sin, cos) = end.sin_cos();
            let lost = lost_in(alpha * (end - start));
            let z = self.axis.steady(sin, cos) - at_start * (1.0 - lost) - level * lost / alpha;
            let slope = cos - level - alpha * z;
            // Near the end, by the curvature too (Halley's method): a step cubes the error.
            let bend = z * (-sin - alpha * slope) / slope;
            let slope = if bend.abs() < slope.abs() { slope - 0.5 * bend } else { slope };
            (-z, -slope)
        };
        let end = newton([low, high], first, 80, falling, |step| {
            // A step that halves the bracket says nothing of how near the end is.
            let is_newton = step.length < 0.25 * step.bracket;
            let settled = is_newton && step.length < 1e-6 * (step.to - low);
            settled || step.length.min(step.bracket) < 1e-15 * step.to.abs().max(1.0)
        });
        end + shift
    }
}
