//! How large a cause is, in terms of the machine.

use std::f64::consts::TAU;

use servoscope_core::answers::{Cause, Identification, ParameterEstimate};

use super::number::{Rounding, significant};
use super::words::{parameter_name, typeset};

/// A ratio above this is said as so many times, and not as per cent above.
const READ_AS_TIMES: f64 = 3.0;

/// A value with half its 95 % interval, to the digits that this leaves: `10.0003 ± 0.0034`. Where
/// the interval is not even about the value, its ends: `0.8 (0.7 to 1.2)`.
pub(super) fn with_interval(estimate: &ParameterEstimate) -> String {
    let Some(value) = estimate.value else { return "not determined".to_owned() };
    let space = if estimate.unit.is_empty() { "" } else { "\u{a0}" };
    let unit = format!("{space}{}", estimate.unit);
    let Some([low, high]) = estimate.interval95.filter(|_| estimate.identifiable) else {
        return format!("{}{unit}", typeset(&significant(value, 4)));
    };
    let half = 0.5 * (high - low);
    let Some(rounding) = Rounding::of(value, half) else {
        return format!("{}{unit}", typeset(&significant(value, 4)));
    };
    let write = |number: f64| typeset(&rounding.write(number));
    match (0.5 * (high + low) - value).abs() > 0.1 * half {
        true => format!("{} ({} to {}){unit}", write(value), write(low), write(high)),
        false => format!("{} ± {}{unit}", write(value), write(half)),
    }
}

/// Parameters of a cause: what each is called, and its value with its interval.
pub(super) fn values(cause: &Cause) -> Vec<(String, String)> {
    let named = |(name, estimate): (&String, &ParameterEstimate)| {
        (parameter_name(&format!("{}.{name}", cause.effect)), with_interval(estimate))
    };
    cause.parameters.iter().map(named).collect()
}

/// What the parameters of a cause come to in the machine, where that takes more than to read
/// them; `model` is the one with the causes.
pub(super) fn in_the_machine(cause: &Cause, model: &Identification) -> Option<String> {
    let own = |name: &str| cause.parameters.get(name).and_then(|estimate| estimate.value);
    let of_model = |name: &str| model.parameters.get(name).and_then(|estimate| estimate.value);
    match cause.effect.as_str() {
        "static_friction" => {
            let above = |level: &str, dry: &str| Some(own(level)? / of_model(dry)? - 1.0);
            let ways = [("fs_plus", "fc_plus", "forwards"), ("fs_minus", "fc_minus", "backwards")];
            let said = ways.into_iter().filter_map(|(level, dry, way)| {
                Some(format!("{} {way}", percent(above(level, dry)?)?))
            });
            let said = said.collect::<Vec<_>>().join(", ");
            (!said.is_empty()).then(|| format!("above dry friction by {said}"))
        }
        "stribeck" => {
            let ratio = own("fs_over_fc")?;
            Some(match ratio > READ_AS_TIMES {
                true => format!("friction at rest is {} times that at speed", short(ratio)),
                false => {
                    format!("friction at rest is {} above that at speed", percent(ratio - 1.0)?)
                }
            })
        }
        "viscous_asymmetry" => sides(own("alpha")?, "damping"),
        "gain_asymmetry" => sides(own("gamma")?, "the amplifier's gain"),
        "friction_drift" => {
            let delta = own("delta")?;
            let way = if delta < 0.0 { "fell" } else { "rose" };
            Some(format!("friction {way} by {} while it was measured", percent(delta.abs())?))
        }
        "transport_delay" => Some(format!("{} ms late", short(1e3 * own("delay")?))),
        "sensor_lag" => {
            let corner = 1.0 / (TAU * own("time_constant")?);
            Some(format!("a low pass with its corner at {} Hz", short(corner)))
        }
        "spring" => {
            let hertz = (own("stiffness")? * of_model("constant")?).sqrt() / TAU;
            hertz.is_finite().then(|| format!("resonance with this spring: {} Hz", short(hertz)))
        }
        "flexible_mode" => {
            let share = own("load_inertia_fraction")?;
            let anti = (own("stiffness")? * of_model("constant")? / share).sqrt() / TAU;
            let resonance = anti / (1.0 - share).sqrt();
            resonance.is_finite().then(|| {
                let [anti, resonance] = [anti, resonance].map(short);
                format!("antiresonance at {anti} Hz, resonance at {resonance} Hz")
            })
        }
        "cogging" => {
            let frequency = cause.parameters.get("cycles_per_unit")?;
            let unit = frequency.unit.strip_prefix("1/").filter(|unit| !unit.contains('·'));
            let unit = unit.unwrap_or("units of position");
            Some(format!("it repeats every {} {unit}", short(TAU / frequency.value?)))
        }
        _ => None,
    }
}

