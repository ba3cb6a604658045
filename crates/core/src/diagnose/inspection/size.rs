//! Finds the smallest size of an effect that leaves an excess.

use nalgebra::DVector;

use crate::diagnose::residuals::subspace::Subspace;
use crate::diagnose::search::linearization::Linearization;
use crate::effects::{ALL, Effect, MachineScales, Middle};
use crate::identify::FitSession;

/// Sizes are found to within this factor.
const ACCURACY: f64 = 1.03;

/// A smaller relative difference of two values is rounding.
const ROUNDING: f64 = 1e-9;

/// Most simulations for one size: the excess grows about as the square of the size, so that a few
/// steps of the secant method are enough unless it does not.
const MOST_STEPS: usize = 20;

/// Longest step of a base parameter, in logarithms or input scales: beyond it a linearisation says
/// nothing.
const LONGEST_STEP: f64 = 0.3;

/// Factors on the typical size between which is searched.
const FACTORS: [f64; 2] = [1e-6, 1e4];

/// An effect of a certain size, and what it does.
#[derive(Debug, Clone)]
pub(super) struct Sized {
    /// Its parameters, in the problem's units.
    pub values: Vec<f64>,
    /// The change of Ŷ/σ by it.
    pub change: DVector<f64>,
    /// What of that the base model, refitted, does not take up.
    pub left: DVector<f64>,
    /// The factor on its typical size.
    factor: f64,
}

/// Why an effect is not seen.
#[derive(Debug, Clone)]
pub(super) enum Unseen {
    /// Its simulation has no periodic response at any size that was tried.
    NoResponse,
    /// The largest size that was tried leaves too little.
    TooSmall(Sized),
}

/// Simulates effects of various sizes beside a fitted base model.
pub(super) struct SizeSearch<'a> {
    session: &'a FitSession<'a>,
    linearization: &'a Linearization,
    scales: MachineScales,
    /// Variance of the residuals, where the size of the noise is estimated from them; otherwise 1.
    variance: f64,
    least_excess: f64,
}

impl<'a> SizeSearch<'a> {
    pub fn new(
        session: &'a FitSession<'a>,
        linearization: &'a Linearization,
        least_excess: f64,
    ) -> Self {
        let variance = match session.noise_known() {
            true => 1.0,
            false => linearization.residuals.norm_squared() / linearization.dof(),
        };
        Self { session, linearization, scales: session.machine_scales(), variance, least_excess }
    }

    /// The smallest size at which the base model, refitted, would leave the excess.
    ///
    /// # Errors
    /// If no size does that a machine would have.
    pub fn smallest(&self, effect: &'static dyn Effect) -> Result<Sized, Unseen> {
        self.find(effect, 1.0, DVector::norm_squared)
    }

    /// The smallest size, from this one up, at which the excess is left beside an imitator that
    /// explains the changes in a space; `None` if there is none.
    pub fn beyond(
        &self,
        effect: &'static dyn Effect,
        from: &Sized,
        imitator: &Subspace,
    ) -> Option<Sized> {
        let left = |left: &DVector<f64>| left.norm_squared() - imitator.energy(left);
        self.find(effect, from.factor, left).ok()
    }

    /// The share of the excess's χ² that a change of the response has before the base model takes
    /// up a part of it.
    pub fn raw_share(&self, sized: &Sized) -> f64 {
        sized.change.norm_squared() / (self.variance * self.least_excess)
    }

    /// How much an effect changes the response, relative to the response.
    pub fn relative(&self, sized: &Sized) -> f64 {
        sized.change.norm() / self.linearization.prediction.norm()
    }

    /// Whether the effect shows only in the order of acquisition, and that is not known.
    pub fn lacks_order(&self, effect: &dyn Effect) -> bool {
        effect.search().needs_run && !self.session.runs_known()
    }

