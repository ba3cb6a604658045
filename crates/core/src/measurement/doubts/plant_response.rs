//! The measured ratio of velocity to input, as the file states them.

use crate::measurement::{Complex, EXCITED_SHARE, Measurement, ResponseKind};

/// Fewest points from which a trend over frequency is read.
const FEWEST: usize = 6;

/// One point of the response.
#[derive(Debug, Clone, Copy)]
pub(super) struct Point {
    /// Magnitude of the input, input units.
    pub magnitude: f64,
    /// Angular frequency, rad/s.
    pub omega_rad_s: f64,
    /// Ratio of the velocity to the input, response units per input unit (and s or 1/s).
    pub ratio: Complex,
}

/// The ratio at every excited line, lowest frequency first. A position or an acceleration is
/// converted to a velocity, as the file calls it.
pub(super) fn points(measurement: &Measurement) -> Vec<Point> {
    let kind = measurement.metadata().response_kind;
    let mut points = Vec::new();
    for experiment in measurement.experiments() {
        let lines = || experiment.input.iter().enumerate().skip(1);
        let largest = lines().map(|(_, u)| u.norm()).fold(0.0, f64::max);
        for (order, input) in lines().filter(|(_, u)| u.norm() > EXCITED_SHARE * largest) {
            let Some(harmonic) = experiment.harmonic(order) else { continue };
            let omega_rad_s = order as f64 * experiment.omega_rad_s;
            let per_velocity = match kind {
                ResponseKind::Velocity => Complex::new(1.0, 0.0),
                ResponseKind::Position => 1.0 / Complex::new(0.0, omega_rad_s),
                ResponseKind::Acceleration => Complex::new(0.0, omega_rad_s),
            };
            let ratio = harmonic.value / per_velocity / input;
            if ratio.norm() > 0.0 && ratio.norm().is_finite() {
                points.push(Point { magnitude: experiment.magnitude, omega_rad_s, ratio });
            }
        }
    }
    points.sort_by(|a, b| a.omega_rad_s.total_cmp(&b.omega_rad_s));
    points
}

/// The points of the magnitude that has the most, the largest of several; all points where each has
/// a magnitude of its own. Gains of several magnitudes differ by friction.
pub(super) fn of_one_magnitude(points: &[Point]) -> Vec<Point> {
    let count = |magnitude: f64| points.iter().filter(|p| p.magnitude == magnitude).count();
    let mut magnitudes: Vec<f64> = points.iter().map(|point| point.magnitude).collect();
    magnitudes.sort_by(f64::total_cmp);
    magnitudes.dedup();
    let most = magnitudes.into_iter().max_by_key(|magnitude| count(*magnitude));
    let is_level = |magnitude: &f64| count(*magnitude) >= FEWEST;
    let own = |point: &&Point| most.filter(is_level).is_none_or(|level| point.magnitude == level);
    points.iter().filter(own).copied().collect()
}

/// The lowest and the highest third of the points, by their number; `None` if there are too few.
pub(super) fn outer_thirds(points: &[Point]) -> Option<[&[Point]; 2]> {
    let third = points.len() / 3;
    (points.len() >= FEWEST).then(|| [&points[..third], &points[points.len() - third..]])
}

/// Median phase, degrees, within ±180° of `about_deg`.
pub(super) fn median_phase_deg(points: &[Point], about_deg: f64) -> f64 {
    let near = |point: &Point| {
        let turned = point.ratio * Complex::from_polar(1.0, -about_deg.to_radians());
        about_deg + turned.arg().to_degrees()
    };
    median(points.iter().map(near).collect())
}

/// The middle of some values.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}
