//! What the tests of figures are drawn of, the ordinary and the extreme.

use servoscope_core::answers::sample;
use servoscope_core::answers::{
    ComparedExperiment, ComparedHarmonic, Comparison, ConvergenceRow, Discrepancy, Identification,
    Linearity, Pattern, Unanswered, ValidBand,
};

use super::{Extended, Subject, Theme, draw};

/// Everything a figure may be drawn of.
#[derive(Clone)]
pub(super) struct Known {
    pub(super) identification: Identification,
    pub(super) comparison: Comparison,
    pub(super) linearity: Linearity,
    pub(super) discrepancy: Option<Discrepancy>,
    pub(super) valid_band: Option<ValidBand>,
    pub(super) extended: Option<Comparison>,
    pub(super) convergence: Vec<ConvergenceRow>,
}

impl Known {
    pub(super) fn of(comparison: Comparison) -> Self {
        let mut identification = sample::identification();
        let level = identification.parameters["fc_plus"].clone();
        identification.parameters.insert("fc_minus".into(), level);
        let (discrepancy, extended) = (None, None);
        let (linearity, convergence) = (sample::linearity(), history());
        let valid_band = None;
        Self {
            identification,
            comparison,
            linearity,
            discrepancy,
            valid_band,
            extended,
            convergence,
        }
    }

    pub(super) fn subject(&self) -> Subject<'_> {
        Subject {
            identification: Some(&self.identification),
            comparison: Some(&self.comparison),
            linearity: Some(&self.linearity),
            discrepancy: self.discrepancy.as_ref(),
            valid_band: self.valid_band.as_ref(),
            extended: self.extended.as_ref().map(|comparison| Extended {
                name: "with static_friction and actuator_saturation",
                identification: &self.identification,
                comparison,
            }),
            convergence: &self.convergence,
            named: None,
        }
    }

    pub(super) fn draw(&self, name: &str) -> String {
        let svg = draw(name, &self.subject(), Theme::Auto);
        svg.unwrap_or_else(|error| panic!("{name}: {error}"))
    }
}

/// Two orders through every stage, the first costs beyond any measure.
fn history() -> Vec<ConvergenceRow> {
    let row = |stage: &str, order: u64, cycle: u64, best: f64, mean: Option<f64>| ConvergenceRow {
        stage: format!("{stage} (order {order})"),
        cycle,
        evaluations: 20 * cycle,
        best,
        mean,
        elapsed_s: 0.01 * cycle as f64,
    };
    let mut rows = Vec::new();
    for order in 0..2 {
        rows.push(row("closed_form", order, 0, 3e5, None));
        rows.extend(
            (1..60).map(|i| row("network", order, i, 2.0 / i as f64, Some(1.0 / i as f64))),
        );
        rows.push(row("colony", order, 1, f64::MAX, None));
        rows.extend((2..50).map(|i| row("colony", order, i, 3e4 / i as f64, Some(1e9 / i as f64))));
        rows.extend(
            (0..9).map(|i| row("refinement", order, i, 640.0 + 10.0 / (1.0 + i as f64), None)),
        );
    }
    rows
}

/// With a model that has the causes, beside which the base model is 5 % off.
pub(super) fn extended() -> Known {
    let off = changed(|h| h.simulated = h.simulated.map(|x| 1.05 * x));
    Known { extended: Some(sample::comparison()), ..off }
}

pub(super) fn diagnosed() -> Known {
    Known { discrepancy: Some(sample::discrepancy()), ..Known::of(sample::comparison()) }
}

fn experiment(
    index: usize,
    magnitude: f64,
    omega: f64,
    lines: &[usize],
    highest: usize,
) -> ComparedExperiment {
    let harmonic = |order: usize| {
        let excited = lines.contains(&order);
        let frequency = order as f64 * omega;
        let size = if excited { 1.0 } else { 1e-3 } / (1.0 + frequency / 50.0);
        // Some scatter without a random number: the golden ratio fills the circle evenly.
        let angle = 2.399_963 * order as f64;
        let noise = [1e-5 * angle.cos(), if order == 0 { 0.0 } else { 1e-5 * angle.sin() }];
        let im = if order == 0 { 0.0 } else { -0.5 * size };
        ComparedHarmonic {
            order,
            input: [if excited { magnitude / lines.len() as f64 } else { 0.0 }, 0.0],
            measured: [size + noise[0], im + noise[1]],
            simulated: [size, im],
            std: 1e-5,
        }
    };
    let harmonics = (0..=highest).map(harmonic).collect();
    ComparedExperiment { experiment: index, magnitude, omega_rad_s: omega, run: None, harmonics }
}

