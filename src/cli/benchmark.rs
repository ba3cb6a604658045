//! `servoscope benchmark`

mod ablation;
mod draws;
mod watch;

use std::path::PathBuf;

use servoscope_bench::naming::effect_draws::ids;
use servoscope_bench::naming::{
    Case, Kind, Plan, SettingChange, Settings, Sizing, drawn_fault, known_effect,
};
use servoscope_core::answers::FaultKind;

use super::choice::one_of;
use super::{Failure, terminal};

/// Arguments of `benchmark`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Single draws of each effect at each level.
    #[arg(long, value_name = "N", default_value_t = Plan::default().singles)]
    draws: u32,
    /// Draws in which nothing is hidden, at all levels together; as many of `analyser` and of
    /// `analyser-record`.
    #[arg(long, value_name = "N", default_value_t = Plan::default().clean)]
    clean: u32,
    /// Pairs of effects at each level above 40 dB.
    #[arg(long, value_name = "N", default_value_t = Plan::default().pairs)]
    pairs: u32,
    /// Draws with something that the library does not have, at the quietest level.
    #[arg(long, value_name = "N", default_value_t = Plan::default().outsiders)]
    outsiders: u32,
    /// Tables of analysers with each effect: bare Bode tables or few harmonics, with noise in
    /// proportion to the value and a floor 60 to 80 dB down, not stated, or stated by repeats or a
    /// coherence; as many records of `analyser-record`.
    #[arg(long, value_name = "N", default_value_t = Plan::default().analysers)]
    analyser: u32,
    /// Machines with one dominant effect and 3 to 6 small ones, of each effect at each level above
    /// 40 dB; as many of each effect that are recorded.
    #[arg(long, value_name = "N", default_value_t = Plan::default().machines)]
    machines: u32,
    /// Machines with two dominant effects and 3 to 6 small ones, at each level above 40 dB; as many
    /// that are recorded.
    #[arg(long, value_name = "N", default_value_t = Plan::default().machine_pairs)]
    machine_pairs: u32,
    /// Measurements with a fault of each sort (bad rows, a wrong gain or phase of a level or an
    /// experiment, a wrong sign, unit, reference, quantity or timing) of clean machines at each
    /// level above 40 dB; as many of machines with an effect, the effects taken in turn; as many
    /// records with each fault that they may have, bad samples and channels that clip among them. The
    /// same measurements are diagnosed without the fault, too.
    #[arg(long, value_name = "N", default_value_t = Plan::default().mismeasured)]
    mismeasured: u32,
    /// Kinds of these faults, as an answer names them [default: all].
    #[arg(long, value_name = "FAULT,…", value_delimiter = ',', value_parser = drawn_fault)]
    faults: Vec<FaultKind>,
    /// Noise, dB below the median response: 60, 50 or 40; not of `analyser`.
    #[arg(long, value_name = "DB,…", value_delimiter = ',', default_values_t = [60, 50, 40])]
    #[arg(value_parser = clap::value_parser!(u32).range(20..=100))]
    levels: Vec<u32>,
    /// Effects of the single draws, of `analyser`, of its records and of `mismeasured`, dominant
    /// effects of `machine` [default: all].
    #[arg(long, value_name = "ID,…", value_delimiter = ',', value_parser = known_effect)]
    effects: Vec<&'static str>,
    /// Kinds of draw [default: single, clean, pair and outsider; the others would make the run
    /// several times as long].
    #[arg(long, value_name = "KIND,…", value_delimiter = ',')]
    #[arg(value_parser = one_of::<Kind>(Kind::ALL.map(Kind::name)))]
    kinds: Vec<Kind>,
    /// Orders of the actuator, taken in turn.
    #[arg(long, value_name = "N,…", value_delimiter = ',', default_values_t = [0, 1, 2])]
    #[arg(value_parser = clap::value_parser!(u8).range(0..=2))]
    orders: Vec<u8>,
    /// Seed of every draw.
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Brings an effect to its excess by its character instead of how much of it there is:
    /// joints by their stiffness, Stribeck curves by their velocity.
    #[arg(long)]
    by_character: bool,
    /// Leaves the actuator's order to the data instead of giving the true one.
    #[arg(long)]
    order_from_data: bool,
    /// Where a diagnosis asks for one more experiment, measures it and, apart from it, a
    /// random one, and counts how often either leaves the hidden effect alone as the cause.
    #[arg(long)]
    separate: bool,
    /// For every draw of one effect, prints which other effect fits the noise-free response best,
    /// and counts how often the hidden one is named first by the excess χ² of that fit: effects
    /// that fit equally well without noise cannot be told apart. Does the same for the faults of
    /// `mismeasured`, with the excess χ² of the machine's own model, refitted.
    #[arg(long)]
    nearest: bool,
    /// Changes a setting of the search for causes; may be repeated.
    #[arg(long, value_name = "NAME=VALUE")]
    setting: Vec<SettingChange>,
    /// Lists the settings of the search with their values, and runs nothing.
    #[arg(long)]
    settings: bool,
    /// Diagnoses every draw with other settings of the search, and prints a table of the answers and
    /// the processor time: each setting whose name begins with NAME halved and doubled, or set to
    /// VALUE, several joined by `+` together [default: all halved and doubled but those of records].
    #[arg(long, value_name = "NAME[=VALUE],…", value_delimiter = ',', num_args = 0..)]
    ablation: Option<Vec<String>>,
    /// Draws at once, each with its share of the cores [default: one per core].
    #[arg(long, value_name = "N")]
    jobs: Option<usize>,
    /// Writes every draw, what was hidden and what was answered, as JSON into this file.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Runs one draw by its key and prints the whole diagnosis.
    #[arg(long, value_name = "KEY")]
    case: Option<Case>,
}

