//! Arbitrary bytes, and mutations of valid files of every format: each is read or refused with a
//! reason, and none panics.

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::select;
use proptest::test_runner::{Config, RngAlgorithm, TestError, TestRng, TestRunner};
use rayon::prelude::*;

use super::super::{bam, matlab, sysid, tdms, twincat_scope};
use super::mutation::{Mutation, NUMBERS, mutation};
use super::universal::response;
use super::workbooks::{book, rows};
use super::*;

/// Reads a file, and looks at it as before an upload.
fn is_read_or_refused(bytes: &[u8]) -> Result<(), TestCaseError> {
    let given = Source { name: "given", bytes: b"# given with the upload\n# magnitude: 2\n" };
    let file = Source { name: "file", bytes };
    for sources in [&[file][..], &[file, given]] {
        look(sources);
        if let Err(error) = read(sources) {
            prop_assert!(!error.reason.is_empty());
            // What a person is told has an end.
            prop_assert!(error.to_string().len() < 10_000, "{} bytes", error.to_string().len());
        }
    }
    Ok(())
}

/// How many cases are drawn, and from which seed: few in every run, many in the slow tests.
#[derive(Clone, Copy)]
struct Cases {
    count: u32,
    seed: u8,
}

const FEW: Cases = Cases { count: 150, seed: 1 };
const MANY: Cases = Cases { count: 10_000, seed: 2 };

impl Cases {
    fn runner(self) -> TestRunner {
        let config = Config { cases: self.count, failure_persistence: None, ..Config::default() };
        TestRunner::new_with_rng(config, TestRng::from_seed(RngAlgorithm::ChaCha, &[self.seed; 32]))
    }

    /// Reads the files that are made of values of a strategy.
    fn tried<S: Strategy>(
        self,
        strategy: S,
        bytes: impl Fn(S::Value) -> Vec<u8>,
    ) -> Result<(), TestError<S::Value>> {
        self.runner().run(&strategy, |case| is_read_or_refused(&bytes(case)))
    }
}

/// A valid file, and how what is mutated of it is made a file.
struct Valid {
    name: &'static str,
    content: Vec<u8>,
    file: fn(&[u8]) -> Vec<u8>,
}

fn plain(name: &'static str, content: impl Into<Vec<u8>>) -> Valid {
    Valid { name, content: content.into(), file: <[u8]>::to_vec }
}

fn valid() -> Vec<Valid> {
    let table = "# input: current A\n# response: velocity rad/s\n\
        magnitude,omega_rad_s,experiment,harmonic,re,im,std,repeat,run\n\
        1,2,0,0,0.1,0,0.1,0,0\n1,2,0,1,0.4,-0.2,0.1,0,0\n2,2,1,1,0.8,-0.3,0.1,0,1\n";
    let spreadsheet = "sep=;\n# response: position mm\n# magnitude: 0.5\n\
        Frequenz;Betrag;Phase (°);Kohärenz;Mittelungen\nkHz;dB;;1;\n0,125;-3,5;-90;0,99;16\n\
        0,25;-6;-120,5;0,98;16\n";
    let json = r#"{"axis":"X","labels":{"a":"b"},"experiments":[
        {"time_s":[0,1,2,3,4,5,6,7],"input":[0,1,0,-1,0,1,0,-1],"output":[1,0,-1,0,1,0,-1,0.1],
         "period_s":4,"settle_periods":0,"run":1},
        {"magnitude":1,"omega_rad_s":2,"harmonics":[{"harmonic":1,"re":1,"im":2,"u_re":1,"u_im":0}]}]}"#;
    let motion = "# period_s: none\n# intersample: linear\ntime_s,input,output\n0,0,0\n0.1,1,0.1\n\
        0.2,1,0.2\n0.3,0,0.1\n0.4,0,0\n";
    let rest = (5..20).map(|n| format!("{:.1},0,0\n", 0.1 * f64::from(n)));
    let motion = motion.to_owned() + &rest.collect::<String>();
    let cells = rows(&[
        &["magnitude", "omega_rad_s", "re", "im"],
        &["1", "2", "3", "4"],
        &["1", "3", "2", "1"],
    ]);
    let digilent = "#Digilent WaveForms Network Analyzer - Bode\n#Relative: yes\n\
        # response: velocity rad/s\n# magnitude: 0.5\n\
        Frequency (Hz),Channel 1 Magnitude (dB),Channel 2 Magnitude (dB),Channel 2 Phase (°)\n\
        1,0,-6,-45\n10,0,-26,-90\n";
    let bode = "# response: velocity rad/s\n# magnitude: 0.5\n# inverted: yes\n\
        Frequency (Hz);Trace 1: Gain: Magnitude (dB);\"Trace 2: Gain: Phase (°)\"\n1,5;-6;-45\n";
    let nf = "# response: velocity rad/s\nFrequency (Hz), V1 (Vrms), V2 (Vrms), θ (deg), Y1, Y2\n\
        1, 0.5, 0.25, -45, 0, 0\n10, 0.7, 0.1, -90, 0, 0\n";
    let given = "# given with the upload\n# decimal: comma\n# response: position mm\n\
        # column_names: a; b [mm]\n# label.a: b\n";
    vec![
        plain("harmonic table", table),
        plain("spreadsheet", spreadsheet),
        plain("record", record(12, 4)),
        plain("motion", motion),
        plain("JSON", json),
        plain("universal file", response()),
        plain("TDMS", tdms::tests::readable()),
        plain("TwinCAT", twincat_scope::tests::export("\t", true, ",")),
        plain("SysId", sysid::tests::log(4)),
        plain("BAM", bam::tests::readable()),
        plain("Digilent", digilent),
        plain("Bode 100", bode),
        plain("NF FRA", nf),
        plain("what is given", given),
        plain("workbook", book(&[("one", &cells)])),
        Valid {
            name: "cells of a workbook",
            content: cells.into_bytes(),
            file: |cells| book(&[("one", &String::from_utf8_lossy(cells))]),
        },
        Valid { name: "MATLAB", content: matlab::tests::readable(), file: matlab::tests::plain },
        Valid {
            name: "packed MATLAB",
            content: matlab::tests::one_element(),
            file: matlab::tests::packed,
        },
    ]
}

