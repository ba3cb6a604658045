//! The features of a response, the input of the neural network.
//!
//! The response is proportional to K. All features are independent of its scale: logarithms of
//! lines less their mean, phases, and other harmonics relative to the fundamental and its
//! phase.

use crate::measurement::Complex;

use super::problem::{Problem, Target};

/// Most frequencies of pure cosines that are used (tuned).
const MOST_FREQUENCIES: usize = 5;

/// Most lines of general inputs that are used (tuned).
const MOST_LINES: usize = 40;

/// Share of the largest line that is added to every size, so that logarithms and ratios stay finite
/// for a response that is zero (tuned).
const FLOOR: f64 = 1e-3;

/// Which data the features are made of: chosen once, from the inputs and the measured response, and
/// then the same for every simulated plant.
pub(super) struct Features {
    /// (experiment, index of the target, which features it becomes).
    picks: Vec<(usize, usize, Role)>,
}

#[derive(Clone, Copy, PartialEq)]
enum Role {
    /// ln of its size, and its phase relative to the input line of the same frequency.
    Line,
    /// Relative to the fundamental of its experiment: `fundamental` is the index of that target.
    Relative { fundamental: usize },
}

impl Features {
    /// Chooses the data that the features are made of.
    pub fn of(problem: &Problem) -> Self {
        let mut picks = Vec::new();
        let cosines: Vec<usize> = (0..problem.experiments.len())
            .filter(|e| problem.experiments[*e].excitation.is_pure_cosine())
            .collect();
        for e in spread_over(problem, &cosines) {
            let targets = &problem.experiments[e].targets;
            let Some(fundamental) = targets.iter().position(|t| t.order == 1) else { continue };
            for (t, target) in targets.iter().enumerate() {
                match target.order {
                    1 => picks.push((e, t, Role::Line)),
                    0 | 3 => picks.push((e, t, Role::Relative { fundamental })),
                    _ => {}
                }
            }
        }
        let general: Vec<usize> =
            (0..problem.experiments.len()).filter(|e| !cosines.contains(e)).collect();
        for e in general.iter().copied() {
            let targets = &problem.experiments[e].targets;
            let mut lines: Vec<usize> =
                (0..targets.len()).filter(|t| targets[*t].order > 0).collect();
            let size = |t: &usize| (targets[*t].value / targets[*t].per_velocity).norm();
            lines.sort_by(|s, t| size(t).total_cmp(&size(s)));
            lines.truncate((MOST_LINES / general.len()).max(3));
            lines.sort_unstable();
            picks.extend(lines.into_iter().map(|t| (e, t, Role::Line)));
        }
        Self { picks }
    }

    /// Features of the measured response, and the mean logarithm of its lines.
    pub fn of_measured(&self, problem: &Problem) -> (Vec<f64>, f64) {
        self.extract(problem, |_, _, target| target.value)
    }

    /// Features of a simulated response (by experiment, then by target), and the mean logarithm of
    /// its lines.
    pub fn of_simulated(&self, problem: &Problem, values: &[Vec<Complex>]) -> (Vec<f64>, f64) {
        self.extract(problem, |e, t, _| values[e][t])
    }

    fn extract(
        &self,
        problem: &Problem,
        value: impl Fn(usize, usize, &Target) -> Complex,
    ) -> (Vec<f64>, f64) {
        let velocity = |e: usize, t: usize| {
            let target = &problem.experiments[e].targets[t];
            value(e, t, target) / target.per_velocity
        };
        let lines = || self.picks.iter().filter(|(_, _, role)| *role == Role::Line);
        let largest = lines().map(|(e, t, _)| velocity(*e, *t).norm()).fold(0.0, f64::max);
        let floor = (FLOOR * largest).max(f64::MIN_POSITIVE);
        let logarithm = |e: usize, t: usize| (velocity(e, t).norm() + floor).ln();
        let mean =
            lines().map(|(e, t, _)| logarithm(*e, *t)).sum::<f64>() / lines().count().max(1) as f64;
        let mut features = Vec::new();
        for (e, t, role) in &self.picks {
            let experiment = &problem.experiments[*e];
            let target = &experiment.targets[*t];
            let here = velocity(*e, *t);
            match role {
                Role::Line => {
                    let input = experiment.excitation.input().get(target.order);
                    let turn = input.copied().unwrap_or_default().conj();
                    let turned = here * turn / (turn.norm() + f64::MIN_POSITIVE);
                    let size = here.norm() + floor;
                    features.extend([logarithm(*e, *t) - mean, turned.re / size, turned.im / size]);
                }
                Role::Relative { fundamental } => {
                    let first = velocity(*e, *fundamental);
                    let size = first.norm() + floor;
                    let back = (first / size).conj().powu(target.order as u32);
                    let relative = here * back / size;
                    features.push(relative.re);
                    if !target.real {
                        features.push(relative.im);
                    }
                }
            }
        }
        (features, mean)
    }
}