impl Args {
    fn plan(&self) -> Plan {
        let or_all = |given: &[&'static str]| if given.is_empty() { ids() } else { given.to_vec() };
        let usual = || Plan::default().kinds;
        Plan {
            kinds: if self.kinds.is_empty() { usual() } else { self.kinds.clone() },
            levels_db: self.levels.clone(),
            orders: self.orders.clone(),
            effects: or_all(&self.effects),
            singles: self.draws,
            clean: self.clean,
            pairs: self.pairs,
            outsiders: self.outsiders,
            analysers: self.analyser,
            machines: self.machines,
            machine_pairs: self.machine_pairs,
            mismeasured: self.mismeasured,
            faults: self.faults.clone(),
        }
    }

    fn settings(&self) -> Settings {
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        let jobs = self.jobs.unwrap_or(threads);
        let sizing = if self.by_character { Sizing::Character } else { Sizing::Amount };
        let search = ablation::changed(&self.setting);
        let Self { seed, order_from_data, separate, nearest, .. } = *self;
        Settings { seed, sizing, order_from_data, search, separate, nearest, jobs, threads }
    }

    /// What repeats a draw of this run, but for its key.
    fn command(&self) -> String {
        let sizing = if self.by_character { " --by-character" } else { "" };
        let order = if self.order_from_data { " --order-from-data" } else { "" };
        let changes = self.setting.iter().map(|change| format!(" --setting {change}"));
        let changes: String = changes.collect();
        format!("servoscope benchmark --seed {}{sizing}{order}{changes}", self.seed)
    }
}

/// Runs the draws and prints what they come to.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    if args.settings {
        let text = ablation::listing(&args.settings().search);
        return terminal::print_raw(text.as_bytes());
    }
    if let Some(case) = &args.case {
        return draws::one(case, args);
    }
    let cases = args.plan().cases();
    if cases.is_empty() {
        return Err(Failure::Input("no draw is left of these kinds, levels and numbers".into()));
    }
    if let Some(names) = &args.ablation {
        return ablation::run(&cases, args, names);
    }
    draws::all(&cases, args)
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        args: Args,
    }

    pub(super) fn asked(line: &str) -> Result<Args, String> {
        let words = std::iter::once("benchmark").chain(line.split_whitespace());
        Line::try_parse_from(words).map(|line| line.args).map_err(|error| error.to_string())
    }

    #[test]
    fn without_arguments_it_is_the_whole_plan() {
        assert_eq!(asked("").unwrap().plan(), Plan::default());
    }

    #[test]
    fn kinds_levels_effects_and_orders_can_be_chosen() {
        let line = "--kinds single,clean --levels 50 --effects spring,stribeck --orders 2 \
                    --draws 3 --clean 4";
        let cases = asked(line).unwrap().plan().cases();
        assert_eq!(cases.len(), 2 * 3 + 4);
        assert!(cases.iter().all(|case| (case.level_db, case.order) == (50, 2)));
        let line = "--kinds analyser --effects spring,stribeck --analyser 2 --clean 3";
        let keys = asked(line).unwrap().plan().cases().into_iter().map(|case| case.to_string());
        let keys: Vec<String> = keys.collect();
        assert_eq!((keys.len(), keys[0].as_str()), (7, "analyser-70-spring-o0-0"));
        let line = "--kinds machine,machine-2 --effects spring --machines 2 --machine-pairs 1";
        let keys = asked(line).unwrap().plan().cases().into_iter().map(|case| case.to_string());
        let keys: Vec<String> = keys.collect();
        assert_eq!((keys.len(), keys[5].as_str()), (6, "machine-2-50-o0-0"));
        let line = "--kinds mismeasured --effects spring,stribeck --mismeasured 1 --levels 60,40";
        let keys = asked(line).unwrap().plan().cases().into_iter().map(|case| case.to_string());
        let keys: Vec<String> = keys.collect();
        assert_eq!((keys.len(), keys[12].as_str()), (2 * 13, "mismeasured-60-o0-12"));
        assert_eq!(keys[14], "mismeasured-60-stribeck-o1-1");
        let line = "--kinds mismeasured-record --effects spring --mismeasured 1 --levels 60,50";
        let keys = asked(line).unwrap().plan().cases().into_iter().map(|case| case.to_string());
        let keys: Vec<String> = keys.collect();
        assert_eq!(keys.len(), 2 * 7);
        assert!(keys[8].contains("-60-spring-") && keys[8].ends_with("-1"), "{}", keys[8]);
        let line = "--kinds mismeasured --effects spring --mismeasured 2 --faults std_factor";
        let keys = asked(line).unwrap().plan().cases().into_iter().map(|case| case.to_string());
        let keys: Vec<String> = keys.collect();
        assert_eq!((keys.len(), keys[1].as_str()), (2 * 2 * 2, "mismeasured-60-o0-15"));
        assert!(asked("--faults std").unwrap_err().contains("bad_rows, std_factor"));
        assert!(asked("--effects sprng").unwrap_err().contains("hardening_spring"));
        assert!(asked("--kinds none").unwrap_err().contains("outsider"));
        assert!(asked("--orders 3").is_err() && asked("--case spring").is_err());
    }

    #[test]
    fn the_command_that_repeats_a_draw_has_what_it_depends_on() {
        let line = "--seed 9 --by-character --order-from-data --orders 1 --jobs 1 \
                    --setting rival_share=0.25 --setting glance_steps=6";
        let args = asked(line).unwrap();
        let command = "servoscope benchmark --seed 9 --by-character --order-from-data \
                       --setting rival_share=0.25 --setting glance_steps=6";
        assert_eq!(args.command(), command);
        let repeated = format!("{} --case clean-60-o1-0", args.command());
        let again = asked(repeated.trim_start_matches("servoscope benchmark ")).unwrap();
        let settings = Settings { jobs: again.settings().jobs, ..args.settings() };
        assert_eq!(again.settings(), settings);
        assert_eq!((settings.search.rival_share, settings.search.glance_steps), (0.25, 6));
        assert_eq!(again.case, "clean-60-o1-0".parse().ok());
    }
}
