//! The command line: the same questions as over HTTP, asked offline, and the
//! server itself. One file a subcommand.

mod backup;
mod batch;
mod benchmark;
mod choice;
mod completions;
mod computation;
mod config;
mod demo;
mod diagnose;
mod effects;
mod failure;
mod figures;
mod given;
mod identify;
mod inspect;
mod interrupt;
mod keys;
mod logging;
mod manual;
mod openapi;
mod page;
mod place;
mod plan;
mod reproduce;
mod rerun;
mod restore;
mod serve;
mod show;
mod shown;
mod simulate;
mod target;
mod terminal;
mod validate;
mod worker;

use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};

use crate::config::LogFormat;

use failure::Failure;

/// What to try first, below the list of commands.
const EXAMPLES: &str = "\
Examples:
  servoscope inspect axis.csv                        how the file is understood
  servoscope diagnose axis.csv                       where the simulation is wrong, and why
  servoscope diagnose axis.csv --report axis.html    the same as a page
  servoscope serve --demo                            the dashboard, with a measurement to try

`servoscope COMMAND --help` lists the options of a command.";

/// Finds out where a simulated servo axis differs from the measured one, and why: identifies its
/// transfer function and friction from its frequency response, and names the physical effects that
/// the model lacks.
#[derive(Debug, Parser)]
#[command(name = "servoscope", version, after_help = EXAMPLES)]
struct Cli {
    /// Logs more on standard error; -vv logs everything.
    #[arg(short, long, action = clap::ArgAction::Count, global = true)]
    verbose: u8,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Writes everything that a server keeps into one file, also while it runs.
    Backup(backup::Args),
    /// Has a server compute every measurement of a folder, and prints what came of each.
    ///
    /// Files that cannot be read are named and left out. The same command on the same folder uploads
    /// and computes nothing twice: it shows the batch that there is.
    Batch(Box<batch::Args>),
    /// Diagnoses simulated machines with hidden effects, and counts how often the answer is right.
    Benchmark(benchmark::Args),
    /// Prints a script that lets a shell complete commands, options and their values.
    Completions(completions::Args),
    /// Shows the settings of the service and where they come from.
    #[command(subcommand)]
    Config(config::Command),
    /// Says where the simulation differs from a measurement, and names the cause.
    Diagnose(diagnose::Args),
    /// Lists the effects that a diagnosis can name, or describes each with a figure.
    Effects(effects::Args),
    /// Fits the base model, a linear axis with dry friction, to a measurement.
    Identify(computation::Args),
    /// Says how a file is understood, what looks wrong with it, and which effects it can reveal.
    Inspect(inspect::Args),
    /// Makes, lists and revokes the keys of a server.
    #[command(subcommand)]
    Keys(keys::Command),
    /// Prints the manual page, or writes one page for every command into a folder.
    Man(manual::Args),
    /// Prints the OpenAPI document of the service.
    Openapi,
    /// Plans experiments: where to measure within a given time, and what that can identify.
    Plan(Box<plan::Args>),
    /// Repeats the experiments of the paper on the method, and prints both results side by side.
    Reproduce(reproduce::Args),
    /// Computes a stored result again, and compares every number with it.
    Rerun(rerun::Args),
    /// Restores a backup into an empty folder or database; SQLite and Postgres backups are
    /// interchangeable.
    Restore(restore::Args),
    /// Runs the HTTP service with its dashboard.
    Serve(Box<serve::Args>),
    /// Shows a stored result: on the terminal, as figures or as a page.
    Show(show::Args),
    /// Simulates a measurement of an axis with known parameters.
    ///
    /// Without --noise-db or --noise-std the response is exact. Without options of the axis it is
    /// the first system of the paper: pole −10 rad/s, constant 10, dry friction 0.5 and 0.4.
    Simulate(Box<simulate::Args>),
    /// Tests a stored result on another measurement of the same axis.
    Validate(validate::Args),
    /// Runs jobs for the servers that use the same database; settings about requests have no effect.
    Worker(Box<worker::Args>),
}