/// Chooses experiments: frequencies evenly spread, and at each the lowest, a middle and the highest
/// magnitude, because only a comparison of magnitudes distinguishes friction from damping.
fn spread_over(problem: &Problem, experiments: &[usize]) -> Vec<usize> {
    let omega = |e: &usize| problem.experiments[*e].excitation.omega_rad_s();
    let magnitude = |e: &usize| problem.experiments[*e].excitation.input()[1].norm();
    let mut sorted = experiments.to_vec();
    sorted
        .sort_by(|a, b| omega(a).total_cmp(&omega(b)).then(magnitude(a).total_cmp(&magnitude(b))));
    let frequencies: Vec<&[usize]> =
        sorted.chunk_by(|a, b| omega(b) / omega(a) < 1.0 + 1e-6).collect();
    evenly(frequencies.len(), MOST_FREQUENCIES)
        .flat_map(|f| evenly(frequencies[f].len(), 3).map(move |m| (f, m)))
        .map(|(f, m)| frequencies[f][m])
        .collect()
}

/// At most `most` of `count` indices, evenly spread, with the first and the last among them.
fn evenly(count: usize, most: usize) -> impl Iterator<Item = usize> {
    let wanted = count.min(most);
    (0..wanted).map(move |i| if wanted > 1 { i * (count - 1) / (wanted - 1) } else { 0 })
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{ACTUATORS, axis, multisine, stepped_sine};
    use super::*;

    fn values(problem: &Problem, factor: f64) -> Vec<Vec<Complex>> {
        let of = |t: &Target| t.value * factor;
        problem.experiments.iter().map(|e| e.targets.iter().map(of).collect()).collect()
    }

    #[test]
    fn a_response_of_another_size_has_the_same_features() {
        for measurement in [stepped_sine(&axis(ACTUATORS[2]), 5), multisine(&axis(ACTUATORS[0]))] {
            let problem = Problem::new(&measurement).unwrap();
            let features = Features::of(&problem);
            let (measured, size) = features.of_measured(&problem);
            let (simulated, larger) = features.of_simulated(&problem, &values(&problem, 5.0));
            assert!((larger - size - 5.0_f64.ln()).abs() < 1e-12);
            for (m, s) in measured.iter().zip(&simulated) {
                assert!((m - s).abs() < 1e-12, "{m} {s}");
            }
        }
    }

    // 5 of 8 frequencies, both magnitudes: ln size, cosine and sine of the phase of the fundamental
    // (3), the mean (1), the third harmonic (2).
    #[test]
    fn of_cosines_five_frequencies_and_three_harmonics_make_the_features() {
        let problem = Problem::new(&stepped_sine(&axis(ACTUATORS[0]), 5)).unwrap();
        let (features, _) = Features::of(&problem).of_measured(&problem);
        assert_eq!(features.len(), 5 * 2 * (3 + 1 + 2));
    }

    #[test]
    fn a_stuck_response_has_finite_features() {
        let problem = Problem::new(&stepped_sine(&axis(ACTUATORS[0]), 5)).unwrap();
        let (features, size) =
            Features::of(&problem).of_simulated(&problem, &values(&problem, 0.0));
        assert!(size.is_finite() && features.iter().all(|x| x.is_finite()));
    }

    #[test]
    fn an_even_spread_holds_first_and_last() {
        assert_eq!(evenly(8, 5).collect::<Vec<_>>(), [0, 1, 3, 5, 7]);
        assert_eq!(evenly(3, 5).collect::<Vec<_>>(), [0, 1, 2]);
        assert_eq!(evenly(1, 5).collect::<Vec<_>>(), [0]);
    }
}
