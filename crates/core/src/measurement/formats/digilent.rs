//! Digilent WaveForms, network analyser.
//!
//! Lines that begin with `#` (`#Digilent WaveForms Network Analyzer - Bode`, `#Relative: yes`, …),
//! then `Frequency (Hz)`, the magnitude of channel 1, and magnitude and phase of channel 2. With
//! `#Relative: yes` channel 2 is relative to channel 1, which is the ratio of response to input.

use super::fault::Fault;
use super::header::Header;
use super::instrument::{Comments, Instrument, renamed};

pub(super) const INSTRUMENT: Instrument =
    Instrument { name: "the network analyser of Digilent WaveForms", is, names };

const MAGNITUDE: &str = "Channel 2 Magnitude (dB)";
const PHASE: &str = "Channel 2 Phase (";

fn is(names: &[String]) -> bool {
    names.iter().any(|name| name == MAGNITUDE) && names.iter().any(|name| name.starts_with(PHASE))
}

fn names(names: &[String], comments: &Comments, _: &mut Header) -> Result<Vec<String>, Fault> {
    let relative = comments.iter().find(|(key, _)| key.eq_ignore_ascii_case("relative"));
    if !relative.is_some_and(|(_, value)| value.eq_ignore_ascii_case("yes")) {
        return Err(Fault::new(
            "the file does not say `#Relative: yes`: export the response relative to channel 1, \
             which measures the input",
        )
        .in_column(MAGNITUDE));
    }
    Ok(renamed(names, |name| match name {
        name if name.starts_with("Frequency") => Some(name.to_owned()),
        MAGNITUDE => Some("Gain (dB)".to_owned()),
        name => name.strip_prefix(PHASE).map(|unit| format!("Phase ({unit}")),
    }))
}

#[cfg(test)]
mod tests {
    use super::super::{Source, read};

    const TEXT: &str = "#Digilent WaveForms Network Analyzer - Bode\n#Settle: 10 ms\n\
        #Relative: yes\n# response: velocity rad/s\n# magnitude: 0.5\n\
        Frequency (Hz),Channel 1 Magnitude (dB),Channel 2 Magnitude (dB),Channel 2 Phase (°)\n\
        1,0,-6,-45\n10,0,-26,-90\n";

    #[test]
    fn channel_2_is_the_ratio_of_response_to_input() {
        let of = |text: &str| read(&[Source { name: "x", bytes: text.as_bytes() }]);
        let plain = of("magnitude,frequency_hz,gain_db,phase_deg\n0.5,1,-6,-45\n0.5,10,-26,-90\n");
        let plain = plain.unwrap();
        assert_eq!(of(TEXT).unwrap().experiments(), plain.experiments());
        let driven = TEXT.replace("#Settle: 10 ms", "#Amplitude: 1 V");
        assert_eq!(of(&driven).unwrap().experiments(), plain.experiments());
        let absolute = of(&TEXT.replace("yes", "no")).unwrap_err();
        assert!(absolute.reason.contains("relative to channel 1"), "{absolute}");
    }
}
