//! OMICRON Bode 100: text between semicolons or commas, with names such as
//! `Trace 1: Gain: Magnitude (dB)`, `Trace 2: Gain: Phase (°)`, `Trace 1: Gain: Real`.

use super::fault::Fault;
use super::header::Header;
use super::instrument::{Comments, Instrument, renamed};
use super::lack;

pub(super) const INSTRUMENT: Instrument = Instrument { name: "the Bode 100 of OMICRON", is, names };

/// Quantity (`Gain`) and form (`Magnitude (dB)`) of a trace.
fn trace(name: &str) -> Option<(&str, &str)> {
    let (quantity, form) = name.strip_prefix("Trace ")?.split_once(':')?.1.split_once(':')?;
    Some((quantity.trim(), form.trim()))
}

fn is(names: &[String]) -> bool {
    names.iter().any(|name| name.starts_with("Frequency"))
        && names.iter().any(|name| trace(name).is_some())
}

fn names(names: &[String], _: &Comments, header: &mut Header) -> Result<Vec<String>, Fault> {
    let traces = || names.iter().filter_map(|name| trace(name));
    if let Some((quantity, _)) = traces().find(|(quantity, _)| *quantity != "Gain") {
        return Err(Fault::new(format!(
            "the traces are of `{quantity}`: those of a gain are needed"
        )));
    }
    // A loop gain at an injection point is measured with the sign of the feedback.
    if !header.states("inverted") {
        let lack = lack::ask("inverted", "yes");
        return Err(Fault::new(format!(
            "the phase of a loop gain that is measured at an injection point must be turned by \
             180°: {lack}, or `no` if the phase is that of the axis"
        ))
        .lacking(lack));
    }
    let has = |wanted: &str| traces().any(|(_, form)| form == wanted);
    let rectangular = has("Real") && has("Imaginary");
    let mut used: Vec<String> = Vec::new();
    let columns = renamed(names, |name| match trace(name) {
        None if name.starts_with("Frequency") => Some(name.to_owned()),
        None => None,
        Some((_, "Real")) if rectangular => Some("gain_re".to_owned()),
        Some((_, "Imaginary")) if rectangular => Some("gain_im".to_owned()),
        Some((_, form)) if !rectangular && form.starts_with("Magnitude (dB") => {
            Some("Gain (dB)".to_owned())
        }
        Some((_, form)) if !rectangular && form.starts_with("Phase (") => Some(form.to_owned()),
        Some(_) => None,
    });
    // The traces show one gain in several forms, so that the first of a form is as good as another.
    Ok(columns
        .into_iter()
        .map(|name| match used.contains(&name) {
            true => String::new(),
            false => {
                used.push(name.clone());
                name
            }
        })
        .collect())
}

#[cfg(test)]
mod tests {
    use super::super::{Source, read};

    #[test]
    fn both_variants_are_the_gain_once_the_sign_is_said() {
        let of = |text: &str| read(&[Source { name: "x", bytes: text.as_bytes() }]);
        let plain = of("magnitude,frequency_hz,gain_db,phase_deg\n0.5,1.5,-6,135\n").unwrap();
        let settings = "# response: velocity rad/s\n# magnitude: 0.5\n";
        let polar = "Frequency (Hz);Trace 1: Gain: Magnitude (dB);\"Trace 2: Gain: Phase (°)\"\n\
            1,5;-6;-45\n";
        let asked = of(&format!("{settings}{polar}")).unwrap_err();
        assert!(asked.reason.contains("--inverted yes"), "{asked}");
        let settings = format!("{settings}# inverted: yes\n");
        let read = of(&format!("{settings}{polar}")).unwrap();
        let close = |other: &crate::measurement::Measurement| {
            let [a, b] = [&plain, other].map(|m| m.experiments()[0].response[0].value);
            // Rounding of the turn and of the numbers below.
            assert!((a - b).norm() < 1e-9, "{a} {b}");
        };
        close(&read);
        let rectangular = "Frequency (Hz),Trace 1: Gain: Real ,Trace 1: Gain: Imaginary ,\
            Trace 1: Gain: Magnitude (dB),Trace 2: Gain: Phase (deg)\n\
            1.5,0.3543928915,-0.3543928915,-6,-45\n";
        close(&of(&format!("{settings}{rectangular}")).unwrap());
        let impedance = polar.replace("Gain", "Impedance");
        assert!(of(&format!("{settings}{impedance}")).unwrap_err().reason.contains("Impedance"));
    }
}
