//! Levels of multisines: distortion at the lines of the band that the input leaves out, and as
//! scatter between inputs of other phases.
//!
//! Distortion at the excited lines themselves is taken to be as large as at the lines left out
//! between them, as it is of a random choice of them (Pintelon and Schoukens 2012, section 4.3.1).

use crate::answers::{DistortionLine, LinearLine, LinearityLevel, Parity, Share};
use crate::measurement::{Complex, Experiment};

use super::SAME_FREQUENCY;
use super::cosines::power;
use super::level::{Part, Power, median, noise_share};
use super::lines::{Line, Lines};

/// Fewest excited lines of a multisine.
const FEWEST_EXCITED: usize = 5;

/// Fewest lines left out from which the distortion of all is extrapolated.
const FEWEST_LEFT_OUT: usize = 3;

/// Largest input at lines left out, over the median input at excited lines, at which they count as
/// left out: the response to it is taken off with an interpolated gain, which errs.
const LARGEST_UNWANTED: f64 = 0.1;

/// Most lines of one parity that are listed; more are averaged with their neighbours.
const MOST_SHOWN: usize = 400;

/// Levels whose root mean squares differ by less than this share are one.
const SAME_LEVEL: f64 = 0.1;

/// Inputs whose lines are correlated by less than this have different phases.
const LARGEST_CORRELATION: f64 = 0.9;

/// Inputs of one level with the same lines.
struct Group<'e> {
    omega_rad_s: f64,
    members: Vec<(&'e Experiment, Lines)>,
}

/// One level for each root mean square of the input, for each choice of lines.
pub(super) fn levels(experiments: &[Experiment]) -> Vec<LinearityLevel> {
    let mut groups: Vec<Group<'_>> = Vec::new();
    for experiment in experiments {
        let lines = Lines::of(experiment);
        if lines.excited.len() < FEWEST_EXCITED {
            continue;
        }
        match groups.iter_mut().find(|group| group.takes(experiment, &lines)) {
            Some(group) => group.members.push((experiment, lines)),
            None => groups.push(Group {
                omega_rad_s: experiment.omega_rad_s,
                members: vec![(experiment, lines)],
            }),
        }
    }
    groups.sort_by(|a, b| a.rms().total_cmp(&b.rms()));
    groups.iter().map(Group::level).collect()
}