/// Does what the arguments of the process ask for. Exit code 0: done; 2: the
/// arguments or the input cannot be used; 1: anything else.
pub fn main() -> ExitCode {
    // Ends the process itself: with 2 for bad usage, 0 for help.
    let matches = Cli::command().get_matches();
    let cli = Cli::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    let done = match cli.command {
        Command::Backup(args) => backup::run(&args),
        Command::Batch(args) => batch::run(&args),
        Command::Benchmark(args) => {
            start_log(cli.verbose);
            benchmark::run(&args)
        }
        Command::Completions(args) => completions::run(&args),
        Command::Config(command) => {
            let of_command = matches.subcommand().and_then(|(_, matches)| matches.subcommand());
            config::run(&command, of_command.map_or(&matches, |(_, matches)| matches))
        }
        Command::Diagnose(args) => {
            start_log(cli.verbose);
            diagnose::run(&args)
        }
        Command::Effects(args) => effects::run(&args),
        Command::Identify(args) => {
            start_log(cli.verbose);
            identify::run(&args)
        }
        Command::Inspect(args) => {
            start_log(cli.verbose);
            inspect::run(&args)
        }
        Command::Keys(command) => keys::run(command),
        Command::Man(args) => manual::run(&args),
        Command::Openapi => openapi::run(),
        Command::Plan(args) => {
            start_log(cli.verbose);
            plan::run(&args)
        }
        Command::Reproduce(args) => {
            start_log(cli.verbose);
            reproduce::run(&args)
        }
        Command::Rerun(args) => {
            start_log(cli.verbose);
            rerun::run(&args)
        }
        Command::Restore(args) => restore::run(&args),
        Command::Serve(args) => serve::run(&args, cli.verbose),
        Command::Show(args) => show::run(&args),
        Command::Simulate(args) => simulate::run(*args),
        Command::Validate(args) => {
            start_log(cli.verbose);
            validate::run(&args)
        }
        Command::Worker(args) => worker::run(&args, cli.verbose),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("servoscope: {failure}");
            failure.exit_code()
        }
    }
}

/// The log of a command that is not a server.
fn start_log(verbose: u8) {
    logging::start("warn", verbose, LogFormat::Text);
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::{IdentifyOptions, Method};

    use super::*;

    #[test]
    fn the_arguments_are_well_formed() {
        Cli::command().debug_assert();
    }

    /// Beginnings of the help of options that do something only where they are given.
    const VERBS: [&str; 8] =
        ["Writes ", "Draws ", "Runs ", "Changes ", "Adds ", "Prints ", "Takes ", "Uses "];

    fn says_what_holds_without_it(argument: &clap::Arg) -> bool {
        let help = argument.get_long_help().or_else(|| argument.get_help());
        let help = help.map(ToString::to_string).unwrap_or_default();
        let flag = !argument.get_action().takes_values();
        flag || argument.is_positional()
            || argument.is_required_set()
            || !argument.get_default_values().is_empty()
            || help.contains("[default: ")
            || VERBS.iter().any(|verb| help.starts_with(verb))
    }

    #[test]
    fn every_option_says_its_default_or_what_it_does_where_it_is_given() {
        let mut commands = vec![Cli::command()];
        let mut silent = Vec::new();
        while let Some(command) = commands.pop() {
            let options = command.get_arguments().filter(|one| !says_what_holds_without_it(one));
            silent.extend(options.map(|one| format!("{} --{}", command.get_name(), one.get_id())));
            commands.extend(command.get_subcommands().cloned());
        }
        assert!(silent.is_empty(), "{silent:#?}");
    }

    #[test]
    fn the_defaults_that_a_help_states_are_those_of_the_library() {
        let options = IdentifyOptions::default();
        let identify = Cli::command().find_subcommand("identify").cloned().unwrap();
        for (name, default) in
            [("seed", options.seed.to_string()), ("method", Method::default().name().to_owned())]
        {
            let argument = identify.get_arguments().find(|one| one.get_id() == name).unwrap();
            let help = argument.get_help().unwrap().to_string();
            assert!(help.contains(&format!("[default: {default}]")), "{help}");
        }
    }
}
