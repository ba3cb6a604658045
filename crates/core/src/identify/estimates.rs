//! Parameter estimates by name, with intervals and correlations.

use indexmap::IndexMap;

use crate::answers::{Correlations, ParameterEstimate};
use crate::effects;
use crate::plant::{Actuator, Plant};

use super::parameter_names;
use super::parameters::{CONSTANT, Coordinate};
use super::pipeline::Fitted;
use super::problem::{Problem, Scales};
use super::uncertainty::{LARGEST_LOG_STD, Uncertainty, largest_std, unit};
use super::units::{Units, bracketed};

/// A fitted point with its uncertainty, to be reported as named parameters.
pub(super) struct Estimates<'a> {
    /// The fitted point.
    pub fitted: &'a Fitted,
    /// The problem, for its scales.
    pub problem: &'a Problem,
    /// Uncertainty if coordinates at a bound are held there.
    pub uncertainty: &'a Uncertainty,
    /// Uncertainty if no coordinate is held: how far one at its bound may reach.
    pub released: &'a Uncertainty,
    /// Which coordinates are held at a bound.
    pub held: &'a [bool],
    /// Half-width of a 95 % interval, in standard deviations.
    pub quantile: f64,
    /// How far the interval of each coordinate reaches below and above the point, if that differs
    /// from `quantile` standard deviations.
    pub reaches: Vec<Option<[f64; 2]>>,
}