/// One direction above the other, of a quantity that is (1 + asymmetry) to (1 − asymmetry).
fn sides(asymmetry: f64, of: &str) -> Option<String> {
    let size = asymmetry.abs();
    let above = percent((1.0 + size) / (1.0 - size) - 1.0)?;
    let (more, less) =
        if asymmetry > 0.0 { ("forwards", "backwards") } else { ("backwards", "forwards") };
    Some(format!("{of} is {above} larger {more} than {less}"))
}

fn percent(share: f64) -> Option<String> {
    (share.is_finite() && share.abs() < 100.0).then(|| format!("{}\u{a0}%", short(100.0 * share)))
}

fn short(value: f64) -> String {
    typeset(&significant(value, 2))
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::sample;

    use super::*;

    fn estimate(value: f64, interval95: Option<[f64; 2]>) -> ParameterEstimate {
        let sample = sample::identification().parameters["pole"].clone();
        ParameterEstimate { value: Some(value), interval95, unit: "A".into(), ..sample }
    }

    #[test]
    fn a_value_has_the_digits_that_its_interval_leaves() {
        let even = estimate(10.000_34, Some([9.996_94, 10.003_74]));
        assert_eq!(with_interval(&even), "10.0003 ± 0.0034\u{a0}A");
        let skew = estimate(0.8, Some([0.7, 1.2]));
        assert_eq!(with_interval(&skew), "0.80 (0.70 to 1.20)\u{a0}A");
        assert_eq!(with_interval(&estimate(-0.123_456, None)), "−0.1235\u{a0}A");
        assert_eq!(with_interval(&ParameterEstimate { value: None, ..even }), "not determined");
    }

    fn cause(effect: &str, values: &[(&str, f64)]) -> Cause {
        let mut cause = sample::explained().causes[0].clone();
        cause.effect = effect.into();
        cause.parameters =
            values.iter().map(|(name, value)| ((*name).into(), estimate(*value, None))).collect();
        cause
    }

    #[test]
    fn a_cause_is_told_in_terms_of_the_machine() {
        let mut model = sample::identification();
        for (name, value) in [("fc_plus", 0.5), ("fc_minus", 0.4), ("constant", 10.0)] {
            model.parameters.insert(name.into(), estimate(value, None));
        }
        let said = |effect: &str, values: &[(&str, f64)]| {
            in_the_machine(&cause(effect, values), &model)
                .unwrap_or_default()
                .replace('\u{a0}', " ")
        };
        assert_eq!(
            said("static_friction", &[("fs_plus", 0.8), ("fs_minus", 0.6)]),
            "above dry friction by 60 % forwards, 50 % backwards"
        );
        assert_eq!(
            said("stribeck", &[("fs_over_fc", 1.6)]),
            "friction at rest is 60 % above that at speed"
        );
        assert_eq!(
            said("stribeck", &[("fs_over_fc", 12.33)]),
            "friction at rest is 12 times that at speed"
        );
        assert_eq!(
            said("viscous_asymmetry", &[("alpha", -0.2197)]),
            "damping is 56 % larger backwards than forwards"
        );
        assert_eq!(said("transport_delay", &[("delay", 0.002)]), "2 ms late");
        // sqrt(40·10/0.25) = 40 rad/s, and that over sqrt(0.75).
        let load = [("load_inertia_fraction", 0.25), ("stiffness", 40.0)];
        assert_eq!(said("flexible_mode", &load), "antiresonance at 6.4 Hz, resonance at 7.4 Hz");
        let mut cogging = cause("cogging", &[("cycles_per_unit", 20.0)]);
        for (unit, said) in [("1/rad", "0.31 rad"), ("1/(response·s)", "0.31 units of position")] {
            cogging.parameters["cycles_per_unit"].unit = unit.into();
            let text = in_the_machine(&cogging, &model).unwrap();
            assert_eq!(text, format!("it repeats every {said}"));
        }
        assert_eq!(said("slew_limit", &[("rate", 3.0)]), "");
    }
}
