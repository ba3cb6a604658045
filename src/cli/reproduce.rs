//! `servoscope reproduce`

use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use indicatif::{ProgressBar, ProgressStyle};

use servoscope_bench::reproduction::{
    Circumstances, Plan, Reproduction, Run, System, as_written, as_written_text, document, record,
    run_all,
};
use servoscope_core::answers::Method;

use super::choice::one_of;
use super::{Failure, interrupt, terminal};

mod charts;

/// Arguments of `reproduce`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Seeds of methods and noise, from 1 on.
    #[arg(long, value_name = "N", default_value_t = 20)]
    #[arg(value_parser = clap::value_parser!(u64).range(1..=1000))]
    seeds: u64,
    /// Noise, dB below the median response; 0: no noise.
    #[arg(long, value_name = "DB,…", value_delimiter = ',', default_values_t = [0, 60, 40])]
    #[arg(value_parser = clap::value_parser!(u32).range(0..=120))]
    levels: Vec<u32>,
    /// Methods [default: all].
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    #[arg(value_parser = one_of::<Method>(Method::all().map(Method::name)))]
    methods: Vec<Method>,
    /// Follows the paper's own equations, to the letter and on their own, and nothing else.
    #[arg(long)]
    as_written: bool,
    /// Writes reproduction.md, reproduction.csv and reproduction/*.svg to a folder.
    #[arg(long, value_name = "DIR")]
    output: Option<PathBuf>,
}

impl Args {
    fn plan(&self) -> Plan {
        let all = Plan::default();
        Plan {
            levels: self.levels.iter().map(|db| (*db > 0).then_some(*db)).collect(),
            methods: if self.methods.is_empty() { all.methods } else { self.methods.clone() },
            seeds: 1..=self.seeds,
            systems: System::ALL.to_vec(),
        }
    }

    /// What repeats this run.
    fn command(&self) -> String {
        let default = Plan::default();
        let mut command = "servoscope reproduce".to_owned();
        if self.plan().seeds != default.seeds {
            command += &format!(" --seeds {}", self.seeds);
        }
        if self.plan().levels != default.levels {
            let levels: Vec<String> = self.levels.iter().map(u32::to_string).collect();
            command += &format!(" --levels {}", levels.join(","));
        }
        if self.plan().methods != default.methods {
            let names: Vec<&str> = self.methods.iter().map(|method| method.name()).collect();
            command += &format!(" --methods {}", names.join(","));
        }
        command
    }
}

/// Runs the experiments and prints what they come to.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let seeds = args.plan().seeds;
    let written = as_written(seeds);
    if args.as_written {
        return print(&as_written_text(&written));
    }
    let plan = args.plan();
    let interrupted = interrupt::flag();
    let cancelled = || interrupted.load(Ordering::Relaxed);
    let before = load();
    let bar = Bar::of(&plan);
    let reproduction = run_all(&plan, &cancelled, &mut |run| bar.done(run));
    let reproduction = reproduction.map_err(Failure::other)?;
    bar.0.finish_and_clear();
    let conditions = conditions(&before, &load());
    let charts = charts::charts(&reproduction).map_err(Failure::other)?;
    let text = document(
        &reproduction,
        &written,
        &charts,
        &Circumstances { command: &args.command(), conditions: &conditions },
    );
    print(&text)?;
    match &args.output {
        Some(folder) => write(folder, &text, &reproduction, &charts),
        None => Ok(()),
    }
}

fn print(text: &str) -> Result<(), Failure> {
    terminal::print_raw(text.as_bytes())
}

fn write(
    folder: &Path,
    text: &str,
    reproduction: &Reproduction,
    charts: &[servoscope_bench::reproduction::Chart],
) -> Result<(), Failure> {
    let figures = folder.join("reproduction");
    let create = |path: &Path| std::fs::create_dir_all(path);
    create(&figures).map_err(|error| Failure::Other(format!("{}: {error}", figures.display())))?;
    let save = |path: PathBuf, text: &str| {
        std::fs::write(&path, text)
            .map_err(|error| Failure::Other(format!("{}: {error}", path.display())))
    };
    save(folder.join("reproduction.md"), text)?;
    save(folder.join("reproduction.csv"), &record(reproduction).map_err(Failure::other)?)?;
    charts.iter().try_for_each(|chart| save(figures.join(chart.file()), &chart.svg))
}

/// One-minute load of the machine, where it says.
fn load() -> Option<String> {
    let text = std::fs::read_to_string("/proc/loadavg").ok()?;
    text.split_whitespace().next().map(str::to_owned)
}

/// Under which conditions times were measured.
fn conditions(before: &Option<String>, after: &Option<String>) -> String {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let profile = if cfg!(debug_assertions) { "a debug build" } else { "a release build" };
    match (before, after) {
        (Some(before), Some(after)) => format!(
            "{profile} on {cores} cores; load of the machine (tasks ready to run, other work \
             included) {before} before and {after} after"
        ),
        _ => format!("{profile} on {cores} cores; the load of the machine is not known"),
    }
}

struct Bar(ProgressBar);

impl Bar {
    fn of(plan: &Plan) -> Self {
        let seeds = plan.seeds.clone().count();
        let count = plan.systems.len() * plan.levels.len() * plan.methods.len() * seeds;
        let style = ProgressStyle::with_template("[{bar:40}] {pos}/{len} {elapsed} of {eta} {msg}");
        let bar = ProgressBar::new(count as u64);
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        Self(bar)
    }

    fn done(&self, run: &Run) {
        self.0.inc(1);
        self.0.set_message(format!("{} {}", run.system.name(), run.method.name()));
    }
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

    fn asked(line: &str) -> Result<Args, String> {
        let words = std::iter::once("reproduce").chain(line.split_whitespace());
        Line::try_parse_from(words).map(|line| line.args).map_err(|error| error.to_string())
    }

    #[test]
    fn without_arguments_it_is_the_whole_plan() {
        let args = asked("").unwrap();
        assert_eq!(
            (args.plan(), args.command().as_str()),
            (Plan::default(), "servoscope reproduce")
        );
    }

    #[test]
    fn the_command_that_repeats_a_run_has_what_it_depends_on() {
        let line = "--seeds 3 --levels 0,50 --methods abc-ann,cma-es";
        let args = asked(&format!("{line} --output docs")).unwrap();
        assert_eq!(args.command(), format!("servoscope reproduce {line}"));
        assert_eq!(args.plan().levels, [None, Some(50)]);
        assert!(asked("--methods magic").unwrap_err().contains("two-magnitude"));
    }
}
