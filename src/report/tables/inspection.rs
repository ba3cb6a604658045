//! Tables of what a measurement can show.

use servoscope_core::answers::{Detectability, DetectableEffect, EffectSize};

use crate::report::columns::Side::{Left, Right};
use crate::report::number::significant;

use super::{Cell, Table};

/// The effects that a measurement can show, the most visible first.
pub(in crate::report) fn visible(found: &Detectability) -> Table {
    let seen =
        found.effects.iter().filter_map(|effect| Some((effect, effect.detected_from.as_ref()?)));
    let mut seen: Vec<(&DetectableEffect, &EffectSize)> = seen.collect();
    seen.sort_by(|a, b| a.1.change.total_cmp(&b.1.change));
    let rows = seen.into_iter().map(|(effect, from)| {
        [
            Cell::Effect(effect.effect.clone()),
            Cell::words(size(from)),
            Cell::PerCent(from.change, 2),
            effect.named_from.as_ref().map_or(Cell::words("never"), |from| Cell::words(size(from))),
            Cell::of(effect.closest_imitator.clone(), Cell::Effect),
        ]
    });
    let columns = [
        ("effect", Left, "Effect"),
        ("smallest size noticed", Left, "smallest size noticed"),
        ("changes", Right, "changes the response by"),
        ("smallest size told apart", Left, "smallest size told apart"),
        ("most similar effect", Left, "most similar effect"),
    ];
    Table::new(columns, rows)
}

/// The effects that it cannot show, and why.
pub(in crate::report) fn unseen(found: &Detectability) -> Table {
    let rows = found.effects.iter().filter_map(|effect| {
        let reason = effect.reason.as_ref()?;
        Some([Cell::Effect(effect.effect.clone()), Cell::Sentence(reason.clone())])
    });
    Table::new([("effect", Left, "Effect"), ("why", Left, "why")], rows)
}

/// The parameter that sets the size of an effect, the first where several do.
pub(super) fn size(size: &EffectSize) -> String {
    let first = size.set_by.first().and_then(|name| size.parameters.get_key_value(name));
    let Some((name, sized)) = first.or_else(|| size.parameters.first()) else {
        return String::new();
    };
    let unit = match sized.unit.as_str() {
        "" => String::new(),
        unit => format!(" {unit}"),
    };
    format!("{name} {}{unit}", significant(sized.value, 3))
}
