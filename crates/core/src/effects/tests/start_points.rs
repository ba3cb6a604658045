//! The starting points of the search for an effect.

use super::*;

#[test]
fn start_points_lie_within_the_bounds() {
    for effect in ALL {
        for point in effect.start_points(&scope()) {
            assert_eq!(point.len(), effect.parameters().len(), "{}", effect.id());
            for (parameter, value) in effect.parameters().iter().zip(point) {
                let [low, high] = (parameter.range)(&scope()).bounds;
                let name = format!("{} {}", effect.id(), parameter.name);
                assert!(low <= value && value <= high, "{name}: {value}");
            }
        }
    }
}

// With steps of a factor of 2, a quarter of the fits of a joint beside an actuator of order 2 end
// in another local minimum; with 1.25, two of 76 do, both lightly damped.
#[test]
fn starts_of_a_flexible_mode_cover_the_band_in_smaller_steps_for_lighter_damping() {
    let scope = scope();
    let points = find("flexible_mode").unwrap().start_points(&scope);
    let frequency = |point: &[f64]| (point[1] * scope.plant.constant / point[0]).sqrt();
    let ratio = |point: &[f64]| 0.5 * point[2] * frequency(point) / point[1];
    for (damping_ratio, next) in [(0.02, 1.12), (0.07, 1.2), (0.25, 1.4), (0.8, 2.0)] {
        let is_so = |point: &&Vec<f64>| (ratio(point) / damping_ratio - 1.0).abs() < 1e-9;
        let found: Vec<f64> = points.iter().filter(is_so).map(|point| frequency(point)).collect();
        assert!((found[0] / scope.omega_low - 1.0).abs() < 1e-9);
        assert!(found[found.len() - 1] > 1.5 * scope.omega_high);
        assert!(found.windows(2).all(|pair| pair[1] < next * pair[0]), "{found:?}");
    }
}

// With a resonance above ten times the band a contact is an impact, whatever its stiffness. A light
// load can look like a heavier one with another gap.
#[test]
fn starts_of_backlash_range_from_resonances_in_the_band_to_impacts_for_light_and_heavy_loads() {
    let scope = scope();
    let points = find("backlash").unwrap().start_points(&scope);
    for (heavy, gap) in [(false, 1e-3), (true, 1e-3), (false, 1e-2), (true, 1e-2)] {
        let is_so = |point: &&Vec<f64>| {
            (point[0] > 0.2) == heavy && (point[3] / scope.largest_travel > gap) == (gap > 5e-3)
        };
        let frequency = |point: &Vec<f64>| {
            let inertia = point[0] * (1.0 - point[0]) / scope.plant.constant;
            (point[1] / inertia).sqrt()
        };
        let mut found: Vec<f64> = points.iter().filter(is_so).map(frequency).collect();
        found.sort_by(f64::total_cmp);
        assert!(found[0] < 3.0 * scope.omega_low, "{found:?}");
        assert!(found[found.len() - 1] > 3.3 * scope.omega_high, "{found:?}");
        assert!(found.windows(2).all(|pair| pair[1] < 3.01 * pair[0]), "{found:?}");
    }
}
