//! One periodic input and its response.

use super::{BadSamples, Complex, size};

/// One harmonic of a response.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Harmonic {
    /// 0 = mean, 1 = fundamental, 2 …
    pub order: usize,
    /// Peak amplitude Yₖ, response units, as in y(t) = Re Σ Yₖ exp(jkωt).
    pub value: Complex,
    /// Standard deviation of each of re and im (of re alone at order 0), response units; `None`
    /// if the upload does not state one.
    pub std: Option<f64>,
}

/// Deviation of one repeat of an experiment, or of one period of a record, from the mean over all
/// of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Repeat {
    /// Deviation of Uₖ, aligned with [`Experiment::input`]; empty if the input was not measured or
    /// does not vary.
    pub input: Vec<Complex>,
    /// Deviation of Yₖ, aligned with [`Experiment::response`].
    pub response: Vec<Complex>,
}

/// The range of a channel that cuts off what lies beyond.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChannelRange {
    /// Smallest value that it reads, response units; −∞ if it does not cut off there.
    pub lowest: f64,
    /// Largest value that it reads; ∞ if it does not cut off there.
    pub highest: f64,
    /// Samples of a period.
    pub samples: usize,
}

/// What seems to be cut off in a record.
#[derive(Debug, Clone, PartialEq)]
pub struct Clipping {
    /// The experiment with an input of which what was cut off is filled in, if it seems to clip.
    pub filled: Option<Experiment>,
    /// Share of the samples of the input that was cut off.
    pub input_share: f64,
    /// The range of the channel of the response, if it seems to clip.
    pub range: Option<ChannelRange>,
    /// Share of the samples of the response that was cut off.
    pub response_share: f64,
}

/// One periodic input, its measured response, and its repeats.
#[derive(Debug, Clone, PartialEq)]
pub struct Experiment {
    /// Half the peak-to-peak value of the input, input units.
    pub magnitude: f64,
    /// Fundamental angular frequency, rad/s.
    pub omega_rad_s: f64,
    /// Uₖ for k = 0, 1, 2 …, input units: u(t) = Re Σ Uₖ exp(jkωt).
    /// A pure cosine is `[0, m]`.
    pub input: Vec<Complex>,
    /// Whether the mean of the input (U₀) was measured rather than assumed to be 0.
    pub input_mean_measured: bool,
    /// Mean velocity of a response that is a position, response units per second: 0 where it
    /// returns after each period. Other responses have it as harmonic 0 and ignore this.
    pub mean_velocity: f64,
    /// Standard deviation of each of re and im of every harmonic of the response from the rounding
    /// of samples, as far as it repeats in every period, so that `repeats` do not tell it.
    pub rounding_std: f64,
    /// Samples of a period of the input, if it was sampled and nothing says how it runs between its
    /// samples. `input` are then the lines of the smoothest course through them.
    pub open_samples: Option<f64>,
    /// Samples of the record that do not belong to the rest.
    pub bad_samples: Option<Box<BadSamples>>,
    /// What a channel of the record seems to cut off.
    pub clipping: Option<Box<Clipping>>,
    /// The range of the channel of the response, if it cuts off what a model predicts beyond.
    pub range: Option<ChannelRange>,
    /// Directions along which the input is not known, as lines Uₖ from k = 0 like `input`: each is the
    /// standard deviation of a number that was not measured, such as some samples that were cut off.
    pub unknown_input: Vec<Vec<Complex>>,
    /// Yₖ, mean over the repeats, in ascending order of k without duplicates.
    pub response: Vec<Harmonic>,
    /// Position in the order of acquisition, if known.
    pub run: Option<f64>,
    /// Deviations of the repeats or periods from their mean; either empty or at least 2.
    pub repeats: Vec<Repeat>,
    /// Whether `repeats` are the periods of one time record.
    pub from_record: bool,
}

impl Experiment {
    /// Highest harmonic of the response.
    pub fn highest_harmonic(&self) -> usize {
        self.response.last().map_or(0, |harmonic| harmonic.order)
    }

    /// The harmonic of this order, if it was measured.
    pub fn harmonic(&self, order: usize) -> Option<&Harmonic> {
        let position = self.response.binary_search_by_key(&order, |harmonic| harmonic.order);
        position.ok().map(|position| &self.response[position])
    }

    /// Whether the upload states a standard deviation for every harmonic.
    pub fn std_given(&self) -> bool {
        self.response.iter().all(|harmonic| harmonic.std.is_some())
    }

    /// Whether the experiment has repeats or several periods.
    pub fn has_repeats(&self) -> bool {
        !self.repeats.is_empty()
    }

    /// The complex amplitude U₁ if all other input lines are zero, otherwise `None`.
    pub fn pure_cosine(&self) -> Option<Complex> {
        let others_vanish =
            self.input.iter().enumerate().all(|(k, u)| k == 1 || *u == Complex::new(0.0, 0.0));
        (others_vanish && self.input.len() > 1).then(|| self.input[1])
    }

    pub(super) fn check(&self) -> Result<(), String> {
        let finite = |z: &Complex| z.re.is_finite() && z.im.is_finite();
        if !(self.magnitude.is_finite() && self.magnitude >= 0.0) {
            return Err(format!("magnitude {} is not a finite number ≥ 0", self.magnitude));
        }
        if !(self.omega_rad_s.is_finite() && self.omega_rad_s > 0.0) {
            return Err(format!("frequency {} rad/s is not positive", self.omega_rad_s));
        }
        if let Some(reason) = size::fault("the magnitude", self.magnitude) {
            return Err(reason);
        }
        if let Some(reason) = size::frequency_fault("the frequency (rad/s)", self.omega_rad_s) {
            return Err(reason);
        }
        if !self.input.iter().all(finite) {
            return Err("an input harmonic is not finite".into());
        }
        let parts = self.input.iter().flat_map(|u| [u.re, u.im]);
        let largest = parts.map(f64::abs).fold(0.0, f64::max);
        if let Some(reason) = size::fault("the largest line of the input", largest) {
            return Err(reason);
        }
        if !self.mean_velocity.is_finite() {
            return Err("the mean velocity is not finite".into());
        }
        if !(self.rounding_std.is_finite() && self.rounding_std >= 0.0) {
            return Err(format!(
                "rounding deviation {} is not a finite number ≥ 0",
                self.rounding_std
            ));
        }
        if self.response.is_empty() {
            return Err("there is no response".into());
        }
        if !self.response.iter().all(|harmonic| finite(&harmonic.value)) {
            return Err("a response harmonic is not finite".into());
        }
        if self.response.windows(2).any(|pair| pair[0].order >= pair[1].order) {
            return Err("response harmonics are not in ascending order".into());
        }
        if let Some(std) = self
            .response
            .iter()
            .filter_map(|harmonic| harmonic.std)
            .find(|s| !(*s > 0.0 && s.is_finite()))
        {
            return Err(format!("standard deviation {std} is not positive"));
        }
        let aligned = |repeat: &Repeat| {
            repeat.response.len() == self.response.len()
                && (repeat.input.is_empty() || repeat.input.len() == self.input.len())
                && repeat.response.iter().chain(&repeat.input).all(finite)
        };
        if self.repeats.len() == 1 || !self.repeats.iter().all(aligned) {
            return Err("the repeats do not fit the data they deviate from".into());
        }
        Ok(())
    }
}
