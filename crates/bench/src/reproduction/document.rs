//! Writes the whole reproduction as one Markdown document, which the command also prints.

use super::as_written::{AsWritten, Network};
use super::chart::Chart;
use super::figure_of_merit::{ALONE, EXACT_TOLERANCE, REFINED, SIGMAS, median};
use super::markdown::{markdown, percent};
use super::runs::Reproduction;
use super::system::{FREQUENCIES, HARMONICS, MAGNITUDES};
use super::tables;

/// How the runs were made.
#[derive(Debug, Clone, Copy)]
pub struct Circumstances<'a> {
    /// The command that repeats them.
    pub command: &'a str,
    /// The conditions under which times were measured.
    pub conditions: &'a str,
}

/// Hand-written conclusions, which do not depend on the exact figures.
const LEARNED: &str = include_str!("learned.md");

/// The whole document.
pub fn document(
    reproduction: &Reproduction,
    written: &AsWritten,
    charts: &[Chart],
    circumstances: &Circumstances<'_>,
) -> String {
    let Circumstances { command, conditions } = circumstances;
    let plan = &reproduction.plan;
    let count = plan.seeds.clone().count();
    let mut text = format!(
        "# The paper's experiments, run again\n\nThis file is written by `{command} --output docs`; \
         every number in its tables is measured by that command, and \
         [reproduction.csv](reproduction.csv) has every run. Numbers in square brackets are \
         references of that paper. Times: {conditions}; one run at a time.\n\n{}\n",
        experiment()
    );
    text += &format!("## Times (Figure 14)\n\n{}\n", tables::times_table(reproduction));
    text += &format!(
        "## As close as what was published\n\nRounded to the digits that a column prints, \
         noise-free, in every row:\n\n{}\n",
        tables::closeness_table(reproduction)
    );
    for &system in &plan.systems {
        let (name, number) = match system {
            super::System::G1 => ("G1", "II"),
            super::System::G2 => ("G2", "III"),
        };
        text += &format!("## Table {number}: {name}\n\n");
        text += &tables::paper_table(reproduction, system);
        for &level in &plan.levels {
            let noise = level.map_or("noise-free".to_owned(), |db| format!("{db} dB"));
            text += &format!("### {name}, {noise}\n\n");
            text += &format!(
                "What the search alone found (the closed form of `two-magnitude`): median, and \
                 the worst of {count} seeds in brackets.\n\n{}\n",
                tables::methods_table(reproduction, system, level, ALONE)
            );
            text += &format!(
                "With refinement:\n\n{}\n",
                tables::methods_table(reproduction, system, level, REFINED)
            );
            text += &format!("{}\n", tables::effort_table(reproduction, system, level));
        }
    }
    text += &as_written_text(written);
    text += &format!("\n## Figures\n\n{}", figures(charts));
    text + "\n" + LEARNED
}

fn experiment() -> String {
    let [low, high] = MAGNITUDES;
    let bands = super::System::ALL.map(|system| {
        let [from, to] = system.band_rad_s();
        format!("{from} to {to} rad/s for {}", system.name())
    });
    format!(
        "The paper states neither magnitudes nor frequencies. Here: **m₁ = {high}** and \
         **m₂ = {low}** input units, at **{FREQUENCIES} frequencies**, log-spaced from {}, \
         harmonics 0 to {HARMONICS}, Fc⁺ = 0.5, Fc⁻ = 0.4, friction on the mechanics behind the \
         actuator. The data are made by a simulator that shares no code with what fits it. N dB \
         means a standard deviation of median|Y₁|·10^(−N/20) on re and im of every harmonic. A seed \
         is that of the method and of the noise. The methods are told the order of the actuator, \
         as in the paper, and no other thing.\n\nAn *error* is the largest relative deviation of \
         any row of the table from the computed target. A *success* is an error of at most {} \
         noise-free, and with noise every parameter within {SIGMAS} standard deviations of the \
         least-squares fit of the same data. *Evaluations* are simulations of the whole \
         measurement, the network's 800 for training included. *Search* is everything before \
         refinement.\n",
        bands.join(" and from "),
        percent(EXACT_TOLERANCE),
    )
}

