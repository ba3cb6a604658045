//! How large the noise of a measurement is, from what it says of it itself.

use super::Measurement;

impl Measurement {
    /// Standard deviation of the noise in each of re and im of a harmonic, root mean square over all
    /// harmonics, response units: of the mean over the repeats or periods where there are any, and
    /// otherwise as stated. `None` if the measurement says nothing of its noise.
    pub fn noise_std(&self) -> Option<f64> {
        rms(self.scatter()).or_else(|| {
            let harmonics = self.experiments().iter().flat_map(|e| &e.response);
            rms(harmonics.filter_map(|harmonic| harmonic.std).map(|std| (std * std, 1.0)))
        })
    }

    /// The noise in decibels below the median fundamental of all experiments. `None` if either is
    /// not known or 0.
    pub fn noise_db(&self) -> Option<f64> {
        let fundamentals = self.experiments().iter().filter_map(|e| e.harmonic(1));
        let mut sizes: Vec<f64> = fundamentals.map(|harmonic| harmonic.value.norm()).collect();
        sizes.sort_by(f64::total_cmp);
        let median = *sizes.get(sizes.len() / 2)?;
        let decibels = 20.0 * (median / self.noise_std()?).log10();
        decibels.is_finite().then_some(decibels)
    }

    /// Variance of the mean over repeats or periods, of each harmonic that has them, and the number
    /// of components that it is of: 1 of a mean, 2 of the others.
    fn scatter(&self) -> impl Iterator<Item = (f64, f64)> {
        let repeated = self.experiments().iter().filter(|e| e.has_repeats());
        repeated.flat_map(|e| {
            let count = e.repeats.len() as f64;
            e.response.iter().enumerate().map(move |(index, harmonic)| {
                let squares: f64 = e.repeats.iter().map(|r| r.response[index].norm_sqr()).sum();
                let components = if harmonic.order == 0 { 1.0 } else { 2.0 };
                (squares / (count * (count - 1.0) * components), components)
            })
        })
    }
}

/// Root mean square of variances with weights; `None` of nothing, or if it is 0.
fn rms(variances: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
    let (sum, weights) = variances.fold((0.0, 0.0), |(sum, weights), (variance, weight)| {
        (sum + weight * variance, weights + weight)
    });
    (sum > 0.0).then(|| (sum / weights).sqrt())
}

#[cfg(test)]
mod tests {
    use crate::measurement::formats::{Source, read};

    fn noise(text: &str) -> [Option<f64>; 2] {
        let read = read(&[Source { name: "x.csv", bytes: text.as_bytes() }]).unwrap();
        [read.noise_std(), read.noise_db()]
    }

    #[test]
    fn the_noise_is_that_of_the_repeats_or_as_stated_or_not_known() {
        let silent = "magnitude,omega_rad_s,re,im\n1,1,1,0\n";
        assert_eq!(noise(silent), [None, None]);
        let stated = "magnitude,omega_rad_s,re,im,std\n1,1,1,0,0.01\n1,2,1,0,0.01\n";
        let [std, decibels] = noise(stated).map(Option::unwrap);
        // Rounding of squares and a logarithm.
        assert!((std - 0.01).abs() < 1e-12 && (decibels - 40.0).abs() < 1e-9, "{std} {decibels}");
        // Deviations of ±0.1 in re alone: 0.02/(2·1·2) is the variance of each component of the mean.
        let repeated = "magnitude,omega_rad_s,repeat,re,im\n1,1,1,0.9,0\n1,1,2,1.1,0\n";
        let [std, _] = noise(repeated).map(Option::unwrap);
        assert!((std - 0.005_f64.sqrt()).abs() < 1e-12, "{std}");
    }
}
