//! A made-up judgement of linearity.

use crate::answers::{DistortionLine, LinearLine, Linearity, LinearityLevel, Parity, Share};

/// A stepped sine of two magnitudes with odd distortion.
pub fn linearity() -> Linearity {
    let level = |magnitude: f64, odd: f64| LinearityLevel {
        magnitude,
        realisations: 1,
        approximation: [0.5, 1.0, 2.0]
            .map(|hz| LinearLine {
                omega_rad_s: std::f64::consts::TAU * hz,
                gain: [0.9 / hz, -0.3],
                noise_std: Some(0.001),
                total_std: None,
                amplitude: magnitude / hz,
                noise: Some(0.001),
            })
            .to_vec(),
        distortion: [(0.5, Parity::Odd), (0.5, Parity::Even), (2.0, Parity::Odd)]
            .map(|(hz, parity)| DistortionLine {
                omega_rad_s: std::f64::consts::TAU * hz,
                parity,
                amplitude: if parity == Parity::Odd { odd * magnitude } else { 0.001 },
                noise: Some(0.001),
            })
            .to_vec(),
        noise: Some(0.003),
        even: Some(Share { value: 0.0, detectable: Some(0.002) }),
        odd: Some(Share { value: odd, detectable: Some(0.002) }),
        stochastic: None,
    };
    Linearity {
        levels: vec![level(1.0, 0.11), level(2.0, 0.06)],
        change_with_level: Some(Share { value: 0.21, detectable: Some(0.002) }),
        sentence: "from the data alone, without a model: noise is 0.3 % of the response; odd \
                   distortion is 6 to 11 %; there is no even distortion above 0.2 %; from the \
                   smallest to the largest magnitude the gain changes by 21 %"
            .into(),
    }
}
