//! How much of the progress each part of the choice of an order takes.

/// Shares of the progress.
pub(super) struct Spans {
    /// Every effect alone, at every order.
    pub singles: [f64; 2],
    /// The same again at an order that turns out to be better.
    pub again: [f64; 2],
    /// Several effects together, at the best order and at the second best.
    pub combining: [[f64; 2]; 2],
    /// Cross-validation and assembly of the answer.
    pub concluding: [f64; 2],
}

impl Spans {
    /// For so many orders at first, and perhaps another one beside what is found.
    pub fn of(orders: usize, perhaps_another: bool) -> Self {
        let (studied, combining, concluding) = match orders {
            1 => (0.3, [[0.3, 0.75], [0.75, 0.75]], [0.75, 1.0]),
            _ => (0.5, [[0.5, 0.65], [0.65, 0.8]], [0.8, 1.0]),
        };
        let first = if perhaps_another { 2.0 / 3.0 * studied } else { studied };
        Self { singles: [0.0, first], again: [first, studied], combining, concluding }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shares_of_the_progress_follow_each_other() {
        for (orders, perhaps_another) in [(1, false), (1, true), (3, false), (3, true)] {
            let Spans { singles, again, combining, concluding } =
                Spans::of(orders, perhaps_another);
            let all = [singles, again, combining[0], combining[1], concluding].concat();
            assert!(all.is_sorted() && (all[0], all[9]) == (0.0, 1.0), "{all:?}");
            assert_eq!(again[0] < again[1], perhaps_another, "{all:?}");
        }
    }
}
