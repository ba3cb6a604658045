//! The band in which a model may be used, and where it departs from the measurement.
//!
//! In every band of frequency the fundamentals (of records, the lines that the input excites) give
//! one complex factor between the simulation and the measurement, by least squares: c = Σ Ŷ*·Y /
//! Σ |Ŷ|². A model departs where c is further from 1 than a limit, with the noise allowed for.

use crate::answers::{BandDeparture, ValidBand};
use crate::identify::ModelFit;
use crate::measurement::Complex;

use super::layout::{Cell, Layout};
use super::sentence::short;

/// Distance of the factor from 1 up to which a model may be used: 3 dB alone, or 20° alone, are
/// about as far (0.35 and 0.35).
const LARGEST_ERROR: f64 = 0.35;

/// Standard deviations of the factor that are allowed for: its error exceeds this many with a
/// probability of 1e-4, and there are at most 24 bands.
const ALLOWED_DEVIATIONS: f64 = 4.3;

/// From so many responses in a band on, their scatter about the factor tells its error. Of fewer,
/// the standard deviations of the data do, which may be those of the largest responses.
const FEWEST_SCATTERED: usize = 6;

/// The simulation beside the measurement in one band.
struct Band {
    hz: [f64; 2],
    /// Measured over simulated.
    factor: Complex,
    departs: bool,
}

/// Where a fitted model departs from its data; `None` if there is nothing to compare.
pub(crate) fn of(fit: &ModelFit) -> Option<ValidBand> {
    let layout = Layout::of(fit);
    let bands: Vec<Band> = (0..layout.bands.len())
        .filter_map(|band| {
            let cells = layout.cells.iter().filter(|cell| cell.excited && cell.band == band);
            factor_of(&cells.collect::<Vec<_>>())
        })
        .collect();
    let usable = widest(&bands);
    let departures = departures(&bands);
    (!bands.is_empty()).then(|| ValidBand {
        sentence: sentence(&departures, usable),
        usable_hz: usable,
        departures,
    })
}

fn factor_of(cells: &[&Cell]) -> Option<Band> {
    let power: f64 = cells.iter().map(|cell| cell.simulated.norm_sqr()).sum();
    if power <= 0.0 {
        return None;
    }
    let product: Complex = cells.iter().map(|cell| cell.simulated.conj() * cell.measured).sum();
    let factor = product / power;
    let variance = |cell: &Cell| match cells.len() < FEWEST_SCATTERED {
        true => 2.0 * cell.std.powi(2),
        false => (cell.measured - factor * cell.simulated).norm_sqr(),
    };
    let noise: f64 = cells.iter().map(|cell| cell.simulated.norm_sqr() * variance(cell)).sum();
    let deviation = noise.sqrt() / power;
    let off = (factor - 1.0).norm();
    let hz = cells.iter().map(|cell| cell.frequency_hz);
    let (low, high) = hz.fold((f64::INFINITY, 0.0_f64), |(a, b), f| (a.min(f), b.max(f)));
    let departs = off > LARGEST_ERROR && off - LARGEST_ERROR > ALLOWED_DEVIATIONS * deviation;
    Some(Band { hz: [low, high], factor, departs })
}

/// Runs of neighbouring bands that depart.
fn departures(bands: &[Band]) -> Vec<BandDeparture> {
    let runs = bands.chunk_by(|a, b| a.departs == b.departs).filter(|run| run[0].departs);
    runs.map(|run| {
        let largest = |of: &dyn Fn(Complex) -> f64| {
            run.iter().map(|band| of(band.factor)).max_by(|a, b| a.abs().total_cmp(&b.abs()))
        };
        BandDeparture {
            from_hz: run[0].hz[0],
            to_hz: run[run.len() - 1].hz[1],
            gain_db: largest(&|factor| 20.0 * factor.norm().log10()).unwrap_or_default(),
            phase_deg: largest(&|factor| factor.arg().to_degrees()).unwrap_or_default(),
        }
    })
    .collect()
}

/// The run of bands without a departure that is widest in octaves.
fn widest(bands: &[Band]) -> Option<[f64; 2]> {
    let runs = bands.chunk_by(|a, b| a.departs == b.departs).filter(|run| !run[0].departs);
    let spans = runs.map(|run| [run[0].hz[0], run[run.len() - 1].hz[1]]);
    spans.max_by(|a, b| (a[1] / a[0]).total_cmp(&(b[1] / b[0])))
}

