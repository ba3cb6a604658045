//! The request of a plan, checked, with every default filled in.

use crate::answers::{PlanOptions, PlanRequest, RoughAxis};
use crate::effects::MachineScales;
use crate::plant::{Actuator, Friction, Plant};
use crate::simulate::{Excitation, respond};

use super::error::PlanError;

/// Highest harmonic that is planned for.
pub(super) const HARMONICS: usize = 7;

/// Default limits, as multiples of the larger friction level and of a.
const LARGEST_OVER_FRICTION: f64 = 8.0;
const LOWEST_OVER_RATE: f64 = 0.15;
const HIGHEST_OVER_RATE: f64 = 10.0;
/// Default of the highest frequency over the natural frequency of the actuator.
const HIGHEST_OVER_NATURAL: f64 = 2.5;

/// Default noise: this share of the response, when it is measured for so many times 1/a.
const DEFAULT_NOISE: (f64, f64) = (1e-3, 10.0);

/// The smallest magnitude that is planned with, as a multiple of the larger friction level: below it
/// an axis whose friction is that uncertain may not move.
const LEAST_OVER_FRICTION: f64 = 1.4;

/// The least ratio of the largest magnitude to the smallest.
const LEAST_SPAN: f64 = 1.5;

/// Largest uncertainty of a parameter: with more, nothing is known of the axis.
const LARGEST_UNCERTAINTY: f64 = 1.0;

/// Settling: an exponential falls to a thousandth in this many time constants.
const SETTLING_TIME_CONSTANTS: f64 = 7.0;
/// A repeat is at least this many of the slowest time constant long.
const REPEAT_TIME_CONSTANTS: f64 = 5.0;
/// Largest ratio of highest to lowest frequency, of the budget to 1/a, and of the time to settle to the
/// shortest period.
const LARGEST_RATIO: f64 = 1e6;

/// A checked request.
#[derive(Debug, Clone)]
pub(super) struct Setting {
    /// The request with every default filled in.
    pub request: PlanRequest,
    /// The rough axis.
    pub plant: Plant,
    /// Smallest and largest magnitude, input units.
    pub magnitudes: [f64; 2],
    /// Lowest and highest frequency, rad/s.
    pub band_rad_s: [f64; 2],
    /// Standard deviation of the additive noise of a harmonic after one second, velocity units.
    pub noise_std: f64,
    /// Time until the response has settled, s.
    pub settle_s: f64,
    /// Least duration of a repeat, s.
    pub repeat_s: f64,
}

impl Setting {
    /// Checks a request.
    ///
    /// # Errors
    /// [`PlanError::Invalid`] says which value cannot be used, and what to do.
    pub fn of(request: &PlanRequest) -> Result<Self, PlanError> {
        let axis = &request.axis;
        let plant = plant(axis)?;
        positive("budget_s", request.budget_s)?;
        if !(request.options.uncertainty > 0.0
            && request.options.uncertainty <= LARGEST_UNCERTAINTY)
        {
            let reason = format!(
                "{} is not above 0 and at most 1; 0.25 means ± 25 %",
                request.options.uncertainty
            );
            return Err(PlanError::Invalid { field: "options.uncertainty", reason });
        }
        if !(request.options.noise_share >= 0.0 && request.options.noise_share < 1.0) {
            let reason =
                format!("{} is not a share from 0 to below 1", request.options.noise_share);
            return Err(PlanError::Invalid { field: "options.noise_share", reason });
        }
        for (field, value) in [
            ("options.largest_magnitude", request.options.largest_magnitude),
            ("options.lowest_rad_s", request.options.lowest_rad_s),
            ("options.highest_rad_s", request.options.highest_rad_s),
            ("options.largest_velocity", request.options.largest_velocity),
            ("options.largest_travel", request.options.largest_travel),
            ("options.noise_std", request.options.noise_std),
        ] {
            value.map_or(Ok(()), |value| positive(field, value))?;
        }
        let magnitudes = magnitudes(&plant, request.options.largest_magnitude)?;
        let band_rad_s = band(&plant, request)?;
        let slowest = slowest_rate(&plant) * (-request.options.uncertainty).exp();
        let rate = plant.viscous_rate_rad_s;
        if request.budget_s * rate > LARGEST_RATIO {
            let reason = format!(
                "{} s is more than a million time constants of the axis ({:.3} s); give less",
                request.budget_s,
                1.0 / rate
            );
            return Err(PlanError::Invalid { field: "budget_s", reason });
        }
        let settle_s = SETTLING_TIME_CONSTANTS / slowest;
        let settle_periods = settle_s * band_rad_s[1] / std::f64::consts::TAU;
        if settle_periods > LARGEST_RATIO {
            let reason = format!(
                "the axis takes more than a million periods of the highest frequency, {:.3e} rad/s, to \
                 settle; give lower frequencies, or an axis that is damped more",
                band_rad_s[1]
            );
            return Err(PlanError::Invalid { field: "options.highest_rad_s", reason });
        }
        let noise_std =
            request.options.noise_std.unwrap_or_else(|| default_noise(&plant, magnitudes));
        let options = PlanOptions {
            largest_magnitude: Some(magnitudes[1]),
            lowest_rad_s: Some(band_rad_s[0]),
            highest_rad_s: Some(band_rad_s[1]),
            noise_std: Some(noise_std),
            ..request.options
        };
        let request = PlanRequest { options, ..*request };
        Ok(Self {
            request,
            plant,
            magnitudes,
            band_rad_s,
            noise_std,
            settle_s,
            repeat_s: REPEAT_TIME_CONSTANTS / slowest,
        })
    }

