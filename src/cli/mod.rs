//! The command line: the same questions as over HTTP, asked offline, and the
//! server itself. One file a subcommand.

mod benchmark;
mod computation;
mod config;
mod demo;
mod diagnose;
mod failure;
mod figures;
mod given;
mod identify;
mod inspect;
mod interrupt;
mod keys;
mod logging;
mod openapi;
mod page;
mod place;
mod plan;
mod reproduce;
mod rerun;
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

/// Identifies transfer function and friction of a servo axis from its measured
/// frequency response.
#[derive(Debug, Parser)]
#[command(name = "servoscope", version)]
struct Cli {
    /// Says more on standard error; twice: everything.
    #[arg(short, long, action = clap::ArgAction::Count, global = true)]
    verbose: u8,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Hides effects in drawn machines, diagnoses them and scores what is named.
    Benchmark(benchmark::Args),
    /// Shows the settings of the service and where they come from.
    #[command(subcommand)]
    Config(config::Command),
    /// Says where the base model departs from a measurement, and names what it lacks.
    Diagnose(diagnose::Args),
    /// Fits the base model to a measurement.
    Identify(computation::Args),
    /// Says how a measurement was understood, what looks wrong with it, and which effects it can show.
    Inspect(inspect::Args),
    /// Makes, lists and revokes the keys of a server.
    #[command(subcommand)]
    Keys(keys::Command),
    /// Prints the OpenAPI document of the service.
    Openapi,
    /// Plans experiments: where to measure within a time budget, and which effects that can name.
    Plan(Box<plan::Args>),
    /// Runs the experiments of the paper and prints its tables with our columns beside its own.
    Reproduce(reproduce::Args),
    /// Computes a result again and compares every bit.
    Rerun(rerun::Args),
    /// Runs the service.
    Serve(Box<serve::Args>),
    /// Shows a result that was stored: on the terminal, as figures or as a page.
    Show(show::Args),
    /// Writes a measurement of an axis with known parameters.
    ///
    /// The response is exact; without any flag it is that of the first system of the paper.
    Simulate(Box<simulate::Args>),
    /// Tries the models of a result on another measurement.
    Validate(validate::Args),
    /// Runs jobs of servers that share its database; settings about requests mean nothing to it.
    Worker(Box<config::Args>),
}

/// Does what the arguments of the process ask for. Exit code 0: done; 2: the
/// arguments or the input cannot be used; 1: anything else.
pub fn main() -> ExitCode {
    // Ends the process itself: with 2 for bad usage, 0 for help.
    let matches = Cli::command().get_matches();
    let cli = Cli::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    let done = match cli.command {
        Command::Benchmark(args) => {
            start_log(cli.verbose);
            benchmark::run(&args)
        }
        Command::Config(command) => {
            let of_command = matches.subcommand().and_then(|(_, matches)| matches.subcommand());
            config::run(&command, of_command.map_or(&matches, |(_, matches)| matches))
        }
        Command::Diagnose(args) => {
            start_log(cli.verbose);
            diagnose::run(&args)
        }
        Command::Identify(args) => {
            start_log(cli.verbose);
            identify::run(&args)
        }
        Command::Inspect(args) => {
            start_log(cli.verbose);
            inspect::run(&args)
        }
        Command::Keys(command) => keys::run(command),
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
    use super::*;

    #[test]
    fn the_arguments_are_well_formed() {
        Cli::command().debug_assert();
    }
}
