//! Standardisation: scales each component to mean 0 and standard deviation 1 over the samples.

/// Mean and standard deviation of each component of a set of vectors.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Scaling {
    means: Vec<f64>,
    /// 0 where a component does not vary.
    deviations: Vec<f64>,
}

impl Scaling {
    /// The scaling of samples of equal length; values that are not finite are ignored.
    pub(super) fn of<'a>(samples: impl Iterator<Item = &'a [f64]> + Clone) -> Self {
        let length = samples.clone().next().map_or(0, <[f64]>::len);
        assert!(length > 0, "samples without components");
        let (mut means, mut deviations) = (vec![0.0; length], vec![0.0; length]);
        for component in 0..length {
            let values = || samples.clone().map(|s| s[component]).filter(|x| x.is_finite());
            let count = values().count().max(1) as f64;
            let mean = values().sum::<f64>() / count;
            let variance = values().map(|x| (x - mean).powi(2)).sum::<f64>() / count;
            means[component] = mean;
            // Smaller variation is rounding.
            let varies = variance.sqrt() > 1e-12 * mean.abs();
            deviations[component] = if varies { variance.sqrt() } else { 0.0 };
        }
        Self { means, deviations }
    }

    pub(super) fn len(&self) -> usize {
        self.means.len()
    }

    /// Standard deviation of a component; 0 where it does not vary.
    pub(super) fn deviation(&self, component: usize) -> f64 {
        self.deviations[component]
    }

    /// Standardises `values`, clipped to ±`range`. A component that does not vary, and NaN, become
    /// 0, the mean.
    pub(super) fn apply(&self, values: &[f64], range: f64, out: &mut [f64]) {
        assert_eq!(values.len(), self.len(), "components");
        for (component, (out, value)) in out.iter_mut().zip(values).enumerate() {
            let deviation = self.deviations[component];
            let scaled = (value - self.means[component]) / deviation;
            let usable = deviation > 0.0 && !scaled.is_nan();
            *out = if usable { scaled.clamp(-range, range) } else { 0.0 };
        }
    }

    /// Converts standardised values back to the original units.
    pub(super) fn invert(&self, scaled: &[f64]) -> Vec<f64> {
        let terms = self.means.iter().zip(&self.deviations).zip(scaled);
        terms.map(|((mean, deviation), x)| mean + deviation * x).collect()
    }
}