#[test]
fn the_files_that_are_mutated_are_valid() {
    let given = Source { name: "given", bytes: b"# given with the upload\n# response: velocity\n" };
    for Valid { name, content, file } in valid() {
        let bytes = file(&content);
        let source = Source { name, bytes: &bytes };
        let read = read(&[source]).or_else(|first| read(&[source, given]).map_err(|_| first));
        if name != "what is given" && name != "universal file" {
            assert!(read.is_ok(), "{name}: {}", read.unwrap_err());
        }
    }
}

fn arbitrary_bytes(cases: Cases) {
    let bytes = vec(any::<u8>(), 0..2000);
    cases.tried(bytes, |bytes| bytes).unwrap();
    // Some that begin as a format does.
    let beginnings = [
        "PK\u{3}\u{4}",
        "TDSm",
        "{",
        "[",
        "    -1\n    58\n",
        "MATLAB 5.0 MAT-file",
        "Name\t",
        "# ",
    ];
    let begun = (select(beginnings.to_vec()), vec(any::<u8>(), 0..2000));
    cases.tried(begun, |(begin, bytes)| [begin.as_bytes(), &bytes].concat()).unwrap();
}

fn mutated_files_of_every_format(cases: Cases) {
    valid().into_par_iter().for_each(|Valid { name, content, file }| {
        let mutated = |mutations: Vec<Mutation>| {
            let mut content = content.clone();
            mutations.iter().for_each(|mutation| mutation.apply(&mut content));
            file(&content)
        };
        let result = cases.tried(vec(mutation(), 1..5), mutated);
        assert!(result.is_ok(), "{name}: {}", result.unwrap_err());
    });
}

#[test]
fn arbitrary_bytes_and_mutated_files_of_every_format_are_read_or_refused() {
    arbitrary_bytes(FEW);
    mutated_files_of_every_format(FEW);
}

#[test]
#[ignore = "slow: ten thousand files of every format"]
fn ten_thousand_mutated_files_of_every_format_are_read_or_refused() {
    arbitrary_bytes(MANY);
    mutated_files_of_every_format(MANY);
}

#[test]
fn whatever_is_stated_is_taken_or_refused_by_its_key() {
    let keys = [
        "name",
        "input",
        "response",
        "loop",
        "measured_at",
        "reference",
        "amplitude",
        "period_s",
        "settle_s",
        "settle_periods",
        "averages",
        "magnitude",
        "decimal",
        "inverted",
        "sample_s",
        "column_names",
        "sheet",
        "repeats",
        "label.a",
        "initial_velocity",
        "no_such_key",
    ];
    let value = prop_oneof![select(&NUMBERS[..]).prop_map(str::to_owned), any::<String>()];
    let mut runner = Cases { count: 1000, seed: 7 }.runner();
    let tried = runner.run(&(select(keys.to_vec()), value), |(key, value)| {
        let mut given = Given::default();
        if let Err(error) = given.set(key, &value) {
            prop_assert_eq!(error.column.as_deref(), Some(key));
        }
        Ok(())
    });
    tried.unwrap();
}