impl Group<'_> {
    fn takes(&self, experiment: &Experiment, lines: &Lines) -> bool {
        let orders =
            |lines: &Lines| lines.excited.iter().map(|line| line.order).collect::<Vec<_>>();
        (experiment.omega_rad_s / self.omega_rad_s - 1.0).abs() < SAME_FREQUENCY
            && (rms(lines) / self.rms() - 1.0).abs() < SAME_LEVEL
            && orders(lines) == orders(&self.members[0].1)
    }

    fn rms(&self) -> f64 {
        rms(&self.members[0].1)
    }

    fn lines(&self) -> impl Iterator<Item = &Lines> {
        self.members.iter().map(|(_, lines)| lines)
    }

    /// Number of inputs of which no two have the same phases; 1 if any two have.
    fn realisations(&self) -> usize {
        let members = &self.members;
        let pairs = (1..members.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
        let mut alike = pairs.map(|(i, j)| correlation(&members[i].1, &members[j].1));
        if alike.any(|correlation| correlation > LARGEST_CORRELATION) { 1 } else { members.len() }
    }

    fn level(&self) -> LinearityLevel {
        let realisations = self.realisations();
        let excited: Vec<Power> = self.lines().flat_map(|l| &l.excited).map(power).collect();
        let whole: f64 = excited.iter().map(|line| line.power).sum();
        let (mut distortion, mut shares) = (Vec::new(), [None, None]);
        if self.lines().all(|lines| lines.unwanted < LARGEST_UNWANTED) {
            for (parity, share) in [Parity::Even, Parity::Odd].into_iter().zip(&mut shares) {
                *share = self.left_out(parity, whole, &mut distortion);
            }
        }
        distortion.sort_by(|a, b| a.omega_rad_s.total_cmp(&b.omega_rad_s));
        let (approximation, stochastic) = self.approximation(realisations);
        let [even, odd] = shares;
        LinearityLevel {
            magnitude: median(self.members.iter().map(|(e, _)| e.magnitude).collect()),
            realisations,
            approximation,
            distortion,
            noise: noise_share(&excited),
            even,
            odd,
            stochastic,
        }
    }

    /// Adds the lines of a parity that are left out within the band; returns the share of all lines
    /// of that parity.
    fn left_out(
        &self,
        parity: Parity,
        whole: f64,
        distortion: &mut Vec<DistortionLine>,
    ) -> Option<Share> {
        let is_own = |line: &&Line| line.order.is_multiple_of(2) == (parity == Parity::Even);
        let mut part = Part::default();
        let (mut own_excited, mut found) = (0, Vec::new());
        for lines in self.lines() {
            own_excited += lines.excited.iter().filter(is_own).count();
            let band = lines.excited[0].order..lines.excited[lines.excited.len() - 1].order;
            let inside = |line: &&Line| band.contains(&line.order);
            for line in lines.others.iter().filter(is_own).filter(inside) {
                part.add(power(line), lines.degrees);
                found.push((line.order, power(line)));
            }
        }
        let count = part.lines();
        found.sort_by_key(|(order, _)| *order);
        let members = self.members.len();
        let together = members * count.div_ceil(members * MOST_SHOWN);
        distortion.extend(found.chunks(together.max(1)).map(|lines| {
            let each = lines.len() as f64;
            let order = lines.iter().map(|(order, _)| *order as f64).sum::<f64>() / each;
            let noise: Option<f64> = lines.iter().map(|(_, line)| line.noise).sum();
            let power: f64 = lines.iter().map(|(_, line)| line.power).sum();
            DistortionLine {
                omega_rad_s: order * self.omega_rad_s,
                parity,
                amplitude: (power / each).sqrt(),
                noise: noise.map(|noise| (noise / each).sqrt()),
            }
        }));
        let factor = 1.0 + own_excited as f64 / count.max(1) as f64;
        part.share(whole, factor).filter(|_| count >= FEWEST_LEFT_OUT)
    }

    /// The mean gain at each line over the realisations, and what scatters between them.
    fn approximation(&self, realisations: usize) -> (Vec<LinearLine>, Option<Share>) {
        let count = self.members.len() as f64;
        let (mut scatter, mut whole) = (Part::default(), 0.0);
        let lines = (0..self.members[0].1.excited.len()).map(|index| {
            let own: Vec<Line> = self.lines().map(|lines| lines.excited[index]).collect();
            let gains = || own.iter().map(Line::gain);
            let gain = gains().sum::<Complex>() / count;
            let of_gain = |line: &Line| Some(line.noise? / line.input.norm_sqr());
            // Variance of the gain of one realisation.
            let noise = own.iter().map(of_gain).sum::<Option<f64>>().map(|sum| sum / count);
            let squares: f64 = gains().map(|own| (own - gain).norm_sqr()).sum();
            let total = (realisations > 1).then(|| squares / (count - 1.0));
            let input = own.iter().map(|line| line.input.norm_sqr()).sum::<f64>() / count;
            if let Some(total) = total {
                let power = Power { power: total * input, noise: noise.map(|n| n * input) };
                // More than its variance: the scatter of several is better known than one line.
                scatter.add(power, count - 1.0);
            }
            whole += gain.norm_sqr() * input;
            let of_mean = |variance: f64| (0.5 * variance / count).sqrt();
            let mean_power = |of: fn(&Line) -> Option<f64>| {
                let sum: Option<f64> = own.iter().map(of).sum();
                sum.map(|sum| (sum / count).sqrt())
            };
            LinearLine {
                noise_std: noise.map(of_mean),
                total_std: total.map(of_mean),
                gain: [gain.re, gain.im],
                omega_rad_s: own[0].order as f64 * self.omega_rad_s,
                amplitude: mean_power(|line| Some(line.response.norm_sqr())).unwrap_or(0.0),
                noise: mean_power(|line| line.noise),
            }
        });
        let lines = lines.collect();
        (lines, scatter.share(whole, 1.0))
    }
}

/// Root mean square of the excited lines of an input.
fn rms(lines: &Lines) -> f64 {
    (0.5 * lines.excited.iter().map(|line| line.input.norm_sqr()).sum::<f64>()).sqrt()
}

/// |Σ U·V*|/(|U|·|V|) of the excited lines of two inputs.
fn correlation(a: &Lines, b: &Lines) -> f64 {
    let product: Complex =
        a.excited.iter().zip(&b.excited).map(|(u, v)| u.input * v.input.conj()).sum();
    0.5 * product.norm() / (rms(a) * rms(b))
}
