//! What the data tell without a model, in one sentence.

use crate::answers::{LinearityLevel, Share};
use crate::diagnose::residuals::sentence::short;
use crate::measurement::Measurement;

/// One sentence on the noise, the distortion, and the change of the gain with the level.
pub(super) fn of(
    measurement: &Measurement,
    levels: &[LinearityLevel],
    change: Option<Share>,
) -> String {
    let all = |part: fn(&LinearityLevel) -> Option<Share>| -> Vec<Share> {
        levels.iter().filter_map(part).collect()
    };
    let noise: Vec<f64> = levels.iter().filter_map(|level| level.noise).collect();
    let mut said = vec![match noise.is_empty() {
        true => "the noise is not known".to_owned(),
        false => format!("noise is {} of the response", range(&noise)),
    }];
    let shares = [
        (all(|level| level.odd), "odd distortion", " (as of friction, backlash, saturation)"),
        (all(|level| level.even), "even distortion", " (from differences between the directions)"),
        (all(|level| level.stochastic), "distortion that depends on the phases of the input", ""),
    ];
    said.extend(shares.iter().filter_map(|(shares, name, of)| part(shares, name, of)));
    if let Some(change) = change {
        said.push(match (change.value > 0.0, change.detectable) {
            (true, _) => format!(
                "from the smallest to the largest magnitude the gain changes by {}",
                percent(change.value)
            ),
            (false, least) => format!(
                "the gain does not change with the magnitude (by less than {})",
                percent(least.unwrap_or(0.0))
            ),
        });
    }
    let is_hidden = shares.iter().all(|(shares, ..)| shares.is_empty());
    if is_hidden && measurement.experiments().iter().any(|e| e.pure_cosine().is_none()) {
        said.push(
            "the input excites every line of its band, which hides distortion: leave lines out, \
             or measure again with other phases"
                .into(),
        );
    }
    format!("from the data alone, without a model: {}", said.join("; "))
}

/// A part at all levels: its range and what it may be of, or that there is none; nothing if it was
/// not measured.
fn part(shares: &[Share], name: &str, of: &str) -> Option<String> {
    let values: Vec<f64> = shares.iter().map(|share| share.value).collect();
    let largest = values.iter().copied().reduce(f64::max)?;
    let limits = shares.iter().map(|share| share.detectable);
    Some(match limits.collect::<Option<Vec<f64>>>() {
        None => format!("{name}, noise included, is {}", range(&values)),
        Some(limits) if largest == 0.0 => {
            let least = limits.iter().copied().fold(0.0, f64::max);
            format!("there is no {name} above {}", percent(least))
        }
        Some(_) => format!("{name}{of} is {}", range(&values)),
    })
}

/// From the smallest to the largest of some shares.
fn range(values: &[f64]) -> String {
    let [least, most] = [f64::min, f64::max].map(|of| values.iter().copied().reduce(of));
    let [least, most] = [least, most].map(|value| short(100.0 * value.unwrap_or(0.0)));
    if least == most { format!("{most} %") } else { format!("{least} to {most} %") }
}

fn percent(share: f64) -> String {
    format!("{} %", short(100.0 * share))
}
