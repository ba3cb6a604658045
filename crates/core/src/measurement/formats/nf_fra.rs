//! NF frequency response analysers: `Frequency (Hz), V1 (Vrms), V2 (Vrms), θ (deg), Y1, Y2`, one
//! line a frequency, with the amplitude of the drive at each.

use super::fault::Fault;
use super::header::Header;
use super::instrument::{Comments, Instrument, renamed};

pub(super) const INSTRUMENT: Instrument = Instrument {
    name: "an analyser of NF: V1 is taken as the input, V2 as the response, and the phase as that \
           of V2 against V1",
    is,
    names,
};

fn is(names: &[String]) -> bool {
    let has = |start: &str| names.iter().any(|name| name.starts_with(start));
    has("Frequency") && has("V1 (V") && has("V2 (V") && has("θ")
}

fn names(names: &[String], _: &Comments, header: &mut Header) -> Result<Vec<String>, Fault> {
    let rms = names.iter().any(|name| name == "V1 (Vrms)");
    if rms && !header.states("amplitude") {
        header.set(None, "amplitude", "rms")?;
    }
    Ok(renamed(names, |name| match name {
        name if name.starts_with("Frequency") => Some(name.to_owned()),
        name if name.starts_with("V1") => Some("magnitude".to_owned()),
        name if name.starts_with("V2") => Some("amplitude".to_owned()),
        name => name.strip_prefix('θ').map(|unit| format!("Phase {unit}")),
    }))
}

#[cfg(test)]
mod tests {
    use super::super::{Source, read};

    #[test]
    fn the_drive_of_each_point_is_its_magnitude() {
        let of = |text: &str| read(&[Source { name: "x", bytes: text.as_bytes() }]);
        let text = "# response: velocity rad/s\n\
            Frequency (Hz), V1 (Vrms), V2 (Vrms), θ (deg), Y1, Y2\n\
            1, 0.5, 0.25, -45, 0, 0\n10, 0.7, 0.1, -90, 0, 0\n";
        let plain = of("# amplitude: rms\nmagnitude,frequency_hz,amplitude,phase_deg\n\
            0.5,1,0.25,-45\n0.7,10,0.1,-90\n");
        let read = of(text).unwrap();
        assert_eq!(read.experiments(), plain.unwrap().experiments());
        assert!(read.notes().iter().any(|note| note.contains("V1 is taken")), "{:?}", read.notes());
        let silent = of(text.split_once('\n').unwrap().1).unwrap_err();
        assert!(silent.reason.contains("--response"), "{silent}");
    }
}