impl Estimates<'_> {
    /// Every parameter by name.
    pub fn all(&self, plant: &Plant, units: &Units) -> IndexMap<String, ParameterEstimate> {
        let Units { input, velocity } = units;
        let mut parameters = IndexMap::new();
        let mut insert = |name: &str, estimate: ParameterEstimate| {
            parameters.insert(name.to_owned(), estimate);
        };
        let rate = |value: f64, i: usize| self.logarithmic(value, i, "rad/s");
        let constant = format!("{}/({input}·s)", bracketed(velocity));
        let gain = format!("{}/{}", bracketed(velocity), bracketed(input));
        insert("pole", rate(-plant.viscous_rate_rad_s, 0));
        insert("constant", self.logarithmic(plant.constant, CONSTANT, &constant));
        insert("dc_gain", self.dc_gain(plant, &gain));
        for (i, coordinate) in self.fitted.coordinates.list.iter().enumerate() {
            let friction = plant.friction;
            let scale = self.problem.scales.input;
            let level = |value: f64| self.linear(value, i, scale, [0.0, f64::INFINITY], input);
            match coordinate {
                Coordinate::ViscousRate | Coordinate::Constant => {}
                Coordinate::FcPlus => insert("fc_plus", level(friction.fc_plus)),
                Coordinate::FcMinus => insert("fc_minus", level(friction.fc_minus)),
                Coordinate::FcMean => {
                    let unknown = |value: f64| ParameterEstimate {
                        value: Some(value),
                        std: None,
                        interval95: None,
                        unit: input.clone(),
                        at_bound: false,
                        identifiable: false,
                    };
                    insert("fc_plus", unknown(friction.fc_plus));
                    insert("fc_minus", unknown(friction.fc_minus));
                    insert("fc_mean", level(0.5 * (friction.fc_plus + friction.fc_minus)));
                }
                Coordinate::FcSplit => {}
                Coordinate::ActuatorRate => {
                    if let Actuator::FirstOrder { corner_rad_s } = plant.actuator {
                        insert("actuator_pole", rate(-corner_rad_s, i));
                    }
                }
                Coordinate::NaturalFrequency => {
                    if let Actuator::SecondOrder { natural_frequency_rad_s, .. } = plant.actuator {
                        insert("natural_frequency", rate(natural_frequency_rad_s, i));
                    }
                }
                Coordinate::DampingRatio => {
                    if let Actuator::SecondOrder { damping_ratio, .. } = plant.actuator {
                        insert("damping_ratio", self.logarithmic(damping_ratio, i, ""));
                    }
                }
                Coordinate::OfEffect { effect, parameter } => {
                    let name = parameter_names::name(&self.fitted.coordinates, i);
                    insert(&name, self.of_effect(*effect, *parameter, i, units));
                }
            }
        }
        parameters
    }

    /// A parameter that is estimated as a logarithm. Its interval is that of the logarithm, so it
    /// never contains zero.
    fn logarithmic(&self, value: f64, i: usize, unit_text: &str) -> ParameterEstimate {
        let std = self.std(self.uncertainty, i);
        let known = std.map(|std| (std, self.reach(std, i)));
        self.of_logarithm(value, known, self.held[i], unit_text)
    }

    /// Standard deviation of a coordinate; `None` where the data does not determine it.
    fn std(&self, uncertainty: &Uncertainty, i: usize) -> Option<f64> {
        let coordinates = &self.fitted.coordinates;
        uncertainty.std(&unit(coordinates, i), largest_std(coordinates, i))
    }

    /// How far the interval of a coordinate reaches below and above the point.
    fn reach(&self, std: f64, i: usize) -> [f64; 2] {
        self.reaches[i].unwrap_or([self.quantile * std; 2])
    }

    /// A parameter that is estimated as a logarithm, given its standard deviation and how far its
    /// interval reaches below and above.
    fn of_logarithm(
        &self,
        value: f64,
        known: Option<(f64, [f64; 2])>,
        at_bound: bool,
        unit_text: &str,
    ) -> ParameterEstimate {
        let known = known.filter(|_| !at_bound);
        let ends = |[below, above]: [f64; 2]| {
            let (a, b) = (value * (-below).exp(), value * above.exp());
            [a.min(b), a.max(b)]
        };
        ParameterEstimate {
            value: Some(value),
            std: known.map(|(std, _)| std * value.abs()),
            interval95: known.map(|(_, reach)| ends(reach)),
            unit: unit_text.to_owned(),
            at_bound,
            identifiable: known.is_some(),
        }
    }

    /// A parameter of an effect.
    fn of_effect(
        &self,
        effect: usize,
        parameter: usize,
        i: usize,
        units: &Units,
    ) -> ParameterEstimate {
        let coordinates = &self.fitted.coordinates;
        let parameter = &coordinates.effects[effect].parameters()[parameter];
        let Scales { omega, input, velocity } = self.problem.scales;
        let scale = parameter.dimension.factor(input, velocity, 1.0 / omega);
        let value = scale * coordinates.value(i, self.fitted.point[i]).0;
        let unit_text = units.unit(parameter.dimension);
        match parameter.coordinate {
            effects::Coordinate::Logarithmic => self.logarithmic(value, i, &unit_text),
            effects::Coordinate::Linear | effects::Coordinate::Angle => {
                let ends = [coordinates.lower[i] * scale, coordinates.upper[i] * scale];
                self.linear(value, i, scale, ends, &unit_text)
            }
        }
    }

    /// A parameter that is estimated directly, with `scale` the unit of its coordinate. Its
    /// interval is cut at `low` and `high`, the ends of the parameter's range, as at zero for a
    /// friction level.
    fn linear(
        &self,
        value: f64,
        i: usize,
        scale: f64,
        [low, high]: [f64; 2],
        unit_text: &str,
    ) -> ParameterEstimate {
        let at_bound = self.held[i];
        let uncertainty = if at_bound { self.released } else { self.uncertainty };
        let std = self.std(uncertainty, i).map(|std| std * scale);
        let interval = |std: f64| {
            let [below, above] = self.reach(std / scale, i).map(|reach| reach * scale);
            [(value - below).max(low.min(value)), (value + above).min(high.max(value))]
        };
        ParameterEstimate {
            value: Some(value),
            std,
            interval95: std.map(interval),
            unit: unit_text.to_owned(),
            at_bound,
            identifiable: std.is_some(),
        }
    }

    fn dc_gain(&self, plant: &Plant, unit_text: &str) -> ParameterEstimate {
        let mut combination = vec![0.0; self.fitted.coordinates.len()];
        combination[0] = -1.0;
        combination[CONSTANT] = 1.0;
        let std = self.uncertainty.std(&combination, LARGEST_LOG_STD);
        let value = plant.constant / plant.viscous_rate_rad_s;
        let known = std.map(|std| (std, [self.quantile * std; 2]));
        self.of_logarithm(value, known, self.held[0] || self.held[CONSTANT], unit_text)
    }

    /// Correlations of the identifiable parameters.
    pub fn correlations(&self) -> Correlations {
        let list = &self.fitted.coordinates.list;
        let which: Vec<usize> = (0..list.len())
            .filter(|i| !self.held[*i] && list[*i] != Coordinate::FcSplit)
            .filter(|i| self.std(self.uncertainty, *i).is_some())
            .collect();
        let mut matrix = self.uncertainty.correlations(&which);
        // Poles are reported as −a and −p, which changes the sign of their correlations.
        let sign = |i: usize| match list[i] {
            Coordinate::ViscousRate | Coordinate::ActuatorRate => -1.0,
            _ => 1.0,
        };
        for (r, row) in matrix.iter_mut().enumerate() {
            for (c, value) in row.iter_mut().enumerate() {
                *value *= sign(which[r]) * sign(which[c]);
            }
        }
        let names =
            which.iter().map(|i| parameter_names::name(&self.fitted.coordinates, *i)).collect();
        Correlations { names, matrix }
    }
}
