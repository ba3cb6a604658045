//! The usual scatter of one repeat of a harmonic, from those of nearly the same size or frequency.

/// Number of neighbours whose scatter is taken together. The median of forty variances of ten degrees of
/// freedom is known to about a tenth.
const NEIGHBOURS: usize = 40;

/// Number of those of which it is judged how the scatter depends on what makes them neighbours.
const FURTHER_NEIGHBOURS: usize = 80;

/// The scatter of the repeats of a harmonic.
pub(super) struct Scatter {
    /// Unbiased variances of the parts of one repeat along the mean and across it.
    pub variances: [f64; 2],
    /// Degrees of freedom of both together.
    pub dof: f64,
    /// Whether both parts scatter: the mean is real.
    pub is_complex: bool,
}

/// What is usual of one repeat.
pub(super) struct Usual {
    /// Mean of the variances of its two parts.
    pub mean: f64,
    /// The larger of the two: the noise of a gain and that of a phase differ.
    pub larger: f64,
}

impl Usual {
    /// The one of larger variance.
    pub fn or_larger(self, other: Self) -> Self {
        if other.larger > self.larger { other } else { self }
    }
}

/// What is usual of a repeat of each harmonic, from those of nearly the same `key`, positive numbers: their
/// variances as a power of it, which lies between `powers`, by the median of the slopes between all pairs
/// (H. Theil 1950; P. K. Sen 1968, doi:10.1080/01621459.1968.10480934). Medians are turned into means
/// (Wilson and Hilferty 1931, doi:10.1073/pnas.17.12.684). `None` where nothing scatters.
pub(super) fn of_each(scatter: &[Scatter], key: &[f64], powers: [f64; 2]) -> Vec<Option<Usual>> {
    let mut places: Vec<usize> = (0..scatter.len()).collect();
    places.sort_by(|a, b| key[*a].total_cmp(&key[*b]));
    let each = |place: &usize| {
        let Scatter { variances: [along, across], dof, .. } = scatter[*place];
        let mean = 0.5 * (along + across) / (1.0 - 2.0 / (9.0 * dof)).powi(3);
        Point {
            key: key[*place].max(f64::MIN_POSITIVE).ln(),
            variance: mean.ln(),
            parts: [along, across],
            counts: scatter[*place].is_complex,
        }
    };
    let sorted: Vec<Point> = places.iter().map(each).collect();
    let mut usual: Vec<(usize, Option<Usual>)> =
        places.iter().enumerate().map(|(at, place)| (*place, of(&sorted, at, powers))).collect();
    usual.sort_by_key(|(place, _)| *place);
    usual.into_iter().map(|(_, usual)| usual).collect()
}

/// Logarithms of a key and of the mean variance, and the variances of both parts.
struct Point {
    key: f64,
    variance: f64,
    parts: [f64; 2],
    /// Whether it tells what is usual.
    counts: bool,
}

fn of(sorted: &[Point], position: usize, [least, most]: [f64; 2]) -> Option<Usual> {
    let nearest = |count: usize| {
        let begin = position.saturating_sub(count / 2).min(sorted.len().saturating_sub(count));
        sorted[begin..].iter().take(count).filter(|point| point.counts)
    };
    let further: Vec<&Point> = nearest(FURTHER_NEIGHBOURS).collect();
    let pairs = further.iter().enumerate().flat_map(|(i, a)| {
        further[i + 1..].iter().map(move |b| (b.variance - a.variance) / (b.key - a.key))
    });
    let power = median(pairs).unwrap_or(0.0).clamp(least, most);
    let near = || nearest(NEIGHBOURS);
    if median(near().map(|point| point.parts[0] + point.parts[1]))? == 0.0 {
        return None;
    }
    let own = sorted[position].key;
    let mean = median(near().map(|point| point.variance + power * (own - point.key)))?.exp();
    let part = |which: usize| median(near().map(|point| point.parts[which]));
    let (along, across) = (part(0)?, part(1)?);
    let larger = 2.0 * mean * along.max(across) / (along + across);
    larger.is_finite().then_some(Usual { mean, larger })
}

/// The median of the finite values.
fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    // The median of forty variances of ten degrees of freedom is known to 9 %, the power over a factor of
    // ten in size to 0.1, half a factor of three away from the middle: 12 % together, and three times that.
    #[test]
    fn the_usual_scatter_follows_noise_of_one_size_and_of_a_share_alike() {
        let mut rng = ChaCha8Rng::seed_from_u64(6);
        for (power, [along, across]) in [(0, [1.0, 1.0]), (1, [1.0, 1.0]), (1, [1.2, 0.75])] {
            let sizes: Vec<f64> = (0..120).map(|n| 1.03_f64.powi(n)).collect();
            let mut scatter = |size: &f64| {
                let std = 0.01 * size.powi(power);
                let mut part = |share: f64| -> f64 {
                    let value: f64 = StandardNormal.sample(&mut rng);
                    std * share * value
                };
                let mut variance = |share: f64| {
                    let values: Vec<f64> = (0..6).map(|_| part(share)).collect();
                    let mean = values.iter().sum::<f64>() / 6.0;
                    values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / 5.0
                };
                let variances = [along, across].map(&mut variance);
                Scatter { variances, dof: 10.0, is_complex: true }
            };
            let scatter: Vec<Scatter> = sizes.iter().map(&mut scatter).collect();
            let usual = of_each(&scatter, &sizes, [0.0, 2.0]);
            for position in [0, 60, 119] {
                let usual = usual[position].as_ref().unwrap();
                let std = 0.01 * sizes[position].powi(power);
                let mean = 0.5 * (along * along + across * across) * std.powi(2);
                let larger = (along * along) * std.powi(2);
                let near = |a: f64, b: f64| (a / b).ln().abs() < 0.35;
                assert!(near(usual.mean, mean), "{power} {position}: {} {mean}", usual.mean);
                assert!(
                    near(usual.larger, larger),
                    "{power} {position}: {} {larger}",
                    usual.larger
                );
            }
        }
    }
}
