//! `servoscope plan`

use std::path::{Path, PathBuf};

use servoscope_core::answers::{Answer, PlanOptions, PlanRequest, RoughAxis};
use servoscope_core::diagnose::{ExcitationKind, PlanError, excitation};
use servoscope_core::identify::IdentifyError;

use crate::report;
use crate::report::figures::Theme;
use crate::service::{BuiltIn, JobRequest, Numerics, Submission};

use super::choice::one_of;
use super::{Failure, computation, given, target, terminal};

/// Arguments of `plan`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Files of a first measurement of the axis; without one, describe the axis.
    #[arg(value_name = "FILE", conflicts_with_all = ["pole", "constant", "fc_plus", "fc_minus"])]
    files: Vec<PathBuf>,
    /// Time that all experiments together may take, with settling, seconds.
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    budget_s: f64,
    /// How uncertain the axis is: relative standard deviation of each of its parameters.
    #[arg(long, value_name = "U", default_value_t = PlanOptions::default().uncertainty)]
    uncertainty: f64,
    /// Standard deviation of the noise in the real and imaginary parts of a harmonic that is
    /// measured for one second, velocity units [default: 0.1 % of the response to a middle magnitude
    /// at the pole's frequency, when that is measured for 10/a seconds].
    #[arg(long, value_name = "S")]
    noise_std: Option<f64>,
    /// Noise in proportion to the response: standard deviation of a harmonic in one repeat as a
    /// share of its size.
    #[arg(long, value_name = "SHARE", default_value_t = 0.0)]
    noise_share: f64,
    /// Seed of the axes that are drawn and of the order; the same seed gives the same plan.
    #[arg(long, value_name = "N", default_value_t = PlanOptions::default().seed)]
    seed: u64,
    // Groups with a heading of their own come last: what follows one would stand under it.
    #[command(flatten)]
    axis: Axis,
    #[command(flatten)]
    limits: Limits,
    #[command(flatten)]
    given: given::Args,
    #[command(flatten)]
    output: Output,
}

/// A rough idea of the axis.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Axis")]
struct Axis {
    /// Pole −a of the mechanics, rad/s [default: from the first measurement].
    #[arg(long, value_name = "-A", allow_negative_numbers = true)]
    #[arg(requires_all = ["constant", "fc_plus"])]
    pole: Option<f64>,
    /// Constant K of the mechanics, velocity units per input unit and second [default: from the
    /// first measurement].
    #[arg(long, value_name = "K", requires = "pole", allow_negative_numbers = true)]
    constant: Option<f64>,
    /// Friction while the velocity is positive, input units [default: from the first measurement].
    #[arg(long, value_name = "FC", requires = "pole")]
    fc_plus: Option<f64>,
    /// Friction while the velocity is negative, input units [default: as --fc-plus].
    #[arg(long, value_name = "FC", requires = "pole")]
    fc_minus: Option<f64>,
    /// Pole −p of an actuator of first order, rad/s [default: no such actuator].
    #[arg(long, value_name = "-P", requires = "pole", allow_negative_numbers = true)]
    #[arg(conflicts_with = "natural_frequency")]
    actuator_pole: Option<f64>,
    /// Natural frequency of an actuator of second order, rad/s [default: no such actuator].
    #[arg(long, value_name = "WN", requires_all = ["pole", "damping_ratio"])]
    natural_frequency: Option<f64>,
    /// Damping ratio of an actuator of second order [default: no such actuator].
    #[arg(long, value_name = "ZETA", requires = "natural_frequency")]
    damping_ratio: Option<f64>,
}

/// What the rig allows.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Limits")]
struct Limits {
    /// Largest magnitude of the input, input units [default: 8 times the larger friction level].
    #[arg(long, value_name = "M")]
    largest_magnitude: Option<f64>,
    /// Lowest frequency, rad/s [default: 0.15 a].
    #[arg(long, value_name = "W")]
    lowest_rad_s: Option<f64>,
    /// Highest frequency, rad/s [default: 10 a, or 2.5 times the natural frequency].
    #[arg(long, value_name = "W")]
    highest_rad_s: Option<f64>,
    /// Largest velocity, velocity units [default: any].
    #[arg(long, value_name = "V")]
    largest_velocity: Option<f64>,
    /// Largest distance from the middle of the travel, velocity units times second [default: any].
    #[arg(long, value_name = "X")]
    largest_travel: Option<f64>,
}

