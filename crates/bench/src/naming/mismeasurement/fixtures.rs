//! A hand-made table for the tests.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use servoscope_core::measurement::{Complex, Experiment, Harmonic, Measurement, Metadata, Repeat};

use crate::machines::noise::{NoiseLaw, NoiseStatement};

/// The noise of [`table`].
pub(super) const LAW: NoiseLaw = NoiseLaw { floor: 0.01, share: 0.0 };

/// Three magnitudes at four frequencies, harmonics 0 to 3, with this number of repeats; 0: with a
/// standard deviation of every harmonic.
pub(super) fn table(repeats: usize) -> Measurement {
    let statement = match repeats {
        0 => NoiseStatement::Std,
        count => NoiseStatement::Repeats(count),
    };
    let rng = &mut ChaCha8Rng::seed_from_u64(8);
    observed(|exact| LAW.observe(exact, statement, rng))
}

/// The same without noise, of which the standard deviations are stated.
pub(super) fn exact_table() -> Measurement {
    observed(|exact| (LAW.stated(exact), Vec::new()))
}

fn observed(mut observe: impl FnMut(&[Complex]) -> (Vec<Harmonic>, Vec<Repeat>)) -> Measurement {
    let mut experiments = Vec::new();
    for magnitude in [1.0, 2.0, 4.0] {
        for omega_rad_s in [1.0, 3.0, 9.0, 27.0] {
            let exact = [(0.1, 0.0), (2.0, -1.0), (0.2, 0.1), (0.3, 0.4)];
            let exact = exact.map(|(re, im)| Complex::new(re, im) * magnitude);
            let (response, repeats) = observe(&exact);
            experiments.push(Experiment {
                magnitude,
                omega_rad_s,
                input: vec![Complex::default(), Complex::new(magnitude, 0.0)],
                input_mean_measured: false,
                mean_velocity: 0.0,
                rounding_std: 0.0,
                open_samples: None,
                bad_samples: None,
                clipping: None,
                range: None,
                unknown_input: Vec::new(),
                response,
                run: None,
                repeats,
                from_record: false,
            });
        }
    }
    Measurement::new(Metadata::default(), experiments, Vec::new(), String::new())
        .expect("a valid table")
}
