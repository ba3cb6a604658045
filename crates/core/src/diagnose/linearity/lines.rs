//! The lines of one experiment: input, response, and the noise of the response.

use crate::measurement::{Complex, EXCITED_SHARE, Experiment, Harmonic};

/// Input and response at one line.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    pub order: usize,
    pub input: Complex,
    pub response: Complex,
    /// Mean of |noise|² of the response; that of the input counts as noise of the response. `None`
    /// if neither repeats nor a deviation tell it.
    pub noise: Option<f64>,
}

impl Line {
    /// Response over input.
    pub fn gain(&self) -> Complex {
        self.response / self.input
    }
}

/// The lines of an experiment without the mean: those that the input excites, and the others.
#[derive(Debug, Clone)]
pub(super) struct Lines {
    pub excited: Vec<Line>,
    /// What the input nevertheless has at these lines, and the response to it, is taken off.
    pub others: Vec<Line>,
    /// Complex degrees of freedom with which the noise was estimated.
    pub degrees: f64,
    /// Largest input at the other lines over the median input at the excited ones.
    pub unwanted: f64,
}

impl Lines {
    pub fn of(experiment: &Experiment) -> Self {
        let input = |order: usize| experiment.input.get(order).copied().unwrap_or(Complex::ZERO);
        let response = || experiment.response.iter().enumerate().filter(|(_, h)| h.order > 0);
        let largest = response().map(|(_, h)| input(h.order).norm()).fold(0.0, f64::max);
        let (excited, others): (Vec<_>, Vec<_>) =
            response().partition(|(_, h)| input(h.order).norm() > EXCITED_SHARE * largest);
        let line = |(index, harmonic): (usize, &Harmonic), gain: Complex| Line {
            order: harmonic.order,
            input: input(harmonic.order),
            response: harmonic.value,
            noise: noise(experiment, index, gain),
        };
        let excited: Vec<Line> =
            excited.into_iter().map(|at| line(at, at.1.value / input(at.1.order))).collect();
        let others: Vec<Line> = others
            .into_iter()
            .map(|at| {
                let gain = gain_at(&excited, at.1.order);
                let line = line(at, gain);
                Line { response: line.response - gain * line.input, ..line }
            })
            .collect();
        let mut sizes: Vec<f64> = excited.iter().map(|line| line.input.norm()).collect();
        sizes.sort_by(f64::total_cmp);
        let median = sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
        let unwanted = others.iter().map(|line| line.input.norm()).fold(0.0, f64::max);
        let degrees = match experiment.repeats.len() {
            0 => f64::INFINITY,
            count => (count - 1) as f64,
        };
        Self { excited, others, degrees, unwanted: unwanted / median }
    }
}

/// Mean of |noise|² of the mean response at the harmonic of this index, for a gain at its line: from
/// the scatter of the repeats or, without any, the stated deviation.
fn noise(experiment: &Experiment, index: usize, gain: Complex) -> Option<f64> {
    let Harmonic { order, std, .. } = experiment.response[index];
    let count = experiment.repeats.len() as f64;
    if count == 0.0 {
        return std.map(|std| 2.0 * std * std);
    }
    let squares = experiment.repeats.iter().map(|repeat| {
        let input = repeat.input.get(order).copied().unwrap_or(Complex::ZERO);
        (repeat.response[index] - gain * input).norm_sqr()
    });
    Some(squares.sum::<f64>() / (count * (count - 1.0)))
}

/// The gain at a line that is not excited: interpolated linearly between its excited neighbours;
/// beyond them, that of the nearest.
fn gain_at(excited: &[Line], order: usize) -> Complex {
    let next = excited.partition_point(|line| line.order < order);
    match (next.checked_sub(1).map(|last| &excited[last]), excited.get(next)) {
        (Some(below), Some(above)) => {
            let share = (order - below.order) as f64 / (above.order - below.order) as f64;
            below.gain() * (1.0 - share) + above.gain() * share
        }
        (Some(nearest), None) | (None, Some(nearest)) => nearest.gain(),
        (None, None) => Complex::ZERO,
    }
}
