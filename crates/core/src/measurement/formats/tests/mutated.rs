//! Fuzzing with random mutations of valid files: the reader returns a result and never panics.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;

fn never_panics(valid: &str, seed: u64, count: usize) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let likely = b"0123456789.,-+eE#:\n\r\"{}[] \tnaif\xFF";
    for _ in 0..count {
        let mut bytes = valid.as_bytes().to_vec();
        for _ in 0..rng.random_range(1..4) {
            let at = rng.random_range(0..bytes.len());
            match rng.random_range(0..4) {
                0 => bytes[at] = rng.random(),
                1 => bytes[at] = likely[rng.random_range(0..likely.len())],
                2 => bytes.insert(at, likely[rng.random_range(0..likely.len())]),
                _ => drop(bytes.drain(at..(at + rng.random_range(1..30)).min(bytes.len()))),
            }
            if bytes.is_empty() {
                break;
            }
        }
        if let Err(error) = read(&[Source { name: "x", bytes: &bytes }]) {
            assert!(!error.reason.is_empty());
        }
    }
}

#[test]
fn a_mutated_table_is_read_or_refused() {
    let text = "# input: current A\n# reference: sin\n# measured_at: 2024-05-31T13:45:00Z\n\
        magnitude,omega_rad_s,experiment,harmonic,re,im,std,repeat,run,u_re,u_im\n\
        1,2,0,0,0.1,0,0.1,0,0,0,0\n1,2,0,1,0.4,-0.2,0.1,0,0,1,0\n\
        1,2,0,0,0.2,0,0.1,1,0,0,0\n1,2,0,1,0.5,-0.2,0.1,1,0,1.1,0\n2,2,1,1,0.8,-0.3,0.1,0,1,2,0\n";
    never_panics(text, 1, 2000);
}

#[test]
fn a_mutated_table_with_every_statement_of_noise_is_read_or_refused() {
    let text = "# averages: 16\n# amplitude: rms\n\
        magnitude,omega_rad_s,gain_db,phase_deg,std,coherence,averages,gain_std,gain_db_std,\
        phase_std_deg\n\
        1,1,2,-20,0.1,,,,,\n1,2,1,-40,,0.9,,,,\n1,3,0,-50,,0.8,8,,,\n1,4,-1,-60,,,,0.1,,\n\
        1,5,-2,-70,,,,,0.1,0.5\n1,6,-3,-80,,,,,,0.5\n1,7,-4,-90,,1,,,,\n";
    ok(text);
    never_panics(text, 5, 2000);
}

#[test]
fn a_mutated_record_is_read_or_refused() {
    never_panics(&record(12, 4), 2, 2000);
    never_panics(&format!("# period_s: 0.012\n# settle_periods: 1\n{}", record(12, 4)), 3, 2000);
}

#[test]
fn a_mutated_json_upload_is_read_or_refused() {
    let text = r#"{"axis":"X","labels":{"a":"b"},"experiments":[
        {"time_s":[0,1,2,3,4,5,6,7],"input":[0,1,0,-1,0,1,0,-1],"output":[1,0,-1,0,1,0,-1,0.1],
         "period_s":4,"settle_periods":0,"run":1},
        {"magnitude":1,"omega_rad_s":2,"harmonics":[{"harmonic":1,"re":1,"im":2,"u_re":1,"u_im":0}]}]}"#;
    never_panics(text, 4, 2000);
}

#[test]
fn a_mutated_text_of_a_spreadsheet_is_read_or_refused() {
    let text = "sep=;\nFRA 7; 12.3.2024\n# response: position mm\n# magnitude: 0.5\n\
        Frequenz;Betrag;Phase (°);Kohärenz;Mittelungen\nkHz;dB;;1;\n\
        0,125;-3,5;-90;0,99;16\n0,25;-6;-120,5;0,98;16\n\n;;;;\n";
    ok(text);
    never_panics(text, 6, 2000);
    let names = format!("# column_names: Time [ms]; Current (A); Lage (mm)\n{}", record(12, 4));
    never_panics(&names, 7, 1000);
}