/// What is written.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Output")]
struct Output {
    /// Prints the plan as JSON, and nothing else.
    #[arg(long)]
    json: bool,
    /// Writes the experiments in their order as CSV.
    #[arg(long, value_name = "FILE.csv")]
    table: Option<PathBuf>,
    /// Writes the input as samples that a generator or a drive can play.
    #[arg(long, value_name = "FILE.csv")]
    excitation: Option<PathBuf>,
    /// Which input `--excitation` writes.
    #[arg(long, value_name = "KIND", default_value = "stepped-sine")]
    #[arg(value_parser = one_of::<ExcitationKind>(["stepped-sine", "multisine"]))]
    excitation_kind: ExcitationKind,
    /// Draws the plan as SVG.
    #[arg(long, value_name = "FILE.svg")]
    figure: Option<PathBuf>,
}

/// Plans experiments, and writes what is asked for.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let Output { json, table, excitation: samples, excitation_kind, figure } = &args.output;
    for path in [table, samples, figure].into_iter().flatten() {
        target::file(path)?;
    }
    let (axis, input_unit) = match args.axis.rough() {
        Some(axis) => (axis, String::new()),
        None if args.files.is_empty() => {
            return Err(Failure::Input(
                "give a first measurement, or describe the axis with --pole, --constant and \
                 --fc-plus"
                    .into(),
            ));
        }
        None => measured(args)?,
    };
    let request = PlanRequest { axis, budget_s: args.budget_s, options: args.options() };
    let watch = computation::Watch::new();
    let plan = BuiltIn.plan(&request, &watch);
    watch.finish();
    let plan = plan.map_err(|error| match error {
        PlanError::Cancelled => Failure::other(error),
        PlanError::Invalid { field, reason } => {
            let flag = field.rsplit('.').next().unwrap_or_default().replace('_', "-");
            Failure::Input(format!("--{flag}: {reason}"))
        }
        error => Failure::input(error),
    })?;
    if let Some(path) = table {
        write(path, &report::plan_csv(&plan))?;
    }
    if let Some(path) = samples {
        write(path, &excitation(&plan, *excitation_kind).map_err(Failure::input)?)?;
    }
    if let Some(path) = figure {
        write(path, &report::figures::draw_plan(&plan, &input_unit, Theme::Auto))?;
    }
    match json {
        true => terminal::print_raw(computation::json(&plan)?.as_bytes()),
        false => terminal::print(&report::plan(&plan, terminal::width())),
    }
}

impl Args {
    fn options(&self) -> PlanOptions {
        let Limits {
            largest_magnitude,
            lowest_rad_s,
            highest_rad_s,
            largest_velocity,
            largest_travel,
        } = self.limits;
        PlanOptions {
            uncertainty: self.uncertainty,
            largest_magnitude,
            lowest_rad_s,
            highest_rad_s,
            largest_velocity,
            largest_travel,
            noise_std: self.noise_std,
            noise_share: self.noise_share,
            seed: self.seed,
        }
    }
}

impl Axis {
    /// The axis that is given, if it is.
    fn rough(&self) -> Option<RoughAxis> {
        let fc_plus = self.fc_plus?;
        Some(RoughAxis {
            pole: self.pole?,
            constant: self.constant?,
            fc_plus,
            fc_minus: self.fc_minus.unwrap_or(fc_plus),
            actuator_pole: self.actuator_pole,
            natural_frequency: self.natural_frequency,
            damping_ratio: self.damping_ratio,
        })
    }
}

/// The axis of a first measurement, and the unit of its input.
fn measured(args: &Args) -> Result<(RoughAxis, String), Failure> {
    let request =
        JobRequest::check(&Submission { kind: "identify".into(), ..Submission::default() })?;
    let measurement = computation::measurement(&args.files, &args.given)?;
    let watch = computation::Watch::new();
    let answer = BuiltIn.answer(request.kind, &measurement, None, &request.identify(), &watch);
    watch.finish();
    let answer: Answer = answer.map_err(|error| match error {
        servoscope_core::diagnose::DiagnoseError::Identify(error @ IdentifyError::Cancelled) => {
            Failure::other(error)
        }
        error => Failure::input(error),
    })?;
    let axis = RoughAxis::of(answer.base()).map_err(|name| {
        Failure::Input(format!(
            "the measurement does not determine `{name}`; give the axis instead: --pole, --constant, --fc-plus"
        ))
    })?;
    Ok((axis, measurement.metadata().input.unit.clone()))
}

fn write(path: &Path, text: &str) -> Result<(), Failure> {
    std::fs::write(path, text)
        .map_err(|error| Failure::Other(format!("{}: {error}", path.display())))
}
