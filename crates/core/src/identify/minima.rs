//! Which of the minima that several starts led to are worth following to their end.

use super::refine::Refined;

/// Two rough refinements have led to the same minimum if no coordinate differs by more than this.
const SAME_MINIMUM: f64 = 1e-2;

/// A minimum is followed to its end if it is higher than the lowest by no more than this share: a
/// hundred times what a further step of the rough refinement would gain.
const ABOUT_AS_LOW: f64 = 1e-3;

/// The lowest of some minima, and those about as low that differ from it and from each other, the lowest
/// first.
pub(super) fn different_minima(mut rough: Vec<Refined>) -> Vec<Refined> {
    rough.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let mut different: Vec<Refined> = Vec::new();
    for refined in rough {
        let lowest = different.first().map_or(refined.cost, |first| first.cost);
        let apart = |other: &Refined| {
            let both = refined.point.iter().zip(&other.point);
            both.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        };
        let is_low = refined.cost <= lowest * (1.0 + ABOUT_AS_LOW);
        if is_low && different.iter().all(|other| apart(other) > SAME_MINIMUM) {
            different.push(refined);
        }
    }
    different
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_starts_that_led_to_the_same_minimum_the_lowest_is_followed_and_high_minima_are_not() {
        let refined = |cost: f64, at: f64| Refined {
            point: vec![1.0, at],
            cost,
            evaluations: 1,
            damping: 1.0,
            stop: "converged",
        };
        let rough = vec![
            refined(100.001, 0.005),
            refined(100.0, 0.0),
            refined(100.05, 0.5),
            refined(100.06, 0.505),
            refined(100.2, 2.0),
        ];
        let followed: Vec<f64> = different_minima(rough).iter().map(|one| one.cost).collect();
        assert_eq!(followed, [100.0, 100.05]);
    }
}
