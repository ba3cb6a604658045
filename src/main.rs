//! servoscope: arguments in, exit code out.

fn main() -> std::process::ExitCode {
    servoscope::cli::main()
}
