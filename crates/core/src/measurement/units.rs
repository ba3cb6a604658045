//! Infers the kind of a response from its unit.

use super::ResponseKind;

/// Names of a unit in lower case, and its exponents of distance (length or angle) and time.
struct Unit {
    names: &'static [&'static str],
    exponents: [i32; 2],
    /// SI prefixes that may stand before the names.
    prefixes: &'static [&'static str],
}

/// SI prefixes of symbols, in lower case.
const SYMBOLS: &[&str] = &["n", "u", "µ", "μ", "m", "c", "d", "k", "g"];

/// SI prefixes of names.
const NAMES: &[&str] = &["nano", "micro", "milli", "centi", "deci", "kilo", "mega", "giga"];

/// The units that tell the kind of a response. A name that a unit has without a prefix (`min`)
/// goes before one with a prefix (`m` and `in`).
const UNITS: &[Unit] = &[
    Unit { names: &["m", "rad", "deg", "°", "arcsec"], exponents: [1, 0], prefixes: SYMBOLS },
    Unit {
        names: &[
            "metre", "metres", "meter", "meters", "radian", "radians", "degree", "degrees", "inch",
            "inches",
        ],
        exponents: [1, 0],
        prefixes: NAMES,
    },
    Unit {
        names: &[
            "in",
            "ft",
            "foot",
            "feet",
            "mil",
            "mils",
            "thou",
            "micron",
            "microns",
            "rev",
            "revs",
            "revolution",
            "revolutions",
            "umdrehung",
            "umdrehungen",
            "turn",
            "turns",
            "count",
            "counts",
            "cts",
            "inc",
            "incs",
            "increment",
            "increments",
            "pulse",
            "pulses",
            "step",
            "steps",
            "arcmin",
            "arcminute",
            "arcminutes",
            "arcsecond",
            "arcseconds",
        ],
        exponents: [1, 0],
        prefixes: &[],
    },
    Unit { names: &["s", "sec"], exponents: [0, 1], prefixes: SYMBOLS },
    Unit { names: &["second", "seconds"], exponents: [0, 1], prefixes: NAMES },
    Unit {
        names: &["secs", "min", "mins", "minute", "minutes", "h", "hr", "hour", "hours"],
        exponents: [0, 1],
        prefixes: &[],
    },
    Unit { names: &["hz"], exponents: [0, -1], prefixes: SYMBOLS },
    Unit { names: &["hertz"], exponents: [0, -1], prefixes: NAMES },
    Unit {
        names: &["rpm", "rps", "mph", "kph", "kmh", "fps", "ips"],
        exponents: [1, -1],
        prefixes: &[],
    },
];

/// Exponents of distance and time of one unit; `None` if it is unknown.
fn exponents(name: &str) -> Option<[i32; 2]> {
    // In lower case, newton-metre would be nanometre.
    if name == "Nm" {
        return None;
    }
    let name = name.to_lowercase();
    let has = |unit: &&Unit, name: &str| unit.names.contains(&name);
    let plain = UNITS.iter().find(|unit| has(unit, &name));
    let prefixed = || {
        UNITS.iter().find(|unit| {
            let mut rests = unit.prefixes.iter().filter_map(|prefix| name.strip_prefix(prefix));
            rests.any(|rest| has(unit, rest))
        })
    };
    plain.or_else(prefixed).map(|unit| unit.exponents)
}

/// A text in one spelling: exponents as `^-1`, products as `*`, quotients as `/`.
fn in_one_spelling(unit: &str) -> String {
    let digit = |c: char| "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().position(|superscript| superscript == c);
    let mut text = String::new();
    for c in unit.replace("**", "^").replace(" per ", "/").chars() {
        match (c, digit(c)) {
            ('⁻' | '−', _) => text.push('-'),
            ('·' | '⋅' | '∙' | '×' | '.', _) => text.push('*'),
            (_, Some(digit)) => text += &digit.to_string(),
            _ => text.push(c),
        }
    }
    // A space is a product, but not beside another sign.
    let words: Vec<&str> = text.split_whitespace().collect();
    let mut joined = words.join("*");
    for sign in ["*", "/", "^", "(", ")"] {
        joined = joined.replace(&format!("*{sign}"), sign).replace(&format!("{sign}*"), sign);
    }
    joined
}