    fn find(
        &self,
        effect: &'static dyn Effect,
        start: f64,
        excess: impl Fn(&DVector<f64>) -> f64,
    ) -> Result<Sized, Unseen> {
        let absent = Err(Unseen::NoResponse);
        let Some(without) = self.without(effect) else { return absent };
        let [mut low, mut high] = FACTORS;
        let mut factor = start;
        let (mut enough, mut too_small) = (None, None);
        for _ in 0..MOST_STEPS {
            let found = self.at(effect, factor, &without);
            let excess = found.as_ref().map(|sized| excess(&sized.left) / self.variance);
            match (found, excess.filter(|excess| excess.is_finite())) {
                (Some(sized), Some(excess)) if excess < self.least_excess => {
                    low = factor;
                    too_small = Some(sized);
                }
                (Some(sized), Some(_)) => {
                    high = factor;
                    enough = Some(sized);
                }
                // It cannot be that small.
                _ if enough.is_some() => low = factor,
                // No machine has that much of it, or the simulation has no response.
                _ => high = factor,
            }
            if high / low < ACCURACY {
                break;
            }
            // The excess grows as the square of the size.
            let aimed = excess.filter(|excess| *excess > 0.0);
            let aimed = aimed.map(|excess| factor * (self.least_excess / excess).sqrt());
            factor = match aimed {
                Some(aimed) if aimed > low * 1.01 && aimed < high / 1.01 => aimed,
                _ if enough.is_none() && high == FACTORS[1] => (low * 10.0).min(high),
                _ if too_small.is_none() && low == FACTORS[0] => (high / 10.0).max(low),
                _ => (low * high).sqrt(),
            };
            // An aim that is met from below would be approached for ever.
            if enough.is_none() && factor < low * ACCURACY {
                factor = low * ACCURACY;
            }
        }
        match (enough, too_small) {
            (Some(sized), _) => Ok(sized),
            (None, Some(sized)) => Err(Unseen::TooSmall(sized)),
            (None, None) => Err(Unseen::NoResponse),
        }
    }

    /// Ŷ/σ with the effect at size zero. One that holds the position in its place makes the mean
    /// velocity zero, however small it is; that alone does not show which effect it is.
    fn without(&self, effect: &'static dyn Effect) -> Option<DVector<f64>> {
        if !effect.search().forces_zero_mean {
            return Some(self.linearization.prediction.clone());
        }
        // A ripple of size zero does nothing else.
        let ripple = ALL.iter().find(|effect| effect.is_scanned())?;
        let mut model = self.session.extend(self.session.base(), *ripple);
        model.set(model.parameters_of(0).start, 0.0);
        self.session.predict(&model)
    }

    /// The effect `factor` times as large as it typically is; `None` if no machine has that, or its
    /// simulation has no response.
    fn at(
        &self,
        effect: &'static dyn Effect,
        factor: f64,
        without: &DVector<f64>,
    ) -> Option<Sized> {
        let values = self.values(effect, factor)?;
        let change = self.predict(effect, &values)? - without;
        let left = self.left_by_base(&change);
        Some(Sized { values, change, left, factor })
    }

    /// What of a change of Ŷ/σ the base model does not take up, after a Gauss–Newton step of its
    /// parameters. The base model is simulated there, since a large change that it takes up is not
    /// linear in its parameters.
    fn left_by_base(&self, change: &DVector<f64>) -> DVector<f64> {
        let Linearization { prediction, fitted, .. } = self.linearization;
        let mut moved = self.session.base().clone();
        moved.shift(self.linearization.steps(change).into_iter(), LONGEST_STEP);
        let left = match self.session.predict(&moved) {
            Some(moved) => change - (moved - prediction),
            None => change.clone(),
        };
        fitted.complement(&left)
    }

    /// Its parameters at that size, in the problem's units; `None` if no machine has that.
    fn values(&self, effect: &dyn Effect, factor: f64) -> Option<Vec<f64>> {
        let draw = &effect.descriptor().draw;
        let typical = (draw.draw)(&self.scales, &mut Middle);
        (draw.scaled)(&self.scales, &typical, factor)
    }

    /// Names of the parameters that set the size of an effect near a size.
    pub fn set_by(&self, effect: &dyn Effect, sized: &Sized) -> Vec<String> {
        let near = [0.99, 1.01].into_iter().find_map(|k| self.values(effect, k * sized.factor));
        let Some(near) = near else { return Vec::new() };
        let parameters = effect.parameters().iter().zip(sized.values.iter().zip(near));
        parameters
            .filter(|(_, (here, near))| (*here - near).abs() > ROUNDING * here.abs())
            .map(|(parameter, _)| parameter.name.to_owned())
            .collect()
    }

    /// Ŷ/σ with an effect beside the base model; `None` if it has no response, or if its parameters
    /// are beyond the bounds of a fit.
    fn predict(&self, effect: &'static dyn Effect, values: &[f64]) -> Option<DVector<f64>> {
        let mut model = self.session.extend(self.session.base(), effect);
        let own = model.parameters_of(0);
        own.clone().zip(values).for_each(|(i, value)| model.set(i, *value));
        let is_kept = |(i, value): (usize, &f64)| {
            (model.value(i) - value).abs() <= ROUNDING * value.abs().max(f64::MIN_POSITIVE)
        };
        own.zip(values).all(is_kept).then(|| self.session.predict(&model))?
    }
}
