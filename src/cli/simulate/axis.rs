//! The axis that is simulated, from its parameters by name.

use servoscope_core::plant::{Actuator, Friction, Plant};

use crate::cli::Failure;

/// Parameters of the axis; the defaults are the first system of the paper.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Axis")]
pub(super) struct Axis {
    /// Pole −a of the mechanics, rad/s.
    #[arg(long, value_name = "-A", default_value_t = -10.0, allow_negative_numbers = true)]
    pole: f64,
    /// Constant K: gain of the mechanics K/(s + a), in velocity units per input unit and second.
    #[arg(long, value_name = "K", default_value_t = 10.0, allow_negative_numbers = true)]
    constant: f64,
    /// Friction while the velocity is positive, input units.
    #[arg(long, value_name = "FC", default_value_t = 0.5)]
    fc_plus: f64,
    /// Friction while the velocity is negative, input units.
    #[arg(long, value_name = "FC", default_value_t = 0.4)]
    fc_minus: f64,
    /// Static friction, which the input has to exceed to start the axis in positive direction, input
    /// units [default: as --fc-plus].
    #[arg(long, value_name = "FS")]
    fs_plus: Option<f64>,
    /// The same in negative direction [default: as --fc-minus].
    #[arg(long, value_name = "FS")]
    fs_minus: Option<f64>,
    /// Pole −p of an actuator of first order, rad/s [default: no such actuator].
    #[arg(long, value_name = "-P", allow_negative_numbers = true)]
    #[arg(conflicts_with = "natural_frequency")]
    actuator_pole: Option<f64>,
    /// Natural frequency of an actuator of second order, rad/s [default: no such actuator].
    #[arg(long, value_name = "WN", requires = "damping_ratio")]
    natural_frequency: Option<f64>,
    /// Damping ratio of an actuator of second order [default: no such actuator].
    #[arg(long, value_name = "ZETA", requires = "natural_frequency")]
    damping_ratio: Option<f64>,
}

impl Axis {
    /// The same as a plant.
    pub(super) fn plant(&self) -> Result<Plant, Failure> {
        let rate = rate("--pole", self.pole)?;
        if !(self.constant.is_finite() && self.constant != 0.0) {
            return refuse(format!("--constant: {} does not move the axis", self.constant));
        }
        let friction = Friction {
            fs_plus: self.fs_plus.unwrap_or(self.fc_plus),
            fs_minus: self.fs_minus.unwrap_or(self.fc_minus),
            ..Friction::coulomb(self.fc_plus, self.fc_minus)
        };
        for (side, fc, fs) in [
            ("plus", friction.fc_plus, friction.fs_plus),
            ("minus", friction.fc_minus, friction.fs_minus),
        ] {
            if !(fc >= 0.0 && fc.is_finite()) {
                return refuse(format!(
                    "--fc-{side}: {fc} is not a number ≥ 0; both levels are sizes"
                ));
            }
            if !(fs >= fc && fs.is_finite()) {
                return refuse(format!("--fs-{side}: {fs} is less than --fc-{side}, {fc}"));
            }
        }
        Ok(Plant {
            viscous_rate_rad_s: rate,
            constant: self.constant,
            actuator: self.actuator()?,
            friction,
        })
    }

    fn actuator(&self) -> Result<Actuator, Failure> {
        if let Some(pole) = self.actuator_pole {
            return Ok(Actuator::FirstOrder { corner_rad_s: rate("--actuator-pole", pole)? });
        }
        let (Some(wn), Some(zeta)) = (self.natural_frequency, self.damping_ratio) else {
            return Ok(Actuator::Direct);
        };
        for (flag, value) in [("--natural-frequency", wn), ("--damping-ratio", zeta)] {
            if !(value > 0.0 && value.is_finite()) {
                return refuse(format!("{flag}: {value} is not a positive number"));
            }
        }
        Ok(Actuator::SecondOrder { natural_frequency_rad_s: wn, damping_ratio: zeta })
    }
}

/// The rate of a pole, which is its negative.
fn rate(flag: &str, pole: f64) -> Result<f64, Failure> {
    match pole {
        pole if pole < 0.0 && pole.is_finite() => Ok(-pole),
        pole if pole > 0.0 => {
            refuse(format!("{flag}: {pole} is positive; a stable pole is negative: {flag} -{pole}"))
        }
        _ => refuse(format!(
            "{flag}: {pole} is not negative, as the pole of a stable axis is: \
                             {flag} -10, for example"
        )),
    }
}

fn refuse<T>(reason: String) -> Result<T, Failure> {
    Err(Failure::Input(reason))
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        axis: Axis,
    }

    fn asked(line: &str) -> Result<Plant, String> {
        let words = std::iter::once("simulate").chain(line.split_whitespace());
        let line = Line::try_parse_from(words).map_err(|error| error.to_string())?;
        line.axis.plant().map_err(|failure| failure.to_string())
    }

    #[test]
    fn poles_are_given_with_their_sign_and_refused_without() {
        let plant = asked("--pole -2.5 --actuator-pole -1e2").unwrap();
        assert_eq!(plant.viscous_rate_rad_s, 2.5);
        assert_eq!(plant.actuator, Actuator::FirstOrder { corner_rad_s: 100.0 });
        for flag in ["--pole", "--actuator-pole"] {
            let refused = asked(&format!("{flag} 2.5")).unwrap_err();
            assert!(refused.contains(&format!("{flag} -2.5")), "{refused}");
            assert!(asked(&format!("{flag} 0")).unwrap_err().contains("not negative"));
        }
    }

    #[test]
    fn the_static_level_is_the_coulomb_level_unless_given() {
        let plant = asked("--fc-plus 2 --fs-minus 3").unwrap();
        assert_eq!((plant.friction.fs_plus, plant.friction.fs_minus), (2.0, 3.0));
        let refused = asked("--fs-minus 0.3").unwrap_err();
        assert!(refused.contains("--fs-minus: 0.3 is less than --fc-minus, 0.4"), "{refused}");
        assert!(asked("--fc-plus=-1").unwrap_err().contains("≥ 0"));
    }

    #[test]
    fn an_actuator_of_second_order_needs_both_of_its_parameters() {
        let plant = asked("--natural-frequency 30 --damping-ratio 0.1").unwrap();
        assert_eq!(plant.actuator.order(), 2);
        assert!(asked("--natural-frequency 30").unwrap_err().contains("--damping-ratio"));
        assert!(asked("--damping-ratio 0.1").unwrap_err().contains("--natural-frequency"));
        let both = "--actuator-pole -5 --natural-frequency 30 --damping-ratio 0.1";
        assert!(asked(both).unwrap_err().contains("cannot be used with"));
        let refused = asked("--natural-frequency 30 --damping-ratio 0").unwrap_err();
        assert!(refused.contains("--damping-ratio: 0"), "{refused}");
    }
}
