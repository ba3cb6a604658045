//! Sessions with some data changed, to try what a fault of the measurement would explain.

use super::FitSession;
use crate::measurement::Complex;

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
        FitSession {
            measurement: self.measurement,
            request: self.request,
            observer: self.observer,
            problem,
            fitted,
            order_choice: self.order_choice.clone(),
            orders: self.orders.clone(),
            base: self.base.clone(),
            stand_in: self.stand_in.clone(),
            coarse: None,
        }
    }
}