fn sentence(departures: &[BandDeparture], usable: Option<[f64; 2]>) -> String {
    let Some([from, to]) = usable else {
        return "at no frequency is the model within about 3 dB and 20° of the measurement".into();
    };
    let [from, to] = [short(from), short(to)];
    let band = if from == to { format!("at {from} Hz") } else { format!("from {from} to {to} Hz") };
    let Some(worst) = departures.iter().max_by(|a, b| a.severity().total_cmp(&b.severity())) else {
        return format!(
            "the model stays within about 3 dB and 20° of the measurement {band}, the whole \
             measured band"
        );
    };
    let others = match departures.len() {
        1 => String::new(),
        count => format!(" (the worst of {count} such bands)"),
    };
    format!(
        "use the model {band} only, where it stays within about 3 dB and 20° of the measurement; \
         from {} to {} Hz it is off by up to {:.0} dB and {:.0}°{others}",
        short(worst.from_hz),
        short(worst.to_hz),
        worst.gain_db.abs(),
        worst.phase_deg.abs(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn band(hz: [f64; 2], gain: f64, phase_deg: f64, departs: bool) -> Band {
        Band { hz, factor: Complex::from_polar(gain, phase_deg.to_radians()), departs }
    }

    fn cell(measured: Complex, std: f64) -> Cell {
        Cell {
            rows: (0, Some(1)),
            magnitude: 0,
            band: 0,
            harmonic: 1,
            frequency_hz: 2.0,
            input_magnitude: 1.0,
            experiment: 0,
            order: 1,
            excited: true,
            run: None,
            measured,
            simulated: Complex::new(2.0, 0.0),
            std,
        }
    }

    // The factor is 1.5, so that it is 0.15 beyond the limit; the deviation of its error is
    // std·√2/2.
    #[test]
    fn a_band_departs_only_if_the_noise_cannot_account_for_its_error() {
        let departs = |std: f64| factor_of(&[&cell(Complex::new(3.0, 0.0), std)]).unwrap().departs;
        assert!(departs(0.04));
        assert!(!departs(0.06));
        assert!(!factor_of(&[&cell(Complex::new(2.6, 0.0), 0.0)]).unwrap().departs);
        let turned = Complex::from_polar(2.0, 25f64.to_radians());
        assert!(factor_of(&[&cell(turned, 0.0)]).unwrap().departs);
    }

    // The deviations that come with the data are far too large here.
    #[test]
    fn many_responses_that_are_off_alike_need_no_stated_noise() {
        let alike = vec![cell(Complex::new(3.0, 0.0), 10.0); FEWEST_SCATTERED];
        let cells: Vec<&Cell> = alike.iter().collect();
        assert!(factor_of(&cells).unwrap().departs);
        assert!(!factor_of(&cells[1..]).unwrap().departs);
    }

    #[test]
    fn neighbouring_bands_that_depart_are_one_and_the_rest_may_be_used() {
        let bands = [
            band([0.1, 0.2], 1.0, 0.0, false),
            band([0.3, 8.0], 1.1, 2.0, false),
            band([8.2, 10.0], 0.5, -30.0, true),
            band([11.0, 20.0], 0.2, 157.0, true),
            band([21.0, 30.0], 1.0, 0.0, false),
        ];
        let departures = departures(&bands);
        assert_eq!(departures.len(), 1);
        let BandDeparture { from_hz, to_hz, gain_db, phase_deg } = departures[0];
        assert_eq!([from_hz, to_hz], [8.2, 20.0]);
        assert!((gain_db - 20.0 * 0.2f64.log10()).abs() < 1e-12);
        assert!((phase_deg - 157.0).abs() < 1e-9);
        assert_eq!(widest(&bands), Some([0.1, 8.0]));
        assert_eq!(
            sentence(&departures, widest(&bands)),
            "use the model from 0.1 to 8 Hz only, where it stays within about 3 dB and 20° of the \
             measurement; from 8.2 to 20 Hz it is off by up to 14 dB and 157°"
        );
    }

    #[test]
    fn a_model_that_follows_throughout_may_be_used_throughout() {
        let bands = [band([0.1, 0.2], 1.0, 0.0, false), band([0.3, 8.0], 1.1, 2.0, false)];
        assert_eq!(
            sentence(&departures(&bands), widest(&bands)),
            "the model stays within about 3 dB and 20° of the measurement from 0.1 to 8 Hz, the \
             whole measured band"
        );
        assert!(sentence(&[], Some([0.5, 0.5])).contains("at 0.5 Hz, the whole"));
        assert!(sentence(&[], None).contains("at no frequency"));
    }
}
