//! Sessions with some data changed, to try what a fault of the measurement would explain.

use super::{FitAccuracy, FitSession};
use crate::identify::estimated_input;
use crate::identify::problem::{Problem, UnknownInput};
use crate::measurement::{ChannelRange, Complex};
use crate::simulate::Excitation;

/// How a datum is changed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DatumChange {
    /// Factor of its value.
    pub factor: Complex,
    /// Factor of its standard deviation.
    pub deviation: f64,
}

impl<'a> FitSession<'a> {
    /// The same session with every datum changed, given its experiment and harmonic. Nothing is
    /// fitted again, and models of this session are models of the result.
    pub fn changed(&self, change: impl Fn(usize, usize) -> DatumChange) -> FitSession<'a> {
        let (mut problem, mut fitted) = (self.problem.clone(), self.fitted.clone());
        let rows = problem.experiments.iter_mut().zip(&mut fitted.weights.sigma);
        for (index, (experiment, sigma)) in rows.enumerate() {
            for (target, sigma) in experiment.targets.iter_mut().zip(sigma) {
                if target.constraint {
                    continue;
                }
                let DatumChange { factor, deviation } = change(index, target.order);
                target.value *= factor;
                *sigma *= deviation;
            }
        }
        fitted.weights = fitted.weights.eliminating(&problem);
        FitSession { fitted, ..self.of_problem(problem) }
    }

    /// The same session with every line of the inputs changed by a factor, given its experiment and
    /// order. Nothing is fitted again, and models of this session are models of the result. `None` if
    /// the base model has no response to them, or once the observer cancels.
    pub fn with_input(&self, factor: impl Fn(usize, usize) -> Complex) -> Option<FitSession<'a>> {
        let mut problem = self.problem.clone();
        for (index, experiment) in problem.experiments.iter_mut().enumerate() {
            let before = &experiment.excitation;
            let lines = before.input().iter().enumerate();
            let input = lines.map(|(k, line)| line * factor(index, k)).collect();
            experiment.excitation =
                Excitation::new(before.omega_rad_s(), input).at_run_share(before.run_share());
        }
        self.with_responses_of(problem)
    }

    /// The same session with inputs that are not known along these directions, lines in units of the
    /// input, given the experiment. They are estimated beside the base model, which is fitted again for
    /// that, and models of this session are models of the result. `None` if the base model has no
    /// response, or once the observer cancels.
    pub fn with_unknown_input<'d>(
        &self,
        directions: impl Fn(usize) -> &'d [Vec<Complex>],
    ) -> Option<FitSession<'a>> {
        let mut problem = self.problem.clone();
        for (index, experiment) in problem.experiments.iter_mut().enumerate() {
            experiment.unknown_input = UnknownInput::along(directions(index), problem.scales.input);
        }
        let mut changed = self.with_responses_of(problem)?;
        if changed.problem.lacks_inputs() {
            for _ in 0..estimated_input::ROUNDS {
                let base = changed.refine(&changed.base, FitAccuracy::Settle);
                let plant = base.coordinates.plant(&base.point);
                let mut problem = changed.problem.clone();
                problem.estimate_inputs((&plant, &[]), &changed.fitted.weights).ok()?;
                changed.base = base;
                changed.fitted.weights = changed.fitted.weights.clone().eliminating(&problem);
                changed = changed.with_responses_of(problem)?;
            }
        }
        Some(changed)
    }

    /// The same session with the channel of the response cutting off at a range, response units, given
    /// the experiment. Nothing is fitted again, and models of this session are models of the result.
    /// `None` if the base model has no response, or once the observer cancels.
    pub fn with_range(
        &self,
        range: impl Fn(usize) -> Option<ChannelRange>,
    ) -> Option<FitSession<'a>> {
        let mut problem = self.problem.clone();
        for (index, experiment) in problem.experiments.iter_mut().enumerate() {
            experiment.range = range(index).map(|r| r.scaled(1.0 / problem.response_scale));
        }
        self.with_responses_of(problem)
    }

    fn with_responses_of(&self, problem: Problem) -> Option<FitSession<'a>> {
        let mut changed = self.of_problem(problem);
        changed.stand_in = changed.misfit(&self.base).predict(&self.base.point).ok()?;
        changed.coarse = changed.coarsened();
        Some(changed)
    }

    fn of_problem(&self, problem: Problem) -> FitSession<'a> {
        FitSession {
            measurement: self.measurement,
            request: self.request,
            observer: self.observer,
            problem,
            fitted: self.fitted.clone(),
            order_choice: self.order_choice.clone(),
            orders: self.orders.clone(),
            base: self.base.clone(),
            stand_in: self.stand_in.clone(),
            coarse: None,
        }
    }
}