    /// Periods to settle, and periods of a repeat, at a frequency (rad/s).
    pub fn periods(&self, omega_rad_s: f64) -> [usize; 2] {
        let periods = |seconds: f64| (seconds * omega_rad_s / std::f64::consts::TAU).ceil();
        [periods(self.settle_s), periods(self.repeat_s)].map(|periods| periods.max(1.0) as usize)
    }

    /// Scales from which effects of an axis take their typical sizes.
    pub fn scales(&self, plant: &Plant) -> MachineScales {
        let [lowest, highest] = self.magnitudes;
        let level = |fc: f64| fc.max(1e-3 * highest);
        MachineScales {
            viscous_rate: plant.viscous_rate_rad_s,
            constant: plant.constant,
            coulomb: [level(plant.friction.fc_plus), level(plant.friction.fc_minus)],
            lowest: lowest.max(0.25 * highest),
            highest,
            fastest_rad_s: self.band_rad_s[1],
        }
    }
}

/// Largest friction level of a rough axis: magnitudes are multiples of it, and have to be numbers.
const LARGEST_LEVEL: f64 = 1e100;

fn positive(field: &'static str, value: f64) -> Result<(), PlanError> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(PlanError::Invalid { field, reason: format!("{value} is not a positive number") })
}

/// The rate of a pole, which is its negative.
fn rate(field: &'static str, pole: f64) -> Result<f64, PlanError> {
    if pole < 0.0 && pole.is_finite() {
        return Ok(-pole);
    }
    let reason = format!(
        "{pole} is not negative, as the pole of a stable axis is: -10, for example (rad/s)"
    );
    Err(PlanError::Invalid { field, reason })
}

