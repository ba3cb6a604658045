//! Parts of the response and their sizes beside the noise.

use crate::answers::Share;

/// Standard deviations of the noise from which on a part counts as detected.
const DETECTED: f64 = 3.0;

/// |Y|² of a line, and what noise alone makes of it on average.
#[derive(Debug, Clone, Copy)]
pub(super) struct Power {
    pub power: f64,
    /// `None` if it is not known.
    pub noise: Option<f64>,
}

/// A part of the response: lines together.
#[derive(Debug, Clone, Copy)]
pub(super) struct Part {
    lines: usize,
    power: f64,
    noise: Option<f64>,
    /// Variance of `noise` as it was drawn: the square of a complex Gaussian has the mean v and the
    /// variance v², and v, from n degrees of freedom, has the variance v²/n.
    variance: f64,
}

impl Default for Part {
    fn default() -> Self {
        Self { lines: 0, power: 0.0, noise: Some(0.0), variance: 0.0 }
    }
}

impl Part {
    /// Adds a line whose noise was estimated with so many (complex) degrees of freedom.
    pub fn add(&mut self, Power { power, noise }: Power, degrees: f64) {
        self.lines += 1;
        self.power += power;
        self.noise = self.noise.zip(noise).map(|(sum, noise)| sum + noise);
        self.variance += noise.map_or(0.0, |noise| noise * noise * (1.0 + 1.0 / degrees));
    }

    /// Number of lines.
    pub fn lines(&self) -> usize {
        self.lines
    }

    /// Its share of the power `whole`; each line stands for `factor` lines. `None` without lines.
    pub fn share(&self, whole: f64, factor: f64) -> Option<Share> {
        let Self { lines, power, noise, variance } = *self;
        let relative = |power: f64| (factor * power / whole).sqrt();
        let share = match noise {
            None => Share { value: relative(power), detectable: None },
            Some(noise) => {
                let least = DETECTED * variance.sqrt();
                let beyond = power - noise;
                let value = if beyond > least { relative(beyond) } else { 0.0 };
                Share { value, detectable: Some(relative(least)) }
            }
        };
        // Nothing moved, or beyond all measure.
        (lines > 0 && whole > 0.0).then_some(share).filter(|share| share.value.is_finite())
    }
}

/// The noise of some lines relative to their power; `None` where it is not known.
pub(super) fn noise_share(lines: &[Power]) -> Option<f64> {
    let noise: Option<f64> = lines.iter().map(|line| line.noise).sum();
    let whole: f64 = lines.iter().map(|line| line.power).sum();
    noise.map(|noise| (noise / whole).sqrt()).filter(|share| share.is_finite())
}

/// The median of some values; 0 without any.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(lines: &[(f64, Option<f64>)]) -> Part {
        let mut part = Part::default();
        for (power, noise) in lines {
            part.add(Power { power: *power, noise: *noise }, f64::INFINITY);
        }
        part
    }

    #[test]
    fn a_part_is_what_exceeds_the_noise_relative_to_the_whole() {
        let share = part(&[(0.5, Some(0.01)), (0.52, Some(0.01))]).share(100.0, 1.0).unwrap();
        assert!((share.value - 0.1).abs() < 1e-12, "{share:?}");
        // 3·√(2·0.01²) = 0.0424 of 100.
        assert!((share.detectable.unwrap() - 0.0206).abs() < 1e-4, "{share:?}");
        let doubled = part(&[(0.5, Some(0.01)), (0.52, Some(0.01))]).share(100.0, 4.0).unwrap();
        assert!((doubled.value - 0.2).abs() < 1e-12);
    }

    // A share that is no number could not be stored.
    #[test]
    fn of_a_response_that_is_zero_nothing_has_a_share() {
        assert_eq!(part(&[(0.0, None)]).share(0.0, 1.0), None);
        assert_eq!(part(&[(f64::NAN, None)]).share(1.0, 1.0), None);
        assert_eq!(noise_share(&[Power { power: 0.0, noise: Some(1.0) }]), None);
    }

    #[test]
    fn what_noise_alone_may_make_is_no_part_and_without_a_noise_all_of_it_is() {
        assert_eq!(part(&[(0.03, Some(0.01))]).share(1.0, 1.0).unwrap().value, 0.0);
        let unknown = part(&[(0.03, Some(0.01)), (0.01, None)]).share(1.0, 1.0).unwrap();
        assert_eq!(unknown, Share { value: 0.2, detectable: None });
        assert_eq!(part(&[]).share(1.0, 1.0), None);
    }
}