/// The section on the literal implementation of the paper's equations.
pub fn as_written_text(written: &AsWritten) -> String {
    let mut text = "## The paper as written\n\nIts equations one by one, to the letter as far as \
                    that goes. None of this is used by any method above.\n\n**Its colony** (10 food \
                    sources, 50 cycles, one dimension a step, on the distance to the known target \
                    parameters; no measurement enters):\n\n"
        .to_owned();
    let header = ["system", "objective", "evaluations", "error: median", "worst"];
    let rows = written.colonies.iter().map(|(system, objective, colonies)| {
        let errors: Vec<f64> = colonies.iter().map(|colony| colony.error).collect();
        let worst = errors.iter().copied().fold(0.0, f64::max);
        vec![
            system.name().to_owned(),
            objective.name().to_owned(),
            colonies.first().map_or(0, |colony| colony.evaluations).to_string(),
            percent(median(&errors)),
            percent(worst),
        ]
    });
    text += &markdown(&header.map(str::to_owned), &rows.collect::<Vec<_>>());
    text += "\nAs printed the objective has no absolute value, and so no least value: the colony \
             goes to a corner of whatever range it is given (here 0 to twice the target; the paper \
             gives none). The limit of abandonment and the fitness behind the onlookers' \
             probabilities are not given either: food sources × parameters, and ranks.\n\n**Its \
             network** (two magnitudes in, 20 hidden neurons, weights from [0, 1], equations 2 to \
             6, until every error is below 0.1):\n\n";
    let header =
        ["system", "equation 5", "γ", "converged", "overflowed", "steps, median", "error, median"];
    let rows = written.networks.iter().map(|(system, rule, rate, networks)| {
        let of =
            |value: fn(&Network) -> f64| median(&networks.iter().map(value).collect::<Vec<_>>());
        let counted = |which: fn(&&Network) -> bool| {
            format!("{} of {}", networks.iter().filter(which).count(), networks.len())
        };
        let error = of(|network| network.error);
        vec![
            system.name().to_owned(),
            rule.name().to_owned(),
            rate.to_string(),
            counted(|network| network.converged),
            counted(|network| network.overflowed),
            of(|network| network.steps as f64).to_string(),
            if error.is_finite() { percent(error) } else { "–".into() },
        ]
    });
    text += &markdown(&header.map(str::to_owned), &rows.collect::<Vec<_>>());
    let topology = &written.topology;
    let alone = &topology.alone;
    text += &format!(
        "\nAs printed, equation 5 moves every weight of an output by the same amount, and the \
         output follows P ← P + γ S P (T − P), S = Σ yᵢ ≈ 15: the logistic map, far beyond where it \
         converges (0 < γ S T < 2), and for a negative target never. With the gradient it does \
         converge, and has then learnt one number an output: it is told the magnitudes and never \
         the response, so that it answers alike for every machine. Equation 5 gives no error to \
         the weights of the hidden layer; the text sets them to 1 and draws them from [0, 1]; they \
         stay as drawn. The data set of equation 1 is not given.\n\n**Its topology** (Figure 1: \
         friction fed back around the whole of G2). Without any input it oscillates at \
         **{:.3} rad/s**, half peak-to-peak {:.3}, mean {:.3}. Of the {} points of the design {} \
         have a response of the excitation's period; the others are refused{}.\n",
        alone.omega_rad_s,
        alone.amplitude,
        alone.mean,
        topology.periodic + topology.refused.len(),
        topology.periodic,
        refused(&topology.refused),
    );
    text
}

fn refused(points: &[(f64, f64)]) -> String {
    let mut magnitudes: Vec<f64> = points.iter().map(|(magnitude, _)| *magnitude).collect();
    magnitudes.dedup();
    let of = |magnitude: &f64| {
        let frequencies = points.iter().filter(|(m, _)| m == magnitude);
        let listed: Vec<String> = frequencies.map(|(_, omega)| format!("{omega:.2}")).collect();
        format!("m = {magnitude} at {} rad/s", listed.join(", "))
    };
    let listed: Vec<String> = magnitudes.iter().map(of).collect();
    if listed.is_empty() { String::new() } else { format!(": {}", listed.join("; ")) }
}

fn figures(charts: &[Chart]) -> String {
    let image = |chart: &Chart| {
        format!(
            "![{}](reproduction/{})\n\n*{}: {}*\n\n",
            chart.title,
            chart.file(),
            chart.name,
            chart.title
        )
    };
    charts.iter().map(image).collect()
}
