//! The order of the experiments.
//!
//! An axis warms up while it is measured. In a sweep that goes up, what the warming changes looks like an
//! effect of frequency or magnitude. So the order is drawn, and of many drawn orders the one is taken in
//! which the position is least correlated with both (rerandomisation: K. L. Morgan, D. B. Rubin 2012,
//! doi:10.1214/12-AOS1008).

use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use super::design::Point;

/// Orders that are drawn.
const DRAWN: usize = 200;

/// Indices of experiments in the order in which they are to be made.
pub(super) fn of(experiments: &[Point], rng: &mut ChaCha8Rng) -> Vec<usize> {
    let mut order: Vec<usize> = (0..experiments.len()).collect();
    let mut best: Option<(f64, Vec<usize>)> = None;
    for _ in 0..DRAWN {
        order.shuffle(rng);
        let confounded = confounded(experiments, &order);
        if best.as_ref().is_none_or(|(least, _)| confounded < *least) {
            best = Some((confounded, order.clone()));
        }
    }
    best.map_or(order, |(_, order)| order)
}

/// The larger of the squared correlations of the position in an order with the logarithms of magnitude
/// and frequency.
pub(super) fn confounded(experiments: &[Point], order: &[usize]) -> f64 {
    let squared = |value: fn(&Point) -> f64| {
        let values: Vec<f64> = order.iter().map(|i| value(&experiments[*i]).ln()).collect();
        correlation(&values).powi(2)
    };
    squared(|point| point.magnitude).max(squared(|point| point.omega_rad_s))
}

/// The correlation of values with their position; 0 if they are all the same.
fn correlation(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let middle = 0.5 * (count - 1.0);
    let (mut product, mut by_value, mut by_position) = (0.0, 0.0, 0.0);
    for (position, value) in values.iter().enumerate() {
        let (x, y) = (position as f64 - middle, value - mean);
        product += x * y;
        by_value += y * y;
        by_position += x * x;
    }
    let size = (by_value * by_position).sqrt();
    if size > f64::MIN_POSITIVE { product / size } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;

    // 12 orders at random have a squared correlation of 1/11 with either on average.
    #[test]
    fn the_position_says_next_to_nothing_of_magnitude_and_frequency() {
        let experiments: Vec<Point> = (0..12)
            .map(|i| Point {
                magnitude: 1.0 + f64::from(i / 4),
                omega_rad_s: 1.0 + f64::from(i % 4),
                settle_periods: 1,
                measured_periods: 1,
            })
            .collect();
        let upward: Vec<usize> = (0..12).collect();
        assert!(confounded(&experiments, &upward) > 0.8);
        let order = of(&experiments, &mut ChaCha8Rng::seed_from_u64(3));
        assert!(confounded(&experiments, &order) < 0.01, "{order:?}");
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, upward);
    }
}