/// The kind of response that a unit belongs to; `None` if the unit is unknown or belongs to no
/// motion.
///
/// Units are products, powers and quotients of those of one table, in the usual spellings: `m/s^2`,
/// `m s-2`, `m·s⁻²`, `m*s**-2`, `m/(s*s)`, `metres per second`.
pub(super) fn kind_of(unit: &str) -> Option<ResponseKind> {
    let unit = in_one_spelling(unit);
    // Revolutions per minute in German. Alone, U is no unit of a motion.
    let unit = unit.strip_prefix("U/").map_or(unit.clone(), |time| format!("rev/{time}"));
    // Only what is in brackets may be a product below the line: `m/s*s` could mean two things.
    let (above, below) = unit.split_once('/').unwrap_or((&unit, ""));
    let below = match below.strip_prefix('(').and_then(|rest| rest.strip_suffix(')')) {
        Some(product) => product.split('*').collect(),
        None if below.contains('*') => return None,
        None => below.split('/').collect::<Vec<_>>(),
    };
    let factors =
        above.split('*').map(|factor| (factor, 1)).chain(below.into_iter().map(|f| (f, -1)));
    let mut sum = [0, 0];
    for (factor, sign) in factors.filter(|(factor, _)| !["", "1"].contains(factor)) {
        let factor = factor.trim_start_matches('(').trim_end_matches(')');
        let end = factor.find(|c: char| "^-+".contains(c) || c.is_ascii_digit());
        let (name, power) = factor.split_at(end.unwrap_or(factor.len()));
        let power = match power.strip_prefix('^').unwrap_or(power) {
            "" if end.is_none() => 1,
            power => power.trim_matches(['(', ')']).parse::<i32>().ok()?,
        };
        let exponents = exponents(name)?;
        sum = [0, 1].map(|i| sum[i] + sign * power.clamp(-9, 9) * exponents[i]);
    }
    match sum {
        [1, 0] => Some(ResponseKind::Position),
        // An angle is often left out: 1/min, Hz.
        [0 | 1, -1] => Some(ResponseKind::Velocity),
        [0 | 1, -2] => Some(ResponseKind::Acceleration),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_tells_the_kind_of_a_response_in_any_usual_spelling() {
        use ResponseKind::{Acceleration, Position, Velocity};
        for (kind, units) in [
            (
                Position,
                "mm,Rad,°,m,µm,μm,um,nm,cm,in,inch,inches,ft,feet,mil,mdeg,krad,degrees,radians,\
                 Meters,millimetres,counts,rev,arcsec,m^1,m^2/m",
            ),
            (
                Velocity,
                "m/s,deg / s,rpm,RPM,rev/min,U/min,U / s,Umdrehungen/min,rad/sec,deg/sec,m s-1,m*s^-1,m*s**-1,rad·s⁻¹,rad s^-1,\
                 km/h,ft/s,Hz,kHz,1/min,min-1,min⁻¹,1/s,s^-1,mm/ms,metres per second,\
                 degrees/minute,m*s^(-1),m/(s),µm/s,counts/s,mm / min",
            ),
            (
                Acceleration,
                "rad/s²,m/s^2,m/s2,m/(s^2),m/(s²),m/s/s,m s-2,m·s⁻²,m/(s*s),rad s^-2,m/s**2,\
                 mm/s²,degrees/second^2,m / s ^ 2,1/s²,Hz/s",
            ),
        ] {
            for unit in units.split(',') {
                assert_eq!(kind_of(unit), Some(kind), "{unit}");
            }
        }
    }

    #[test]
    fn a_unit_that_is_unknown_or_of_no_motion_tells_nothing() {
        for unit in
            ",U,V,A,N·m,Nm,N m,V/s,s,g,%,m/s*s,m^2,kg m/s,m/s^3,rad/V,/,//,^,m^,m^x,-,m/s^,(,)*"
                .split(',')
        {
            assert_eq!(kind_of(unit), None, "{unit}");
        }
    }
}
