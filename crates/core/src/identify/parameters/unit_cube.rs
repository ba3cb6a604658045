//! The search ranges as a unit cube.

use super::{CONSTANT, Coordinates};

impl Coordinates {
    /// Maps a vector of the unit cube to the search ranges of all coordinates but K, whose entry is
    /// left 0.
    pub fn within_search(&self, cube: &[f64]) -> Vec<f64> {
        let mut cube = cube.iter();
        (0..self.len())
            .map(|i| match i {
                CONSTANT => 0.0,
                _ => {
                    let share = cube.next().expect("one entry a coordinate but K");
                    self.search_lower[i] + share * (self.search_upper[i] - self.search_lower[i])
                }
            })
            .collect()
    }

    /// The inverse of [`Self::within_search`], clamped to the cube.
    pub fn share_of_search(&self, point: &[f64]) -> Vec<f64> {
        let shares = self.share_of_search_unclamped(point);
        shares.into_iter().map(|share| share.clamp(0.0, 1.0)).collect()
    }

    /// The inverse of [`Self::within_search`], not clamped: entries leave `[0, 1]` where the point
    /// lies outside the search ranges.
    pub fn share_of_search_unclamped(&self, point: &[f64]) -> Vec<f64> {
        (0..self.len())
            .filter(|i| *i != CONSTANT)
            .map(|i| {
                let width = self.search_upper[i] - self.search_lower[i];
                (point[i] - self.search_lower[i]) / width
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::PRIOR;
    use super::*;

    #[test]
    fn the_cube_spans_the_search_range_and_leaves_k_out() {
        let coordinates = Coordinates::new(2, false, &PRIOR);
        let cube = [0.1, 0.3, 0.5, 0.7, 0.9];
        let point = coordinates.within_search(&cube);
        assert_eq!(point[CONSTANT], 0.0);
        for (share, wanted) in coordinates.share_of_search(&point).iter().zip(cube) {
            assert!((share - wanted).abs() < 1e-14);
        }
        let corner = coordinates.within_search(&[1.0; 5]);
        assert!((0..6).all(|i| i == CONSTANT || corner[i] <= coordinates.upper[i]));
    }
}