fn plant(axis: &RoughAxis) -> Result<Plant, PlanError> {
    let viscous_rate_rad_s = rate("axis.pole", axis.pole)?;
    if !(axis.constant.is_finite() && axis.constant != 0.0) {
        let reason = format!("{} does not move the axis", axis.constant);
        return Err(PlanError::Invalid { field: "axis.constant", reason });
    }
    for (field, level) in [("axis.fc_plus", axis.fc_plus), ("axis.fc_minus", axis.fc_minus)] {
        if !(0.0..=LARGEST_LEVEL).contains(&level) {
            let reason = format!(
                "{level} is not a number from 0 to {LARGEST_LEVEL:e}; both levels are sizes"
            );
            return Err(PlanError::Invalid { field, reason });
        }
    }
    let actuator = match (axis.actuator_pole, axis.natural_frequency, axis.damping_ratio) {
        (None, None, None) => Actuator::Direct,
        (Some(pole), None, None) => {
            Actuator::FirstOrder { corner_rad_s: rate("axis.actuator_pole", pole)? }
        }
        (None, Some(natural_frequency_rad_s), Some(damping_ratio)) => {
            positive("axis.natural_frequency", natural_frequency_rad_s)?;
            positive("axis.damping_ratio", damping_ratio)?;
            Actuator::SecondOrder { natural_frequency_rad_s, damping_ratio }
        }
        _ => {
            let reason = "give `actuator_pole` alone for an actuator of first order, \
                          `natural_frequency` and `damping_ratio` for one of second order, or none \
                          of them"
                .into();
            return Err(PlanError::Invalid { field: "axis", reason });
        }
    };
    Ok(Plant {
        viscous_rate_rad_s,
        constant: axis.constant,
        actuator,
        friction: Friction::coulomb(axis.fc_plus, axis.fc_minus),
    })
}

/// Smallest and largest magnitude.
fn magnitudes(plant: &Plant, largest: Option<f64>) -> Result<[f64; 2], PlanError> {
    let level = plant.friction.fc_plus.max(plant.friction.fc_minus);
    let Some(largest) = largest.or((level > 0.0).then_some(LARGEST_OVER_FRICTION * level)) else {
        let reason = "give it: without friction it cannot be chosen from the axis".into();
        return Err(PlanError::Invalid { field: "options.largest_magnitude", reason });
    };
    let least = LEAST_OVER_FRICTION * level;
    if largest < LEAST_SPAN * least {
        let reason = format!(
            "a largest magnitude of {largest} hardly moves an axis with {level} of friction, both in \
             units of the input; give at least {:.3}",
            LEAST_SPAN * least
        );
        return Err(PlanError::Invalid { field: "options.largest_magnitude", reason });
    }
    Ok([least.max(largest / LARGEST_OVER_FRICTION), largest])
}

/// Lowest and highest frequency.
fn band(plant: &Plant, request: &PlanRequest) -> Result<[f64; 2], PlanError> {
    let rate = plant.viscous_rate_rad_s;
    let highest = match plant.actuator {
        Actuator::SecondOrder { natural_frequency_rad_s, .. } => {
            HIGHEST_OVER_NATURAL * natural_frequency_rad_s
        }
        _ => HIGHEST_OVER_RATE * rate,
    };
    let lowest = request.options.lowest_rad_s.unwrap_or(LOWEST_OVER_RATE * rate);
    let highest = request.options.highest_rad_s.unwrap_or(highest.max(2.0 * lowest));
    if highest < 2.0 * lowest || highest > LARGEST_RATIO * lowest {
        let reason = format!(
            "cannot plan in the band from {lowest} to {highest} rad/s: the highest frequency must be 2 \
             to 1 000 000 times the lowest"
        );
        return Err(PlanError::Invalid { field: "options.highest_rad_s", reason });
    }
    Ok([lowest, highest])
}

/// The slowest rate at which a linear motion dies away, 1/s.
fn slowest_rate(plant: &Plant) -> f64 {
    let actuator = match plant.actuator {
        Actuator::Direct => f64::INFINITY,
        Actuator::FirstOrder { corner_rad_s } => corner_rad_s,
        // The real part of the slower pole; of an overdamped one to within a factor of two.
        Actuator::SecondOrder { natural_frequency_rad_s, damping_ratio } => {
            natural_frequency_rad_s * damping_ratio.min(0.5 / damping_ratio)
        }
    };
    plant.viscous_rate_rad_s.min(actuator)
}

/// The default noise after one second.
fn default_noise(plant: &Plant, [least, largest]: [f64; 2]) -> f64 {
    let (share, time_constants) = DEFAULT_NOISE;
    let rate = plant.viscous_rate_rad_s;
    let excitation = Excitation::cosine(rate, (least * largest).sqrt());
    let linear = (least * largest).sqrt() * plant.constant.abs() / rate;
    let response = respond(plant, &[], &excitation, 1).map_or(linear, |found| found[1].norm());
    share * response * (time_constants / rate).sqrt()
}