/// One record whose response has 1100 lines, every other one excited.
pub(super) fn record() -> Known {
    let lines: Vec<usize> = (1..=1100).step_by(2).collect();
    let experiments = vec![experiment(0, 2.5, 1.0, &lines, 1100)];
    Known {
        discrepancy: Some(Discrepancy {
            patterns: vec![
                Pattern { frequencies_hz: Some([1.0, 5.0]), ..sample::pattern("A band.") },
                Pattern { frequencies_hz: Some([1.5, 2.0]), ..sample::pattern("Within the band.") },
            ],
            ..sample::discrepancy()
        }),
        ..Known::of(Comparison { experiments, ..sample::comparison() })
    }
}

/// 48 experiments with 8 harmonics: 3 magnitudes at 16 frequencies.
pub(super) fn stepped() -> Known {
    let design = [0.6, 1.2, 2.4].into_iter();
    let design = design.flat_map(|m| (0..16).map(move |i| (m, 1.4_f64.powi(i))));
    let experiments =
        design.enumerate().map(|(i, (m, omega))| experiment(i, m, omega, &[1], 8)).collect();
    Known::of(Comparison { experiments, ..sample::comparison() })
}

fn changed(change: impl Fn(&mut ComparedHarmonic)) -> Known {
    let mut comparison = sample::comparison();
    comparison.experiments.iter_mut().flat_map(|e| &mut e.harmonics).for_each(change);
    Known::of(comparison)
}

/// What a figure must bear, each with the names of the figures it allows.
pub(super) fn extremes() -> Vec<(&'static str, Known)> {
    let mut single = sample::comparison();
    single.experiments.truncate(1);
    single.experiments[0].harmonics.retain(|h| h.order == 1);
    let mut odd_units = diagnosed();
    odd_units.comparison.input_unit = "<A & \"B\">\u{1}".into();
    odd_units.comparison.response_unit =
        "a unit of a name far longer than any axis has room for, ".repeat(4);
    odd_units.comparison.response_quantity = "position".into();
    let mut bare = Known::of(sample::comparison());
    bare.comparison.input_unit.clear();
    bare.comparison.response_unit.clear();
    bare.comparison.std_estimated = true;
    bare.comparison.unanswered = vec![Unanswered {
        experiment: 18,
        magnitude: Some(1.0),
        omega_rad_s: Some(2.0),
        reason: "it does not settle".into(),
    }];
    let mut many = sample::comparison();
    many.experiments =
        (0..40).map(|i| experiment(i, 1.0 + i as f64, 2.0 + i as f64, &[1], 3)).collect();
    let mut several = record();
    several.comparison.experiments = (0..6)
        .map(|i| experiment(i, 1.0 + (i / 2) as f64, 1.0, &(1..40).collect::<Vec<_>>(), 60))
        .collect();
    let mut steep = diagnosed();
    for (i, experiment) in steep.comparison.experiments.iter_mut().enumerate() {
        experiment.magnitude *= 1e-7;
        experiment.omega_rad_s *= 10.0_f64.powi(i as i32 - 9);
        experiment.harmonics.iter_mut().for_each(|h| h.measured = h.measured.map(|x| x * 1e12));
    }
    vec![
        ("a diagnosis", diagnosed()),
        ("a diagnosis with causes", extended()),
        ("a record", record()),
        ("several records", several),
        ("48 experiments", stepped()),
        ("one harmonic", Known::of(single)),
        ("all stuck", changed(|h| (h.measured, h.simulated) = ([0.0; 2], [0.0; 2]))),
        ("simulated stuck", changed(|h| h.simulated = [0.0; 2])),
        ("odd units", odd_units),
        ("no units", bare),
        ("40 magnitudes", Known::of(many)),
        ("steep", steep),
        ("no noise", changed(|h| h.std = 0.0)),
    ]
}
